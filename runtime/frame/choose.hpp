#pragma once
// The choice: facts in, a method per light out, all lights of all views together; and what runs beside these methods,
// the outgoing ones of fades and a probe.
#include "runtime/frame/frame.hpp"
#include "runtime/frame/frame_budget.hpp"
#include "runtime/frame/frame_costs.hpp"
#include "runtime/frame/probe_run.hpp"
#include "runtime/select/frame_plan.hpp"

namespace gnomon {

/// What the choice takes.
struct ChooseParts {
    Selector& selector;
    FramePlan& plan;
    const MethodTable& methods;
    FrameBudget& budget;
    FrameHistory& history;
    ProbeRun& probe;
    bool ownReady = false; ///< The runtime's own passes, grid and mix, can run.
};

/// Third stage. The frame's budget has begun, and facts are measured.
void choose(Frame& frame, const ChooseParts& parts);

/// Rules in force; null: there are none.
inline const rules::RuleBase* ruleBaseOf(const Selector& selector)
{
    return selector.engine() ? &selector.engine()->base() : nullptr;
}

} // namespace gnomon
