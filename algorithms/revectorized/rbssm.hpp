#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Soft shadows of lights with a radius from their depth map: the blockers around a receiver say how wide the penumbra
/// is there, and a kernel as wide is laid over a map whose edges are lines.
/// Source:    M. Macedo, "Efficient shadow anti-aliasing techniques using silhouette revectorization", 2018, 5.3; R.
/// Fernando, "Percentage-closer soft shadows", SIGGRAPH 2005 sketches.
/// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
/// Strong at: contact and other narrow penumbrae in coarse maps.
/// Weak at:   casters at several depths before one receiver; noise in wide penumbrae; cost.
extern const AlgorithmEntry kRbssm;

} // namespace gnomon
