#pragma once
// Facts: what the choice of a method may depend on, for every light of every view.
#include "runtime/accel/device_rays.hpp"
#include "runtime/base/arena.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/rays/ray_scene.hpp"

namespace gnomon {

/// What measuring takes.
struct FactsParts {
    const SceneRegistry& scene;
    const MethodTable& methods;
    const DeviceMemory& memory;
    FrameArena& arena;
    PassGraph& graph;
    LightStates& lights;
    PipelineId grid;
    bool measuresGrids = false; ///< The depth grid's pipeline is ready, and there are rules that ask for distances.
    bool originMoved = false;   ///< In this frame.
    std::uint64_t completedFrame = 0;
    double cheapestShare = 0.0; ///< Of the budget, as the last frame's plan has it.
    double frameRate = 0.0;
    DeviceRays* rays = nullptr;      ///< Null where the device traces none.
    RayScene* hostRays = nullptr;    ///< Null where the processor traces none.
    std::span<const Caster> casters; ///< All, for hostRays.
};

/// Second stage: fills Frame::lights, and declares the depth grids that are due. @param given one for each of
/// Frame::views, which are open
void measureFacts(Frame& frame, std::span<const GnViewFrame> given, const FactsParts& parts);

} // namespace gnomon
