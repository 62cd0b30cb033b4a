// A frame's trip through the stages, and what becomes of a frame that fails or is dropped.
#include <exception>
#include <utility>

#include "runtime/api/context.hpp"
#include "runtime/frame/choose.hpp"
#include "runtime/frame/declare.hpp"
#include "runtime/frame/learn.hpp"
#include "runtime/frame/measure_facts.hpp"
#include "runtime/frame/read_frame.hpp"

namespace gnomon {

namespace {

double msSince(std::chrono::steady_clock::time_point since)
{
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

} // namespace

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

// --- the trip ---

/// Checks the input, then runs the frame; a frame that fails leaves everything as before it, but for what it gives
/// back where memory was short.
Result<GnResult> Context::startFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd)
{
    const Time start = std::chrono::steady_clock::now();
    const ReadParts parts{
        .newest = newest_, .views = views_, .scene = *scene_, .vk = *vk_, .executor = executor_.get()};
    if (Result<void> ok = readFrame(info, parts, input_); !ok) {
        if (frame_.stats.frame > newest_) frame_.stats.submits = 0; // of an attempt before this one
        return ok.error();
    }
    keepVisibility(frame_.views, *pool_, newest_);
    thrownEarly_ = nullptr;
    finishedEarly_.reset();
    const std::uint64_t before = newest_;
    const auto undo = [&](bool memoryShort) {
        withdrawFrame(info.frame, memoryShort);
        newest_ = before;
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

Result<GnResult> Context::runFrame(const GnFrameInfo& info, FrameMode mode, VkCommandBuffer cmd, Time start)
{
    openFrame(info, mode, start);
    const SceneRegistry::Snapshot& snapshot = scene_->begin(info.frame, origin_.at());
    if (Result<void> ok = decide(info, snapshot.casters); !ok) return ok.error();
    const SubmitParts submit = submitParts();
    frame_.warmup = nextWarmup(frame_, submit);
    declareLights(frame_, {*graph_, *methods_, *selector_, messages_, arena_, own_.mix, deviceRays_.get()});
    for (const ViewFrame& view : frame_.views)
        if (view.packed) images_.pack(*graph_, view.view->camera, view.visibility, view.packed, view.lights);
    recordDecisions(frame_, chooseParts());
    if (Result<void> ok = openSlot(frame_, input_, info.completedFrame, isTimed(info), snapshot, submit); !ok)
        return ok.error();
    learn(frame_,
          {executor_->newest(), executor_->newestTimed(), executor_->hasClock(), *plan_, history_, methods_->size()});
    if (!executor_->hasClock() && !std::exchange(saidNoClock_, true))
        messages_.warn("NoTimestamps",
                       "the queue has no timestamps, or they stand still or run backwards: GPU times are "
                       "unknown, and methods count as the knowledge base predicts them");
    if (Result<void> ok = submitFrame(frame_, cmd, history_.past.present(), submit); !ok) return ok.error();
    frame_.stats.callMs = static_cast<float>(msSince(start));
    finishStats();
    return methods_->anyReady() ? GN_SUCCESS : GN_NOT_READY;
}

/// What is done with by now goes, and the frame begins.
void Context::openFrame(const GnFrameInfo& info, FrameMode mode, Time start)
{
    frame_.stats = {};
    frame_.stats.frame = info.frame;
    frame_.stats.sharedMs = history_.shared.ms();
    before_ = countersNow(*vk_, rays_.get());
    history_.intervals.note(start, newest_ != 0);
    newest_ = info.frame;
    history_.past.begin(info.frame);

    scene_->retire(info.completedFrame);
    views_.release(info.completedFrame);
    arena_.reset();
    pool_->begin(info.frame, info.completedFrame);
    graph_->reset();
    if (deviceRays_) deviceRays_->begin();
    frame_.begin(info.frame, mode);
    for (View* view : input_.views)
        frame_.views.push_back({.view = view});
    // Depth grids know receivers about the old origin.
    if (origin_.follow({info.pViews, info.viewCount}, info.frame))
        views_.forEach([](View& view) { view.grid->invalidate(); });
}

/// What serves each light of each view.
Result<void> Context::decide(const GnFrameInfo& info, std::span<const Caster> casters)
{
    const Time start = std::chrono::steady_clock::now();
    for (std::uint32_t i = 0; i < info.viewCount; ++i) {
        const GnViewFrame& given = info.pViews[i];
        if (Result<void> ok = openView(frame_, i, given, {*pool_, *graph_, origin_.at(), casters, images_}); !ok)
            return ok;
        history_.past.present().pixels += double(given.imageExtent.width) * double(given.imageExtent.height);
    }
    beginBudget(info);
    measureFacts(frame_, {info.pViews, info.viewCount},
                 {.scene = *scene_,
                  .methods = *methods_,
                  .memory = *memory_,
                  .arena = arena_,
                  .graph = *graph_,
                  .lights = lights_,
                  .grid = own_.grid,
                  .measuresGrids = own_.ready && selector_->hasRules(),
                  .originMoved = origin_.movedIn() == info.frame,
                  .completedFrame = info.completedFrame,
                  .cheapestShare = budget_.cheapestShare(),
                  .frameRate = history_.intervals.rate(),
                  .rays = deviceRays_.get(),
                  .hostRays = rays_.get(),
                  .casters = casters});
    choose(frame_, chooseParts());
    frame_.stats.decideUs = static_cast<float>(msSince(start) * 1000.0);
    return {};
}

void Context::beginBudget(const GnFrameInfo& info)
{
    std::uint32_t lights = 0;
    for (std::uint32_t i = 0; i < info.viewCount; ++i)
        lights += info.pViews[i].lightCount;
    const FrameTotals& totals = history_.totals;
    const PastFrame& measured = history_.past.at(totals.frame());
    budget_.begin(ruleBaseOf(*selector_), {.hostMs = double{info.budgetMs},
                                           .lights = lights,
                                           .cut = frame_.cameraCut(),
                                           .disturbed = history_.past.disturbedBefore(info.frame, kTimedPeriod),
                                           .tookMs = totals.known() ? totals.ms() : history_.predictedMs,
                                           .intervalMs = history_.intervals.newestMs(),
                                           .measured = {.frame = totals.frame(),
                                                        .ms = totals.ms(),
                                                        .plannedMs = measured.plannedMs,
                                                        .cheapestMs = measured.cheapestMs,
                                                        .beside = measured.beside}});
}

bool Context::isTimed(const GnFrameInfo& info)
{
    const bool unasked = history_.timed.has(info.frame, probe_.runs() ? probe_.since() : 0);
    history_.past.present().timedUnasked = unasked;
    return unasked || timeEveryFrame_ || (info.flags & GN_FRAME_TIMED_BIT) != 0;
}

ChooseParts Context::chooseParts()
{
    return {*selector_, *plan_, *methods_, budget_, history_, probe_, own_.ready};
}

SubmitParts Context::submitParts()
{
    return {*executor_, *scene_, rays_.get(), *methods_, own_, *pipelines_, messages_};
}

/// While host passes run on a worker the counters are its; they are read when the frame is finished.
void Context::finishStats()
{
    if (executor_->underway()) return;
    countFrame(frame_.stats, before_, {*vk_, *memory_, *graph_, *executor_, rays_.get()});
    history_.predictedMs = frame_.predictedMs;
    history_.past.present().cpuMs = frame_.stats.cpuMs;
    forgetOldLights(views_, lights_, *scene_, *plan_, newest_);
}

Result<GnResult> Context::finishFrame(std::uint64_t timeoutNs)
{
    if (!executor_->underway()) {
        if (thrownEarly_) std::rethrow_exception(std::exchange(thrownEarly_, nullptr));
        if (finishedEarly_) return *std::exchange(finishedEarly_, std::nullopt);
        return frameOrder("gnFinishShadows without gnBeginShadows");
    }
    const Time start = std::chrono::steady_clock::now();
    const auto undo = [&](bool memoryShort) {
        finishStats(); // how much of it was submitted
        forgetFrame(newest_, memoryShort);
        --newest_;
    };
    Result<GnResult> finished = GN_SUCCESS;
    try {
        finished = executor_->finish(timeoutNs);
    } catch (...) {
        undo(false);
        throw;
    }
    frame_.stats.callMs += static_cast<float>(msSince(start));
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

// --- frames that do not count ---

Result<void> Context::dropFrame(std::uint64_t frame)
{
    if (frame == 0 || frame != recorded_)
        return frameOrder("frame " + std::to_string(frame) + " is not the one recorded last (" +
                          std::to_string(recorded_) + ")");
    if (const std::uint32_t warmup = history_.past.at(frame).warmup; warmup != UINT32_MAX)
        setReady(warmup, false, *methods_, own_); // it has not run
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
    frame_.maps.clear();
    frame_.dropped = true;
    views_.forEach([&](View& view) {
        view.grid->drop(frame);
        loseVisibility(view, *pool_, frame);
    });
}

/// What a frame that nobody will see has noted for others; where memory was short, what is kept goes as well: tried
/// again, the frame starts with what frames in flight use, and nothing else.
void Context::forgetFrame(std::uint64_t frame, bool memoryShort)
{
    frame_.maps.clear();
    frame_.dropped = true;
    for (const ViewFrame& viewFrame : frame_.views) {
        viewFrame.view->grid->drop(frame);
        for (auto& [id, memory] : viewFrame.view->lights)
            memory.fade.withdraw(frame);
    }
    restoreVisibility(frame_.views, *pool_, newest_, memoryShort);
    if (memoryShort) pool_->evictAll();
}

} // namespace gnomon
