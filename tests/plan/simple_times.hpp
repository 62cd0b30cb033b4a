#pragma once
// The plainest account of what methods take: one smoothed timing per light, method and pass, carried over to other
// sizes in proportion. What was not timed is expected to take what a knowledge base says, times what timings of the
// method, else of the device, have shown, and some octaves more. To hold cost::CostModel against.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/cost/knowledge_base.hpp"

namespace gnomon::test {

/// Set on six of the twelve invented traces (demo/theses/measurements/2026-11-simple.md).
struct SimpleTuning {
    bool scalesBySeed = true;   ///< Timings grow with what the base says; else with triangles (update), pixels.
    bool followsDevice = true;  ///< A step that most timings show in two frames moves what is known of all methods.
    double rate = 0.3;          ///< Of the way to the lesser of the two newest timings.
    double lightOctaves = 0.1;  ///< Counted for a light that was not timed with a method that others were,
    double methodOctaves = 0.6; ///< for a method without timings,
    double deviceOctaves = 3.0; ///< for a device without timings.
    double headroom = 0.02;     ///< Share of the budget left unspent,
    double kept = 0.5;          ///< of which so much may be used up before the plan counts as broken.
    double gain = 0.02;         ///< Share by which what serves counts for more.
    double margin = 0.05;       ///< Share of its time that another method must have room for beyond it.
};

class SimpleTimes {
public:
    SimpleTimes(const cost::DeviceKnowledge& known, std::span<const std::string> methods, uint32_t lights,
                const SimpleTuning& tuning);

    /// Update and resolve, with the octaves for what was not timed.
    double ms(uint32_t light, uint32_t method, const cost::Workload& workload) const;
    /// The timings of one frame, then endFrame().
    void observe(uint32_t light, uint32_t method, cost::Pass pass, const cost::Workload& workload, double ms);
    void endFrame();
    void forget(uint32_t light);

private:
    struct Timed {
        double perSize = 0.0; ///< Smoothed; 0: never timed.
        double newest = 0.0;
    };
    double seedMs(uint32_t method, cost::Pass pass, const cost::Workload& workload) const;
    double sizeOf(uint32_t method, cost::Pass pass, const cost::Workload& workload) const;
    double passMs(uint32_t light, uint32_t method, cost::Pass pass, const cost::Workload& workload) const;
    Timed& timed(uint32_t light, uint32_t method, cost::Pass pass)
    {
        return timed_[(size_t{light} * methods_ + method) * 2 + static_cast<size_t>(pass)];
    }

    SimpleTuning tuning_;
    uint32_t methods_;
    std::vector<std::array<cost::TrackCost, cost::kTracks>> seeds_; ///< By method.
    std::vector<Timed> timed_;                                      ///< lights x methods x passes
    std::vector<std::array<Timed, 2>> scales_; ///< By method and pass: smoothed times over the seed.
    double device_ = 1.0;                      ///< The same of all methods.
    bool known_ = false;                       ///< Anything was timed.
    std::vector<double> steps_;                ///< Of this frame: timings over what was expected.
    std::vector<double> firsts_;               ///< The same of lights that were not timed before.
    double lastStep_ = 1.0;
};

} // namespace gnomon::test
