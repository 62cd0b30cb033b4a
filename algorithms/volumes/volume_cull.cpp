#include "algorithms/volumes/volume_cull.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/volumes/shadow_reach.hpp"

#include "shaders/volumes/cull.h"
#include "shaders/volumes_cull_volumes_comp.h"
#include "shaders/volumes_reached_tiles_comp.h"

namespace gnomon {

namespace {

static_assert(sizeof(gpu::VolumeRegion::shadow) / sizeof(glm::vec4) == gpu::SHADOW_PLANES);
static_assert(sizeof(gpu::UmbraRegion::planes) / sizeof(glm::vec4) == gpu::UMBRA_PLANES);
static_assert(sizeof(gpu::CullConstants::candidates) / sizeof(gpu::CullCandidate) == gpu::CANDIDATES);

// Volumes below which all are drawn: the choice takes 0.1 to 0.2 ms a light on a software device, about what a volume
// does.
constexpr std::size_t kLeastCandidates = 4;

// Head of the list of reached boxes: count and needed umbrae.
constexpr VkDeviceSize kReachedHead = 16;

std::uint32_t groups(std::size_t invocations)
{
    return static_cast<std::uint32_t>((invocations + gpu::CULL_GROUP - 1) / gpu::CULL_GROUP);
}

std::uint32_t tileCount(const VkRect2D& area)
{
    const VkExtent2D tiles = tileExtent(area);
    return tiles.width * tiles.height;
}

VkDeviceSize reachedSize(std::uint32_t tiles)
{
    return kReachedHead + VkDeviceSize{sizeof(gpu::ReachedBox)} * tiles;
}

// --- where volumes can be ---

struct RegionBuild {
    const LightView* light = nullptr;
    std::span<const VolumePiece> pieces;
    std::span<const StaticVolumes::Occluder> occluders;
    std::size_t count = 0; ///< Volumes of the pieces.
    BufferId buffer;
};

constexpr VkDeviceSize kUmbraeSize = VkDeviceSize{sizeof(gpu::UmbraRegion)} * gpu::UMBRAE;

void writeRegions(const RegionBuild& build, HostContext& host)
{
    const std::span<gpu::UmbraRegion> umbrae = host.write<gpu::UmbraRegion>(build.buffer).first(gpu::UMBRAE);
    for (std::size_t i = 0; i < build.occluders.size(); ++i) {
        const std::vector<glm::vec4>& planes = build.occluders[i].umbra.planes;
        std::fill_n(umbrae[i].planes, gpu::UMBRA_PLANES, gpu::nowhereOutside());
        std::copy(planes.begin(), planes.end(), umbrae[i].planes);
    }
    const std::span<std::byte> bytes = host.write<std::byte>(build.buffer).subspan(kUmbraeSize);
    const std::span<gpu::VolumeRegion> regions(reinterpret_cast<gpu::VolumeRegion*>(bytes.data()), build.count);
    std::size_t next = 0;
    VolumeSource source;
    for (const VolumePiece& piece : build.pieces) {
        if (piece.source == source) continue;
        source = piece.source;
        gpu::VolumeRegion region{};
        std::copy_n(boxShadow(source.bounds(), *build.light).planes, gpu::SHADOW_PLANES, region.shadow);
        region.umbra = gpu::NO_UMBRA;
        regions[next++] = region;
    }
    for (std::size_t i = 0; i < build.occluders.size(); ++i)
        regions[build.occluders[i].position].umbra = static_cast<std::uint32_t>(i);
}

/// Made again when the light or one of the casters changes. @param count volumes of the pieces
BufferId declareRegions(PassBuilder& passes, const LightView& light, const CulledList& list,
                        std::span<const VolumePiece> pieces, std::size_t count)
{
    const BufferId buffer = passes.persistent(BufferInfo{.name = "volumes.regions",
                                                         .scope = Scope::light,
                                                         .size = kUmbraeSize + sizeof(gpu::VolumeRegion) * count,
                                                         .place = BufferPlace::upload,
                                                         .variant = list.variant});
    if (!passes.stale(buffer, list.stamp)) {
        passes.kept();
        return buffer;
    }
    const RegionBuild build{&light, pieces, list.occluders, count, buffer};
    passes.prepare("volumes.regions", Scope::light, list.variant).writes(buffer).run([build](HostContext& host) {
        writeRegions(build, host);
    });
    return buffer;
}

// --- every frame ---

/// Umbrae are of use while nobody can look out of the caster's inside.
std::uint32_t usableUmbrae(std::span<const StaticVolumes::Occluder> occluders, const CameraView& view)
{
    const Aabb near = eyeBounds(view);
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < occluders.size(); ++i) {
        const Aabb& box = occluders[i].bounds;
        if (!overlap(near, {box.lower - kUmbraMargin, box.upper + kUmbraMargin})) mask |= 1u << i;
    }
    return mask;
}

gpu::ReachConstants reachConstants(const ShadowTask& task, std::span<const StaticVolumes::Occluder> occluders)
{
    const LightView& light = *task.light;
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const bool cone = light.type == GN_LIGHT_TYPE_SPOT;
    gpu::ReachConstants block{};
    block.eyeWs = glm::vec4(task.view->eye, 0.0f);
    block.lightWs = glm::vec4(directional ? light.direction() : light.position(), directional ? 0.0f : 1.0f);
    block.axis = glm::vec4(light.direction(), cone ? std::cos(light.coneAngle) : -1.0f);
    block.sine = cone ? std::sin(light.coneAngle) : 0.0f;
    // Squared in the shader; whatever is beyond the root of the largest float has no end.
    block.range = std::min(light.constants.range, 1e18f);
    block.tileCount = tileCount(task.view->area);
    block.umbraMask = usableUmbrae(occluders, *task.view);
    return block;
}

BufferId declareReached(PassBuilder& passes, PipelineId pipeline, const ShadowTask& task,
                        std::span<const StaticVolumes::Occluder> occluders, BufferId tiles, BufferId regions)
{
    gpu::ReachConstants* block = passes.arena().make<gpu::ReachConstants>();
    *block = reachConstants(task, occluders);
    const BufferId reached =
        passes.transient(BufferInfo{.name = "volumes.reached", .size = reachedSize(block->tileCount)});
    passes.transfer("volumes.clear_reached").writes(reached).record([=](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(reached), 0, kReachedHead, 0);
    });
    passes.compute("volumes.reached").reads(tiles).reads(regions).updates(reached).record([=](PassContext& gpu) {
        gpu.bind(pipeline,
                 {gpu.constants(0, *block), gpu.storage(1, tiles), gpu.storage(2, regions), gpu.storage(3, reached)});
        gpu.vk->vkCmdDispatch(gpu.cmd, groups(block->tileCount), 1, 1);
    });
    return reached;
}

/// Which volume of the list each of its pieces is of.
std::span<const std::uint32_t> volumePositions(FrameArena& arena, std::span<const VolumePiece> pieces)
{
    const std::span<std::uint32_t> positions = arena.array<std::uint32_t>(pieces.size());
    std::uint32_t position = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i > 0 && pieces[i].source != pieces[i - 1].source) ++position;
        positions[i] = position;
    }
    return positions;
}

bool comesFrom(const VolumeDraw& draw, const VolumeList& list)
{
    return draw.list.index == list.buffer.index;
}

/// The plan's draws of a list of sides. @param positions volumePositions() of it
std::span<const gpu::CullCandidate> candidatesOf(FrameArena& arena, const VolumePlan& plan, const VolumeList& sides,
                                                 std::span<const std::uint32_t> positions)
{
    const std::span<gpu::CullCandidate> candidates =
        arena.array<gpu::CullCandidate>(plan.zPass.size() + plan.zFail.size());
    std::size_t count = 0;
    const auto add = [&](const VolumeDraw& draw, const VolumeDraw& caps) {
        if (!comesFrom(draw, sides)) return;
        candidates[count++] = {.region = positions[draw.firstCommand],
                               .firstSide = draw.firstCommand,
                               .sideCount = draw.commandCount,
                               .firstCap = caps.firstCommand,
                               .capCount = caps.commandCount};
    };
    for (const VolumeDraw& draw : plan.zPass)
        add(draw, {});
    // Each has its caps, in the same order, but where their list has failed, and the frame with it.
    if (plan.caps.size() != plan.zFail.size()) return candidates.first(count);
    for (std::size_t i = 0; i < plan.zFail.size(); ++i)
        add(plan.zFail[i], plan.caps[i]);
    return candidates.first(count);
}

BufferId commandsFor(PassBuilder& passes, const char* name, const VolumeList& list, std::uint32_t variant)
{
    if (!list.buffer) return {};
    return passes.transient(BufferInfo{.name = name,
                                       .size = VkDeviceSize{sizeof(VkDrawIndexedIndirectCommand)} * list.pieces.size(),
                                       .variant = variant});
}

/// Commands in the places that they have in the lists they are made of.
struct CulledCommands {
    BufferId sides, caps; ///< caps: null id without any.
};

CulledCommands declareChoice(PassBuilder& passes, PipelineId pipeline, const CulledList& list, const VolumeList& sides,
                             const VolumeList& caps, BufferId regions, BufferId reached,
                             std::span<const gpu::CullCandidate> candidates)
{
    const CulledCommands culled{.sides = commandsFor(passes, "volumes.culled_sides", sides, list.variant),
                                .caps = commandsFor(passes, "volumes.culled_caps", caps, list.variant)};
    PassRef pass = passes.compute("volumes.cull", Scope::task, list.variant);
    pass.reads(regions).reads(reached).reads(sides.buffer).writes(culled.sides);
    if (culled.caps) pass.reads(caps.buffer).writes(culled.caps);
    // Without caps the shader touches neither; something must be bound.
    const BufferId from[2] = {sides.buffer, culled.caps ? caps.buffer : sides.buffer};
    const BufferId to[2] = {culled.sides, culled.caps ? culled.caps : culled.sides};
    pass.record([=](PassContext& gpu) {
        for (std::size_t first = 0; first < candidates.size(); first += gpu::CANDIDATES) {
            const std::size_t count = std::min<std::size_t>(gpu::CANDIDATES, candidates.size() - first);
            gpu::CullConstants block;
            std::copy_n(candidates.data() + first, count, block.candidates);
            gpu.bind(pipeline,
                     {gpu.constants(0, block), gpu.storage(1, regions), gpu.storage(2, reached),
                      gpu.storage(3, from[0]), gpu.storage(4, from[1]), gpu.storage(5, to[0]), gpu.storage(6, to[1])});
            gpu.vk->vkCmdDispatch(gpu.cmd, static_cast<std::uint32_t>(count), 1, 1);
        }
    });
    return culled;
}

void replaceCommands(std::span<VolumeDraw> draws, const VolumeList& list, BufferId commands)
{
    for (VolumeDraw& draw : draws)
        if (comesFrom(draw, list)) draw.commands = commands;
}

} // namespace

VolumeCullPipelines makeVolumeCullPipelines(const AlgorithmServices& services)
{
    return {.reached = services.pipelines->compute("volumes.reached", {k_volumes_reached_tiles_comp},
                                                   {constantsAt(0), bufferAt(1), bufferAt(2), bufferAt(3)}),
            .cull = services.pipelines->compute(
                "volumes.cull", {k_volumes_cull_volumes_comp},
                {constantsAt(0), bufferAt(1), bufferAt(2), bufferAt(3), bufferAt(4), bufferAt(5), bufferAt(6)})};
}

void declareCull(PassBuilder& passes, const VolumeCullPipelines& pipelines, const ShadowTask& task,
                 const ViewStencil& stencil, std::span<const CulledList> lists, VolumePlan& plan)
{
    BufferId reached;
    for (const CulledList& list : lists) {
        const VolumeList &sides = plan.lists[list.index], &caps = plan.lists[2 + list.index];
        const std::span<const std::uint32_t> positions = volumePositions(passes.arena(), sides.pieces);
        const std::span<const gpu::CullCandidate> candidates = candidatesOf(passes.arena(), plan, sides, positions);
        if (candidates.size() < kLeastCandidates) continue;
        const BufferId regions = declareRegions(passes, *task.light, list, sides.pieces, positions.back() + 1);
        if (!reached) reached = declareReached(passes, pipelines.reached, task, list.occluders, stencil.tiles, regions);
        const CulledCommands culled =
            declareChoice(passes, pipelines.cull, list, sides, caps, regions, reached, candidates);
        replaceCommands(plan.zPass, sides, culled.sides);
        replaceCommands(plan.zFail, sides, culled.sides);
        if (culled.caps) replaceCommands(plan.caps, caps, culled.caps);
        plan.commands[list.index] = culled.sides;
        plan.commands[2 + list.index] = culled.caps;
    }
}

VkDeviceSize cullMemory(VkExtent2D extent)
{
    return pooledSize(reachedSize(tileCount({{0, 0}, extent})));
}

} // namespace gnomon
