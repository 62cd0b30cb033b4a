// One frame, stage by stage: input -> facts -> decisions -> passes -> submits -> timings. Each stage is one function.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "runtime/api/context.hpp"
#include "runtime/base/hash.hpp"
#include "runtime/base/number_text.hpp"

namespace gnomon {

namespace {

// Coordinates are relative to an origin that follows the eye in steps of this many metres. At most three quarters of a
// step from the eye a float resolves 0.015 mm; with steps of 1024 m, rays left from one or two metres before the eye
// hit the surface they came from. Every step moves all that is kept, so smaller ones are not free either.
constexpr double kOriginStep = 256.0;
// Nothing fits it, so the plan step returns the cheapest plan.
constexpr double kNextToNothingMs = 1e-3;

} // namespace

double Context::msSince(std::chrono::steady_clock::time_point since) const
{
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

Result<GnResult> Context::recordFrame(VkCommandBuffer cmd, const GnFrameInfo& info)
{
    if (!cmd) return Error{GN_ERROR_NULL_ARGUMENT, "CommandBufferMissing", "commandBuffer is null"};
    if (info.waitCount || info.signalCount)
        return Error{GN_ERROR_OUT_OF_RANGE, "SemaphoresRecorded",
                     "a recorded frame neither waits nor signals: the host's submit does"};
    return startFrame(info, FrameMode::recorded, cmd);
}

Result<GnResult> Context::beginFrame(const GnFrameInfo& info, FrameMode mode)
{
    return startFrame(info, mode, VK_NULL_HANDLE);
}

/// Checks the input, then runs the frame; a frame that fails leaves everything as before it, but for what it gives
/// back where memory was short.
Result<GnResult> Context::startFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd)
{
    const auto start = std::chrono::steady_clock::now();
    if (Result<void> ok = takeInput(info); !ok) {
        if (stats_.frame > frame_) stats_.submits = 0; // of an attempt before this one
        return ok.error();
    }
    keepVisibility();
    thrownEarly_ = nullptr;
    finishedEarly_.reset();
    const std::uint64_t before = frame_;
    const auto undo = [&](bool memoryShort) {
        withdrawFrame(info.frame, memoryShort);
        frame_ = before;
    };
    try {
        Result<GnResult> run = runFrame(info, mode, cmd, start);
        if (run)
            recorded_ = mode == FrameMode::recorded ? info.frame : 0;
        else
            undo(run.error().result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
        return run;
    } catch (...) { // no memory; the C API says so
        undo(false);
        throw;
    }
}

std::uint32_t Context::nextWarmup()
{
    if (createOwnPipelines()) return kRuntimeOwner;
    MethodDemand demand{.pinned = 0, .others = pending_.empty()};
    for (const PendingLight& pending : pending_) {
        const std::uint32_t pinned = pending.decision->pinned;
        if (pinned == UINT32_MAX) {
            demand.others = true;
            continue;
        }
        demand.pinned |= 1u << pinned;
        const Method& method = (*methods_)[pinned];
        demand.others |= pending.decision->method != pinned && (method.ready || method.unavailable);
    }
    return methods_->nextWarmup(demand);
}

/// Its pipelines have run once. Where memory was short for that, another frame tries again; nobody has asked yet for
/// what they do.
void Context::settleWarmup(std::uint32_t owner)
{
    const Error* const error = executor_->warmupError();
    if (error && error->result == GN_ERROR_OUT_OF_DEVICE_MEMORY) return;
    if (!error) {
        setReady(owner, true);
        present().warmup = owner;
    } else if (owner == kRuntimeOwner) {
        failOwnPipelines(error->text);
    } else {
        methods_->fail((*methods_)[owner], error->text);
    }
}

/// After passes have been submitted, so nothing may fail any more.
void Context::noteWarmup(std::uint32_t owner) noexcept
{
    try {
        settleWarmup(owner);
    } catch (...) { // no memory for the words about it: another frame tries again
    }
}

void Context::setReady(std::uint32_t owner, bool ready)
{
    (owner == kRuntimeOwner ? gridReady_ : (*methods_)[owner].ready) = ready;
}

void Context::openStats(std::uint64_t frame, std::chrono::steady_clock::time_point start)
{
    stats_ = {};
    stats_.frame = frame;
    stats_.sharedMs = sharedMs_.get();
    objectsBefore_ = vk_->objectsMade;
    queriesBefore_ = rays_ ? rays_->queryNanoseconds() : 0;
    pipelinesBefore_ = vk_->pipelinesMade;
    if (frame_ != 0) {
        const auto ms = std::chrono::duration<float, std::milli>(start - lastFrameStart_).count();
        frameTimes_[frameTimeCount_++ % frameTimes_.size()] = ms;
    }
    lastFrameStart_ = start;
    frame_ = frame;
    present() = {.frame = frame_};
}

/// What serves each light of each view.
Result<void> Context::decide(const GnFrameInfo& info, FrameMode mode, std::span<const Caster> casters)
{
    const auto start = std::chrono::steady_clock::now();
    for (std::uint32_t i = 0; i < info.viewCount; ++i)
        if (Result<void> ok = prepareView(*viewFrames_[i].view, info.pViews[i], casters); !ok) return ok;
    raysNeeded_ = false;
    predictedMs_ = 0.0;
    pending_.clear();
    plan_->begin();
    updateBudget(info);
    for (std::uint32_t i = 0; i < info.viewCount; ++i)
        assessView(i, info.pViews[i], info, mode);
    planLights(info);
    stats_.decideUs = static_cast<float>(msSince(start) * 1000.0);
    return {};
}

Result<GnResult> Context::runFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd,
                                   std::chrono::steady_clock::time_point start)
{
    openStats(info.frame, start);
    scene_->retire(info.completedFrame);
    std::erase_if(retiredGrids_, [&](const RetiredGrid& old) { return old.frame <= info.completedFrame; });
    openGraph(info);
    const SceneRegistry::Snapshot& snapshot = scene_->begin(info.frame, origin_);
    if (Result<void> ok = decide(info, mode, snapshot.casters); !ok) return ok.error();
    const std::uint32_t warmup = nextWarmup();
    for (const PendingLight& pending : pending_)
        declareLight(pending, mode);
    recordDecisions();
    collectLightMaps();

    const bool asked = timeEveryFrame_ || (info.flags & GN_FRAME_TIMED_BIT);
    const bool unasked = info.frame % kTimedPeriod == 0 || learnsFrom(info.frame);
    present().timedUnasked = unasked;
    const ExecutorFrame frame{.frame = info.frame,
                              .completedFrame = info.completedFrame,
                              .timed = asked || unasked,
                              .scene = &snapshot,
                              .uploads = scene_.get(),
                              .rays = rays_.get(),
                              .raysNeeded = raysNeeded_,
                              .warmupOwner = warmup,
                              .waits = waits_,
                              .signals = signals_,
                              .visibilities = visibilities_.data(),
                              .visibilityCount = static_cast<std::uint32_t>(visibilities_.size()),
                              .imports = imports_.data(),
                              .importCount = static_cast<std::uint32_t>(imports_.size()),
                              .lightMaps = lightMaps_};
    if (Result<void> ok = executor_->begin(frame); !ok) return ok.error();
    takeTimings();
    if (mode == FrameMode::recorded) {
        if (Result<void> ok = executor_->record(cmd); !ok) return ok.error();
    } else if (Result<void> ok = executor_->start(mode == FrameMode::submit); !ok) {
        return ok.error();
    }
    if (warmup != UINT32_MAX || stats_.pipelinesCreated) present().disturbed = true;
    if (warmup != UINT32_MAX) noteWarmup(warmup);
    stats_.callMs = static_cast<float>(msSince(start));
    finishStats();
    return methods_->anyReady() ? GN_SUCCESS : GN_NOT_READY;
}

Result<GnResult> Context::finishFrame(std::uint64_t timeoutNs)
{
    if (!executor_->underway()) {
        if (thrownEarly_) std::rethrow_exception(std::exchange(thrownEarly_, nullptr));
        if (finishedEarly_) return *std::exchange(finishedEarly_, std::nullopt);
        return frameOrder("gnFinishShadows without gnBeginShadows");
    }
    const auto start = std::chrono::steady_clock::now();
    const auto undo = [&](bool memoryShort) {
        finishStats(); // how much of it was submitted
        forgetFrame(frame_, memoryShort);
        --frame_;
    };
    Result<GnResult> finished = GN_SUCCESS;
    try {
        finished = executor_->finish(timeoutNs);
    } catch (...) {
        undo(false);
        throw;
    }
    stats_.callMs += static_cast<float>(msSince(start));
    if (!finished) {
        undo(finished.error().result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
        return finished;
    }
    finishStats();
    if (*finished == GN_SUCCESS && !methods_->anyReady()) return GN_NOT_READY;
    return finished;
}

/// For calls that cannot go on beside a frame under way. How it ended, gnFinishShadows() says.
void Context::finishUnderway() noexcept
{
    if (!executor_->underway()) return;
    try {
        finishedEarly_ = finishFrame(UINT64_MAX);
        if (*finishedEarly_ || finishedEarly_->error().result != GN_ERROR_DEVICE_LOST) return;
        lost_ = true; // nothing may follow, and nobody else tells
        messages_.error(finishedEarly_->error());
    } catch (...) {
        thrownEarly_ = std::current_exception();
    }
}

Result<void> Context::dropFrame(std::uint64_t frame)
{
    if (frame == 0 || frame != recorded_)
        return frameOrder("frame " + std::to_string(frame) + " is not the one recorded last (" +
                          std::to_string(recorded_) + ")");
    if (const std::uint32_t warmup = past(frame).warmup; warmup != UINT32_MAX)
        setReady(warmup, false); // it has not run
    if (pool_->frame() == frame)
        withdrawFrame(frame, false);
    else
        loseFrame(frame);
    recorded_ = 0;
    return {};
}

/// A frame of which nothing was submitted.
void Context::withdrawFrame(std::uint64_t frame, bool memoryShort)
{
    pool_->withdraw(frame);
    executor_->drop(frame);
    scene_->dropUploads(frame);
    forgetFrame(frame, memoryShort);
}

/// The same after an attempt at the next frame has failed: what was before this one is not known any more.
void Context::loseFrame(std::uint64_t frame)
{
    pool_->lose(frame);
    executor_->drop(frame);
    scene_->dropUploads(frame);
    maps_.clear();
    views_.forEach([&](std::unique_ptr<View>& view) {
        view->grid->drop(frame);
        if (view->madeIn != frame || !view->visibility) return;
        pool_->retire(std::move(view->visibility), 0); // nobody has ever read it
        ++view->revision;
    });
}

/// What a frame that nobody will see has noted for others; where memory was short, what is kept goes as well: tried
/// again, the frame starts with what frames in flight use, and nothing else.
void Context::forgetFrame(std::uint64_t frame, bool memoryShort)
{
    maps_.clear();
    for (ViewFrame& viewFrame : viewFrames_)
        viewFrame.view->grid->drop(frame);
    withdrawFades(frame);
    restoreVisibility(memoryShort);
    if (memoryShort) pool_->evictAll();
}

void Context::openGraph(const GnFrameInfo& info)
{
    arena_.reset();
    pool_->begin(info.frame, info.completedFrame);
    graph_->reset();
    viewFrames_.clear();
    lightFrames_.clear();
    maps_.clear();
    visibilities_.clear();
    imports_.clear();
    for (View* view : acceptedViews_)
        viewFrames_.push_back({.view = view});
    if (info.viewCount == 0) return;
    // Followed with a quarter step of slack, so that a camera on a boundary does not flip it every frame; and only
    // where no view is left near it, so that views far from one another do not, in whatever order they come.
    const auto near = [this](const GnViewFrame& view) {
        for (int i = 0; i < 3; ++i)
            if (std::abs(view.eye[i] - origin_[i]) > 0.75 * kOriginStep) return false;
        return true;
    };
    if (originSet_ && std::any_of(info.pViews, info.pViews + info.viewCount, near)) return;
    for (int i = 0; i < 3; ++i)
        origin_[i] = std::round(info.pViews[0].eye[i] / kOriginStep) * kOriginStep;
    originSet_ = true;
    // All revisions are others now, though nothing has moved; and depth grids know receivers about the old one.
    originMovedIn_ = info.frame;
    views_.forEach([](std::unique_ptr<View>& view) { view->grid->invalidate(); });
}

// --- decisions and passes ---

const LightCasters& Context::castersOf(const LightView& light)
{
    for (const LightFrame& known : lightFrames_)
        if (known.id == light.id) return known.casters;
    lightFrames_.push_back({light.id, light.handle, scene_->castersOf(light, arena_)});
    return lightFrames_.back().casters;
}

void Context::assessView(std::uint32_t viewIndex, const GnViewFrame& frame, const GnFrameInfo& info, FrameMode mode)
{
    ViewFrame& viewFrame = viewFrames_[viewIndex];
    View& view = *viewFrame.view;
    std::uint32_t dynamicLights = 0, pinnedLights = 0;
    for (std::uint32_t i = 0; i < frame.lightCount; ++i) {
        const LightView* light = scene_->light(frame.pLights[i]);
        dynamicLights += !light->isStatic;
        pinnedLights += lights_[light->id].pinned != UINT32_MAX;
    }

    view.grid->collect(info.completedFrame);
    if (gridReady_ && selector_->hasRules() && pinnedLights < frame.lightCount && view.grid->wanted(info.frame)) {
        graph_->beginTask({.view = view.id}, &view.camera, viewFrame.depth, viewFrame.normals);
        // Without memory for a grid the frame goes without; the next one that wants it tries again.
        (void)view.grid->declare(*graph_, view.camera, viewFrame.depth, gridPipeline_, info.frame);
        graph_->endTask();
    }

    const double rate = meanFrameRate();
    view.decisions.reserve(frame.lightCount); // addresses stay
    for (std::uint32_t i = 0; i < frame.lightCount; ++i) {
        const LightView& light = *scene_->light(frame.pLights[i]);
        const LightCasters& casters = *arena_.make(castersOf(light));
        LightState& state = lights_[light.id];
        state.motion.note(info.frame, light, casters, originMovedIn_ == info.frame);
        state.lastFrame = info.frame;
        LightMemory& memory = view.lights[light.id];
        // Lights take turns, so that no frame looks all of them up.
        const std::uint64_t age = info.frame - memory.measuredAt;
        const bool due = (info.frame + light.id) % kGridPeriod == 0 || age >= 2 * kGridPeriod;
        if (view.grid->valid() && (!memory.measured || due)) {
            const Reach reach =
                measureReach(view.grid->camera(), view.grid->tiles(), view.grid->allTiles(), light, casters.all);
            memory.distance = reach.distance;
            memory.planarity = reach.planarity;
            memory.share.add(reach.share);
            memory.treeLevels.add(reach.treeLevels);
            memory.measured = true;
            memory.measuredAt = info.frame;
        }
        const SelectionInput input{.view = &view.camera,
                                   .light = &light,
                                   .casters = &casters,
                                   .pinned = state.pinned,
                                   .dynamicLights = dynamicLights,
                                   .lightMotion = state.motion.share(),
                                   .frameBudget = budgetMs_ > 0.0 ? planReport_.cheapestMs / budgetMs_ : 0.0,
                                   .frameRate = rate,
                                   .importance = light.importance,
                                   .recorded = mode == FrameMode::recorded,
                                   .still = state.motion.rests(),
                                   .memoryLeft = memory_->limit() - std::min(memory_->used(), memory_->limit()),
                                   .frame = info.frame};
        view.decisions.push_back(selector_->assess(input, memory));
        LightDecision& decision = view.decisions.back();
        plan_->add(decision, memory, input);
        pending_.push_back({viewIndex, i, &light, &casters, &decision, &memory});
    }
    selector_->choose(view.decisions);
}

/// The budget in force: the host's, below the cap of the rules; without one, that cap, or what `budget: auto` has
/// found.
void Context::updateBudget(const GnFrameInfo& info)
{
    const rules::RuleBase* base = selector_->engine() ? &selector_->engine()->base() : nullptr;
    const bool automatic = info.budgetMs == 0.0f && countsTime(base) && base->policy.budget.automatic;
    budgetMs_ = budgetInForce(base, double{info.budgetMs});
    budgetPerCheapest_ = 0.0;
    measuresBudget_ = budgetBegins_ = false;
    if (automatic) {
        if (autoBudgetRules_ != base->textHash) autoBudget_.restart();
        autoBudgetRules_ = base->textHash;
        std::uint32_t lights = 0;
        for (std::uint32_t i = 0; i < info.viewCount; ++i)
            lights += info.pViews[i].lightCount;
        autoBudget_.look(lights, cameraCut());
        // What was timed last, if nothing but methods had a part in it.
        const bool disturbed = std::any_of(past_.begin(), past_.end(), [&](const PastFrame& past) {
            return past.disturbed && past.frame + kTimedPeriod > info.frame;
        });
        const double tookMs = measuredMs() >= 0.0 ? measuredMs() : lastPredictedMs_;
        const float intervalMs = frameTimeCount_ ? frameTimes_[(frameTimeCount_ - 1) % frameTimes_.size()] : 0.0f;
        const PastFrame& measured = past(untimedFrame_);
        if (untimedFrame_ > followed_ && !disturbed && !measured.beside)
            autoBudget_.follow(measuredMs(), measured.plannedMs, measured.cheapestMs);
        followed_ = untimedFrame_;
        if (!disturbed) budgetBegins_ = autoBudget_.note(tookMs, intervalMs);
        measuresBudget_ = autoBudget_.measuring();
        budgetMs_ = autoBudget_.ms();
        budgetPerCheapest_ = autoBudget_.perCheapest();
    }
}

/// All lights of all views together: within the budget where there is one, then settled.
void Context::planLights(const GnFrameInfo& info)
{
    const rules::RuleBase* base = selector_->engine() ? &selector_->engine()->base() : nullptr;
    const bool cut = cameraCut() || budgetBegins_; // the cheapest plan was to be measured, not to be kept
    planReport_ = plan_->decide(base, {.ms = measuresBudget_ ? kNextToNothingMs : budgetMs_,
                                       .perCheapest = budgetPerCheapest_,
                                       .sharedMs = unaskedMs_.get(),
                                       .parts = sharedParts_.parts(present().pixels),
                                       .measuredMs = measuredMs(),
                                       .cut = cut,
                                       .probe = wantsProbe(base),
                                       .frame = info.frame});
    if (budgetPerCheapest_ > 0.0 && planReport_.budgetMs > 0.0) budgetMs_ = planReport_.budgetMs;
    stats_.budgetMs = static_cast<float>(budgetMs_);
    fades_.clear();
    for (const PendingLight& pending : pending_) {
        fades_.push_back(nextFade(pending, base));
        selector_->commit(*pending.decision, *pending.memory, info.frame);
        stats_.switches += pending.decision->switched;
        predictedMs_ += pending.decision->predictedMs;
    }
    settleFades();
    settleProbe();
    present().plannedMs = planReport_.predictedMs;
    present().cheapestMs = planReport_.cheapestMs;
    std::uint64_t& methods = present().methods;
    methods = kEmptyHash;
    for (const PendingLight& pending : pending_) {
        const LightDecision& decision = *pending.decision;
        for (const std::uint32_t part :
             {pending.viewIndex, pending.light->id, decision.method, decision.outgoing, decision.probed})
            methods = hashWith(methods, part);
        present().beside |= decision.outgoing != UINT32_MAX || decision.probed != UINT32_MAX;
    }
    if (countsTime(base)) noteChanges(info.frame);
    for (const ViewFrame& viewFrame : viewFrames_)
        viewFrame.view->lastFrame = info.frame;
}

/// Of any view of the frame.
bool Context::cameraCut() const
{
    return std::any_of(viewFrames_.begin(), viewFrames_.end(),
                       [](const ViewFrame& viewFrame) { return viewFrame.view->camera.cut; });
}

double Context::meanFrameRate() const
{
    const std::size_t known = std::min<std::size_t>(frameTimeCount_, frameTimes_.size());
    float sum = 0.0f;
    for (std::size_t i = 0; i < known; ++i)
        sum += frameTimes_[i];
    return sum > 0.0f ? 1000.0 * static_cast<double>(known) / sum : 0.0;
}

} // namespace gnomon
