#pragma once
// Where a picture may show the inside of closed casters: pixels whose view rays start in one, because the near plane
// cuts it or the eye is inside. Everywhere else what is seen lies outside of all that is drawn and closed.
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Where that may be. Both hold together.
struct NearClipRegion {
    VkRect2D pixels{}; ///< Image coordinates, within the view's area; empty, as mostly: nowhere.
    Aabb receivers;    ///< What is seen there from within lies in here, relative to the frame's origin.
};

/// Around all pixels whose view rays start within the bounds of one of the casters that are closed and not
/// alpha-tested.
NearClipRegion nearClip(const CameraView& view, std::span<const Caster* const> casters);

} // namespace gnomon
