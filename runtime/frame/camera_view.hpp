#pragma once
// What the host says of a camera, turned into what shaders and rays use.
#include <array>
#include <span>

#include "gnomon/gnomon.h"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// The camera relative to `origin`; the frame has been checked (read_frame.hpp).
/// @param casters that may be seen
CameraView makeCameraView(const GnViewFrame& frame, const std::array<double, 3>& origin, std::uint32_t id,
                          std::span<const Caster> casters = {});

} // namespace gnomon
