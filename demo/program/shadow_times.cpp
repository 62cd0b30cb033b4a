#include "demo/program/shadow_times.hpp"

#include <cmath>
#include <limits>

namespace gnomon::demo {

void ShadowTimes::note(const ShadowHost& shadows)
{
    const GnFrameStats stats = shadows.stats();
    if (first_ == 0) first_ = stats.frame;
    ms_.resize(stats.frame + 1 - first_, std::numeric_limits<double>::quiet_NaN());
    uint64_t timed = 0;
    uint32_t count = 0;
    if (gnGetPassTimings(shadows.context(), &timed, &count, nullptr) >= 0 && std::isnan(ms(timed))) {
        passes_.resize(count);
        gnGetPassTimings(shadows.context(), &timed, &count, passes_.data());
        double sum = 0.0;
        for (const GnPassTiming& pass : passes_)
            sum += double(pass.gpuMs) + double(pass.cpuMs);
        take(timed, sum);
    }
    take(stats.gpuFrame, double(stats.gpuMs) + double(stats.gpuFrameCpuMs));
}

double ShadowTimes::ms(uint64_t frame) const
{
    const bool known = frame >= first_ && frame - first_ < ms_.size();
    return known ? ms_[frame - first_] : std::numeric_limits<double>::quiet_NaN();
}

void ShadowTimes::take(uint64_t frame, double ms)
{
    if (frame >= first_ && frame - first_ < ms_.size()) ms_[frame - first_] = ms;
}

} // namespace gnomon::demo
