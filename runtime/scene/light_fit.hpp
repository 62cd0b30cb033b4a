#pragma once
// Projections of lights: what a map covers. Camera-independent, so that a static light's map can be kept.
#include <array>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// How depth is stored in a map, kept with it.
enum class DepthKind : std::uint8_t {
    clip,     ///< z/w of the matrix: 0 near, 1 far.
    distance, ///< Euclidean distance from the light / range end: 0 at the light, 1 at `far`.
};

/// One map's projection.
struct LightFit {
    glm::mat4 clipFromWorld{1.0f}; ///< World relative to the origin; Vulkan clip space, 0 near, 1 far, y down.
    std::array<Plane, 6> volume;   ///< World, inward: what the map covers.
    float nearWs = 0.0f;           ///< Metres from the light (directional: along it).
    float farWs = 0.0f;
    float texelAtOne = 0.0f;       ///< Width of a texel at distance 1 m (directional: anywhere), for resolution 1.
    DepthKind depth = DepthKind::clip;
};

/// Spot: the cone's square, near and far from the casters and receivers in range. The far end is the light's range, or
/// reaches past `scene` where the range is unlimited.
LightFit fitSpot(const LightView& light, const Aabb& scene);
/// Directional: the scene's bounds seen along the light, texel-independent.
LightFit fitDirectional(const LightView& light, const Aabb& scene);
/// Point: face +X, -X, +Y, -Y, +Z, -Z in world axes, widened by `borderTexels` at `resolution` so that filtering near a
/// face border stays inside the face.
LightFit fitCubeFace(const LightView& light, const Aabb& scene, std::uint32_t face, std::uint32_t resolution,
                     float borderTexels);

/// Union of the bounds of the light's casters and of what the camera can see of the light's reach: everything a map of
/// this light may have to cover. Camera-independent: bounds of casters, clipped to the light's range.
Aabb sceneBounds(const LightCasters& casters);

} // namespace gnomon
