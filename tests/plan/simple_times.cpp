#include "tests/plan/simple_times.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::test {

namespace {

constexpr double kLeastMs = 1e-6; // below what any clock tells
constexpr double kStep = 1.15;    // a larger one is no noise

double medianOf(std::vector<double>& values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace

SimpleTimes::SimpleTimes(const cost::DeviceKnowledge& known, std::span<const std::string> methods, uint32_t lights,
                         const SimpleTuning& tuning)
    : tuning_(tuning), methods_(static_cast<uint32_t>(methods.size())), seeds_(methods.size()),
      timed_(size_t{lights} * methods.size() * 2), scales_(methods.size())
{
    std::array<cost::TrackCost, cost::kTracks> costliest{}; // what is not in the base is as costly as any, term by term
    for (const cost::AlgorithmCost& algorithm : known.algorithms)
        for (uint32_t t = 0; t < cost::kTracks; ++t)
            for (uint32_t i = 0; i < cost::kTerms; ++i)
                costliest[t].ms[i] = std::max(costliest[t].ms[i], algorithm.tracks[t].ms[i]);
    for (size_t m = 0; m < methods.size(); ++m) {
        const cost::AlgorithmCost* of = known.find(methods[m]);
        seeds_[m] = of ? of->tracks : costliest;
    }
    steps_.reserve(size_t{lights} * 2);
    firsts_.reserve(size_t{lights} * 2);
}

double SimpleTimes::seedMs(uint32_t method, cost::Pass pass, const cost::Workload& workload) const
{
    const cost::Terms terms = cost::termsOf(workload, pass);
    double ms = 0.0;
    for (const cost::Processor on : {cost::Processor::gpu, cost::Processor::cpu})
        ms += cost::sumOf(seeds_[method][cost::trackOf(pass, on)].ms, terms);
    return ms;
}

double SimpleTimes::sizeOf(uint32_t method, cost::Pass pass, const cost::Workload& workload) const
{
    if (tuning_.scalesBySeed) return std::max(seedMs(method, pass, workload), kLeastMs);
    const double drawn = workload.drawnTriangles > 0.0 ? workload.drawnTriangles : workload.casterTriangles;
    return std::max(pass == cost::Pass::update ? drawn : workload.pixels, 1.0);
}

double SimpleTimes::passMs(uint32_t light, uint32_t method, cost::Pass pass, const cost::Workload& workload) const
{
    const Timed& own = timed_[(size_t{light} * methods_ + method) * 2 + static_cast<size_t>(pass)];
    if (own.perSize > 0.0) return own.perSize * sizeOf(method, pass, workload);
    const Timed& scale = scales_[method][static_cast<size_t>(pass)];
    const double octaves = scale.perSize > 0.0 ? tuning_.lightOctaves
                           : known_            ? tuning_.methodOctaves
                                               : tuning_.deviceOctaves;
    return seedMs(method, pass, workload) * (scale.perSize > 0.0 ? scale.perSize : device_) * std::exp2(octaves);
}

double SimpleTimes::ms(uint32_t light, uint32_t method, const cost::Workload& workload) const
{
    const double update = workload.still ? 0.0 : passMs(light, method, cost::Pass::update, workload);
    return update + passMs(light, method, cost::Pass::resolve, workload);
}

void SimpleTimes::observe(uint32_t light, uint32_t method, cost::Pass pass, const cost::Workload& workload, double ms)
{
    if (!(ms > kLeastMs)) return;
    const auto follow = [&](Timed& known, double value) {
        const double believed = known.newest > 0.0 ? std::min(known.newest, value) : value; // a spike shows in one
        known.newest = value;
        known.perSize += (known.perSize > 0.0 ? tuning_.rate : 1.0) * (believed - known.perSize);
    };
    Timed& own = timed(light, method, pass);
    const double size = sizeOf(method, pass, workload), seed = std::max(seedMs(method, pass, workload), kLeastMs);
    if (own.perSize > 0.0)
        steps_.push_back(ms / (own.perSize * size));
    else
        firsts_.push_back(ms / seed);
    follow(own, ms / size);
    follow(scales_[method][static_cast<size_t>(pass)], ms / seed);
}

void SimpleTimes::endFrame()
{
    if (!firsts_.empty()) {
        device_ += (known_ ? tuning_.rate : 1.0) * (medianOf(firsts_) - device_);
        known_ = true;
    }
    const double step = steps_.empty() ? 1.0 : medianOf(steps_);
    const double both = step > 1.0 ? std::min(step, lastStep_) : std::max(step, lastStep_);
    lastStep_ = step;
    if (tuning_.followsDevice && (both > kStep || both < 1.0 / kStep)) {
        lastStep_ = 1.0;
        device_ *= both;
        for (Timed& each : timed_)
            each.perSize *= both;
        for (auto& each : scales_)
            for (Timed& scale : each)
                scale.perSize *= both;
    }
    steps_.clear();
    firsts_.clear();
}

void SimpleTimes::forget(uint32_t light)
{
    const auto first = timed_.begin() + static_cast<std::ptrdiff_t>(size_t{light} * methods_ * 2);
    std::fill(first, first + static_cast<std::ptrdiff_t>(size_t{methods_} * 2), Timed{});
}

} // namespace gnomon::test
