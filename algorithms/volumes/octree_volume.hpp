#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Stencil shadow volumes of lights and casters that stand still: built once, concealed ones left out, the rest kept in
/// an octree and drawn only where the depth image says that they matter. The picture is stencil_volume's.
/// Source:    Rautenbach, Pieterse and Kourie, in Rautenbach 2008, 3.3.4, 4.3.6 and 4.4. Umbrae of convex occluders:
///            Hudson et al. 1997; culling of volumes: Lloyd et al. 2004.
/// Reads:     topology and positions of the casters, receiver depth, geometric normals. Writes: visibility.
/// Strong at: many static casters behind walls, and many lights of which each matters to a part of the view.
/// Weak at:   what stencil_volume is weak at; lights that move get nothing but stencil_volume.
extern const AlgorithmEntry kOctreeVolume;

} // namespace gnomon
