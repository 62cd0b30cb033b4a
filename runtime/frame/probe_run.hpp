#pragma once
// Under a budget with time to spare, a method that may be cheaper than predicted runs beside the one that serves, for
// as long as it takes to time it. Nobody sees it: exploring must not flicker. Policy::Probing says how often.
#include <cstdint>

#include "rules/engine/rule_base.hpp"
#include "runtime/cost/cost_model.hpp"
#include "runtime/select/depth_grid.hpp"

namespace gnomon {

/// The one probe that runs, and when the newest one began.
class ProbeRun {
public:
    bool runs() const { return method_ != UINT32_MAX; }
    std::uint32_t method() const { return method_; }
    std::uint64_t since() const { return since_; } ///< Frame in which the newest one began; 0: there was none yet.
    bool isOf(std::uint32_t view, std::uint32_t light) const { return view == view_ && light == light_; }
    bool isDone(std::uint64_t frame) const { return frame >= since_ + cost::kLearnFrames; }

    /// Whether the rules want another one. @param base in force; null: no rules
    bool isDue(const rules::RuleBase* base, std::uint64_t frame) const
    {
        if (!base || base->policy.probing.everyFrames == 0 || runs()) return false;
        // Predictions are made again about once in a grid's period; looking more often finds the same.
        return frame % kGridPeriod == 0 && frame >= since_ + base->policy.probing.everyFrames;
    }
    void begin(std::uint32_t view, std::uint32_t light, std::uint32_t method, std::uint64_t frame)
    {
        view_ = view;
        light_ = light;
        method_ = method;
        since_ = frame;
    }
    void end() { method_ = UINT32_MAX; }

private:
    std::uint32_t view_ = 0, light_ = 0, method_ = UINT32_MAX; ///< Ids, and the method's index.
    std::uint64_t since_ = 0;
};

} // namespace gnomon
