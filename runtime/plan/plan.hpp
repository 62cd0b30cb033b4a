#pragma once

/// The plan step: one method per light from suitability, quality and predicted cost, within a budget.
///
///     PlanStep plan;
///     plan.reserve(lights, methods);                      // the only call that allocates
///     const PlanReport report = plan.step(input);         // each frame
///     plan.lights()[i].chosen; plan.why(i)[method];       // until the next step
///
/// Order of authority: capability > pin > never > near floor > budget > benefit > incumbent > cheaper > registry order.
/// README.md explains every constant.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rules/engine/rule_base.hpp"
#include "runtime/plan/greedy.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon::plan {

inline constexpr int32_t kNoOpinion = -1;

enum class Eligibility : uint8_t {
    eligible,
    trait, ///< Cannot serve the light: traits, device, memory, not ready. Nothing overrules it.
    never, ///< Vetoed by a rule. Only a pin overrules it.
};

/// What is known of one method for one light.
struct Candidate {
    Eligibility eligibility = Eligibility::eligible;
    int32_t suitability = kNoOpinion; ///< In steps of 1/4096, kNoOpinion without a rule that speaks.
    float quality = 1.0f;             ///< [0, 1].
    double ms = 0.0;                  ///< What it counts as: as predicted, or an upper bound where nobody has timed it.
                                      ///< Not finite or negative counts as unable.
    double likelyMs = 0.0;            ///< What it is expected to take where `ms` is such a bound; 0: `ms`.
    double sigmaMs = 0.0;             ///< Standard error of `ms`.
    double firstFrameMs = 0.0;        ///< Once, if the light switches to it: allocation, pipelines, caches.
    bool familiar = true;             ///< Some light was timed with it.
};

/// What the plan remembers of a light between frames. The owner keeps it beside the light; zero is a new light.
struct LightMemory {
    uint32_t incumbent = kNone;
    uint32_t previous = kNone; ///< Before the incumbent.
    uint64_t switchedAt = 0;   ///< Frame.
    uint64_t bannedUntil = 0;  ///< Frame: the light does not go back to `previous` before.
    uint64_t nearUntil = 0;    ///< Frame: until then the floor holds for what reaches it, though it is not asked for.
    float nearQuality = 0.0f;  ///< What it asks.
    bool onTrial = false;      ///< The incumbent serves for kTrialFrames so that its time is known.
};

struct LightRequest {
    LightMemory* memory = nullptr; ///< Required; updated by step().
    double importance = 1.0;       ///< > 0.
    uint32_t pinned = kNone;       ///< The host insists.
    bool floor = false;            ///< Near: nothing below minimumQuality.
    float minimumQuality = 0.0f;
};

/// Borrowed for the call.
struct PlanInput {
    uint64_t frame = 0;
    std::span<const LightRequest> lights;
    std::span<const Candidate> candidates; ///< lights x methods, light by light.
    std::span<const SharedPart> parts;     ///< Work that methods share; at most kMaxParts.
    uint32_t methods = 0;
    double budgetMs = 0.0;
    /// The budget as a multiple of what the cheapest plan is predicted to take, by kLeash from budgetMs at most where
    /// that is known; 0: budgetMs itself.
    double perCheapest = 0.0;
    double sharedMs = 0.0;    ///< Of the budget, and of what was measured, this is spent whatever the plan: no part.
    double measuredMs = -1.0; ///< Newest measured sum of the shadow passes; < 0: unknown.
    bool cut = false;         ///< Camera cut: all holds are lifted.
    const rules::Policy* policy = nullptr;         ///< Null: the defaults.
    const rules::Policy& inForce() const noexcept; ///< `policy`, or the defaults.
};

/// Why a method is, or is not, the one.
enum class Why : uint8_t {
    chosen,
    trait,      ///< Cannot serve the light.
    pinned,     ///< The host pinned another one.
    never,      ///< Vetoed by a rule.
    noOpinion,  ///< No rule speaks about it, but rules speak about others.
    floor,      ///< Near, and not good enough.
    budget,     ///< Better, but the time is not there.
    hysteresis, ///< Better and affordable, but held: LightPlan::hold says by what.
    outscored,  ///< No better than the chosen one.
    price,      ///< Suits better, but shows no more, and takes longer.
};

/// What keeps a light from a method that would be worth more and that there is time for.
enum class Hold : uint8_t {
    none,
    threshold,  ///< The change would not gain enough.
    margin,     ///< There is time for what it is predicted to take, but not for a little more and its first frame.
    quota,      ///< Others were upgraded in this frame.
    spareTime,  ///< The plan has not been within the budget for long enough.
    ban,        ///< It has just left that method.
    firstFrame, ///< The first frame costs more than the stay would gain.
    trial,      ///< No light was timed with it, and another light tries such a method.
};

struct LightPlan {
    uint32_t chosen = kNone;
    uint32_t incumbent = kNone; ///< Before this step.
    uint32_t wanted = kNone;    ///< What it moves towards, or is held from.
    double benefit = 0.0;       ///< importance * utility().
    double ms = 0.0;            ///< Predicted, without shared parts.
    double threshold = 0.0;     ///< What another method must be worth more, as a share of the benefit.
    Hold hold = Hold::none;
    bool floor = false;      ///< Near, or was within the frames of a flip.
    bool floorUnmet = false; ///< Near, but no method is good enough: the best of them serve.
    bool waits = false;      ///< What no light was timed with is another light's to try.
    bool onTrial = false;    ///< Nothing keeps the budget, and what is thought costlier is tried.
    bool switched = false;
    bool flipped = false;
};

enum class Cause : uint8_t {
    kept,     ///< Nothing changed.
    forced,   ///< Only lights that were new or had lost their method changed.
    repaired, ///< Over the budget, and changed for it.
    gain,     ///< Voluntary.
    fresh,    ///< First step, or a camera cut: nothing holds.
};

struct PlanReport {
    Cause cause = Cause::kept;
    double value = 0.0, predictedMs = 0.0; ///< Milliseconds with shared parts, here and below.
    double partsMs = 0.0;                  ///< Of predictedMs, the shared parts.
    double standardErrorMs = 0.0;          ///< Of the predicted sum.
    double budgetMs = 0.0;                 ///< In force, shared part included.
    double usableMs = 0.0;                 ///< Budget less shared part and headroom.
    double cheapestMs = 0.0;               ///< Of the cheapest plan that keeps pins, vetoes and floors.
    double overMs = 0.0;                   ///< Predicted above the budget; the floor may force it. 0 when within.
    bool feasible = true;                  ///< The cheapest plan is within the budget.
    uint32_t switches = 0, upgrades = 0, flips = 0, floorsUnmet = 0;
};

/// Spare time must have lasted so long before it is spent: one half second at 60 Hz, the relief that groups of frames
/// in other controllers wait for.
inline constexpr uint32_t kSpareFrames = 30;
/// Headroom never takes more than this share: an unknown device would otherwise have no budget at all.
inline constexpr double kMostHeadroom = 0.5;
/// How far from its measurement a budget may be by predictions alone. Lights that come and steps of the camera within
/// the quarter second that a measurement lags are less; a model that finds that a scene takes ten times as long is
/// more.
inline constexpr double kLeash = 1.5;
/// Share of the budget that lights are left with whatever the rest takes: a budget of nothing would be none.
inline constexpr double kLeastShare = 0.01;
/// Share of the headroom that may be used up before a plan counts as broken. Entering and leaving at the same limit
/// would repair and upgrade in turn on noise.
inline constexpr double kKeepShare = 0.5;
/// Share that a change must have room for beyond its prediction: half the spread of one, 8 % where a light was timed.
inline constexpr double kChangeMargin = 0.05;
/// Share of the budget that first frames of a repair may take in one frame, but for one light's.
inline constexpr double kMostFirst = 0.5;
/// What a change needs room for, ms, with its share of the first frame. The three are a Candidate's.
inline double roomForChangeMs(double ms, double likelyMs, double firstFrameMs) noexcept
{
    return changePriceMs(std::max(ms, (1.0 + kChangeMargin) * (likelyMs > 0.0 ? likelyMs : ms)), firstFrameMs);
}
/// Frames from a change to a method that no light was timed with until its time is known, at the latest: four that are
/// timed (cost::kLearnFrames), and two until timings come.
inline constexpr uint32_t kTrialFrames = 6;
/// Nothing must have kept the budget for so long before what is thought too dear is tried: two seconds at 60 Hz. In
/// recorded traces, which the model knows, it takes up to 83 frames until the view has moved on.
inline constexpr uint32_t kBrokenFrames = 120;
/// What shows as much as the incumbent is taken for its price if it takes this share less.
inline constexpr double kClearlyLess = 0.2;

class PlanStep {
public:
    /// Grows the scratch memory; the only call that allocates.
    void reserve(uint32_t lights, uint32_t methods);

    /// `input.lights` and `input.methods` must fit what was reserved.
    PlanReport step(const PlanInput& input) noexcept;

    std::span<const LightPlan> lights() const noexcept { return std::span(plans_).first(lightCount_); }
    std::span<const Why> why(uint32_t light) const noexcept { return std::span(why_).subspan(at(light, 0), methods_); }

    /// Of the newest step: whether pins, vetoes and floor leave the light this method, and importance * utility().
    bool mayServe(uint32_t light, uint32_t method) const noexcept { return allowed_[light].has(method); }
    double benefitOf(uint32_t light, uint32_t method) const noexcept { return values_[at(light, method)]; }
    /// What the light would be the reason for of the shared parts, with that method and the others as they are.
    double sharedMs(uint32_t light, uint32_t method) const noexcept;
    /// What `method` needs of the shared parts that the newest plan does not pay.
    double unpaidMs(uint32_t method) const noexcept;

private:
    void admit(const PlanInput& input) noexcept;
    void admitLight(const PlanInput& input, uint32_t light) noexcept;
    void applyFloor(uint32_t light, float minimum, bool asked) noexcept;
    void offerAll(const PlanInput& input) noexcept;
    bool gateTrials(const PlanInput& input) noexcept;
    double waitForTrials(const PlanInput& input, double headroom, double limitMs, bool over,
                         PlanReport& report) noexcept;
    bool isFamiliar(uint32_t light, uint32_t method) const noexcept { return candidates_[at(light, method)].familiar; }
    bool waitsWith(uint32_t light, uint32_t method) const noexcept;
    bool isWorthKeeping(uint32_t light) const noexcept;
    void offer(const PlanInput& input, uint32_t light) noexcept;
    double changedMs(uint32_t light, uint32_t method) const noexcept;
    bool isFresh(const PlanInput& input) const noexcept { return input.cut || !started_; }

    void planWithinBudget(const PlanInput& input, PlanReport& report) noexcept;
    double findTarget(const PlanInput& input, double headroom, PlanReport& report) noexcept;
    void improve(const PlanInput& input, double limitMs, PlanReport& report) noexcept;
    Hold tryUpgrade(const PlanInput& input, uint32_t light, double limitMs) noexcept;
    void tryDear(const PlanInput& input, PlanReport& report) noexcept;
    bool payUntil(const PlanInput& input, double limitMs) noexcept;
    void takeTarget() noexcept;
    uint32_t partsInUse() const noexcept;
    Hold holdOf(const PlanInput& input, uint32_t light) const noexcept;
    double headroomMs(const PlanInput& input, double& errorMs) const noexcept;
    void remember(const PlanInput& input, PlanReport& report) noexcept;
    void explainLight(const PlanInput& input, uint32_t light, const PlanReport& report) noexcept;

    struct Sums {
        double worth = 0.0; ///< With hysteresis.
        double ms = 0.0;    ///< With shared parts.
    };
    Sums sumOf(std::span<const uint32_t> chosen) const noexcept;
    double moveMs(uint32_t light, uint32_t to) const noexcept;
    void move(uint32_t light, uint32_t to) noexcept;
    void countUsers() noexcept;
    size_t at(uint32_t light, uint32_t method) const noexcept { return size_t{light} * methods_ + method; }
    /// Of lights x methods, those of a light.
    auto methodsOf(auto& cells, uint32_t light) const noexcept
    {
        return std::span(cells).subspan(at(light, 0), methods_);
    }

    Greedy greedy_;
    std::span<const Candidate> candidates_;         ///< Of the step's input, as
    std::span<const SharedPart> parts_;             ///< these.
    std::vector<double> values_, worths_, costsMs_; ///< lights x methods; worth is value with hysteresis.
    std::vector<MethodSet> allowed_;                ///< By light.
    std::vector<uint32_t> current_, target_, saved_;
    std::vector<uint8_t> orders_; ///< lights x methods, of sharedUtilities().
    std::vector<LightPlan> plans_;
    std::vector<Why> why_;
    std::vector<UtilityTerms> terms_;         ///< Scratch of admitLight().
    std::array<uint32_t, kMaxParts> users_{}; ///< Lights of current_ per part.
    uint32_t lightCount_ = 0, methods_ = 0;
    uint32_t orderedMethods_ = 0; ///< Stride of orders_; 0: they are to be made again.
    uint32_t calmFrames_ = 0;     ///< In a row within the budget.
    uint32_t brokenFrames_ = 0;   ///< In a row in which nothing kept the budget, and
    double savedMs_ = 0.0;        ///< what was saved up in them, for trials.
    bool started_ = false;
};

} // namespace gnomon::plan
