#include "demo/program/decision_log.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>

#include "demo/program/checks.hpp"
#include "demo/program/measure.hpp"
#include "demo/scene/scene_file.hpp"
#include "runtime/select/explain.hpp"
#include "runtime/select/vocabulary.hpp"
#ifdef GNOMON_WITH_YAML
#include "rules/yaml/rule_base_reader.hpp"
#endif

namespace gnomon::demo {

void DecisionCollector::frame(const ShadowHost& shadows, uint64_t frame)
{
    if (next_ == 0) next_ = origin_ = frame;
    newest_ = frame;
    if (newest_ - next_ + 1 >= RecordRing::kFrames / 2) collect(shadows);
}

void DecisionCollector::collect(const ShadowHost& shadows)
{
    if (next_ == 0 || newest_ < next_) return;
    size_t size = 0;
    const GnContext context = shadows.context();
    if (gnGetDecisionLog(context, shadows.view(0), next_, origin_, &size, nullptr) < 0) return; // no frame yet
    std::string chunk(size, '\0');
    if (gnGetDecisionLog(context, shadows.view(0), next_, origin_, &size, chunk.data()) < 0) return;
    next_ = newest_ + 1;
    size_ += chunk.size();
    chunks_.push_back(std::move(chunk));
    while (size_ > kMaxDecisionLogBytes && chunks_.size() > 1) {
        size_ -= chunks_.front().size();
        chunks_.pop_front();
    }
}

std::string DecisionCollector::bytes() const
{
    std::string all;
    all.reserve(size_);
    for (const std::string& chunk : chunks_)
        all += chunk;
    return all;
}

namespace {

using Answer = Outcome<std::string>;

struct Place {
    const DecisionLog* log;
    size_t index;
};

/// The rule base of a chunk, bound to the first `methods` that it names: those there were at a decision.
std::optional<rules::Engine> engineOf(const DecisionLog& log, size_t methods)
{
#ifdef GNOMON_WITH_YAML
    if (log.rulesText.empty()) return std::nullopt;
    const AlgorithmRegistry registry = builtinRegistry();
    RuleVocabulary vocabulary(registry);
    for (size_t m = 0; m < log.methods.size(); ++m) {
        if (m < methods)
            vocabulary.addMethod(log.methods[m].name, log.methods[m].traits);
        else
            vocabulary.absent.push_back({log.methods[m].name, {}});
    }
    // Of this build, but not of the one that wrote the log.
    for (const BuiltinAlgorithm& algorithm : registry.algorithms) {
        const std::string_view name = algorithm.entry->name;
        const bool logged = std::any_of(log.methods.begin(), log.methods.end(),
                                        [&](const LoggedMethod& method) { return method.name == name; });
        if (!logged) vocabulary.absent.push_back({std::string(name), {}});
    }
    rules::ParseResult parsed = rules::parseRuleBase(log.rulesText, log.rulesName, log.preset);
    if (!parsed) return std::nullopt;
    return std::move(rules::Engine::bind(std::move(*parsed.base), vocabulary.view()).engine);
#else
    (void)log, (void)methods;
    return std::nullopt;
#endif
}

std::string frameRange(const std::vector<DecisionLog>& logs)
{
    uint64_t low = UINT64_MAX, high = 0;
    for (const DecisionLog& log : logs)
        for (const RecordHead& head : log.heads) {
            low = std::min(low, head.frame - log.frameOrigin);
            high = std::max(high, head.frame - log.frameOrigin);
        }
    return low > high ? "no frame" : "frames " + std::to_string(low) + " to " + std::to_string(high);
}

/// The light that has the name, or else the number.
Outcome<uint32_t> lightIn(const std::vector<DecisionLog>& logs, const std::string& wanted)
{
    std::string known;
    for (const bool byName : {true, false}) // a light may have another one's number for its name
        for (const DecisionLog& log : logs)
            for (const LoggedLight& light : log.lights)
                if (wanted == (byName ? light.name : std::to_string(light.id))) return light.id;
    for (const DecisionLog& log : logs)
        for (const LoggedLight& light : log.lights)
            if (known.find("'" + light.name + "'") == std::string::npos)
                known += (known.empty() ? "'" : ", '") + light.name + "'";
    return Outcome<uint32_t>::failure("no light '" + wanted + "' in the log; there are " + known);
}

std::optional<Place> placeOf(const std::vector<DecisionLog>& logs, uint64_t frame, uint32_t light)
{
    for (const DecisionLog& log : logs)
        for (size_t i = 0; i < log.heads.size(); ++i)
            if (log.heads[i].lightId == light && log.heads[i].frame - log.frameOrigin == frame) return Place{&log, i};
    return std::nullopt;
}

/// The newest decision about the light before this one, or the newest for another method.
std::optional<Place> earlierPlace(const std::vector<DecisionLog>& logs, const RecordHead& now, bool otherMethod)
{
    std::optional<Place> newest;
    for (const DecisionLog& log : logs)
        for (size_t i = 0; i < log.heads.size(); ++i) {
            const RecordHead& head = log.heads[i];
            if (head.lightId != now.lightId || head.frame >= now.frame) continue;
            if (otherMethod && head.method == now.method) continue;
            if (!newest || head.frame > newest->log->heads[newest->index].frame) newest = Place{&log, i};
        }
    return newest;
}

Answer answer(const std::vector<DecisionLog>& logs, const Place& place, const WhyQuestion& question)
{
    const DecisionLog& log = *place.log;
    const DecisionRecord record = log.record(place.index);
    std::vector<MethodWords> methods;
    for (const LoggedMethod& method : log.methods)
        methods.push_back({method.name, method.unavailable, (method.traits & GN_TRAIT_RAYS_BIT) != 0,
                           (method.traits & GN_TRAIT_DEVICE_RAYS_BIT) != 0});
    std::string light = "number " + std::to_string(record.lightId);
    for (const LoggedLight& named : log.lights)
        if (named.id == record.lightId) light = named.name;
    const std::optional<rules::Engine> engine = engineOf(log, record.methods);
    const bool same = engine && engine->base().textHash == record.ruleHash;
    const ExplainWords words{.methods = methods,
                             .engine = same ? &*engine : nullptr,
                             .light = light,
                             .frameOrigin = log.frameOrigin,
                             .software = log.software};
    if (question.asked == Asked::why) return explainWhy(record, words);
    if (question.asked == Asked::whatIf) return explainWhatIf(record, words);
    if (question.asked == Asked::whyNot) {
        const auto found = std::find_if(methods.begin(), methods.end(),
                                        [&](const MethodWords& method) { return method.name == question.method; });
        if (found == methods.end()) return Answer::failure("no method '" + question.method + "' in the log");
        return explainWhyNot(record, static_cast<uint32_t>(found - methods.begin()), words);
    }
    const std::optional<Place> earlier = earlierPlace(logs, record, question.asked == Asked::changedSinceSwitch);
    DecisionRecord before;
    if (earlier) before = earlier->log->record(earlier->index);
    return explainWhatChanged(record, earlier ? &before : nullptr, words);
}

} // namespace

Outcome<std::string> answerFromLog(std::string_view bytes, const WhyQuestion& question)
{
    if (bytes.size() > kMaxDecisionLogBytes)
        return Answer::failure("decision log: " + std::to_string(bytes.size()) + " bytes, more than 16 MiB");
    std::vector<DecisionLog> logs;
    while (!bytes.empty() || logs.empty()) {
        Result<DecisionLog> log = readDecisionLog(bytes);
        if (!log) return Answer::failure(log.error().text + " (part " + std::to_string(logs.size() + 1) + ")");
        if (!log->heads.empty()) logs.push_back(std::move(*log));
        if (bytes.empty() && logs.empty()) return Answer::failure("decision log: holds no decision");
    }
    const Outcome<uint32_t> light = lightIn(logs, question.light);
    if (!light) return Answer::failure(light.error());
    const std::optional<Place> place = placeOf(logs, question.frame, *light);
    if (!place)
        return Answer::failure("no decision about light '" + question.light + "' in frame " +
                               std::to_string(question.frame) + "; the log has " + frameRange(logs));
    return answer(logs, *place, question);
}

void printAnswers(const DecisionCollector& decisions, const std::vector<WhyQuestion>& questions)
{
    for (const WhyQuestion& question : questions)
        std::printf("%s", valueOf(answerFromLog(decisions.bytes(), question)).c_str());
}

Outcome<WhyQuestion> parseWhy(const std::string& text)
{
    WhyQuestion question;
    const size_t first = text.find(':');
    const auto [end, status] = std::from_chars(text.data(), text.data() + std::min(first, text.size()), question.frame);
    if (first == std::string::npos || status != std::errc() || end != text.data() + first)
        return Outcome<WhyQuestion>::failure("'" + text + "' is not FRAME:LIGHT or FRAME:LIGHT:METHOD");
    const size_t second = text.find(':', first + 1);
    question.light = text.substr(first + 1, second == std::string::npos ? second : second - first - 1);
    if (second != std::string::npos) question.asked = Asked::whyNot, question.method = text.substr(second + 1);
    return question;
}

std::vector<WhyQuestion> parseQuestions(const std::vector<std::string>& texts)
{
    std::vector<WhyQuestion> questions;
    for (const std::string& text : texts)
        questions.push_back(valueOf(parseWhy(text)));
    return questions;
}

void requireAnswers(const std::vector<WhyQuestion>& questions, const RunOptions& options)
{
    if (questions.empty()) return;
    Scene scene = valueOf(loadScene(options.scene));
    if (options.lights > 0) limitLights(scene, options.lights);
    const uint32_t frames = options.frames > 0 ? options.frames : scene.frames;
    for (const WhyQuestion& question : questions) {
        const bool isNumber = !question.light.empty() && std::all_of(question.light.begin(), question.light.end(),
                                                                     [](char c) { return c >= '0' && c <= '9'; });
        if (!isNumber) requireLight(scene, question.light);
        if (question.asked == Asked::whyNot) requireMethods({question.method});
        const bool isEndless = options.window && options.frames == 0;
        if (!isEndless && question.frame >= frames)
            throw HostError("--why: frame " + std::to_string(question.frame) + " of a run with frames 0 to " +
                            std::to_string(frames - 1));
    }
}

} // namespace gnomon::demo
