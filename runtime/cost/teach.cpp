#include "runtime/cost/teach.hpp"

#include <algorithm>
#include <array>

namespace gnomon::cost {

namespace {

using Tracks = std::array<TrackCost, kTracks>;

// By how much a pixel that a light with a radius reaches is costlier than one of a point source: in
// rules/knowledge/lavapipe.csv 6 to 19 times for eight of thirteen methods of penumbrae; two take less, three that add
// up many shadows more.
constexpr double kSoftPixel = 8.0;
constexpr double kLevels = 8.0;  // of trees on a ray's way, the median of the same samples
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

/// What was never timed under a light with a radius is not for that without a price there. Workloads of methods whose
/// edges are hard have no such pixels.
Tracks withPenumbrae(Tracks tracks)
{
    constexpr auto kSoft = static_cast<size_t>(Term::softPixels);
    const std::array both{trackOf(Pass::resolve, Processor::gpu), trackOf(Pass::resolve, Processor::cpu)};
    if (std::ranges::any_of(both, [&](uint32_t t) { return tracks[t].ms[kSoft] > 0.0; })) return tracks;
    for (const uint32_t t : both) {
        Terms& ms = tracks[t].ms;
        const auto of = [&](Term term) { return ms[static_cast<size_t>(term)]; };
        ms[kSoft] = kSoftPixel * (of(Term::viewPixels) + of(Term::drawnPixels) + of(Term::reachedPixels) +
                                  kLevels * of(Term::rayLevels));
    }
    return tracks;
}

} // namespace

uint32_t teach(CostModel& model, const DeviceKnowledge& device, std::span<const TaughtMethod> methods,
               uint32_t firstMethod)
{
    const auto costliestOf = [&](auto&& counts) {
        Tracks costliest{};
        for (const TaughtMethod& method : methods)
            if (const AlgorithmCost* known = device.find(method.algorithm); known && counts(method))
                raise(costliest, known->tracks);
        return costliest;
    };
    const auto isEmpty = [](const Tracks& tracks) {
        return std::all_of(tracks.begin(), tracks.end(), [](const TrackCost& track) { return track.samples == 0; });
    };
    // What a GPU and other cores took says nothing of what the same cores take for both.
    model.setSharedCores(model.sharedCores() && device.kind == "software");
    uint32_t measured = 0;
    for (auto m = firstMethod; m < methods.size(); ++m) {
        if (const AlgorithmCost* known = device.find(methods[m].algorithm); known && known->isTimed()) {
            model.teach(m, withPenumbrae(known->tracks), 0.0);
            ++measured;
            continue;
        }
        Tracks alike = costliestOf([&](const TaughtMethod& other) { return other.kind == methods[m].kind; });
        if (isEmpty(alike)) alike = costliestOf([](const TaughtMethod&) { return true; });
        if (!isEmpty(alike)) model.teach(m, withPenumbrae(alike), kOfAKind);
    }
    return measured;
}

} // namespace gnomon::cost
