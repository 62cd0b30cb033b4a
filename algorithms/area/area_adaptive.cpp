#include "algorithms/area/area_adaptive.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "algorithms/area/area_maps.hpp"
#include "algorithms/area/source_quads.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/source_points.hpp"
#include "algorithms/shared/source_size.hpp"
#include "shaders/area/area_adaptive.h"
#include "shaders/area_area_adaptive_resolve_frag.h"
#include "shaders/area_area_adaptive_test_comp.h"
#include "shaders/area_area_light_bits_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kLeast, kWindow, kReasons };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of every point's map.", 64, 2048, 512, true},
    {"least", "Every square is divided so often: 4, 9, 25, 81 or 289 points at least.", 0, kQuadLevels, 2},
    {"window", "Pixels from one that is looked at for steps to the next; more of them take fewer points.", 1, 16, 2},
    {"reasons", "1: the byte in visibility is the share of the 289 points whose maps were drawn.", 0, 1, 0},
};

constexpr VkFormat kWordFormat = VK_FORMAT_R32_UINT;
constexpr std::uint32_t kFlags = 1 + 4 + 16 + 64; ///< A word for each square that may be divided.

constexpr BindingInfo kTestBindings[] = {
    {.binding = 0, .kind = BindingKind::constants},
    {.binding = 1, .kind = BindingKind::sampledImage, .format = kWordFormat, .array = true},
    {.binding = 2, .kind = BindingKind::storageBuffer}};

/// Squares of all levels before one.
constexpr std::uint32_t firstFlag(std::uint32_t level)
{
    return ((1u << (2 * level)) - 1) / 3;
}
static_assert(firstFlag(kQuadLevels) == kFlags && gpu::MAX_QUADS == kMostQuads && gpu::MAX_POINTS == kLatticePoints);
static_assert(gpu::MAX_AREA_MAPS == kWordPoints);

/// What is decided in a frame, round by round; in its memory.
struct Tree {
    SourceQuads quads;
    std::array<bool, kPointWords * kWordPoints> skipped{};

    void note()
    {
        for (std::uint32_t place = 0; place < skipped.size(); ++place)
            skipped[place] = (quads.needed(place / kWordPoints) >> place % kWordPoints & 1) == 0;
    }
};

struct Images {
    ImageId maps, words;
    BufferId flags;
};

Images makeImages(PassBuilder& passes, const ShadowTask& task)
{
    const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
    return {.maps = passes.transient(ImageInfo{.name = "area_adaptive.maps",
                                               .format = kMapFormat,
                                               .extent = {resolution, resolution},
                                               .layers = kWordPoints}),
            .words = passes.transient(ImageInfo{.name = "area_adaptive.words",
                                                .format = kWordFormat,
                                                .extent = passes.extent(task.depth),
                                                .layers = kPointWords}),
            .flags = passes.transient(
                BufferInfo{.name = "area_adaptive.flags", .size = 4 * kFlags, .place = BufferPlace::readback})};
}

gpu::QuadTests testsOf(const SourceQuads& quads, const VkRect2D& area, std::uint32_t window)
{
    gpu::QuadTests tests{};
    tests.area = {area.offset.x, area.offset.y, area.extent.width, area.extent.height};
    tests.window = window;
    tests.firstFlag = firstFlag(quads.level());
    for (const SourceQuad& quad : quads.quads()) {
        gpu::uvec4& corners = tests.corners[tests.count++];
        for (std::uint32_t i = 0; i < 4; ++i)
            corners[static_cast<int>(i)] = placeOf(quad.at(i, quads.level()));
    }
    return tests;
}

gpu::PointWeights weightsOf(const SourceQuads& quads, bool reasons)
{
    gpu::PointWeights weights{};
    weights.shown = reasons ? static_cast<float>(quads.points()) / kLatticePoints : -1.0f;
    for (std::uint32_t place = 0; place < kPointWords * kWordPoints; ++place) {
        if (quads.weight(place) == 0.0f) continue;
        const int at = weights.count % 2 == 0 ? 0 : 2;
        gpu::uvec4& pair = weights.points[weights.count++ / 2];
        pair[at] = place;
        pair[at + 1] = std::bit_cast<std::uint32_t>(quads.weight(place));
    }
    return weights;
}

class AreaAdaptive final : public ShadowAlgorithm {
public:
    explicit AreaAdaptive(const AlgorithmServices& services);
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }

private:
    void declareWord(PassBuilder& passes, const ShadowTask& task, const Images& images, std::uint32_t word,
                     BufferId after, const Tree* tree) const;
    BufferId declareDivision(PassBuilder& passes, const ShadowTask& task, const Images& images, std::uint32_t level,
                             Tree* tree) const;
    void declareResolve(PassBuilder& passes, const ShadowTask& task, const Images& images, BufferId after,
                        const Tree* tree) const;

    DepthMapPipelines casters_;
    PointLookups bits_;
    PipelineId test_, resolve_;
};

AreaAdaptive::AreaAdaptive(const AlgorithmServices& services)
    : casters_(makeDepthMapPipelines(services)),
      bits_(makePointLookups(services, "area_adaptive.bits", k_area_area_light_bits_frag, kWordFormat)),
      test_(services.pipelines->compute({.name = "area_adaptive.test",
                                         .compute = {.code = k_area_area_adaptive_test_comp},
                                         .bindings = kTestBindings}))
{
    GraphicsPipelineInfo info{.name = "area_adaptive.resolve",
                              .vertex = {.code = k_shared_fullscreen_vert},
                              .fragment = {.code = k_area_area_adaptive_resolve_frag},
                              .bindings = std::span(kTestBindings).first(2)};
    info.colorFormat = VK_FORMAT_R8_UNORM;
    resolve_ = services.pipelines->graphics(info);
}

Rect areaOf(const ShadowTask& task)
{
    const VkRect2D& area = task.view->area;
    return {area.offset.x, area.offset.y, area.extent.width, area.extent.height};
}

/// The maps of a word's points, those that are needed, and the pass that makes bits of them.
void AreaAdaptive::declareWord(PassBuilder& passes, const ShadowTask& task, const Images& images, std::uint32_t word,
                               BufferId after, const Tree* tree) const
{
    FrameArena& arena = passes.arena();
    const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
    const bool soft = task.light->constants.sourceRadius > 0.0f;
    const float nearest = nearestCaster(task);
    auto* constants = arena.make(gpu::AreaConstants{});
    constants->base = centreConstants(task, resolution);
    constants->share = 1.0f; // nearest texels: a bit is yes or no
    for (std::uint32_t i = 0; i < kWordPoints; ++i) {
        const std::uint32_t place = word * kWordPoints + i;
        const LatticePoint at = pointIn(place);
        if (at.x == kLattice) break;
        ShadowTask point = task;
        if (soft) point.light = arena.make(lightAt(*task.light, at.square(), place, nearest));
        constants->points[constants->count++] = declarePointMap(passes, casters_, point,
                                                                {.name = "area_adaptive.casters",
                                                                 .image = images.maps,
                                                                 .resolution = resolution,
                                                                 .layer = i,
                                                                 .variant = place,
                                                                 .after = after,
                                                                 .skipped = &tree->skipped[place]});
    }
    const LookupImages look(task, images.maps);
    PassRef pass = passes.raster("area_adaptive.bits", Scope::task, word);
    look.uses(pass);
    if (after) pass.reads(after);
    pass.writes(images.words, {.layer = word}).area(areaOf(task));
    pass.record([=, pipeline = bits_.of[look.hasNormals]](PassContext& gpu) {
        gpu::AreaConstants block = *constants;
        block.needed = tree->quads.needed(word);
        if (block.needed == 0) return;
        gpu.bind(pipeline, {gpu.constants(0, block), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                            gpu.sampled(4, look.map, SamplerKind::nearestBorderFar)});
        gpu.drawFullscreen();
    });
}

/// Looks for steps in what the level's squares show, and divides those that show one. @return what later passes wait
/// for
BufferId AreaAdaptive::declareDivision(PassBuilder& passes, const ShadowTask& task, const Images& images,
                                       std::uint32_t level, Tree* tree) const
{
    const auto window = static_cast<std::uint32_t>(task.settings[kWindow]);
    const VkRect2D area = task.view->area;
    passes.compute("area_adaptive.test", Scope::task, level)
        .samples(images.words)
        .updates(images.flags)
        .record([=, pipeline = test_](PassContext& gpu) {
            const gpu::QuadTests tests = testsOf(tree->quads, area, window);
            if (tests.count == 0) return;
            gpu.bind(pipeline, {gpu.constants(0, tests), gpu.sampled(1, images.words), gpu.storage(2, images.flags)});
            const std::uint32_t stride = window * gpu::QUAD_GROUP;
            gpu.vk->vkCmdDispatch(gpu.cmd, (area.extent.width + stride - 1) / stride,
                                  (area.extent.height + stride - 1) / stride, 1);
        });
    const BufferId divided = passes.transient(
        BufferInfo{.name = "area_adaptive.divided", .size = 4, .place = BufferPlace::upload, .variant = level});
    passes.host("area_adaptive.divide", Scope::task, level)
        .reads(images.flags)
        .writes(divided)
        .run([=](HostContext& host) {
            tree->quads.divide(
                host.read<std::uint32_t>(images.flags).subspan(firstFlag(level), std::size_t{1} << (2 * level)));
            if (level + 1 == kQuadLevels) tree->quads.end();
            tree->note();
            host.write<std::uint32_t>(divided)[0] = tree->quads.points();
        });
    return divided;
}

void AreaAdaptive::declareResolve(PassBuilder& passes, const ShadowTask& task, const Images& images, BufferId after,
                                  const Tree* tree) const
{
    PassRef pass = passes.raster("area_adaptive.resolve");
    pass.writes(task.visibility, {.layer = task.layer}).samples(images.words).area(areaOf(task));
    if (after) pass.reads(after);
    pass.record([=, reasons = task.settings[kReasons] != 0.0, pipeline = resolve_](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, weightsOf(tree->quads, reasons)), gpu.sampled(1, images.words)});
        gpu.drawFullscreen();
    });
}

void AreaAdaptive::declare(PassBuilder& passes, const ShadowTask& task)
{
    const Images images = makeImages(passes, task);
    // Without a surface all corners are the same point.
    const std::uint32_t levels = task.light->constants.sourceRadius > 0.0f ? kQuadLevels : 0;
    const std::uint32_t least = std::min(static_cast<std::uint32_t>(task.settings[kLeast]), levels);
    Tree* tree = passes.arena().make(Tree{});
    constexpr std::array<std::uint32_t, kMostQuads> kAll = [] {
        std::array<std::uint32_t, kMostQuads> all{};
        all.fill(1);
        return all;
    }();
    for (std::uint32_t level = 0; level < least; ++level)
        tree->quads.divide(kAll);
    if (least == levels) tree->quads.end();
    tree->note();
    passes.transfer("area_adaptive.clear").writes(images.flags).record([flags = images.flags](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(flags), 0, VK_WHOLE_SIZE, 0);
    });
    BufferId after;
    for (std::uint32_t level = 0; level <= levels; ++level) {
        for (std::uint32_t word = kFirstWord[level]; word < kFirstWord[level + 1]; ++word)
            declareWord(passes, task, images, word, after, tree);
        if (level >= least && level < levels) after = declareDivision(passes, task, images, level, tree);
    }
    declareResolve(passes, task, images, after, tree);
}

VkDeviceSize memoryPerLight(std::span<const double> settings, VkExtent2D extent, GnLightType)
{
    const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
    return VkDeviceSize{4} * resolution * resolution * kWordPoints + kPointWords * storedImageSize(extent, 4);
}

} // namespace

constinit const AlgorithmEntry kAreaAdaptive{
    .name = "area_adaptive",
    .source = "Schwarzler et al. 2012; Macedo 2018, 6.1",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT |
              GN_TRAIT_RECTANGLE_BIT,
    .roundTrips = kQuadLevels,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight = memoryPerLight,
    .missing = nullptr,
    .create = makeAlgorithm<AreaAdaptive>,
    .typicalWrongPercent = 1.0f, // of lights without a surface: shadow_map's at half its side
};

} // namespace gnomon
