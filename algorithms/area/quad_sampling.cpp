#include "algorithms/area/quad_sampling.hpp"

#include <algorithm>
#include <bit>

#include <glm/geometric.hpp>

#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/source_points.hpp"
#include "algorithms/shared/source_size.hpp"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kFlags = 1 + 4 + 16 + 64; ///< A word for each square that may be divided.

/// Squares of all levels before one.
constexpr std::uint32_t firstFlag(std::uint32_t level)
{
    return ((1u << (2 * level)) - 1) / 3;
}
static_assert(firstFlag(kQuadLevels) == kFlags && gpu::MAX_QUADS == kMostQuads && gpu::MAX_POINTS == kLatticePoints);
static_assert(gpu::MAX_AREA_MAPS == kWordPoints);

gpu::QuadTests testsOf(const SourceQuads& quads, const VkRect2D& area, std::uint32_t window, std::uint32_t ramps)
{
    gpu::QuadTests tests{};
    tests.area = {area.offset.x, area.offset.y, area.extent.width, area.extent.height};
    tests.window = window;
    tests.ramps = ramps;
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

std::uint32_t levelOf(std::uint32_t word)
{
    std::uint32_t level = 0;
    while (word >= kFirstWord[level + 1])
        ++level;
    return level;
}

/// The ways from a point to its neighbours in squares of a level.
void addGaps(gpu::AreaConstants& constants, const LightView& light, std::uint32_t level)
{
    const float part = 2.0f / static_cast<float>(1u << level);
    const glm::vec3 x = glm::normalize(glm::cross(light.direction(), axisAcross(light.direction())));
    const bool flat = light.flat();
    constants.gapX = glm::vec4(part * (flat ? light.sourceX : discRadius(light) * x), 0.0f);
    constants.gapY =
        glm::vec4(part * (flat ? light.sourceY : discRadius(light) * glm::cross(light.direction(), x)), 0.0f);
}

} // namespace

/// What is decided in a frame, round by round; in its memory.
struct QuadSampling::Tree {
    SourceQuads quads;
    std::array<bool, kPointWords * kWordPoints> skipped{};

    void note()
    {
        for (std::uint32_t place = 0; place < skipped.size(); ++place)
            skipped[place] = (quads.needed(place / kWordPoints) >> place % kWordPoints & 1) == 0;
    }
};

struct QuadSampling::Images {
    ImageId maps, words;
    BufferId flags;
};

QuadSampling::QuadSampling(const AlgorithmServices& services, const QuadMethod& method)
    : method_(method), casters_(makeDepthMapPipelines(services)),
      look_(makePointLookups(services, method.look, method.lookCode, method.format))
{
    const BindingInfo bindings[] = {
        constantsAt(0),
        {.binding = 1, .kind = BindingKind::sampledImage, .format = method.format, .array = true},
        bufferAt(2)};
    test_ =
        services.pipelines->compute({.name = method.test, .compute = {.code = method.testCode}, .bindings = bindings});
    resolve_ = services.pipelines->graphics({.name = method.resolve,
                                             .vertex = {.code = k_shared_fullscreen_vert},
                                             .fragment = {.code = method.resolveCode},
                                             .bindings = std::span(bindings).first(2),
                                             .colorFormat = VK_FORMAT_R8_UNORM});
}

QuadSampling::Images QuadSampling::makeImages(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule) const
{
    return {.maps = passes.transient(ImageInfo{.name = "area_quads.maps",
                                               .format = kMapFormat,
                                               .extent = {rule.resolution, rule.resolution},
                                               .layers = kWordPoints}),
            .words = passes.transient(ImageInfo{.name = method_.words,
                                                .format = method_.format,
                                                .extent = passes.extent(task.depth),
                                                .layers = kPointWords}),
            .flags = passes.transient(
                BufferInfo{.name = "area_quads.flags", .size = 4 * kFlags, .place = BufferPlace::readback})};
}

/// The maps of a word's points, those that are needed, and the pass that looks them up.
void QuadSampling::declareWord(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule, const Images& images,
                               std::uint32_t word, BufferId after, const Tree* tree) const
{
    FrameArena& arena = passes.arena();
    const bool soft = task.light->constants.sourceRadius > 0.0f;
    const float nearest = nearestCaster(task);
    auto* constants = arena.make(gpu::AreaConstants{});
    constants->base = centreConstants(task, rule.resolution);
    constants->base.map.filterSide = static_cast<float>(rule.filter);
    constants->share = 1.0f; // a bit is yes or no
    if (soft) addGaps(*constants, *task.light, std::max(rule.least, levelOf(word)));
    for (std::uint32_t i = 0; i < kWordPoints; ++i) {
        const std::uint32_t place = word * kWordPoints + i;
        const LatticePoint at = pointIn(place);
        if (at.x == kLattice) break;
        ShadowTask point = task;
        if (soft)
            point.light =
                arena.make(lightAt(*task.light, pointAt(*task.light, rule.inset * at.square(), place), nearest));
        constants->points[constants->count++] = declarePointMap(passes, casters_, point,
                                                                {.name = "area_quads.casters",
                                                                 .image = images.maps,
                                                                 .resolution = rule.resolution,
                                                                 .layer = i,
                                                                 .variant = place,
                                                                 .seen = soft,
                                                                 .after = after,
                                                                 .skipped = &tree->skipped[place]});
    }
    const LookupImages look(task, images.maps);
    PassRef pass = passes.raster(method_.look, Scope::task, word);
    look.uses(pass);
    if (after) pass.reads(after);
    pass.writes(images.words, {.layer = word}).area(drawnArea(*task.view));
    pass.record([=, pipeline = look_.of[look.hasNormals]](PassContext& gpu) {
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
BufferId QuadSampling::declareDivision(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule,
                                       const Images& images, std::uint32_t level, Tree* tree) const
{
    const std::uint32_t window = rule.window[level], ramps = rule.ramps;
    const VkRect2D area = task.view->area;
    passes.compute(method_.test, Scope::task, level)
        .samples(images.words)
        .updates(images.flags)
        .record([=, pipeline = test_](PassContext& gpu) {
            const gpu::QuadTests tests = testsOf(tree->quads, area, window, ramps);
            if (tests.count == 0) return;
            gpu.bind(pipeline, {gpu.constants(0, tests), gpu.sampled(1, images.words), gpu.storage(2, images.flags)});
            const std::uint32_t stride = window * gpu::QUAD_GROUP;
            gpu.vk->vkCmdDispatch(gpu.cmd, (area.extent.width + stride - 1) / stride,
                                  (area.extent.height + stride - 1) / stride, 1);
        });
    const BufferId divided = passes.transient(
        BufferInfo{.name = "area_quads.divided", .size = 4, .place = BufferPlace::upload, .variant = level});
    passes.host("area_quads.divide", Scope::task, level)
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

void QuadSampling::declareResolve(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule,
                                  const Images& images, BufferId after, const Tree* tree) const
{
    PassRef pass = passes.raster(method_.resolve);
    pass.writes(task.visibility, {.layer = task.layer}).samples(images.words).area(drawnArea(*task.view));
    if (after) pass.reads(after);
    pass.record([=, reasons = rule.reasons, pipeline = resolve_](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, weightsOf(tree->quads, reasons)), gpu.sampled(1, images.words)});
        gpu.drawFullscreen();
    });
}

void QuadSampling::declare(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule) const
{
    const Images images = makeImages(passes, task, rule);
    // Without a surface all corners are the same point.
    const std::uint32_t levels = task.light->constants.sourceRadius > 0.0f ? kQuadLevels : 0;
    const std::uint32_t least = std::min(rule.least, levels);
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
    passes.transfer("area_quads.clear").writes(images.flags).record([flags = images.flags](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(flags), 0, VK_WHOLE_SIZE, 0);
    });
    BufferId after;
    for (std::uint32_t level = 0; level <= levels; ++level) {
        for (std::uint32_t word = kFirstWord[level]; word < kFirstWord[level + 1]; ++word)
            declareWord(passes, task, rule, images, word, after, tree);
        if (level >= least && level < levels) after = declareDivision(passes, task, rule, images, level, tree);
    }
    declareResolve(passes, task, rule, images, after, tree);
}

VkDeviceSize quadMemory(std::uint32_t resolution, VkExtent2D extent, std::uint32_t wordSize)
{
    return VkDeviceSize{4} * resolution * resolution * kWordPoints + kPointWords * storedImageSize(extent, wordSize);
}

} // namespace gnomon
