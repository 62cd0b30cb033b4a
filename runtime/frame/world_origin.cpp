#include "runtime/frame/world_origin.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon {

bool WorldOrigin::follow(std::span<const GnViewFrame> views, std::uint64_t frame)
{
    if (views.empty()) return false;
    // With a quarter step of slack, so that a camera on a boundary does not flip it every frame; and only where no view
    // is left near it, so that views far from one another do not, in whatever order they come.
    const auto near = [this](const GnViewFrame& view) {
        for (std::size_t i = 0; i < 3; ++i)
            if (std::abs(view.eye[i] - at_[i]) > 0.75 * kStep) return false;
        return true;
    };
    if (set_ && std::any_of(views.begin(), views.end(), near)) return false;
    for (std::size_t i = 0; i < 3; ++i)
        at_[i] = std::round(views[0].eye[i] / kStep) * kStep;
    set_ = true;
    movedIn_ = frame;
    return true;
}

} // namespace gnomon
