#pragma once
// All lights of a frame, planned without a device: methods that only have names, times that a test makes up.
#include <doctest/doctest.h>

#include <vector>

#include "explain/selector_fixture.hpp"
#include "runtime/base/jobs.hpp"
#include "runtime/select/choice.hpp"
#include "runtime/select/frame_plan.hpp"

namespace gnomon::test {

/// Lights of one view, by the built-in methods; none of them is ever run.
class PlanTable {
public:
    PlanTable()
    {
        for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms) {
            entries_.push_back(*algorithm.entry);
            entries_.back().missing = [](const DeviceTable&) { return "there is no device"; };
        }
        for (const AlgorithmEntry& entry : entries_)
            REQUIRE(methods_.addEntry(entry));
        view_.area.extent = {640, 360};
    }

    struct Lamp {
        LightView light{};
        LightMemory memory;
        LightDecision decision;
        std::vector<Candidate> candidates; ///< Of the decision.
        MethodSet able;                    ///< Methods that may serve.
        std::uint32_t suited = 0;          ///< By the rules.
        std::uint32_t pinned = UINT32_MAX;
        std::uint32_t mostSide = kUnmeasuredSide; ///< That memory allows its maps.
        double floorTruth = 0.0;
    };

    /// Predicts and plans for these lights as in a frame. Without a base every method may serve, and the rules like all
    /// alike.
    void predict(FramePlan& plan, std::vector<Lamp>& lamps, std::uint64_t frame,
                 std::span<const plan::SharedPart> parts = {}, const rules::RuleBase* base = nullptr,
                 double measuredMs = -1.0, double budgetMs = 0.0)
    {
        plan.begin();
        for (Lamp& lamp : lamps) {
            lamp.light.id = static_cast<std::uint32_t>(&lamp - lamps.data()) + 1;
            lamp.candidates.assign(methods_.size(), {});
            lamp.decision = {};
            lamp.decision.candidates = lamp.candidates;
            lamp.decision.method = 0;
            for (std::uint32_t m = 0; base && m < methods_.size(); ++m)
                lamp.decision.candidates[m] = {.exclusion = lamp.able.has(m) ? Exclusion::none : Exclusion::lightKind,
                                               .quantised = 2000};
            if (base) lamp.decision.method = lamp.suited;
            lamp.decision.floorTruth = lamp.floorTruth;
            SelectionInput input = this->input(lamp);
            input.pinned = lamp.pinned;
            input.mostPlainSide = lamp.mostSide;
            input.frame = frame;
            plan.add(lamp.decision, lamp.memory, input);
        }
        report = plan.decide(base, {.ms = budgetMs,
                                    .parts = parts,
                                    .measuredMs = measuredMs,
                                    .lastSecondMs = 60.0 * std::max(measuredMs, 0.0),
                                    .frame = frame});
    }
    plan::PlanReport report; ///< Of the newest predict().

    MethodTable& methods() { return methods_; }
    /// What a lamp is asked with.
    SelectionInput input(const Lamp& lamp) const
    {
        return {.view = &view_, .light = &lamp.light, .casters = &casters_};
    }

private:
    std::vector<AlgorithmEntry> entries_;
    DeviceTable vk_;
    DeviceMemory memory_{vk_, 0, {}};
    SamplerSet samplers_{vk_};
    PipelineStore pipelines_{vk_, memory_, samplers_};
    JobSystem jobs_{nullptr, nullptr, 1};
    Messages messages_{nullptr, nullptr};
    MethodTable methods_{vk_, pipelines_, jobs_, messages_, false};
    CameraView view_;
    LightCasters casters_;
};

} // namespace gnomon::test
