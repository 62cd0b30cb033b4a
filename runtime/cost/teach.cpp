#include "runtime/cost/teach.hpp"

#include <algorithm>
#include <array>

namespace gnomon::cost {

namespace {

using Tracks = std::array<TrackCost, kTracks>;

constexpr double kOfAKind = 0.5; // octaves: methods of one kind take the same to a factor of 1.4 (rules/knowledge)

/// The larger of each number.
void raise(Tracks& tracks, const Tracks& other)
{
    for (uint32_t t = 0; t < kTracks; ++t) {
        tracks[t].octaves = std::max(tracks[t].octaves, other[t].octaves);
        tracks[t].samples = std::max(tracks[t].samples, other[t].samples);
        for (uint32_t i = 0; i < kTerms; ++i)
            tracks[t].ms[i] = std::max(tracks[t].ms[i], other[t].ms[i]);
    }
}

} // namespace

uint32_t teach(CostModel& model, const DeviceKnowledge& device, std::span<const TaughtMethod> methods,
               uint32_t firstMethod)
{
    const auto dearestOf = [&](auto&& counts) {
        Tracks dearest{};
        for (const TaughtMethod& method : methods)
            if (const AlgorithmCost* known = device.find(method.algorithm); known && counts(method))
                raise(dearest, known->tracks);
        return dearest;
    };
    const auto isEmpty = [](const Tracks& tracks) {
        return std::all_of(tracks.begin(), tracks.end(), [](const TrackCost& track) { return track.samples == 0; });
    };
    uint32_t measured = 0;
    for (auto m = firstMethod; m < methods.size(); ++m) {
        if (const AlgorithmCost* known = device.find(methods[m].algorithm); known && known->isTimed()) {
            model.teach(m, known->tracks, 0.0);
            ++measured;
            continue;
        }
        Tracks alike = dearestOf([&](const TaughtMethod& other) { return other.kind == methods[m].kind; });
        if (isEmpty(alike)) alike = dearestOf([](const TaughtMethod&) { return true; });
        if (!isEmpty(alike)) model.teach(m, alike, kOfAKind);
    }
    return measured;
}

} // namespace gnomon::cost
