#pragma once
// Facts in, a method per light out, with everything that is needed to say why.
#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "rules/engine/engine.hpp"
#include "runtime/base/method_array.hpp"
#include "runtime/cost/cost_model.hpp"
#include "runtime/plan/plan.hpp"
#include "runtime/select/facts.hpp"
#include "runtime/select/fade.hpp"
#include "runtime/select/methods.hpp"
#include "runtime/select/vocabulary.hpp"

namespace gnomon {

struct Choice;

/// Why a method cannot serve a light in a frame. Text is made on demand (explain.cpp).
enum class Exclusion : std::uint8_t {
    none,
    device, ///< Method::unavailable
    lightKind,
    notReady,
    roundTrips, ///< Recorded frames have no CPU between passes.
    hostDrawn,  ///< Reads triangles; host-drawn casters are in range.
    topology,   ///< Casters whose topology is still being built.
    trees,      ///< Casters whose tree is still being built.
    memory,     ///< Would not fit below the limit.
    refused,    ///< ShadowAlgorithm::refuses
    vetoed,     ///< By a `never` rule.
    unseen,     ///< No pixel can be in the light's range.
    gpuOnly,    ///< Casters that the host lets nobody copy to the CPU.
    copies,     ///< Casters whose copy for the CPU is not there yet.
    gpuPlaced,  ///< Casters whose transforms the GPU alone knows.
};

struct Candidate {
    Exclusion exclusion = Exclusion::none;
    bool opinion = false;
    std::int32_t quantised = -1;   ///< Suitability in steps of 1/4096; -1: no opinion.
    std::uint64_t detail = 0;      ///< Count, bytes or rule, as the exclusion says.
    const char* refusal = nullptr; ///< Static storage.
    float quality = 0.0f;          ///< Share of the truth it keeps, as the plan counts it; from the plan on.
    float predictedMs = 0.0f;      ///< By the cost model.
    float sureMs = 0.0f;           ///< What choices count with: as predicted where the light was timed with the method;
                                   ///< else what its class hardly exceeds (cost::Prediction::sureMs()).
    /// What changing to it takes beyond that: its first frame, and without a budget the incumbent's while the two fade.
    float firstMs = 0.0f;
    float sharedMs = 0.0f; ///< Work for the whole view: what no other light of the plan needs; without a plan,
                           ///< the light's part of it if all had the method.
    plan::Why why = plan::Why::outscored; ///< By the plan step, or by the best suitability where there is none.
};

/// Candidate::refusal of a method that failed when it declared its passes.
inline constexpr const char* kPassesFailed = "its passes could not be made; a message says why";

/// What was decided for one light in one view, and from what. Fixed size.
struct LightDecision {
    GnLight light = VK_NULL_HANDLE;
    std::uint32_t lightId = 0;
    std::uint32_t method = UINT32_MAX; ///< UINT32_MAX: nothing can serve.
    std::uint32_t wanted = UINT32_MAX; ///< Where the fallback serves: what it stands in for.
    std::uint32_t incumbent = UINT32_MAX;
    GnReason reason = GN_REASON_RULES;
    float suitability = 0.0f;
    float predictedMs = 0.0f;
    float measuredMs = 0.0f;
    float viewerDistance = 0.0f;
    bool distanceMeasured = false;
    bool switched = false;
    bool flatSource = false; ///< LightView::flat().
    bool asksHost = false;   ///< LightCasters::opacities: what can trace on the CPU does.
    bool guessed = false;    ///< The incumbent was chosen before its receivers were measured, as they are now.
    std::uint32_t outgoing = UINT32_MAX;             ///< Runs as well while the picture fades from it.
    float fade = 1.0f;                               ///< Share of `method` in what is shown.
    std::uint32_t probed = UINT32_MAX;               ///< Runs as well, to be measured; what it shows nobody sees.
    std::uint32_t plainSide = kUnmeasuredSide;       ///< MapSide::side() of the light.
    double mapSide = 0.0;                            ///< Of the maps of `method`, texels; 0: it has none.
    std::uint32_t wantedPlainSide = kUnmeasuredSide; ///< MapSide::wanted() of the light.
    double wantedSide = 0.0;                         ///< Of the maps of `method`, by coverage; likewise.
    std::uint32_t redrawEvery = 0; ///< Frames, DrawnMap::every(); 0: the map is drawn whenever something moves.
    std::uint32_t mapAge = 0;      ///< DrawnMap::age().
    const char* noFade = nullptr;  ///< Why a fade was not begun, or cut short. Static storage.
    bool floor = false;            ///< Near, or was within the frames of a flip, and time has a say.
    bool floorUnmet = false;       ///< Near, but no eligible method is good enough.
    double floorTruth = 0.0;       ///< How true the rule base's condition for near quality is.
    float minimumQuality = 0.0f;   ///< What near quality asks of this light, or asked when it was near.
    std::uint32_t pinned = UINT32_MAX;
    float importance = 1.0f;
    plan::Hold hold = plan::Hold::none;
    double threshold = 0.0; ///< LightPlan's.
    FactValues facts{};
    std::span<Candidate> candidates; ///< Of every method; kept by who asked for the decision.
};

/// Of a method whose passes could not be made for a light: it is left alone for a while, each time for twice as long.
struct PassFailure {
    std::uint64_t at = 0, until = 0; ///< Frames.
    std::uint32_t times = 0;
    bool memory = false; ///< For want of it.

    void note(std::uint64_t frame, bool forMemory)
    {
        // Memory that something else has left is free within a few frames; a refusal may last. A minute at most.
        constexpr std::uint64_t kForMemory = 4, kElse = 60, kMost = 3600;
        const std::uint64_t pause = (forMemory ? kForMemory : kElse) << std::min(times, 16u);
        *this = {frame, frame + std::min(pause, kMost), times + 1, forMemory};
    }
    /// Its passes were made. Forgotten when they have been for as long as it was left alone: what fails again every few
    /// frames would else come and go forever.
    void noteServed(std::uint64_t frame)
    {
        if (times != 0 && frame >= until + (until - at)) *this = {};
    }
    /// @param setAt  of the method's newest setting: with another one it may well go
    bool holds(std::uint64_t frame, std::uint64_t setAt) const { return frame < until && setAt < at; }
};

/// What is remembered of a light in a view between frames.
struct LightMemory {
    std::uint32_t incumbent = UINT32_MAX;
    float distance = 0.0f;      ///< Measured; valid if `measured`.
    float planarity = 0.0f;     ///< Likewise.
    float texelPixels = 0.0f;   ///< Across a texel of a plain map of 1024, on average; at first a guess, 0: none.
    double mapWidth = 0.0;      ///< Metres, mapWidth(); 0: not asked for yet.
    double wishedSide = 0.0;    ///< sideFor(), at first a guess; 0: no receiver is visible, or none was looked for.
    std::uint32_t nearSide = 0; ///< Where a map suits best within the near floor: the least side that reaches it.
    double floorTimes = 1.0;    ///< Within the near floor it may be so many times as wrong as all near lights are.
    bool measured = false;
    std::uint64_t measuredAt = 0; ///< Frame of the newest measurement.
    MedianOfFive share;
    MedianOfFive treeLevels;       ///< Reach::treeLevels; valid if `measured`.
    MedianOfFive penumbraPixels;   ///< Reach::penumbraPixels; likewise.
    MedianOfFive outlines;         ///< Reach::outlines; likewise.
    TracedOutlines traced;         ///< The same where rays tell.
    MethodArray<float> measuredMs; ///< Newest per method; 0: none.
    std::uint64_t lastFrame = 0;
    plan::LightMemory plan;
    Fade fade;
    cost::Workload workload;             ///< As the last frame saw it.
    std::uint32_t costSlot = UINT32_MAX; ///< In the cost model.
    std::uint64_t methodSince = 0;       ///< Frame in which the method last changed.
    bool guessed = false;                ///< The incumbent was chosen while `measured` was false.
    std::uint64_t pricedAt = 0;          ///< Frame in which the method last changed for its price.
    std::uint32_t redrawEvery = 0;       ///< LightDecision's, of the newest frame.
    std::uint32_t tried = UINT32_MAX;    ///< Serves from pricedAt on so that its time is known.
    std::uint32_t probed = UINT32_MAX;   ///< The newest method that was measured beside it, from probedSince on.
    std::uint64_t probedSince = 0;
    MethodArray<PassFailure> failures;
    PassFailure sampleFailure; ///< Of the map beside, for hosts' shaders.

    bool isOnTrial() const { return tried != UINT32_MAX; }
};

/// Share of the picture that a light reaches: as measured, or as guessed until then.
double shareOf(const LightMemory& memory, const CameraView& view, const LightView& light);
/// Fact::penumbraPixels.
double penumbraOf(const LightMemory& memory, const LightView& light);

/// A request: everything about one light in one view that the choice may depend on.
struct SelectionInput {
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    const LightCasters* casters = nullptr;
    std::uint32_t pinned = UINT32_MAX;
    std::uint32_t dynamicLights = 0;
    double lightMotion = 0.0;
    double frameBudget = 0.0;
    double frameRate = 0.0;
    float importance = 1.0f;
    bool recorded = false;
    bool seen = true;                                ///< canBeSeen(), or the host pinned a method.
    std::uint32_t plainSide = kUnmeasuredSide;       ///< MapSide::side().
    std::uint32_t wantedPlainSide = kUnmeasuredSide; ///< MapSide::wanted().
    std::uint32_t mostPlainSide = kUnmeasuredSide;   ///< MapSide::most().
    bool still = false;        ///< Neither the light nor a caster in its range is known or suspected to move.
    bool viewRests = true;     ///< The view has neither moved nor turned for some frames.
    std::uint32_t unbuilt = 0; ///< DeviceRays::unbuilt().
    VkDeviceSize memoryLeft = 0;
    std::uint64_t frame = 0;
};

class Selector {
public:
    explicit Selector(MethodTable& methods) : methods_(methods) {}

    /// Parses and binds; on any error nothing changes and every finding is in `findings`.
    Result<void> loadRules(std::string_view text, std::string_view fileName, const AlgorithmRegistry& registry,
                           std::vector<rules::Diagnostic>& findings);
    /// The rules in force as one of their presets changes them; empty: as they stand.
    Result<void> setPreset(std::string_view preset, const AlgorithmRegistry& registry,
                           std::vector<rules::Diagnostic>& findings);
    /// Rules bound to the methods there are, ready to be put in force.
    struct BoundRules {
        std::shared_ptr<const rules::Engine> engine; ///< Null: no rules.
        rules::Inference inference;
    };
    /// The rules in force, bound to one more method, which comes last; an error where its name means something else to
    /// them. Nothing changes until they are adopted.
    Result<BoundRules> boundWith(const std::string& name, GnTraits traits, const AlgorithmRegistry& registry) const;
    void adopt(BoundRules rules) noexcept;

    bool hasRules() const { return engine_ != nullptr; }
    const rules::Engine* engine() const { return engine_.get(); }
    /// Records outlive the rules in force: whoever explains one later keeps those it was decided by.
    const std::shared_ptr<const rules::Engine>& sharedEngine() const { return engine_; }
    /// The rule base in force as it was read, and the name it came under.
    std::string_view rulesText() const { return rulesText_; }
    std::string_view rulesName() const { return rulesName_; }
    std::string_view preset() const { return engine_ ? std::string_view(engine_->base().preset) : std::string_view(); }

    /// Facts and capability of one light; allocates nothing. No method is chosen yet.
    LightDecision assess(const SelectionInput& input, const LightMemory& memory, std::span<Candidate> candidates) const;
    /// What the rules think of each of them, and the best by suitability. Allocates nothing.
    void choose(std::span<LightDecision> decisions);
    /// What serves a light whose method has just been excluded, and whose others may fail as well: the best of the
    /// others first, whatever the plan says (replacementsInOrder()).
    std::vector<Choice> replacements(const LightDecision& decision) const;
    /// One of them serves; nothing runs beside it.
    void substitute(LightDecision& decision, const Choice& choice) const;
    /// The method is settled: what the log says of it, and what the next frame remembers.
    void commit(LightDecision& decision, LightMemory& memory, std::uint64_t frame) const;

    /// All facts, rules and candidates of a decision. @param engine that decided it; null: no rules
    std::string explain(const LightDecision& decision, const rules::Engine* engine) const;

private:
    RuleVocabulary vocabulary(const AlgorithmRegistry& registry) const;
    Result<BoundRules> readRules(std::string_view text, std::string_view fileName, std::string_view preset,
                                 const AlgorithmRegistry& registry, std::vector<rules::Diagnostic>& findings) const;
    struct Unprepared { ///< Casters that wait for workers or the GPU.
        std::uint64_t topology = 0, trees = 0, copies = 0;
        std::uint64_t connectivity = 0; ///< Of what `copies` counts.
        std::uint64_t gpuOnly = 0;      ///< For good.
    };
    Candidate examine(const Method& method, const SelectionInput& input, const Unprepared& casters,
                      const LightMemory& memory) const;
    void rank(LightDecision& decision);
    void rankWithoutRules(LightDecision& decision) const;

    MethodTable& methods_;
    std::shared_ptr<const rules::Engine> engine_; ///< Null: no rules.
    rules::Inference inference_;                  ///< Of engine_: what it says of the light at hand.
    std::string rulesText_, rulesName_;
};

} // namespace gnomon
