#pragma once
// Passes: every light's method declares what it will do, and so do the methods that run beside it.
#include "runtime/accel/device_rays.hpp"
#include "runtime/base/arena.hpp"
#include "runtime/base/messages.hpp"
#include "runtime/frame/frame.hpp"

namespace gnomon {

/// What declaring takes.
struct DeclareParts {
    PassGraph& graph;
    const MethodTable& methods;
    const Selector& selector;
    const Messages& messages;
    FrameArena& arena;
    PipelineId mix;             ///< Of the pass that mixes two methods.
    DeviceRays* rays = nullptr; ///< Null where the device traces none.
};

/// Fourth stage. Where a method's passes cannot be made, the next of the choice's replacements serves the light; where
/// none can, it is lit.
void declareLights(Frame& frame, const DeclareParts& parts);

} // namespace gnomon
