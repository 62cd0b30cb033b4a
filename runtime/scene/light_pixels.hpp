#pragma once
// Where a light can matter: most lights reach a part of the picture, and only there a resolve pass has work.
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Bounds of all that the light reaches; +-1e30 where there is no end.
Aabb lightBounds(const LightView& light);

/// The pixels of view.area that can show something in the light's range; of no extent where there are none.
VkRect2D lightPixels(const LightView& light, const CameraView& view);

/// A layer of visibility of which a pass writes these pixels only: 1 in all others.
Part visibilityIn(const CameraView& view, std::uint32_t layer, const VkRect2D& pixels);
/// The task's layer.
Part visibilityIn(const ShadowTask& task, const VkRect2D& pixels);

} // namespace gnomon
