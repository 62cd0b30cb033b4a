#include "runtime/frame/measure_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "runtime/scene/light_pixels.hpp"
#include "runtime/select/outlines.hpp"

namespace gnomon {

namespace {

/// Of the memory that may be used, what all maps together may take whose sides follow coverage. The limit is half of
/// the heap where the host gives none, which makes it a quarter.
constexpr double kMapShare = 0.5;

/// Of a view's lights.
struct Counts {
    std::uint32_t dynamic = 0;
    std::uint32_t settled = 0; ///< Pinned, to methods that ask for no distance either.
};

Counts countLights(const GnViewFrame& given, const FactsParts& parts)
{
    Counts counts;
    for (std::uint32_t i = 0; i < given.lightCount; ++i) {
        const LightView* light = parts.scene.light(given.pLights[i]);
        counts.dynamic += !light->isStatic;
        const std::uint32_t pinned = parts.lights[light->id].pinned;
        counts.settled += pinned != UINT32_MAX && !parts.methods[pinned].followsCoverage();
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

/// Pixels across a texel of a plain map of 1024, on receivers of a mean MapCoverage::nearness.
float texelPixels(const LightMemory& memory, const CameraView& camera, float nearness)
{
    return static_cast<float>(memory.mapWidth * double{nearness} / (double{pixelAngleOf(camera)} * 1024.0));
}

/// A light and what its view's newest grid says of it.
struct GridLight {
    const DepthGrid& grid;
    const LightView& light;
    const LightCasters& casters;
    LightMemory& memory;
};

/// Beyond so many casters rays are not asked for outlines. The 300 of city_night took 1.3 ms to be placed, once, and
/// 0.04 ms to be sorted again after some had moved (one core of an AMD EPYC): so many take 18 and 0.5 ms in proportion.
constexpr std::size_t kMostPlaced = 4096;

/// Of at most 1024 rays. What has moved since the last frame that asked for any is placed anew for them.
void traceOutlines(const GridLight& of, const TileSample& sample, const FactsParts& parts)
{
    if (!parts.hostRays || parts.casters.size() > kMostPlaced || !raysTellOutlines(of.casters)) {
        of.memory.traced.reset();
        return;
    }
    if (sample.tiles().empty() || !parts.hostRays->update(parts.casters)) return; // no memory: as told before
    const auto found = outlinesByRays(of.grid.camera(), of.light, sample.tiles(), *parts.hostRays);
    if (found) of.memory.traced.add(found->density, texelPixels(of.memory, of.grid.camera(), found->nearness));
}

/// Whether it is the turn of the view's i-th light: casters are placed in one frame of eight, for up to eight lights.
bool tracesNow(std::uint64_t frame, std::uint64_t i, std::uint64_t lights)
{
    constexpr std::uint64_t kTogether = 8;
    const std::uint64_t groups = (lights + kTogether - 1) / kTogether;
    return frame % kGridPeriod == 0 && i / kTogether == frame / kGridPeriod % groups;
}

/// Lights take turns, so that no frame looks all of them up.
void measureDistance(const GridLight& of, std::uint64_t frame, bool traces, const FactsParts& parts)
{
    LightMemory& memory = of.memory;
    const bool due = traces || (frame + of.light.id) % kGridPeriod == 0 || frame - memory.measuredAt >= 2 * kGridPeriod;
    if (!of.grid.valid() || (memory.measured && !due)) return;
    const CameraView& camera = of.grid.camera();
    TileSample sample;
    const Reach reach = measureReach(camera, of.grid.tiles(), of.grid.allTiles(), of.light, of.casters.all, sample);
    memory.distance = reach.distance;
    memory.planarity = reach.planarity;
    memory.share.add(reach.share);
    memory.treeLevels.add(reach.treeLevels);
    memory.penumbraPixels.add(reach.penumbraPixels);
    memory.outlines.add(reach.outlines);
    memory.measured = true;
    memory.measuredAt = frame;
    memory.mapWidth = mapWidth(of.light, of.casters);
    const float texel = texelPixels(memory, camera, reach.meanNearness);
    // What a light is worth by its map, and the side that it needs, do not follow every step of the eye.
    constexpr float kSameTexel = 0.15f;
    if (!(std::fabs(texel - memory.texelPixels) <= kSameTexel * memory.texelPixels)) memory.texelPixels = texel;
    if (traces || !memory.traced.known()) traceOutlines(of, sample, parts);
    const VkExtent2D drawn = camera.area.extent;
    memory.wishedSide = sideFor({.texelAtOne = memory.mapWidth,
                                 .nearness = double{reach.nearness},
                                 .pixelAngle = double{pixelAngleOf(camera)},
                                 .pixels = double{reach.share} * drawn.width * drawn.height,
                                 .maps = mapsOf(of.light.type)});
}

/// Until receivers are measured they count as far from the light as from the eye. A directional light is at no
/// distance, nor is anything to an orthographic eye: pixels alone limit the side then, and texels count as wide as
/// usual.
void guessSide(const CameraView& view, const LightView& light, const LightCasters& casters, LightMemory& memory)
{
    const double pixelAngle = double{pixelAngleOf(view)}, width = mapWidth(light, casters);
    const bool placed = light.type != GN_LIGHT_TYPE_DIRECTIONAL && !gpu::isOrthographic(view.constants);
    if (placed) memory.texelPixels = static_cast<float>(width / (pixelAngle * kUnmeasuredSide));
    const VkExtent2D drawn = view.area.extent;
    const double wish = sideFor({.texelAtOne = width,
                                 .nearness = placed ? 1.0 : std::numeric_limits<double>::max(),
                                 .pixelAngle = pixelAngle,
                                 .pixels = guessedShare(view, light) * drawn.width * drawn.height,
                                 .maps = mapsOf(light.type)});
    memory.wishedSide = std::min(wish, double{kUnmeasuredSide});
}

/// In a light's first frame only what the host calls static is known to rest. A map that is kept would be the cheapest
/// for all others, too, and drawn for nothing where they move.
bool isStill(const LightView& light, const LightCasters& casters, const MotionHistory& motion)
{
    return motion.rests() && (!motion.isNew || (light.isStatic && casters.dynamics.empty()));
}

void measureView(Frame& frame, std::uint32_t index, const GnViewFrame& given, const FactsParts& parts)
{
    const ViewFrame& viewFrame = frame.views[index];
    View& view = *viewFrame.view;
    const Counts counts = countLights(given, parts);
    view.grid->collect(parts.completedFrame);
    if (parts.measuresGrids && counts.settled < given.lightCount) declareGrid(viewFrame, frame.number, parts);
    for (std::uint32_t i = 0; i < given.lightCount; ++i) {
        const LightView& light = *parts.scene.light(given.pLights[i]);
        const LightCasters& casters = *parts.arena.make(castersOf(frame, light, parts));
        LightState& state = parts.lights[light.id];
        state.motion.note(frame.number, light, casters, parts.originMoved);
        state.lastFrame = frame.number;
        LightMemory& memory = view.lights[light.id];
        if (view.camera.cut) memory.traced.reset();
        const bool traces = tracesNow(frame.number, i, given.lightCount);
        measureDistance({*view.grid, light, casters, memory}, frame.number, traces, parts);
        if (parts.measuresGrids && !memory.measured) guessSide(view.camera, light, casters, memory);
        const VkDeviceSize limit = parts.memory.limit();
        frame.lights.push_back({.viewIndex = index,
                                .layer = i,
                                .light = &light,
                                .casters = &casters,
                                .memory = &memory,
                                .state = &state,
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
                                          .seen = state.pinned != UINT32_MAX || canBeSeen(light, view.camera),
                                          .still = isStill(light, casters, state.motion),
                                          .viewRests = frame.number - view.movedIn >= kRestFrames,
                                          .memoryLeft = limit - std::min(parts.memory.used(), limit),
                                          .frame = frame.number}});
    }
}

/// Whether the light's method has maps whose sides follow coverage, or it has none yet.
bool drawsMaps(const ViewLight& light, const MethodTable& methods)
{
    const std::uint32_t method = light.memory->incumbent;
    return method >= methods.size() || methods[method].followsCoverage();
}

/// Device bytes of the light's maps over the square of the side of plain ones; of plain ones where it has none.
double bytesPerTexel(const ViewLight& light, const MethodTable& methods)
{
    constexpr std::uint32_t kLarge = 1024, kSmall = 512;
    constexpr double kPlainTexel = 8.0; // bytes: depth, and the static casters' apart
    const std::uint32_t method = light.memory->incumbent;
    if (method >= methods.size() || !methods[method].followsCoverage())
        return kPlainTexel * (light.light->type == GN_LIGHT_TYPE_POINT ? 6.0 : 1.0);
    const auto bytes = [&](std::uint32_t side) {
        return static_cast<double>(methods[method].entry->memoryFor(methods[method].settingsAt(side),
                                                                    light.facts.view->extent, light.light->type));
    };
    return (bytes(kLarge) - bytes(kSmall)) / (kLarge * kLarge - kSmall * kSmall);
}

/// Whether a light's map is kept, so that another side would have it drawn once more.
bool keepsMap(const ViewLight& light, const MethodTable& methods)
{
    const std::uint32_t method = light.memory->incumbent;
    return (light.light->isStatic || light.facts.still) && method < methods.size() && methods[method].followsCoverage();
}

/// What the views make of a light's maps, which they share: the most of each.
void gatherSides(Frame& frame, const MethodTable& methods)
{
    for (const ViewLight& light : frame.lights)
        light.state->maps = {.side = &light.state->mapSide, .drawn = false};
    for (const ViewLight& light : frame.lights) {
        SideRequest& maps = light.state->maps;
        const VkExtent2D drawn = light.facts.view->area.extent;
        const double share = light.facts.seen ? shareOf(*light.memory, *light.facts.view, *light.light) : 0.0;
        const double pixels = share * drawn.width * drawn.height;
        maps.redraws |= keepsMap(light, methods);
        maps.drawn |= drawsMaps(light, methods);
        maps.bytesPerTexel = std::max(maps.bytesPerTexel, bytesPerTexel(light, methods));
        maps.worth = std::max(maps.worth, double{light.facts.importance} * pixels);
    }
}

/// Sides of the lights' maps in this frame.
void settleSides(Frame& frame, const FactsParts& parts)
{
    gatherSides(frame, parts.methods);
    for (const ViewLight& light : frame.lights) {
        light.state->sideKnown &= !light.facts.view->cut;
        if (parts.originMoved || light.facts.view->cut) light.state->drawn.lose();
        light.state->wishedSide = 0.0;
    }
    for (const ViewLight& light : frame.lights)
        light.state->wishedSide =
            std::max({light.state->wishedSide, light.memory->wishedSide, 1.0 * light.memory->nearSide});
    const std::span<SideRequest> requests = parts.arena.array<SideRequest>(frame.lights.size());
    std::size_t count = 0;
    double held = 0.0;
    for (const ViewLight& light : frame.lights) {
        LightState& state = *light.state;
        const bool settled = std::exchange(state.sideFrame, frame.number) == frame.number; // for another view
        if (!settled) state.mapSide.follow(state.wishedSide, !state.sideKnown);
        state.sideKnown |= light.memory->measured && state.wishedSide > 0.0; // in any of them
        if (settled) continue;
        if (state.maps.drawn && light.memory->incumbent < parts.methods.size())
            held += state.maps.bytes(state.mapSide.side());
        requests[count++] = state.maps;
    }
    const auto limit = static_cast<double>(parts.memory.limit()), used = static_cast<double>(parts.memory.used());
    fitSides(requests.first(count), std::min(kMapShare * limit, std::max(limit - used, 0.0) + held), frame.number);
    takeSides(requests.first(count));
    for (ViewLight& light : frame.lights) {
        light.facts.plainSide = light.state->mapSide.side();
        light.facts.wantedPlainSide = light.state->mapSide.wanted();
        light.facts.mostPlainSide = light.state->mapSide.most();
    }
}

/// How many casters the device has to build before it can trace a light. What a frame builds goes to lights that are
/// traced already before it goes to others.
void measureUnbuilt(Frame& frame, const FactsParts& parts)
{
    std::uint64_t most = 0; // most often it fits whatever is built
    for (const ViewLight& light : frame.lights)
        most += light.casters->triangles;
    if (!parts.rays || most <= DeviceRays::kBuiltPerFrame) return;
    for (const bool traced : {true, false})
        for (ViewLight& light : frame.lights) {
            const std::uint32_t incumbent = light.memory->incumbent;
            if (traced != (incumbent < parts.methods.size() && parts.methods[incumbent].has(GN_TRAIT_DEVICE_RAYS_BIT)))
                continue;
            light.facts.unbuilt = parts.rays->unbuilt(PassBuilder(parts.graph), *light.casters, light.state->unbuilt);
        }
}

} // namespace

void measureFacts(Frame& frame, std::span<const GnViewFrame> given, const FactsParts& parts)
{
    for (std::uint32_t i = 0; i < given.size(); ++i)
        measureView(frame, i, given[i], parts);
    settleSides(frame, parts);
    measureUnbuilt(frame, parts);
}

} // namespace gnomon
