#pragma once
// What is kept of decisions: one record of fixed size per light, view and frame, in a ring. Numbers only; text is made
// when somebody asks (explain.hpp).
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "runtime/select/selector.hpp"

namespace gnomon {

/// Why a light's method was thought about.
enum class Replan : std::uint8_t {
    everyFrame, ///< No budget: the best suitability, each frame again.
    kept,       ///< The plan stayed within its budget, and nothing was worth a change.
    host,       ///< The host pinned it.
    cut,        ///< Camera cut: nothing holds.
    first,      ///< First plan of all.
    forced,     ///< New lights, or methods that could no longer serve.
    overBudget, ///< The plan was repaired.
    gain,       ///< A better plan was worth it.
    measuring,  ///< The cheapest plan runs, so that the budget can be found from it.
    count
};

/// One of the rules that count most.
struct FiredRule {
    std::uint32_t rule = rules::kNoRule;
    std::uint32_t variable = rules::kNoRule; ///< Of the limiting antecedent, as rules::RuleState counts.
    std::uint32_t term = 0;
    float strength = 0.0f;   ///< What counts of it: weight included, less what it yields to higher priorities.
    float membership = 0.0f; ///< Of the limiting term.
    float weight = 1.0f;
};
constexpr std::size_t kFiredRules = 4;
using FiredRules = std::array<FiredRule, kFiredRules>; ///< Strongest first; what did not fire is kNoRule.

/// What is written down of a decision each frame, beside its candidates.
struct RecordHead {
    std::uint64_t frame = 0;
    std::uint64_t ruleHash = 0;  ///< rules::RuleBase::textHash; 0: no rules.
    std::uint64_t knowledge = 0; ///< Timings the cost model had learned from.
    std::uint32_t lightId = 0;
    std::uint32_t method = UINT32_MAX;
    std::uint32_t wanted = UINT32_MAX; ///< Before readiness or the plan had their say.
    std::uint32_t incumbent = UINT32_MAX;
    std::uint32_t pinned = UINT32_MAX;
    std::uint32_t methods = 0;     ///< Candidates in use.
    MethodSet fallbacks;           ///< What serves while another is not ready.
    std::uint32_t distanceAge = 0; ///< Frames since viewerDistance was measured; UINT32_MAX: never, a lower bound.
    GnReason reason = GN_REASON_RULES;
    Replan replan = Replan::everyFrame;
    plan::Hold hold = plan::Hold::none;
    bool budgeted = false;   ///< A plan decided; the members from budgetMs on are set.
    bool priced = false;     ///< No budget, but the rule base lets predicted times choose among equals.
    bool guessed = false;    ///< LightDecision::guessed: the incumbent has no advantage.
    bool flatSource = false; ///< LightDecision's.
    bool asksHost = false;   ///< Likewise.
    bool switched = false;
    bool floor = false; ///< The near-quality floor held.
    bool floorUnmet = false;
    std::uint16_t mapSide = 0;    ///< Of the maps of `method`, texels; 0: it has none.
    std::uint16_t wantedSide = 0; ///< What screen coverage asks for.
    std::uint8_t redrawEvery = 0; ///< LightDecision's.
    std::uint8_t mapAge = 0;
    /// The floor holds while the first reaches the second, and for the frames of a flip after; 0: none.
    float floorTruth = 0.0f, floorStrength = 0.0f;
    float minimumQuality = 0.0f;
    float importance = 1.0f;
    float suitability = 0.0f;
    float measuredMs = 0.0f;                               ///< Of this very frame, two frames later; 0: not timed.
    float budgetMs = 0.0f, usableMs = 0.0f, planMs = 0.0f; ///< Of all lights; usable is the budget less headroom.
    float leastMs = 0.0f;   ///< Of the cheapest plan, where that is over the budget: nothing fits. 0: something does.
    float errorMs = 0.0f;   ///< One standard error of the predicted sum of all lights.
    float threshold = 0.0f; ///< What another method must be worth more, as a share of what the light's own is worth.
    FactValues facts{};
};

/// The same with the rules behind it, which follow from its facts whenever somebody asks.
struct ReasonedHead : RecordHead {
    FiredRules fired{};
};

struct DecisionRecord : ReasonedHead {
    std::vector<Candidate> candidates; ///< `methods` of them.

    std::span<const Candidate> all() const { return candidates; }
};

/// What the decisions of a frame have in common.
struct FrameRecord {
    std::uint64_t frame = 0;
    std::uint64_t knowledge = 0;
    std::uint32_t methods = 0;
    MethodSet fallbacks;
    const rules::RuleBase* base = nullptr; ///< Null: no rules.
    bool budgeted = false, priced = false, cut = false, measuring = false;
    double budgetMs = 0.0;
    plan::PlanReport report;
};

FiredRules strongestRules(const rules::Engine& engine, const rules::Inference& inference);

/// The record of one settled decision. @param measuredAt frame of the distance measurement in use
RecordHead makeRecord(const LightDecision& decision, const FrameRecord& frame, std::uint64_t measuredAt);

/// The last 256 frames of a view. Grows when more lights or methods appear than ever before, else allocates nothing:
/// 59 kB a light and 12 kB a method more (256 times 232 and 48 bytes).
class RecordRing {
public:
    static constexpr std::uint32_t kFrames = 256;

    /// Starts a frame, over the one of 256 frames ago. @param rules what decides it, kept as long; null: none
    void begin(std::uint64_t frame, std::uint32_t lights, std::uint32_t methods,
               std::shared_ptr<const rules::Engine> rules);
    /// At most as many as begin() was told.
    void add(const RecordHead& head, std::span<const Candidate> candidates);
    /// A timing of a frame in the ring has come in.
    void noteMeasured(std::uint64_t frame, std::uint32_t lightId, std::uint32_t method, float ms);

    std::uint64_t newest() const { return newest_; } ///< 0: none yet.
    std::uint64_t oldest() const;                    ///< 0: none yet.
    bool has(std::uint64_t frame) const;
    /// Lights of a frame; 0 for one that is not in the ring.
    std::uint32_t lights(std::uint64_t frame) const;
    /// How many methods a frame was decided among; 0 for one that is not in the ring.
    std::uint32_t methods(std::uint64_t frame) const;
    /// The rules a frame was decided by, whatever was loaded since; null: none, or the frame is not in the ring.
    std::shared_ptr<const rules::Engine> rules(std::uint64_t frame) const;
    DecisionRecord at(std::uint64_t frame, std::uint32_t index) const;
    /// False if the frame is not in the ring or did not have the light.
    bool find(std::uint64_t frame, std::uint32_t lightId, DecisionRecord& out) const;

private:
    struct Slot {
        std::uint64_t frame = 0;
        std::uint32_t count = 0, methods = 0;
        std::shared_ptr<const rules::Engine> rules;
    };
    std::size_t cell(std::uint64_t frame, std::uint32_t index) const { return frame % kFrames * lights_ + index; }
    void grow(std::uint32_t lights, std::uint32_t methods);

    std::array<Slot, kFrames> slots_{};
    std::uint32_t lights_ = 0, methods_ = 0; ///< Room per frame.
    std::uint64_t newest_ = 0;
    std::vector<RecordHead> heads_;
    std::vector<Candidate> candidates_;
};

} // namespace gnomon
