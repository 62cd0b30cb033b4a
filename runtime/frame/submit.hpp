#pragma once
// The frame's way to the device: which pipelines run for the first time, the frame's slot, recording and submitting.
#include <span>

#include "runtime/frame/frame.hpp"
#include "runtime/frame/own_pipelines.hpp"
#include "runtime/frame/past_frames.hpp"
#include "runtime/passes/pass_executor.hpp"

namespace gnomon {

/// What submitting takes.
struct SubmitParts {
    PassExecutor& executor;
    SceneRegistry& scene;
    RayScene* rays = nullptr; ///< Null without Embree.
    MethodTable& methods;
    OwnPipelines& own;
    PipelineStore& pipelines;
    const Messages& messages;
};

/// Whose pipelines this frame runs for the first time, once they are compiled: one method a frame.
std::uint32_t nextWarmup(const Frame& frame, const SubmitParts& parts);
/// Those of a method, or of the runtime, count as ready, or do not any more.
void setReady(std::uint32_t owner, bool ready, MethodTable& methods, OwnPipelines& own);

/// Claims the frame's slot. Timings of completed frames come in with it.
Result<void> openSlot(const Frame& frame, const FrameInput& input, std::uint64_t completedFrame, bool timed,
                      const SceneRegistry::Snapshot& snapshot, const SubmitParts& parts);

/// Fifth stage: everything goes into the host's command buffer, or the first round to the queue.
/// @param cmd of FrameMode::recorded @param present learns what ran for the first time
Result<void> submitFrame(const Frame& frame, VkCommandBuffer cmd, PastFrame& present, const SubmitParts& parts);

/// Running totals, as they are when a frame begins.
struct CountersBefore {
    std::uint64_t objects = 0, pipelines = 0, rayNanoseconds = 0;
};
CountersBefore countersNow(const DeviceTable& vk, const RayScene* rays);

/// What counting takes.
struct CountParts {
    const DeviceTable& vk;
    const DeviceMemory& memory;
    const PassGraph& graph;
    PassExecutor& executor; ///< No frame is under way: while host passes run on a worker the counters are its.
    const RayScene* rays = nullptr;
};
/// What the frame has done, for the host.
void countFrame(GnFrameStats& stats, const CountersBefore& before, const CountParts& parts);

} // namespace gnomon
