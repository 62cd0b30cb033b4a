#include "explain/selector_fixture.hpp"

#include <algorithm>

#include "rules/yaml/rule_base_reader.hpp"
#include "runtime/select/choice.hpp"
#include "runtime/select/vocabulary.hpp"

namespace gnomon::test {

std::optional<rules::Engine> bindRules(std::string_view text)
{
    const AlgorithmRegistry registry = builtinRegistry();
    RuleVocabulary vocabulary(registry);
    for (const BuiltinAlgorithm& algorithm : registry.algorithms)
        vocabulary.addMethod(algorithm.entry->name, algorithm.entry->traits);
    rules::ParseResult parsed = rules::parseRuleBase(text, "fixture");
    if (!parsed) return std::nullopt;
    return std::move(rules::Engine::bind(std::move(*parsed.base), vocabulary.view()).engine);
}

std::string_view fixtureRules()
{
    return R"(version: 1
name: fixture
options: {and: min, or: max, aggregation: max, defuzzifier: centroid, allocation: budget}
variables:
  viewerDistance:
    universe: [0, 90]
    unit: m
    terms: {near: [-.inf, -.inf, 30, 60], far: [30, 60, .inf, .inf]}
  casterTriangles:
    universe: [2, 7]
    unit: log10
    terms: {small: [-.inf, -.inf, 4, 6], huge: [4, 6, .inf, .inf]}
rules:
  - id: A1
    rule: "if viewerDistance is near then stencil_volume is favoured and pcf_hybrid is acceptable and shadow_map is avoided"
    because: "edges are looked at from near"
  - id: A2
    rule: "if viewerDistance is far then shadow_map is favoured and pcf_hybrid is acceptable and stencil_volume is avoided"
    because: "a texel is a pixel or less out there"
  - id: V1
    rule: "if casterTriangles is huge then never stencil_volume"
    because: "a million silhouette edges do not fit"
policy:
  floor: {when: viewerDistance is near, minimumQuality: 0.8, atStrength: 0.5}
)";
}

const std::vector<MethodWords>& methodWords()
{
    static const std::vector<MethodWords> words = [] {
        std::vector<MethodWords> all;
        for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
            all.push_back({algorithm.entry->name, "", (algorithm.entry->traits & GN_TRAIT_RAYS_BIT) != 0});
        return all;
    }();
    return words;
}

std::uint32_t methodNamed(std::string_view name)
{
    const auto found = std::find_if(methodWords().begin(), methodWords().end(),
                                    [&](const MethodWords& method) { return method.name == name; });
    return static_cast<std::uint32_t>(found - methodWords().begin());
}

Situation::Situation() : candidates(methodWords().size())
{
    facts.fill(0.0);
    for (Candidate& candidate : candidates)
        candidate.quality = 1.0f, candidate.predictedMs = candidate.sureMs = 1.0f;
    fact(Fact::viewerDistance) = 12.5;
    fact(Fact::casterTriangles) = 3.5;
}

void SelectorFixture::plan(const Situation& situation, LightDecision& decision, FrameRecord& frame)
{
    const auto methods = static_cast<std::uint32_t>(situation.candidates.size());
    const rules::Policy& policy = engine_.base().policy;
    memory_.incumbent = situation.incumbent;
    plan_.reserve(2, methods);
    decision.minimumQuality = static_cast<float>(policy.floor.minimumQuality);
    std::vector<plan::LightRequest> lights = {
        {.memory = &memory_,
         .importance = situation.importance,
         .pinned = situation.pinned,
         .floor = !policy.floor.when.empty() && decision.floorTruth >= policy.floor.atStrength,
         .minimumQuality = decision.minimumQuality},
        {.memory = &other_, .pinned = 0}};
    std::vector<plan::Candidate> candidates;
    for (std::uint32_t m = 0; m < methods; ++m) {
        const Candidate& from = decision.candidates[m];
        candidates.push_back({.eligibility = from.exclusion == Exclusion::none     ? plan::Eligibility::eligible
                                             : from.exclusion == Exclusion::vetoed ? plan::Eligibility::never
                                                                                   : plan::Eligibility::trait,
                              .suitability = from.quantised,
                              .quality = from.quality,
                              .ms = double{from.sureMs}});
    }
    for (std::uint32_t m = 0; m < methods; ++m)
        candidates.push_back({.suitability = 1, .ms = situation.othersMs});
    frame.report = plan_.step({.frame = frame_,
                               .lights = lights,
                               .candidates = candidates,
                               .parts = situation.parts,
                               .methods = methods,
                               .budgetMs = situation.budgetMs,
                               .cut = situation.cut,
                               .policy = &policy});
    for (std::uint32_t m = 0; m < methods; ++m) {
        decision.candidates[m].why = plan_.why(0)[m];
        decision.candidates[m].sharedMs = static_cast<float>(plan_.sharedMs(0, m));
    }
    takePlan(plan_.lights()[0], decision);
}

DecisionRecord SelectorFixture::decide(const Situation& situation)
{
    const auto methods = static_cast<std::uint32_t>(situation.candidates.size());
    rules::Inference inference = engine_.makeInference();
    engine_.evaluate(situation.facts, inference);
    std::vector<Candidate> candidates = situation.candidates;
    LightDecision decision;
    decision.candidates = candidates;
    decision.lightId = 1;
    decision.facts = situation.facts;
    decision.distanceMeasured = true;
    decision.incumbent = situation.incumbent;
    decision.pinned = situation.pinned;
    decision.importance = static_cast<float>(situation.importance);
    decision.floorTruth = inference.floorTruth;
    for (std::uint32_t m = 0; m < methods; ++m) {
        Candidate& candidate = candidates[m];
        candidate.quantised = inference.outputs[m].quantised;
        candidate.opinion = inference.outputs[m].hasOpinion;
        if (inference.outputs[m].vetoed && candidate.exclusion == Exclusion::none) {
            candidate.exclusion = Exclusion::vetoed;
            candidate.detail = inference.outputs[m].vetoRule;
        }
    }
    const MethodSet fallbacks{methodNamed("shadow_map")};
    const Choice choice = chooseBySuitability(
        candidates, {.incumbent = situation.incumbent, .pinned = situation.pinned, .fallbacks = fallbacks});
    decision.method = choice.method;
    decision.wanted = choice.wanted;
    decision.reason = choice.reason;
    FrameRecord frame{.frame = ++frame_,
                      .methods = methods,
                      .fallbacks = fallbacks,
                      .base = &engine_.base(),
                      .budgeted = situation.budgetMs > 0.0,
                      .cut = situation.cut,
                      .budgetMs = situation.budgetMs};
    for (std::uint32_t m = 0; m < methods; ++m) {
        Candidate& candidate = decision.candidates[m];
        candidate.why = m == decision.method      ? plan::Why::chosen
                        : candidate.quantised < 0 ? plan::Why::noOpinion
                                                  : plan::Why::outscored;
    }
    if (frame.budgeted) plan(situation, decision, frame);
    if (decision.method < methods)
        decision.suitability =
            static_cast<float>(std::max(decision.candidates[decision.method].quantised, 0)) / rules::kSuitabilitySteps;
    decision.switched = situation.incumbent != UINT32_MAX && decision.method != situation.incumbent;
    DecisionRecord record;
    static_cast<RecordHead&>(record) = makeRecord(decision, frame, frame_);
    record.fired = strongestRules(engine_, inference);
    record.candidates = std::move(candidates);
    return record;
}

std::size_t lineCount(const std::string& text)
{
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

bool contains(const std::string& text, std::string_view part)
{
    return text.find(part) != std::string::npos;
}

} // namespace gnomon::test
