#include "algorithms/shared/blocker_search.hpp"

#include <cmath>

#include <glm/geometric.hpp>

#include "algorithms/shared/source_size.hpp"

namespace gnomon {

gpu::DiscCone discCone(const LightView& light, const LightFit& fit, const gpu::MapLookup& look)
{
    gpu::DiscCone cone{};
    cone.radius = discRadius(light);
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        cone.texelWs = glm::length(glm::vec3(look.texelDx));
        cone.reach = cone.radius * glm::length(glm::vec3(look.axisWs)) / cone.texelWs;
        return cone;
    }
    // One over the distance is linear in depth: (1 - depth) / near.
    cone.tangentPerTexel = cone.texelWs = fit.texelAtOne / look.side;
    cone.reach = cone.radius / (std::fabs(look.depthScale) * cone.tangentPerTexel);
    return cone;
}

} // namespace gnomon
