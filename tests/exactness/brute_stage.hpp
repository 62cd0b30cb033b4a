#pragma once
// A stage as the brute force sees it: from what the host registers and draws, in double precision.
#include <vector>

#include "exactness/stage.hpp"
#include "runtime/brute_force.hpp"

namespace gnomon::exact {

brute::View bruteView(const Stage& stage);

/// The light of a layer.
brute::Light bruteLight(const Stage& stage, size_t layer);

/// World triangles from what the host registers: the basis in float, positions and translation as they are.
std::vector<brute::Triangle> bruteTriangles(const Stage& stage);

/// The normal that the host has drawn at a pixel.
glm::dvec3 drawnNormal(const Stage& stage, uint32_t x, uint32_t y);

} // namespace gnomon::exact
