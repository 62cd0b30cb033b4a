#pragma once
// How large a light with a surface is: the disc that its sphere turns towards a receiver, or the sun's; of a rectangle,
// one of the same area.
#include <cmath>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Radius of the disc over the length of the ray towards its centre (Receivers::at): a directional light's radius is an
/// angle, and its rays are of length 1.
inline float discRadius(const LightView& light)
{
    const float radius = light.constants.sourceRadius;
    return light.type == GN_LIGHT_TYPE_DIRECTIONAL ? std::tan(radius) : radius;
}

/// A sun as wide as this is half of the sky's height; its disc's rim lies at tan = 1.
inline constexpr float kWidestSun = 0.7854f;

/// Why rays cannot go to points of this light's disc, or null.
inline const char* refusesDisc(const LightView& light)
{
    const bool wide = light.type == GN_LIGHT_TYPE_DIRECTIONAL && light.constants.sourceRadius > kWidestSun;
    return wide ? "directional light's sourceRadius above 0.7854 (45 degrees)" : nullptr;
}

} // namespace gnomon
