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

/// One map's projection. Seen from the light nothing is mirrored: front faces keep their winding.
///
/// Every caster within `scene` and the light's reach lies between the light and `far`. Receivers may lie beyond: past
/// `far` (unlimited range, directional) they compare as depth 1, past the sides of a directional fit they are lit.
/// Casters may lie before `near` only where `scene` comes closer to the light than 1/10000 of its far end; clamped
/// depth (depthClamp, or gl_Position.z) lets those cast as if they stood at `near`.
struct LightFit {
    glm::mat4 clipFromWorld{1.0f}; ///< World relative to the origin; Vulkan clip space, 0 near, 1 far, y down.
    std::array<Plane, 6> volume;   ///< World, inward, unit normals: left, right, top, bottom, near, far.
    float nearWs = 0.0f;           ///< Metres from the light along the map's axis (directional: from the origin).
    float farWs = 0.0f;
    float endWs = 0.0f;      ///< No caster lies past it; at most `farWs`. Before it where the range is longer.
    float texelAtOne = 0.0f; ///< Width of a texel at distance 1 m (directional: anywhere), for resolution 1.
    DepthKind depth = DepthKind::clip;
};

/// How near a face touches a light, metres. One in the plane of a face, set into a ceiling say, is by rounding before
/// or behind it, and no ray that ends short of the light meets that face. 2^-21 of the largest coordinate: a few units
/// in the last place of positions and of where transforms put them, and the share of coordinates in the offset at which
/// rays end (shaders/shared/receiver.h).
/// @param extent metres; how far coordinates of casters go, if farther than the light's.
double touchingDistance(const LightView& light, double extent) noexcept;

/// From a point to a box, metres; 0 inside.
double nearestDistance(const Aabb& box, glm::dvec3 point);

/// Spot: the square around the cone, a little wider, so that no receiver that the light reaches lies beside it, and
/// widened by `borderTexels` at `resolution`, so that filters at the cone's rim stay inside. Near and far from the
/// casters in range; the far end is the light's range, or reaches past `scene` where the range is unlimited.
LightFit fitSpot(const LightView& light, const Aabb& scene, std::uint32_t resolution = 1, float borderTexels = 0.0f);
/// Directional: the scene's bounds seen along the light, texel-independent. `scene` bounds all casters, so that none is
/// in front of the near end.
LightFit fitDirectional(const LightView& light, const Aabb& scene);
/// A part of what fitDirectional() gives, with its depths.
/// @param middle metres from the origin along the map's sides, to the right and down
/// @param half   metres, half the length of either side
LightFit fitWindow(const LightFit& whole, glm::dvec2 middle, glm::dvec2 half);
/// The same light's picture mapped by a projective map, so that a part of it gets all texels, or some get more: clip x,
/// y and w are `map` times those of `whole`, up to a factor. All that lies on a ray of the light stays on one, with the
/// order of its depths.
/// @param least what `map` makes of a w of 1, where it is least in the new picture; above 0
LightFit fitProjected(const LightFit& whole, const glm::dmat3& map, double least);
/// Point: face +X, -X, +Y, -Y, +Z, -Z in world axes, widened by `borderTexels` at `resolution` so that filtering near a
/// face border stays inside the face. Near and far are those of all six faces.
LightFit fitCubeFace(const LightView& light, const Aabb& scene, std::uint32_t face, std::uint32_t resolution,
                     float borderTexels);

/// The least depth that any of a box has in the maps of a light with a position, metres along their axes, and a little
/// less; not above 0 where the box reaches the light, or its plane.
float nearestDepth(const LightView& light, const Aabb& box);

/// Distance from a light with a position past which it has no caster, metres: its range, or a little more than the
/// farthest point of `scene` where that is nearer.
float casterReach(const LightView& light, const Aabb& scene);

/// Bounds of the light's casters: everything a map of this light has to cover, seen from no camera. Where a moving
/// caster sticks out of the static ones the box is rounded up to coarse steps, so that the fit, and with it the map of
/// the static casters, does not change in every frame. No casters: a zero box at the origin.
Aabb sceneBounds(const LightCasters& casters);

} // namespace gnomon
