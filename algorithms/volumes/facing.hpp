#pragma once
// Which faces look towards a light: what every silhouette starts from.
//
//     sum = ((x * light.x + y * light.y) + z * light.z) + w * light.w      facing if sum > 0
#include <cstdint>
#include <span>

#include <glm/vec4.hpp>

#include "runtime/scene/topology.hpp"

namespace gnomon {

/// facing[i] = 1 if face first + i looks towards the light, else 0. @param light lightInObjectSpace().at
void findFacing(const FacePlanes& planes, const glm::vec4& light, std::uint32_t first, std::span<std::uint8_t> facing);

} // namespace gnomon
