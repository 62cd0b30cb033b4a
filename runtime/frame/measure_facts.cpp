#include "runtime/frame/measure_facts.hpp"

#include <algorithm>

namespace gnomon {

namespace {

/// Of a view's lights.
struct Counts {
    std::uint32_t dynamic = 0, pinned = 0;
};

Counts countLights(const GnViewFrame& given, const FactsParts& parts)
{
    Counts counts;
    for (std::uint32_t i = 0; i < given.lightCount; ++i) {
        const LightView* light = parts.scene.light(given.pLights[i]);
        counts.dynamic += !light->isStatic;
        counts.pinned += parts.lights[light->id].pinned != UINT32_MAX;
    }
    return counts;
}

const LightCasters& castersOf(Frame& frame, const LightView& light, const FactsParts& parts)
{
    for (const LightFrame& known : frame.casters)
        if (known.id == light.id) return known.casters;
    frame.casters.push_back({light.id, light.handle, parts.scene.castersOf(light, parts.arena)});
    return frame.casters.back().casters;
}

/// Without memory for a grid the frame goes without; the next one that wants it tries again.
void declareGrid(const ViewFrame& viewFrame, std::uint64_t frame, const FactsParts& parts)
{
    View& view = *viewFrame.view;
    if (!view.grid->wanted(frame)) return;
    parts.graph.beginTask({.view = view.id}, &view.camera, viewFrame.depth, viewFrame.normals);
    (void)view.grid->declare(parts.graph, view.camera, viewFrame.depth, parts.grid, frame);
    parts.graph.endTask();
}

/// What the view's newest grid says of a light. Lights take turns, so that no frame looks all of them up.
void measureDistance(const DepthGrid& grid, const LightView& light, const LightCasters& casters, LightMemory& memory,
                     std::uint64_t frame)
{
    const bool due = (frame + light.id) % kGridPeriod == 0 || frame - memory.measuredAt >= 2 * kGridPeriod;
    if (!grid.valid() || (memory.measured && !due)) return;
    const Reach reach = measureReach(grid.camera(), grid.tiles(), grid.allTiles(), light, casters.all);
    memory.distance = reach.distance;
    memory.planarity = reach.planarity;
    memory.share.add(reach.share);
    memory.treeLevels.add(reach.treeLevels);
    memory.measured = true;
    memory.measuredAt = frame;
}

void measureView(Frame& frame, std::uint32_t index, const GnViewFrame& given, const FactsParts& parts)
{
    const ViewFrame& viewFrame = frame.views[index];
    View& view = *viewFrame.view;
    const Counts counts = countLights(given, parts);
    view.grid->collect(parts.completedFrame);
    if (parts.measuresGrids && counts.pinned < given.lightCount) declareGrid(viewFrame, frame.number, parts);
    for (std::uint32_t i = 0; i < given.lightCount; ++i) {
        const LightView& light = *parts.scene.light(given.pLights[i]);
        const LightCasters& casters = *parts.arena.make(castersOf(frame, light, parts));
        LightState& state = parts.lights[light.id];
        state.motion.note(frame.number, light, casters, parts.originMoved);
        state.lastFrame = frame.number;
        LightMemory& memory = view.lights[light.id];
        measureDistance(*view.grid, light, casters, memory, frame.number);
        const VkDeviceSize limit = parts.memory.limit();
        frame.lights.push_back({.viewIndex = index,
                                .layer = i,
                                .light = &light,
                                .casters = &casters,
                                .memory = &memory,
                                .facts = {.view = &view.camera,
                                          .light = &light,
                                          .casters = &casters,
                                          .pinned = state.pinned,
                                          .dynamicLights = counts.dynamic,
                                          .lightMotion = state.motion.share(),
                                          .frameBudget = parts.cheapestShare,
                                          .frameRate = parts.frameRate,
                                          .importance = light.importance,
                                          .recorded = frame.mode == FrameMode::recorded,
                                          .still = state.motion.rests(),
                                          .memoryLeft = limit - std::min(parts.memory.used(), limit),
                                          .frame = frame.number}});
    }
}

} // namespace

void measureFacts(Frame& frame, std::span<const GnViewFrame> given, const FactsParts& parts)
{
    for (std::uint32_t i = 0; i < given.size(); ++i)
        measureView(frame, i, given[i], parts);
}

} // namespace gnomon
