#pragma once
// Lights for tests without a device or a registry.
#include <cmath>

#include <glm/geometric.hpp>

#include "runtime/scene/scene_view.hpp"

namespace gnomon::test {

/// @param range metres @param cone half angle of spot lights, radians
inline LightView lightOf(GnLightType type, glm::vec3 position, glm::vec3 direction, float range, float cone)
{
    LightView light{};
    light.type = type;
    const bool directional = type == GN_LIGHT_TYPE_DIRECTIONAL;
    light.constants.positionWs = glm::vec4(position, directional ? 0.0f : 1.0f);
    light.constants.directionWs =
        glm::vec4(glm::normalize(direction), type == GN_LIGHT_TYPE_SPOT ? std::cos(cone) : -2.0f);
    light.constants.range = directional ? kUnlimitedRange : range;
    light.coneAngle = type == GN_LIGHT_TYPE_SPOT ? cone : 0.0f;
    light.constants.type = static_cast<gpu::uint>(type);
    return light;
}

} // namespace gnomon::test
