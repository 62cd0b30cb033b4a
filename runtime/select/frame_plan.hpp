#pragma once
// All lights of a frame together: what each method would cost (cost model), and which of them fit (plan step).
#include <vector>

#include "runtime/cost/cost_model.hpp"
#include "runtime/plan/plan.hpp"
#include "runtime/select/selector.hpp"

namespace gnomon {

/// What a light's passes took in one timed frame.
struct LightTiming {
    float updateGpuMs = 0.0f, updateCpuMs = 0.0f;   ///< Light scope: maps, volumes.
    float resolveGpuMs = 0.0f, resolveCpuMs = 0.0f; ///< Task scope.
    bool updated = false;                           ///< Some light-scope pass ran.
};

class FramePlan {
public:
    FramePlan(const MethodTable& methods, bool sharedCores) : methods_(methods) { model_.setSharedCores(sharedCores); }

    void begin();
    /// One light of one view; both references live until decide() is done.
    void add(LightDecision& decision, LightMemory& memory, const SelectionInput& input);

    struct Budget {
        double ms = 0.0;          ///< 0: none; the best suitability is kept.
        double measuredMs = -1.0; ///< Newest measured sum; < 0: unknown.
        bool cut = false;
        std::uint64_t frame = 0;
    };
    /// Predicts, and with a budget and a rule base that says so, chooses anew. @return the report of the plan step.
    plan::PlanReport decide(const rules::RuleBase* base, const Budget& budget);

    /// Timings of one completed frame, light by light, then endFrame().
    void observe(LightMemory& memory, std::uint32_t method, const LightTiming& timing, bool disturbed);
    void endFrame() { model_.endFrame(); }
    /// The light is gone, its slot is free.
    void forget(LightMemory& memory);

    /// Grows with every timing that the cost model learns from.
    std::uint64_t knowledgeRevision() const { return model_.samples(); }

private:
    void fill(const rules::RuleBase* base);
    void take(const plan::LightPlan& plan, LightDecision& decision) const;
    void explainWithoutPlan(LightDecision& decision, bool hasRules) const;
    std::uint32_t slotOf(LightMemory& memory);

    struct Request {
        LightDecision* decision;
        LightMemory* memory;
        std::uint32_t pinned;
        float importance;
    };
    const MethodTable& methods_;
    cost::CostModel model_;
    plan::PlanStep plan_;
    std::vector<Request> requests_;
    std::vector<plan::LightRequest> lights_;
    std::vector<plan::Candidate> candidates_;
    std::vector<std::uint32_t> freeSlots_;
    std::uint32_t slots_ = 0, slotsUsed_ = 0, modelMethods_ = 0;
};

/// Share of the truth a method keeps, (0, 1]: 1 / (1 + wrong percent). What is wrong is known from the bench at map
/// side 1024 (AlgorithmEntry::typicalWrongPercent) and falls with the side as 1 / side.
float qualityOf(const Method& method);

} // namespace gnomon
