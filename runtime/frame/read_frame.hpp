#pragma once
// What the host says of a frame, checked before anything changes: order, budget, semaphores, views, lights, images.
#include <string>

#include "runtime/frame/frame.hpp"
#include "runtime/passes/pass_executor.hpp"

namespace gnomon {

/// #GN_ERROR_FRAME_ORDER: calls and frame numbers that do not follow each other.
Error frameOrder(const std::string& text);

/// What a frame is checked against.
struct ReadParts {
    std::uint64_t newest = 0; ///< The newest frame begun; 0: none.
    Views& views;
    const SceneRegistry& scene;
    const DeviceTable& vk;
    const PassExecutor* executor = nullptr; ///< Null: none is under way, and memory is there for all.
};

/// First stage. On an error nothing has changed but `out`, which is not to be used then.
Result<void> readFrame(const GnFrameInfo& info, const ReadParts& parts, FrameInput& out);

} // namespace gnomon
