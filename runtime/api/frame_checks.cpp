// What the host says of a frame, checked before anything changes: order, budget, semaphores, views, lights, images.
#include <algorithm>
#include <cmath>

#include "runtime/api/context.hpp"
#include "runtime/base/number_text.hpp"

namespace gnomon {

Error frameOrder(const std::string& text)
{
    return {GN_ERROR_FRAME_ORDER, "FrameOrder", text};
}

namespace {

Result<void> checkSemaphores(const GnSemaphorePoint* points, std::uint32_t count, const char* name)
{
    const auto missing = [name](const std::string& what) {
        return Error{GN_ERROR_NULL_ARGUMENT, "SemaphoresMissing", std::string(name).append(what).append(" is null")};
    };
    if (count && !points) return missing("");
    for (std::uint32_t i = 0; i < count; ++i)
        if (!points[i].semaphore) return missing(std::string("[") + std::to_string(i) + "].semaphore");
    return {};
}

} // namespace

Result<void> Context::takeInput(const GnFrameInfo& info)
{
    if (executor_->underway()) return frameOrder("gnFinishShadows of frame " + std::to_string(frame_) + " is missing");
    if (info.frame == 0) return frameOrder("frame is 0; the first frame is at least 1");
    if (frame_ != 0 && info.frame != frame_ + 1)
        return frameOrder("frame is " + std::to_string(info.frame) + " after " + std::to_string(frame_));
    if (const GnFrameFlags other = info.flags & ~(GN_FRAME_PRESUBMIT_BIT | GN_FRAME_TIMED_BIT))
        return unknownFlags("GnFrameInfo::flags", other, "GnFrameFlagBits");
    if (info.completedFrame >= info.frame)
        return frameOrder("completedFrame " + std::to_string(info.completedFrame) + " is not before frame " +
                          std::to_string(info.frame));
    if (Result<void> free = executor_->checkSlot(info.frame, info.completedFrame); !free) return free;
    if (std::isnan(info.budgetMs)) return Error{GN_ERROR_NOT_A_NUMBER, "BudgetNaN", "budgetMs is NaN"};
    if (std::isinf(info.budgetMs)) return Error{GN_ERROR_INFINITE, "BudgetInfinite", "budgetMs is infinite"};
    if (info.budgetMs < 0.0f)
        return Error{GN_ERROR_OUT_OF_RANGE, "BudgetNegative", "budgetMs is " + shortestText(double{info.budgetMs})};
    if (info.viewCount && !info.pViews) return Error{GN_ERROR_NULL_ARGUMENT, "ViewsMissing", "pViews is null"};
    if (Result<void> ok = checkSemaphores(info.pWaits, info.waitCount, "pWaits"); !ok) return ok;
    if (Result<void> ok = checkSemaphores(info.pSignals, info.signalCount, "pSignals"); !ok) return ok;
    if (Result<void> ok = acceptViews(info); !ok) return ok;

    auto points = [](const GnSemaphorePoint* list, std::uint32_t count, std::vector<VkSemaphoreSubmitInfo>& out) {
        out.clear();
        for (std::uint32_t i = 0; i < count; ++i)
            out.push_back({.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                           .semaphore = list[i].semaphore,
                           .value = list[i].value,
                           .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT});
    };
    points(info.pWaits, info.waitCount, waits_);
    points(info.pSignals, info.signalCount, signals_);
    return {};
}

/// Everything about views and lights is checked before anything changes.
Result<void> Context::acceptViews(const GnFrameInfo& info)
{
    acceptedViews_.clear();
    for (std::uint32_t i = 0; i < info.viewCount; ++i) {
        const GnViewFrame& frame = info.pViews[i];
        View* view = findView(frame.view);
        if (!view)
            return Error{GN_ERROR_INVALID_HANDLE, "InvalidHandle",
                         "pViews[" + std::to_string(i) + "].view is not a live view of this context"};
        if (std::find(acceptedViews_.begin(), acceptedViews_.end(), view) != acceptedViews_.end())
            return Error{GN_ERROR_OUT_OF_RANGE, "ViewTwice", "view '" + view->name + "' appears twice in the frame"};
        if (Result<void> ok = checkViewFrame(frame, view->name.c_str(), view->maxLights, *vk_); !ok) return ok;
        for (std::uint32_t k = 0; k < frame.lightCount; ++k) {
            const GnLight* earlier = std::find(frame.pLights, frame.pLights + k, frame.pLights[k]);
            if (earlier != frame.pLights + k)
                return Error{GN_ERROR_OUT_OF_RANGE, "LightTwice",
                             "view '" + view->name + "': pLights[" + std::to_string(k) + "] is pLights[" +
                                 std::to_string(earlier - frame.pLights) + "] again"};
            if (!scene_->validLight(frame.pLights[k]))
                return Error{GN_ERROR_INVALID_HANDLE, "InvalidHandle",
                             "view '" + view->name + "': pLights[" + std::to_string(k) +
                                 "] is not a live light of this context"};
        }
        if (Result<void> ok = checkSharedImages(info, i, view->name); !ok) return ok;
        acceptedViews_.push_back(view);
    }
    return {};
}

/// Views may share their images (two parts of one). Layouts belong to an image, which is one thing for all of them.
Result<void> Context::checkSharedImages(const GnFrameInfo& info, std::uint32_t index, const std::string& name) const
{
    const GnViewFrame& frame = info.pViews[index];
    for (std::uint32_t i = 0; i < index; ++i) {
        const GnViewFrame& other = info.pViews[i];
        const bool depth = other.depthImage == frame.depthImage;
        const bool normals = frame.normalImage && other.normalImage == frame.normalImage;
        const bool sameSize =
            other.imageExtent.width == frame.imageExtent.width && other.imageExtent.height == frame.imageExtent.height;
        const bool same = sameSize && (!depth || other.depthView == frame.depthView) &&
                          (!normals || other.normalView == frame.normalView);
        if ((depth || normals) && !same)
            return Error{GN_ERROR_OUT_OF_RANGE, "ImageShared",
                         "view '" + name + "' shares " + (depth ? "depthImage" : "normalImage") + " with pViews[" +
                             std::to_string(i) + "], but not its image view and imageExtent"};
    }
    return {};
}

} // namespace gnomon
