#pragma once
// Whether a part of space around a light can hold anything a camera sees.
#include <array>

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

/// Edges of a face of the cube around a point light, faces as in fitCubeFace().
std::array<glm::vec3, 4> cubeFaceEdges(std::uint32_t face);

} // namespace gnomon
