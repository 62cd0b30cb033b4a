#pragma once
// The shadow of a box as a convex region that holds at least the true one, and the umbra of a convex caster as one that
// holds at most it: what may be left undrawn is decided between the two. Plain CPU code without Vulkan.
#include <optional>
#include <vector>

#include <glm/vec4.hpp>

#include "algorithms/volumes/volume_list.hpp"
#include "runtime/scene/scene_view.hpp"
#include "shaders/volumes/cull.h"

namespace gnomon {

/// A plane here is a vec4 with dot(xyz, p) + w > 0 outside the region; xyz has unit length.

/// The points that light reaches through the box only, the box included: at most gpu::SHADOW_PLANES planes, the rest
/// are gpu::nowhereOutside(). Exact but for rounding.
struct BoxShadow {
    glm::vec4 planes[gpu::SHADOW_PLANES];
};
BoxShadow boxShadow(const Aabb& box, const LightView& light);

/// Everything behind the lit faces of a closed convex cluster, as seen from the light.
struct Umbra {
    std::vector<glm::vec4> planes; ///< At most gpu::UMBRA_PLANES.
    std::vector<glm::vec4> away;   ///< Planes of the faces turned away from the light.
};

/// Empty where the source is not known to be opaque, closed and convex, has too many faces, or holds the light.
std::optional<Umbra> umbraOf(const VolumeSource& source, const LightView& light);

/// How far inside an umbra something has to lie, in metres: the rasteriser puts the umbra's border within 1/256 pixel
/// of the true one, which at 1/700 radian a pixel is 5 mm at 900 m.
inline constexpr float kUmbraMargin = 0.005f;

/// Whether the box, and with it everything its shadow holds, lies in the umbra and outside the caster itself. "True" is
/// certain.
bool conceals(const Umbra& umbra, const Aabb& box);

} // namespace gnomon
