#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Stencil shadow volumes without a silhouette search: all edges of a mesh are drawn, from one list that depends on
/// nothing but the mesh, and the vertex shader shrinks those that bound no volume to a point.
/// Source:    I. Kolic, Z. Mihajlovic, L. Budin, "Stencil shadow volumes for complex and deformable objects", ICECS
/// 2004;
///            Rautenbach 2008, 2.4.
/// Reads:     topology and positions of the casters, receiver depth, geometric normals. Writes: visibility.
/// Strong at: many instances of few meshes, under lights that move: nothing is built, kept or uploaded for any of them.
/// Weak at:   large meshes on slow vertex stages: every edge has its corners shaded in every frame and light.
extern const AlgorithmEntry kAllEdgesVolume;

} // namespace gnomon
