#pragma once
// Which part of a map with straight edges a box may be drawn into.
#include <glm/mat4x4.hpp>

#include "algorithms/shared/kept_map.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Cells of which a texel may be covered by anything inside the box, in maps of 64 texels and more; all of them where
/// the box reaches the plane w = 0, or lies so close to it that its corners fall far outside the map, or closer than a
/// thousandth of its depth.
/// @param clipFromZero, zeroWs  MapProjection's
Cells boxCells(const Aabb& boxWs, const glm::mat4& clipFromZero, const glm::vec3& zeroWs);

} // namespace gnomon
