#include "runtime/frame/submit.hpp"

namespace gnomon {

namespace {

/// Its pipelines have run once. Where memory was short for that, another frame tries again; nobody has asked yet for
/// what they do.
void settleWarmup(std::uint32_t owner, PastFrame& present, const SubmitParts& parts)
{
    const Error* const error = parts.executor.warmupError();
    if (error && error->result == GN_ERROR_OUT_OF_DEVICE_MEMORY) return;
    if (!error) {
        setReady(owner, true, parts.methods, parts.own);
        present.warmup = owner;
    } else if (owner == kRuntimeOwner) {
        parts.own.fail(error->text, parts.messages);
    } else {
        parts.methods.fail(parts.methods[owner], error->text);
    }
}

/// After passes have been submitted, so nothing may fail any more.
void noteWarmup(std::uint32_t owner, PastFrame& present, const SubmitParts& parts) noexcept
{
    try {
        settleWarmup(owner, present, parts);
    } catch (...) { // no memory for the words about it: another frame tries again
    }
}

} // namespace

std::uint32_t nextWarmup(const Frame& frame, const SubmitParts& parts)
{
    if (parts.own.create(parts.pipelines, parts.messages)) return kRuntimeOwner;
    MethodDemand demand{.others = frame.lights.empty()};
    for (const ViewLight& light : frame.lights) {
        const std::uint32_t pinned = light.decision->pinned;
        if (pinned == UINT32_MAX) {
            demand.others = true;
            continue;
        }
        demand.pinned.add(pinned);
        const Method& method = parts.methods[pinned];
        demand.others |= light.decision->method != pinned && (method.ready || method.unavailable);
    }
    return parts.methods.nextWarmup(demand);
}

void setReady(std::uint32_t owner, bool ready, MethodTable& methods, OwnPipelines& own)
{
    (owner == kRuntimeOwner ? own.ready : methods[owner].ready) = ready;
}

Result<void> openSlot(const Frame& frame, const FrameInput& input, std::uint64_t completedFrame, bool timed,
                      const SceneRegistry::Snapshot& snapshot, const SubmitParts& parts)
{
    return parts.executor.begin({.frame = frame.number,
                                 .completedFrame = completedFrame,
                                 .timed = timed,
                                 .scene = &snapshot,
                                 .uploads = &parts.scene,
                                 .rays = parts.rays,
                                 .raysNeeded = frame.raysNeeded,
                                 .warmupOwner = frame.warmup,
                                 .waits = input.waits,
                                 .signals = input.signals,
                                 .visibilities = frame.visibilities.data(),
                                 .visibilityCount = static_cast<std::uint32_t>(frame.visibilities.size()),
                                 .imports = frame.imports.data(),
                                 .importCount = static_cast<std::uint32_t>(frame.imports.size()),
                                 .lightMaps = frame.lightMaps});
}

Result<void> submitFrame(const Frame& frame, VkCommandBuffer cmd, PastFrame& present, const SubmitParts& parts)
{
    Result<void> gone = frame.mode == FrameMode::recorded ? parts.executor.record(cmd)
                                                          : parts.executor.start(frame.mode == FrameMode::submit);
    if (!gone) return gone;
    if (frame.warmup == UINT32_MAX) return {};
    present.disturbed = true;
    noteWarmup(frame.warmup, present, parts);
    return {};
}

CountersBefore countersNow(const DeviceTable& vk, const RayScene* rays)
{
    return {vk.objectsMade, vk.pipelinesMade, rays ? rays->queryNanoseconds() : 0};
}

void countFrame(GnFrameStats& stats, const CountersBefore& before, const CountParts& parts)
{
    const ExecutorCounters& counters = parts.executor.counters();
    const CountersBefore now = countersNow(parts.vk, parts.rays);
    stats.rounds = parts.graph.rounds();
    stats.submits = counters.submits;
    stats.hostWaits = counters.hostWaits;
    stats.passesRun = counters.passesRun;
    stats.passesKept = parts.graph.counts().kept;
    stats.pagesEvicted = parts.graph.counts().pagesEvicted;
    stats.pagesWithoutRoom = parts.graph.counts().pagesWithoutRoom;
    stats.indexListsBuilt = counters.indexListsBuilt;
    stats.rays = counters.rays;
    if (parts.rays) stats.raysMs = 1e-6f * static_cast<float>(now.rayNanoseconds - before.rayNanoseconds);
    stats.cpuMs = counters.cpuMs;
    stats.deviceAllocations = static_cast<std::uint32_t>(now.objects - before.objects);
    stats.pipelinesCreated = static_cast<std::uint32_t>(now.pipelines - before.pipelines);
    stats.memory = parts.memory.used();
}

} // namespace gnomon
