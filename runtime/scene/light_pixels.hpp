#pragma once
// Where a light can matter: most lights reach a part of the picture, and only there a resolve pass has work.
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Bounds of all that the light reaches; +-1e30 where there is no end.
Aabb lightBounds(const LightView& light);

/// The pixels of view.area that can show something in the light's range; of no extent where there are none.
VkRect2D lightPixels(const LightView& light, const CameraView& view);

/// Whether a pixel of the view can show something in the light's range.
bool canBeSeen(const LightView& light, const CameraView& view);

} // namespace gnomon
