#pragma once
// Whether a part of space around a light can hold anything a camera sees.
#include <array>
#include <span>

#include "runtime/base/arena.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// What a camera sees: from the near rectangle along four edges, for a length or without end.
struct Frustum {
    std::array<glm::vec3, 4> corners; ///< Near rectangle, in ring order.
    std::array<glm::vec3, 4> runs;    ///< From each corner: to the far one where bounded, else directions; all of the
                                      ///< same depth.
    bool bounded = false;
};

/// The part of the view that the light's range can reach; without an end where range is unlimited.
Frustum frustumOf(const CameraView& view, const LightView& light);

/// Whether any part of the frustum lies on the inner side of the plane. Conservative: "false" is never wrong.
bool touches(const Frustum& frustum, const Plane& plane);

/// Whether the frustum meets the endless pyramid from `apex` whose four edges run along `edges` (unit, ring order).
/// Separating axes: side planes of both, and the cross products of their edges. Conservative: "false" is never wrong.
bool meetsPyramid(const Frustum& frustum, glm::vec3 apex, const std::array<glm::vec3, 4>& edges);

/// Whether the shadow of what lies in the box meets the frustum. The shadow is an endless cone around the box's sphere,
/// wider by `angle` radians on every side. Conservative: "false" is never wrong.
bool shadowMeets(const Frustum& frustum, glm::vec3 apex, const Aabb& box, float angle);

/// What maps around a point light leave out: the values of the setting `culling`. The picture is the same with each.
enum class MapCulling : std::uint8_t {
    none,    ///< Nothing: every part (face or paraboloid) is drawn with every caster.
    casters, ///< From a part, the casters outside it.
    parts,   ///< Parts in which no visible receiver lies, too.
    shadows, ///< Casters whose shadow the view does not see, too. The map then depends on the view.
};
inline MapCulling mapCulling(double setting)
{
    return static_cast<MapCulling>(static_cast<std::uint8_t>(setting));
}

/// Those of a part's casters that may throw a shadow into the task's view; all, short of MapCulling::shadows.
/// @param angle of the texels around a receiver that it is compared with, radians
std::span<const Caster* const> castersSeen(MapCulling culling, const Frustum& visible, glm::vec3 light, float angle,
                                           std::span<const Caster* const> casters, FrameArena& arena);

/// Edges of a face of the cube around a point light, faces as in fitCubeFace().
std::array<glm::vec3, 4> cubeFaceEdges(std::uint32_t face);

} // namespace gnomon
