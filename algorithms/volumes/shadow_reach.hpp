#pragma once
// Where the shadow of a caster can be, from its bounds alone; plain CPU code without Vulkan.
#include <array>

#include "runtime/scene/scene_view.hpp"
#include "shaders/volumes/volume.h"

namespace gnomon {

/// Whether any point of the near rectangle can lie in the shadow of the box, or in a penumbra wedge (wedge.h) under one
/// of its edges: whether the pyramid from the light over
/// the rectangle (directional: the prism towards the light) touches it. If not, z-pass counts right, because every view
/// ray starts outside the volume. "True" may be wrong, "false" never is.
/// @param sourceRadius of a light with a position; 0: shadows only
bool shadowsNearRectangle(const Aabb& box, const LightView& light, const std::array<glm::vec3, 4>& nearCorners,
                          float sourceRadius = 0.0f);

/// Whether the light reaches the box, and its shadow can meet the view frustum. "True" may be wrong, "false" never is.
/// @param sourceRadius of a light with a position: the penumbra counts as shadow; 0: what the light's centre does not
/// see
bool shadowTouches(const Aabb& box, const LightView& light, std::span<const Plane> frustum, float sourceRadius = 0.0f);

/// `reach` of VolumePush for a caster with these bounds, relative to the eye.
glm::vec3 casterReach(const Aabb& box, const LightView& light, glm::vec3 eye);

/// Bounds of the eye and the near rectangle.
Aabb eyeBounds(const CameraView& view);

} // namespace gnomon
