#include "runtime/select/auto_budget.hpp"

#include <algorithm>

namespace gnomon {

void AutoBudget::look(std::uint32_t lights, bool cut)
{
    if (lights == 0) return; // nothing is spent without lights
    if (measuring()) {
        lights_ = lights;
        return;
    }
    ++known_;
    const std::uint32_t changed = lights > lights_ ? lights - lights_ : lights_ - lights;
    // An eighth more lights takes less than half of what kFactor leaves.
    other_ = 8 * changed >= lights_ ? other_ + 1 : 0;
    if (other_ < kSettled && !(cut && known_ >= kSettled)) return;
    *this = {};
    again_ = true;
    lights_ = lights;
}

void AutoBudget::follow(double tookMs, double plannedMs, double cheapestMs)
{
    if (!(tookMs > 0.0) || !(plannedMs > 0.0) || !(plannedMs <= kAsCheap * cheapestMs)) return;
    cheapTookMs_[followed_ % kFollowed] = tookMs * std::min(1.0, cheapestMs / plannedMs);
    ratios_[followed_ % kFollowed] = tookMs / plannedMs;
    if (++followed_ < kFollowed) return;
    const auto median = [](std::array<double, kFollowed> window) {
        const auto middle = window.begin() + kFollowed / 2;
        std::nth_element(window.begin(), middle, window.end());
        return *middle;
    };
    ratio_ = median(ratios_);
    if (!measuring()) ms_ = kFactor * median(cheapTookMs_);
}

bool AutoBudget::note(double tookMs, double intervalMs)
{
    if (!measuring() || !(tookMs > 0.0)) return false;
    tookMs_[frames_++] = tookMs;
    elapsedMs_ += intervalMs;
    const bool enough = again_ ? frames_ >= kFewestAgain : frames_ >= kFewestFrames && elapsedMs_ >= 1000.0;
    if (!enough && frames_ < kMostFrames) return false;
    // The median of the later half: the first frames fill caches and make maps that are kept.
    const auto first = tookMs_.begin() + frames_ / 2, last = tookMs_.begin() + frames_;
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last);
    ms_ = kFactor * *middle;
    frames_ = 0;
    return true;
}

} // namespace gnomon
