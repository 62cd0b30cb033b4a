// Records of decisions, asked about.
#include "runtime/select/explain.hpp"

#include <algorithm>

#include "runtime/api/context.hpp"
#include "runtime/select/record_log.hpp"

namespace gnomon {

Result<DecisionRecord> Context::recordOf(const View& view, GnLight light, std::uint64_t frame)
{
    const std::optional<SceneRegistry::LightInfo> info = scene_->lightInfo(light);
    if (!info) return invalidHandle("light");
    if (view.records.newest() == 0)
        return Error{GN_ERROR_FRAME_ORDER, "NoFrameYet", "view '" + view.name + "' has been in no frame yet"};
    const std::uint64_t wanted = frame ? frame : view.records.newest();
    if (!view.records.has(wanted))
        return Error{GN_ERROR_OUT_OF_RANGE, "FrameNotOnRecord",
                     "frame " + std::to_string(wanted) + " of view '" + view.name + "' is not on record; " +
                         std::to_string(view.records.oldest()) + " to " + std::to_string(view.records.newest()) +
                         " are"};
    DecisionRecord record;
    if (!view.records.find(wanted, info->id, record))
        return Error{GN_ERROR_INVALID_HANDLE, "LightNotInFrame",
                     "light '" + std::string(info->name) + "' was not in frame " + std::to_string(wanted) +
                         " of view '" + view.name + "'"};
    return record;
}

/// Id of the strongest rule behind the method that serves; found when asked for, by the rules of that frame.
const char* Context::ruleBehind(const View& view, const LightDecision& decision)
{
    const std::shared_ptr<const rules::Engine> engine = view.records.rules(view.records.newest());
    if (!engine || decision.method >= engine->outputs().size()) return nullptr;
    if (askedRules_ != engine) { // hosts ask every frame: nothing is allocated then
        inference_ = engine->makeInference();
        askedRules_ = engine;
    }
    engine->evaluate(decision.facts, inference_);
    const std::uint32_t rule = inference_.outputs[decision.method].strongestRule;
    const std::string_view id = engine->ruleId(rule);
    return id.empty() ? nullptr : id.data(); // ends with a zero: it is a whole std::string or a literal
}

Result<std::string> Context::answer(GnView viewHandle, GnLight light, const GnQuestion& question)
{
    if (const GnQuestionFlags other = question.flags & ~GN_QUESTION_SINCE_SWITCH_BIT)
        return unknownFlags("GnQuestion::flags", other, "GnQuestionFlagBits");
    if (question.kind == GN_QUESTION_DECISION) return explanation(viewHandle, light, question.frame);
    const View* view = views_.find(viewHandle);
    if (!view) return invalidHandle("view");
    const Result<DecisionRecord> record = recordOf(*view, light, question.frame);
    if (!record) return record.error();
    std::vector<MethodWords> methods;
    for (std::uint32_t i = 0; i < methods_->size(); ++i) {
        const Method& method = (*methods_)[i];
        methods.push_back({method.name, method.unavailable ? method.unavailable : "", method.has(GN_TRAIT_RAYS_BIT),
                           method.has(GN_TRAIT_DEVICE_RAYS_BIT),
                           method.has(GN_TRAIT_SOFT_PENUMBRA_BIT) && !method.has(GN_TRAIT_FLAT_SOURCE_BIT)});
    }
    const std::shared_ptr<const rules::Engine> engine = view->records.rules(record->frame);
    const ExplainWords words{
        .methods = methods, .engine = engine.get(), .light = scene_->lightInfo(light)->name, .software = vk_->software};
    switch (question.kind) {
    case GN_QUESTION_WHY:
        return explainWhy(*record, words);
    case GN_QUESTION_WHY_NOT: {
        if (!question.pMethod) return Error{GN_ERROR_NULL_ARGUMENT, "NullArgument", "pQuestion->pMethod is null"};
        const Method* method = methods_->find(question.pMethod);
        if (!method)
            return Error{GN_ERROR_UNKNOWN_METHOD, "UnknownMethod",
                         std::string("no method is named '") + question.pMethod + "'"};
        return explainWhyNot(*record, method->index, words);
    }
    case GN_QUESTION_WHAT_IF:
        return explainWhatIf(*record, words);
    case GN_QUESTION_WHAT_CHANGED: {
        const std::optional<DecisionRecord> before = earlierRecord(
            *record, view->records.oldest(), question.flags & GN_QUESTION_SINCE_SWITCH_BIT,
            [&](std::uint64_t frame, DecisionRecord& out) { return view->records.find(frame, record->lightId, out); });
        return explainWhatChanged(*record, before ? &*before : nullptr, words);
    }
    default:
        break;
    }
    return Error{GN_ERROR_OUT_OF_RANGE, "UnknownQuestion",
                 "pQuestion->kind is " + std::to_string(static_cast<int>(question.kind)) + ", no GnQuestionKind"};
}

Result<std::string> Context::decisionLog(GnView viewHandle, std::uint64_t firstFrame, std::uint64_t frameOrigin)
{
    const View* view = views_.find(viewHandle);
    if (!view) return invalidHandle("view");
    const RecordRing& records = view->records;
    const std::uint64_t first = std::max(firstFrame, records.oldest());
    if (records.newest() == 0 || first > records.newest())
        return Error{GN_ERROR_OUT_OF_RANGE, "FrameNotOnRecord",
                     "no frame from " + std::to_string(firstFrame) + " on of view '" + view->name + "' is on record"};
    if (frameOrigin > first)
        return Error{GN_ERROR_OUT_OF_RANGE, "FrameOrigin",
                     "frameOrigin " + std::to_string(frameOrigin) + " is after frame " + std::to_string(first)};
    DecisionLog log;
    log.software = vk_->software;
    log.frameOrigin = frameOrigin;
    for (std::uint32_t i = 0; i < methods_->size(); ++i) {
        const Method& method = (*methods_)[i];
        log.methods.push_back({method.name, method.entry->traits, method.unavailable ? method.unavailable : ""});
    }
    log.rulesName = selector_->rulesName();
    log.rulesText = selector_->rulesText();
    log.preset = selector_->preset();
    for (std::uint64_t frame = first; frame <= records.newest(); ++frame)
        for (std::uint32_t i = 0; i < records.lights(frame); ++i)
            log.add(records.at(frame, i));
    for (const LightDecision& decision : view->decisions) // lights that are gone keep their number
        if (const auto info = scene_->lightInfo(decision.light))
            log.lights.push_back({info->id, std::string(info->name)});
    return writeDecisionLog(log);
}

} // namespace gnomon
