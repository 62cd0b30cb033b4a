#include "runtime/frame/frame.hpp"

#include <algorithm>

namespace gnomon {

bool Frame::cameraCut() const
{
    return std::any_of(views.begin(), views.end(), [](const ViewFrame& each) { return each.view->camera.cut; });
}

void Frame::begin(std::uint64_t frame, FrameMode how)
{
    number = frame;
    mode = how;
    views.clear();
    visibilities.clear();
    imports.clear();
    casters.clear();
    lights.clear();
    planned.clear();
    predictedMs = 0.0;
    fades.clear();
    warmup = UINT32_MAX;
    maps.clear();
    raysNeeded = dropped = false;
}

} // namespace gnomon
