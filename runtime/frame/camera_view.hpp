#pragma once
// What the host says of a camera, turned into what shaders and rays use.
#include <array>
#include <span>

#include "gnomon/gnomon.h"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Whether the host's normals say what is turned away from a light. Those of shading do not.
bool judgedByNormals(const GnViewFrame& frame);

/// The camera relative to `origin`; the frame has been checked (read_frame.hpp).
/// @param casters that may be seen
CameraView makeCameraView(const GnViewFrame& frame, const std::array<double, 3>& origin, std::uint32_t id,
                          std::span<const Caster> casters = {});

} // namespace gnomon
