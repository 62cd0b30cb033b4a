// A depth map that knows its triangles; near the edges of its shadows the neighbouring texels' triangles prove
// shadow, and what they cannot prove is traced.
// Source:    D. L. Moderno, "Shadow Mapping and Ray-Tracing", Universidade do Minho, chapters 3 and 4.
// Reads:     caster geometry, receiver depth and normals.     Writes: visibility.
// Strong at: edges in scenes of large or regular triangles: a fraction of a percent of the pixels is traced.
// Weak at:   what the map missed altogether: outside the contour its errors stay.
#include "algorithms/entries.hpp"

#include "algorithms/hybrid/chain_pass.hpp"
#include "algorithms/hybrid/map_classification.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/hybrid_contour_chain_cube_frag.h"
#include "shaders/hybrid_contour_chain_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kContour, kMode, kReasons, kClassify };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024, true},
    {"contour", "Width in pixels of what is looked into around edges of the map's shadows: 2, 4 or 6; 0: everywhere.",
     0, 6, 4},
    {"mode", "0 chain, 1 texels only, 2 texels that say lit, 3 strict, 4 no rays, 5 texels everywhere: see the page.",
     0, 5, 2},
    {"reasons",
     "1: visibility shows why, not what; 2: what every stage would say; 3, 4: how many triangles it could ask.", 0, 4,
     0},
    kClassifySetting,
};

/// Contours are 2, 4 or 6 pixels wide; numbers between them count as the next one.
std::uint32_t contourWidth(double setting)
{
    return (static_cast<std::uint32_t>(setting) + 1) / 2 * 2;
}

class ContourChain final : public ShadowAlgorithm {
public:
    explicit ContourChain(const AlgorithmServices& services)
        : vk_(*services.vk), map_(makeIdMapPipelines(services)),
          status_(services, {.name = "contour_chain.status",
                             .fragment = k_hybrid_contour_chain_frag,
                             .cube = k_hybrid_contour_chain_cube_frag,
                             .filters = false})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto mode = static_cast<ChainMode>(task.settings[kMode]);
        ChainJob job = makeJob(passes, task, mode);
        if (job.stages.candidates == CandidateUse::chain) declareRings(passes, *job.triangles);
        if (classifiesOnHost(task.settings[kClassify], vk_, task))
            declareHostStatus(passes, job);
        else
            declareStatus(passes, task, job);
        PassRef host = passes.host("contour_chain.chain");
        host.reads(job.status).reads(job.depth).writes(job.rows);
        if (job.normals) host.reads(job.normals);
        if (job.settled) host.reads(job.settled);
        job.map.uses(host);
        host.run([job](HostContext& context) { runChain(job, context); });
        declareVisibilityCopy(passes, task, job.rows, task.view->area, "contour_chain.copy");
    }

    const char* refuses(const ShadowTask& task) const override
    {
        std::uint64_t triangles = 0;
        for (const Caster* caster : task.casters->all)
            if (caster->mesh) triangles += caster->mesh->triangleCount();
        return triangles < kNoTriangle ? nullptr : "more triangles in range than texels can number";
    }

private:
    ChainJob makeJob(PassBuilder& passes, const ShadowTask& task, ChainMode mode);
    void declareRings(PassBuilder& passes, const NumberedTriangles& triangles) const;
    void declareStatus(PassBuilder& passes, const ShadowTask& task, const ChainJob& job) const;
    static void declareHostStatus(PassBuilder& passes, ChainJob& job);

    const DeviceTable& vk_;
    IdMapPipelines map_;
    MapResolve status_;
    RingsCache rings_;
};

ChainJob ContourChain::makeJob(PassBuilder& passes, const ShadowTask& task, ChainMode mode)
{
    FrameArena& arena = passes.arena();
    const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
    const auto tells = static_cast<ChainDebugOutput>(task.settings[kReasons]);
    const ChainStages stages = stagesOf(tellsAll(tells) ? ChainMode::strict : mode);
    rings_.begin(passes.frame());
    const NumberedTriangles* triangles = arena.make(
        NumberedTriangles(task.casters->all, stages.candidates == CandidateUse::chain ? &rings_ : nullptr, arena));
    gpu::HybridConstants* constants = arena.make<gpu::HybridConstants>();
    const IdMap map = declareIdMap(passes, map_, task, resolution, *triangles);
    constants->base = mapConstants(task, resolution, 1);
    addLightProjection(constants->base, map.fits, task);
    constants->reasons = tells != ChainDebugOutput::visibility;
    const VkExtent2D extent = task.view->area.extent;
    const VkDeviceSize pixels = VkDeviceSize{extent.width} * extent.height;
    return {.view = task.view,
            .light = task.light,
            .constants = constants,
            .triangles = triangles,
            .map = map,
            .depth = passes.depthOnHost(),
            .normals = passes.normalsOnHost(),
            .status = passes.transient(
                BufferInfo{.name = "contour_chain.status", .size = pixels, .place = BufferPlace::readback}),
            .rows = passes.transient(
                BufferInfo{.name = "contour_chain.visibility", .size = pixels, .place = BufferPlace::upload}),
            .stages = stages,
            .contour = mode == ChainMode::wholeTc || tellsAll(tells) ? 0 : contourWidth(task.settings[kContour]),
            .tells = tells};
}

void ContourChain::declareRings(PassBuilder& passes, const NumberedTriangles& triangles) const
{
    for (const NumberedTriangles::Entry& entry : triangles.entries()) {
        if (!entry.rings || entry.rings->built) continue;
        passes.prepare("contour_chain.rings", Scope::scene, entry.caster->mesh->id)
            .run([rings = entry.rings, topology = entry.caster->mesh->topology](HostContext& host) {
                rings->rings.build(*topology);
                rings->built = true;
                host.countIndexList();
            });
    }
}

void ContourChain::declareStatus(PassBuilder& passes, const ShadowTask& task, const ChainJob& job) const
{
    status_.declare(passes, task, job.map.depth, *job.constants, {});
    declareVisibilityReadback(passes, task, job.status, task.view->area, "contour_chain.readback");
}

/// Bit 0 of each byte is 1 where the pixel is lit, as shaders/hybrid/contour_chain.frag has it. Texels that agree are
/// the chain's first question: sixteen pixels at a time it is asked of all of them for what one costs the contour.
void ContourChain::declareHostStatus(PassBuilder& passes, ChainJob& job)
{
    const VkExtent2D extent = job.view->area.extent;
    const VkDeviceSize words = BitRows::wordsPerRow(extent.width) * VkDeviceSize{extent.height};
    if (!tellsAll(job.tells))
        job.settled = passes.transient(BufferInfo{
            .name = "contour_chain.settled", .size = words * sizeof(std::uint64_t), .place = BufferPlace::readback});
    const MapQuestion question{.view = job.view,
                               .light = job.light,
                               .constants = &job.constants->base,
                               .map = job.map.depthOnHost(),
                               .depth = job.depth,
                               .normals = job.normals};
    const bool reasons = job.constants->reasons != 0;
    const simd::MapBytes bytes{.outside = reasons ? gpu::REASON_OUTSIDE : 255,
                               .backfacing = reasons ? gpu::REASON_BACKFACING : 0,
                               .lit = reasons ? gpu::REASON_MAP_LIT : 255,
                               .dark = reasons ? gpu::REASON_MAP_SHADOW : 0,
                               .unsure = gpu::MAP_UNSURE};
    const Believed believed = job.settled ? job.stages.believed() : Believed::never;
    if (believed != Believed::never) job.stages.hintLit = job.stages.hintShadow = false; // asked here
    PassRef host = passes.host("contour_chain.status");
    question.uses(host);
    host.writes(job.status);
    if (job.settled) host.writes(job.settled);
    host.run([=, status = job.status, settled = job.settled](HostContext& context) {
        const std::span<std::uint64_t> rows =
            settled ? context.write<std::uint64_t>(settled) : context.arena->array<std::uint64_t>(words);
        nearestPixels(question, bytes, context, context.write<std::uint8_t>(status),
                      {extent.width, extent.height, rows}, believed);
    });
}

} // namespace

constinit const AlgorithmEntry kContourChain{
    .name = "contour_chain",
    .source = "Moderno, chapters 3 and 4",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            return idMapMemory(static_cast<std::uint32_t>(settings[kResolution]), mapLayers(type)) +
                   undecidedMemory(extent);
        },
    .missing = [](const DeviceTable& vk) -> const char* {
        return vk.enabled.geometryShader ? nullptr : "needs geometryShader"; // gl_PrimitiveID in fragment shaders
    },
    .create = makeAlgorithm<ContourChain>,
    .typicalWrongPercent = 0.042f, // contour_chain.md, colonnade
};

} // namespace gnomon
