#pragma once
// A depth map that knows its triangles; near the edges of its shadows the neighbouring texels' triangles prove shadow,
// and what they cannot prove is traced. Source:    D. L. Moderno, "Shadow Mapping and Ray-Tracing", Universidade do
// Minho, chapters 3 and 4. Reads:     caster geometry, receiver depth and normals.     Writes: visibility. Strong at:
// edges in scenes of large or regular triangles: a fraction of a percent of the pixels is traced. Weak at:   what the
// map missed altogether: outside the contour its errors stay.
#include "runtime/algorithm.hpp"

namespace gnomon {

extern const AlgorithmEntry kContourChain;

} // namespace gnomon
