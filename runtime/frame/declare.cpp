#include "runtime/frame/declare.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "runtime/passes/pass_context.hpp"
#include "runtime/plan/utility.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "runtime/select/choice.hpp"

namespace gnomon {

namespace {

// A fading light's two methods write these layers of one image.
constexpr std::uint32_t kOutgoingLayer = 0, kIncomingLayer = 1;

/// Where a method's visibility goes.
struct Target {
    ImageId image;
    std::uint32_t layer;
};

/// Declares the light's passes in one frame.
class LightPasses {
public:
    LightPasses(Frame& frame, const ViewLight& light, const DeclareParts& parts)
        : frame_(frame), light_(light), parts_(parts), viewFrame_(frame.views[light.viewIndex]),
          decision_(*light.decision)
    {
    }

    /// What the view's pixels see, and where hosts' shaders want one a map.
    void declare();

private:
    const CameraView& camera() const { return viewFrame_.view->camera; }
    Target layer() const { return {viewFrame_.visibility, light_.layer}; }
    void beginTask(std::uint32_t method = UINT32_MAX)
    {
        parts_.graph.beginTask({.view = camera().id, .light = light_.light->id, .method = method}, &camera(),
                               viewFrame_.depth, viewFrame_.normals);
    }
    void declareVisibility();
    bool hasSample() const;
    void declareSample();
    void replace(Error error);
    void exclude(const Error& error);
    void take(const Choice& choice, const Error& error);
    std::optional<Error> declareMethod(std::uint32_t index, const Target& target);
    MapPose poseFor(const Method& method);
    ImageId declareBeside();
    void declareMix(ImageId pair);
    void declareLit();

    Frame& frame_;
    const ViewLight& light_;
    const DeclareParts& parts_;
    const ViewFrame& viewFrame_;
    LightDecision& decision_;
};

void LightPasses::declare()
{
    declareVisibility();
    if (light_.light->sampled && decision_.reason != GN_REASON_UNSEEN && !hasSample()) declareSample();
}

/// Whether hosts' shaders can look up the map of the method that serves.
bool LightPasses::hasSample() const
{
    return !frame_.maps.empty() && frame_.maps.back().lightId == light_.light->id &&
           frame_.maps.back().viewIndex == light_.viewIndex &&
           frame_.maps.back().map.sample.kind != gpu::SAMPLE_NOTHING;
}

/// The map of the first fallback that has one for them. Where it cannot be made the light has none, and is left alone
/// for a while: asking again in every frame would take the memory of other lights' maps.
void LightPasses::declareSample()
{
    PassFailure& failure = light_.memory->sampleFailure;
    if (failure.holds(frame_.number, 0)) return;
    for (std::uint32_t i = 0; i < parts_.methods.size(); ++i) {
        const Method& method = parts_.methods[i];
        if (!method.ready || !method.has(GN_TRAIT_FALLBACK_BIT) || !method.serves(light_.light->type)) continue;
        beginTask();
        PassBuilder builder(parts_.graph);
        const ShadowAlgorithm::Map* map =
            method.algorithm->declareMap(builder, {.view = &camera(),
                                                   .light = light_.light,
                                                   .casters = light_.casters,
                                                   .settings = method.settingsAt(decision_.plainSide),
                                                   .recorded = frame_.mode == FrameMode::recorded});
        if (const std::optional<Error> error = parts_.graph.endTask()) {
            failure.note(frame_.number, error->result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
            return;
        }
        if (!map) continue;
        failure.noteServed(frame_.number);
        frame_.maps.push_back({light_.light->id, light_.viewIndex, method.name.c_str(), true, *map});
        return;
    }
}

void LightPasses::declareVisibility()
{
    if (decision_.method == UINT32_MAX) return declareLit();
    const ImageId pair = declareBeside();
    const bool fades = decision_.outgoing != UINT32_MAX;
    if (std::optional<Error> error = declareMethod(decision_.method, fades ? Target{pair, kIncomingLayer} : layer()))
        return replace(std::move(*error));
    light_.memory->failures[decision_.method].noteServed(frame_.number);
    if (fades) declareMix(pair);
}

/// The method's passes cannot be made: one of the others serves the light, in the order of the choice.
void LightPasses::replace(Error error)
{
    exclude(error);
    for (const Choice& choice : parts_.selector.replacements(decision_)) {
        take(choice, error);
        if (choice.method == UINT32_MAX) return declareLit();
        std::optional<Error> failed = declareMethod(choice.method, layer());
        if (!failed) return light_.memory->failures[choice.method].noteServed(frame_.number);
        error = std::move(*failed);
        exclude(error);
    }
}

/// The method that was to serve is left alone for a while.
void LightPasses::exclude(const Error& error)
{
    const Method& failed = parts_.methods[decision_.method];
    const bool memory = error.result == GN_ERROR_OUT_OF_DEVICE_MEMORY;
    Candidate& candidate = decision_.candidates[failed.index];
    candidate.exclusion = memory ? Exclusion::memory : Exclusion::refused;
    candidate.refusal = memory ? nullptr : kPassesFailed;
    if (memory)
        candidate.detail = failed.entryFor(*light_.casters)
                               .memoryFor(failed.settingsAt(decision_.plainSide), camera().extent, light_.light->type);
    light_.memory->failures[failed.index].note(frame_.number, memory);
    light_.memory->fade.lose();
}

/// @param error why the method before could not serve
void LightPasses::take(const Choice& choice, const Error& error)
{
    const Method& failed = parts_.methods[decision_.method];
    frame_.predictedMs -= decision_.predictedMs;
    parts_.selector.substitute(decision_, choice);
    parts_.selector.commit(decision_, *light_.memory, frame_.number);
    frame_.predictedMs += decision_.predictedMs;
    parts_.messages.warn(
        error.id, "light '" + std::string(light_.light->name) + "', method '" + failed.name + "': " + error.text +
                      (choice.method == UINT32_MAX ? "; lit in this frame"
                                                   : "; '" + parts_.methods[choice.method].name + "' serves it"));
}

/// The light and its casters of now, or as its map shows them, which is not drawn in this frame then. Tasks share a
/// light's map, and have to agree: with two views, or two methods, all go by what is now.
MapPose LightPasses::poseFor(const Method& method)
{
    const MapPose now{light_.light, light_.casters};
    LightState& state = *light_.state;
    const bool alone = frame_.views.size() == 1 && decision_.outgoing == UINT32_MAX && decision_.probed == UINT32_MAX;
    if (!alone || !state.sideKnown || !method.looksUpMaps()) {
        state.drawn.lose();
        light_.memory->redrawEvery = 0; // another method's map is drawn in every frame at first
        return now;
    }
    const MapKey key{method.index, method.mapSide(decision_.plainSide), light_.memory->mapWidth};
    const MapPose pose = state.drawn.next(frame_.number, key, now, parts_.arena);
    decision_.redrawEvery = light_.memory->redrawEvery = state.drawn.every();
    decision_.mapAge = state.drawn.age();
    return pose;
}

/// One method's passes for the light. @return why it cannot run.
std::optional<Error> LightPasses::declareMethod(std::uint32_t index, const Target& target)
{
    const Method& method = parts_.methods[index];
    const MapPose pose = poseFor(method);
    beginTask(index);
    PassBuilder builder(parts_.graph);
    const TracedScene* traced = nullptr;
    const GnTraits traits = method.entryFor(*pose.casters).traits;
    const bool onDevice = (traits & GN_TRAIT_DEVICE_RAYS_BIT) != 0;
    if (onDevice) {
        if (parts_.rays) {
            parts_.rays->need(*pose.casters); // is needed already, unless it stands in for another method
            traced = parts_.rays->declare(builder, *pose.casters);
        }
        if (!traced)
            builder.fail({GN_ERROR_UNSUPPORTED, "CastersNotTraced", "its casters are not traced in this frame"});
    }
    const ShadowTask task{.view = &camera(),
                          .light = pose.light,
                          .casters = pose.casters,
                          .settings = method.settingsAt(decision_.plainSide),
                          .layer = target.layer,
                          .visibility = target.image,
                          .depth = viewFrame_.depth,
                          .normals = viewFrame_.normals,
                          .motion = viewFrame_.motion,
                          .rays = traced,
                          .recorded = frame_.mode == FrameMode::recorded};
    if (traced || !onDevice) method.algorithm->declare(builder, task);
    if (std::optional<Error> error = parts_.graph.endTask()) return error;
    frame_.raysNeeded |= (traits & GN_TRAIT_RAYS_BIT) != 0;
    const ShadowAlgorithm::Map* const map = method.algorithm->lightMap();
    if (map && index == decision_.method)
        frame_.maps.push_back({light_.light->id, light_.viewIndex, method.name.c_str(), false, *map});
    return std::nullopt;
}

/// The outgoing method of a fading light, or the one that is probed, which nobody sees. @return the image of two layers
/// that it writes one of, the other being for what it is mixed with; null: only one method runs.
ImageId LightPasses::declareBeside()
{
    const std::uint32_t beside = decision_.outgoing != UINT32_MAX ? decision_.outgoing : decision_.probed;
    if (beside == UINT32_MAX) return {};
    beginTask();
    const ImageId pair =
        PassBuilder(parts_.graph)
            .transient(
                ImageInfo{.name = "view.fade", .format = VK_FORMAT_R8_UNORM, .extent = camera().extent, .layers = 2});
    std::optional<Error> error = parts_.graph.endTask();
    if (!error) error = declareMethod(beside, {pair, kOutgoingLayer});
    if (!error) return pair;
    light_.memory->fade.skip();
    light_.memory->failures[beside].note(frame_.number, error->result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
    if (decision_.outgoing != UINT32_MAX) decision_.noFade = kCannotServe;
    decision_.outgoing = decision_.probed = UINT32_MAX;
    decision_.fade = 1.0f;
    return {};
}

void LightPasses::declareMix(ImageId pair)
{
    const float incomingShare = decision_.fade;
    const PipelineId pipeline = parts_.mix;
    const VkRect2D pixels = lightPixels(*light_.light, camera()); // in all others both methods say 1
    beginTask();
    PassBuilder(parts_.graph)
        .raster(kFadePass)
        .samples(pair)
        .writes(viewFrame_.visibility, visibilityIn(camera(), light_.layer, pixels))
        .record([=](PassContext& gpu) {
            if (pixels.extent.width == 0) return;
            gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &pixels);
            gpu.bind(pipeline, {gpu.sampled(0, pair)});
            gpu.push(incomingShare);
            gpu.drawFullscreen();
        });
    (void)parts_.graph.endTask(); // makes nothing, so nothing can fail
    ++frame_.stats.fading;
}

/// A light that nothing can serve is lit.
void LightPasses::declareLit()
{
    parts_.graph.beginTask({.view = camera().id}, &camera(), viewFrame_.depth, viewFrame_.normals);
    PassBuilder(parts_.graph)
        .raster("view.lit", Scope::view, light_.layer)
        .writes(viewFrame_.visibility,
                {.layer = light_.layer, .clear = true, .value = {.color = {.float32 = {1, 1, 1, 1}}}})
        .record([](PassContext&) {});
    parts_.graph.endTask();
}

/// Whether a method would serve the light if its casters were built: the rules like it best, or it shows enough for
/// less.
bool awaitsRays(const LightDecision& decision, const MethodTable& methods)
{
    if (decision.method >= methods.size()) return false;
    const Candidate& serves = decision.candidates[decision.method];
    for (std::uint32_t m = 0; m < methods.size(); ++m) {
        const Candidate& candidate = decision.candidates[m];
        if (!methods[m].has(GN_TRAIT_DEVICE_RAYS_BIT) || candidate.exclusion != Exclusion::notReady ||
            candidate.detail == 0)
            continue;
        const bool asGood =
            plan::showsAsMuch({candidate.quantised, candidate.quality, true}, {serves.quantised, serves.quality, true});
        if (m == decision.wanted || (asGood && candidate.sureMs < serves.sureMs)) return true;
    }
    return false;
}

/// Which casters the device is to trace in this frame, and which soon. @return whether there are such
bool gatherRays(const Frame& frame, const DeclareParts& parts)
{
    bool awaited = false;
    for (const ViewLight& light : frame.lights) {
        const LightDecision& decision = *light.decision;
        const auto traces = [&](std::uint32_t method) {
            return method < parts.methods.size() &&
                   (parts.methods[method].entryFor(*light.casters).traits & GN_TRAIT_DEVICE_RAYS_BIT) != 0;
        };
        if (traces(decision.method) || traces(decision.outgoing) || traces(decision.probed))
            parts.rays->need(*light.casters);
        if (!awaitsRays(decision, parts.methods)) continue;
        parts.rays->want(*light.casters);
        awaited = true;
    }
    return awaited;
}

void declareAwaitedRays(const DeclareParts& parts)
{
    parts.graph.beginTask({}, nullptr, {}, {});
    PassBuilder builder(parts.graph);
    parts.rays->declareWanted(builder);
    (void)parts.graph.endTask(); // for want of memory it is tried again; the light is served without
}

/// Maps of the frame's methods, each once.
void collectLightMaps(Frame& frame, const PassGraph& graph)
{
    frame.lightMaps.clear();
    for (const DeclaredMap& declared : frame.maps) {
        PooledImage* image = &graph.image(declared.map.image);
        if (std::find(frame.lightMaps.begin(), frame.lightMaps.end(), image) == frame.lightMaps.end())
            frame.lightMaps.push_back(image);
    }
}

} // namespace

void declareLights(Frame& frame, const DeclareParts& parts)
{
    const bool awaited = parts.rays && gatherRays(frame, parts);
    for (const ViewLight& light : frame.lights)
        LightPasses(frame, light, parts).declare();
    if (awaited) declareAwaitedRays(parts);
    collectLightMaps(frame, parts.graph);
}

} // namespace gnomon
