#pragma once
// Soft shadows of lights with a surface from eight points of it: a depth map from each, and rays to all eight where the
// maps do not agree.
// Source:    S. Beister, M. Ernst, M. Stamminger, "A Hybrid GPU-CPU Renderer", Vision, Modeling and Visualization 2005.
// Reads:     caster triangles, receiver depth and normals (read back).     Writes: visibility, in eighths.
// Strong at: lit and dark pixels without rays; maps of what stands still are kept.
// Weak at:   nine shades; what is hidden between the points; eight maps whenever a caster moves; no point lights.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kEightPointHybrid;

} // namespace gnomon
