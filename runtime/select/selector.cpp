#include "runtime/select/selector.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/select/choice.hpp"

#if GNOMON_WITH_YAML
#include "rules/yaml/presets.hpp"
#include "rules/yaml/rule_base_reader.hpp"
#endif

namespace gnomon {

namespace {

Error refused(std::span<const rules::Diagnostic> findings, std::string_view fileName)
{
    const auto first = std::find_if(findings.begin(), findings.end(), [](const rules::Diagnostic& finding) {
        return finding.severity == rules::Severity::Error;
    });
    return {GN_ERROR_RULES, "RulesRefused",
            first != findings.end() ? rules::toText(*first) : std::string(fileName) + ": refused"};
}

Selector::BoundRules readyToAdopt(rules::Engine engine)
{
    rules::Inference inference = engine.makeInference();
    return {.engine = std::make_shared<const rules::Engine>(std::move(engine)), .inference = std::move(inference)};
}

} // namespace

RuleVocabulary Selector::vocabulary(const AlgorithmRegistry& registry) const
{
    RuleVocabulary words(registry);
    for (std::uint32_t i = 0; i < methods_.size(); ++i)
        words.addMethod(methods_[i].name, methods_[i].entry->traits);
    return words;
}

Result<Selector::BoundRules> Selector::readRules(std::string_view text, std::string_view fileName,
                                                 std::string_view preset, const AlgorithmRegistry& registry,
                                                 std::vector<rules::Diagnostic>& findings) const
{
#if GNOMON_WITH_YAML
    rules::ParseResult parsed = rules::parseRuleBase(text, fileName, preset);
    findings = std::move(parsed.diagnostics);
    if (!parsed.base) return refused(findings, fileName);
    rules::BindResult bound = rules::Engine::bind(std::move(*parsed.base), vocabulary(registry).view());
    findings.insert(findings.end(), bound.diagnostics.begin(), bound.diagnostics.end());
    if (!bound.engine) return refused(findings, fileName);
    return readyToAdopt(std::move(*bound.engine));
#else
    (void)text, (void)fileName, (void)preset, (void)registry, (void)findings;
    return Error{GN_ERROR_UNSUPPORTED, "NoYaml", "this build reads no rule bases (GNOMON_WITH_YAML is off)"};
#endif
}

Result<void> Selector::loadRules(std::string_view text, std::string_view fileName, const AlgorithmRegistry& registry,
                                 std::vector<rules::Diagnostic>& findings)
{
    Result<BoundRules> rules = readRules(text, fileName, {}, registry, findings);
    if (!rules) return rules.error();
    std::string ownText(text), ownName(fileName); // what may throw comes before what changes
    adopt(std::move(*rules));
    rulesText_ = std::move(ownText);
    rulesName_ = std::move(ownName);
    return {};
}

Result<void> Selector::setPreset(std::string_view preset, const AlgorithmRegistry& registry,
                                 std::vector<rules::Diagnostic>& findings)
{
    if (!engine_) return Error{GN_ERROR_RULES, "NoRules", "a preset changes rules, and none are loaded"};
#if GNOMON_WITH_YAML
    const bool known =
        std::ranges::find(engine_->base().presets, preset, &rules::Preset::name) != engine_->base().presets.end();
    if (!preset.empty() && !known)
        return Error{GN_ERROR_OUT_OF_RANGE, "PresetUnknown",
                     rulesName_ + ": " + rules::noPreset(preset, engine_->base())};
#endif
    Result<BoundRules> rules = readRules(rulesText_, rulesName_, preset, registry, findings);
    if (!rules) return rules.error();
    adopt(std::move(*rules));
    return {};
}

Result<Selector::BoundRules> Selector::boundWith(const std::string& name, GnTraits traits,
                                                 const AlgorithmRegistry& registry) const
{
    if (!engine_) return BoundRules{};
    RuleVocabulary words = vocabulary(registry);
    words.addMethod(name, traits);
    rules::BindResult bound = rules::Engine::bind(engine_->base(), words.view());
    if (!bound.engine) return refused(bound.diagnostics, rulesName_);
    return readyToAdopt(std::move(*bound.engine));
}

void Selector::adopt(BoundRules rules) noexcept
{
    engine_ = std::move(rules.engine);
    inference_ = std::move(rules.inference);
    MethodSet spoken; // where no rule fires that speaks of a method, one of the others serves
    if (engine_)
        for (const std::uint32_t effect : engine_->compiled().effects)
            spoken.add(effect / engine_->compiled().suitabilityTerms);
    methods_.offer(spoken);
}

/// Capability: what no rule can overrule.
Candidate Selector::examine(const Method& method, const SelectionInput& input, const Unprepared& casters,
                            const LightMemory& memory) const
{
    const std::uint32_t incumbent = memory.fade.shows(method.index) ? method.index : memory.incumbent;
    auto out = [](Exclusion exclusion, std::uint64_t detail = 0) {
        return Candidate{.exclusion = exclusion, .detail = detail};
    };
    const AlgorithmEntry& entry = method.entryFor(*input.casters);
    const auto has = [&entry](GnTraitBits trait) { return (entry.traits & trait) != 0; };
    if (method.unavailable) return out(Exclusion::device);
    if (!method.serves(input.light->type)) return out(Exclusion::lightKind);
    if (input.recorded && entry.roundTrips > 0) return out(Exclusion::roundTrips, entry.roundTrips);
    if (has(GN_TRAIT_CPU_GEOMETRY_BIT) && input.casters->hostDrawn)
        return out(Exclusion::hostDrawn, input.casters->hostDrawn);
    if (!has(GN_TRAIT_GPU_TRANSFORMS_BIT) && input.casters->gpuPlaced)
        return out(Exclusion::gpuPlaced, input.casters->gpuPlaced);
    const bool readsThem = readsTriangles(entry.traits);
    if (readsThem && casters.gpuOnly) return out(Exclusion::gpuOnly, casters.gpuOnly);
    const bool byConnectivity = has(GN_TRAIT_GPU_POSITIONS_BIT);
    if (const std::uint64_t missing = byConnectivity ? casters.connectivity : casters.copies; readsThem && missing)
        return out(Exclusion::copies, missing);
    const std::uint64_t waiting = byConnectivity ? casters.topology - casters.copies : casters.topology;
    if (has(GN_TRAIT_TOPOLOGY_BIT) && waiting) return out(Exclusion::topology, waiting);
    if (has(GN_TRAIT_RAYS_BIT) && casters.trees) return out(Exclusion::trees, casters.trees);
    // What the incumbent holds is in use already; it need not fit twice.
    const std::span<const double> settings = method.settingsAt(input.plainSide);
    const VkDeviceSize needs = entry.memoryFor(settings, input.view->extent, input.light->type);
    if (method.index != incumbent && needs > input.memoryLeft) return out(Exclusion::memory, needs);
    if (const PassFailure& failure = memory.failures[method.index]; failure.holds(input.frame, method.setAt))
        return failure.memory ? out(Exclusion::memory, needs)
                              : Candidate{.exclusion = Exclusion::refused, .refusal = kPassesFailed};
    const ShadowTask task{.view = input.view,
                          .light = input.light,
                          .casters = input.casters,
                          .settings = settings,
                          .recorded = input.recorded};
    if (const char* reason = method.algorithm->refuses(task))
        return {.exclusion = Exclusion::refused, .refusal = reason};
    if (!method.ready) return out(Exclusion::notReady);
    if (has(GN_TRAIT_DEVICE_RAYS_BIT) && input.unbuilt) return out(Exclusion::notReady, input.unbuilt);
    return {};
}

/// Suitability of every method, from the rules.
void Selector::rank(LightDecision& decision)
{
    const auto known = std::min(methods_.size(), static_cast<std::uint32_t>(engine_->outputs().size()));
    engine_->evaluate(decision.facts, inference_);
    decision.floorTruth = inference_.floorTruth;
    for (std::uint32_t m = 0; m < known; ++m) {
        Candidate& candidate = decision.candidates[m];
        const rules::OutputState& opinion = inference_.outputs[m];
        candidate.quantised = opinion.quantised;
        candidate.opinion = opinion.hasOpinion;
        // What the host pinned is awaited whatever the rules say of it.
        const bool awaited = candidate.exclusion == Exclusion::notReady && m != decision.pinned;
        if (opinion.vetoed && (candidate.exclusion == Exclusion::none || awaited)) {
            candidate.exclusion = Exclusion::vetoed;
            candidate.detail = opinion.vetoRule;
        }
    }
}

/// The exact ones first, then the fallback.
void Selector::rankWithoutRules(LightDecision& decision) const
{
    for (std::uint32_t i = 0; i < methods_.size(); ++i) {
        Candidate& candidate = decision.candidates[i];
        candidate.quantised = methods_[i].isExact() ? 2 : methods_[i].has(GN_TRAIT_FALLBACK_BIT) ? 1 : 0;
    }
}

double shareOf(const LightMemory& memory, const CameraView& view, const LightView& light)
{
    return memory.measured ? double{memory.share.get()} : guessedShare(view, light);
}

double penumbraOf(const LightMemory& memory, const LightView& light)
{
    if (!(light.constants.sourceRadius > 0.0f)) return 0.0;
    return memory.measured ? double{memory.penumbraPixels.get()} : std::numeric_limits<double>::quiet_NaN();
}

LightDecision Selector::assess(const SelectionInput& input, const LightMemory& memory,
                               std::span<Candidate> candidates) const
{
    LightDecision decision;
    decision.candidates = candidates;
    decision.light = input.light->handle;
    decision.lightId = input.light->id;
    decision.incumbent = memory.incumbent;
    decision.flatSource = input.light->flat();
    decision.asksHost = input.casters->opacities > 0;
    decision.guessed = memory.guessed && memory.measured;
    decision.pinned = input.pinned;
    decision.plainSide = input.plainSide;
    decision.wantedPlainSide = input.wantedPlainSide;
    decision.importance = input.importance;
    decision.distanceMeasured = memory.measured;
    decision.viewerDistance = memory.measured ? memory.distance : reachLowerBound(*input.view, *input.light);

    auto fact = [&](Fact which) -> double& { return decision.facts[static_cast<std::size_t>(which)]; };
    fact(Fact::dynamicLights) = input.dynamicLights;
    fact(Fact::lightMotion) = input.lightMotion;
    fact(Fact::viewerDistance) = decision.viewerDistance;
    fact(Fact::screenShare) = shareOf(memory, *input.view, *input.light);
    fact(Fact::casterTriangles) = trianglesFact(static_cast<double>(input.casters->triangles));
    fact(Fact::lightRadius) = input.light->constants.sourceRadius;
    fact(Fact::receiverPlanarity) = memory.measured ? memory.planarity : std::numeric_limits<double>::quiet_NaN();
    fact(Fact::frameBudget) = input.frameBudget;
    fact(Fact::frameRate) = input.frameRate;
    fact(Fact::penumbraPixels) = penumbraOf(memory, *input.light);
    fact(Fact::texelPixels) = memory.measured ? double{memory.texelPixels} : std::numeric_limits<double>::quiet_NaN();
    fact(Fact::recorded) = input.recorded ? 1.0 : 0.0;

    if (!input.seen) {
        decision.reason = GN_REASON_UNSEEN;
        std::fill(candidates.begin(), candidates.end(), Candidate{.exclusion = Exclusion::unseen});
        return decision;
    }
    Unprepared unprepared;
    for (const Caster* caster : input.casters->all) {
        if (!caster->mesh) continue;
        if (caster->mesh->onGpuOnly()) {
            ++(caster->mesh->noCpuCopy ? unprepared.gpuOnly : unprepared.copies);
            unprepared.connectivity += caster->mesh->connectivity == nullptr;
        }
        unprepared.topology += caster->mesh->topology == nullptr;
        unprepared.trees += caster->mesh->rays == nullptr;
    }
    for (std::uint32_t i = 0; i < methods_.size(); ++i)
        decision.candidates[i] = examine(methods_[i], input, unprepared, memory);
    return decision;
}

namespace {

void take(const Choice& choice, LightDecision& decision)
{
    decision.method = choice.method;
    decision.wanted = choice.wanted;
    decision.reason = choice.reason;
}

} // namespace

void Selector::choose(std::span<LightDecision> decisions)
{
    const MethodSet fallbacks = methods_.fallbacks();
    for (LightDecision& decision : decisions) {
        if (decision.reason == GN_REASON_UNSEEN) continue;
        if (engine_)
            rank(decision);
        else
            rankWithoutRules(decision);
        const Choice choice = chooseBySuitability(decision.candidates, {.incumbent = decision.incumbent,
                                                                        .pinned = decision.pinned,
                                                                        .fallbacks = fallbacks,
                                                                        .hasRules = engine_ != nullptr});
        take(choice, decision);
    }
}

std::vector<Choice> Selector::replacements(const LightDecision& decision) const
{
    return replacementsInOrder(
        decision.candidates,
        {.pinned = decision.pinned, .fallbacks = methods_.fallbacks(), .hasRules = engine_ != nullptr});
}

void Selector::substitute(LightDecision& decision, const Choice& choice) const
{
    take(choice, decision);
    decision.outgoing = decision.probed = UINT32_MAX;
    decision.fade = 1.0f;
    decision.predictedMs = decision.method == UINT32_MAX ? 0.0f : decision.candidates[decision.method].predictedMs;
}

void Selector::commit(LightDecision& decision, LightMemory& memory, std::uint64_t frame) const
{
    decision.mapSide = decision.wantedSide = 0.0;
    if (decision.method != UINT32_MAX) {
        const std::int32_t quantised = decision.candidates[decision.method].quantised;
        decision.suitability =
            engine_ ? static_cast<float>(std::max(quantised, 0)) / static_cast<float>(rules::kSuitabilitySteps) : 1.0f;
        decision.measuredMs = memory.measuredMs[decision.method];
        decision.mapSide = methods_[decision.method].mapSide(decision.plainSide);
        decision.wantedSide = methods_[decision.method].mapSide(decision.wantedPlainSide);
    }
    if (decision.pinned < decision.candidates.size() &&
        decision.candidates[decision.pinned].exclusion == Exclusion::roundTrips) {
        if (decision.method != UINT32_MAX) decision.reason = GN_REASON_NOT_RECORDABLE;
        methods_.warnNotRecordable(decision.pinned, decision.candidates[decision.pinned].detail);
    }
    // Settled again where passes could not be made: what served before counts, not what was to serve.
    decision.switched = decision.incumbent != UINT32_MAX && decision.method != decision.incumbent;
    if (decision.method != memory.incumbent) memory.methodSince = frame;
    memory.incumbent = decision.method;
    memory.guessed = !memory.measured;
    memory.lastFrame = frame;
}

} // namespace gnomon
