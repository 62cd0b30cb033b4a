// A few rays a pixel and frame to the surface of a light, and a filter over pixels and frames.
// Source:    R. L. Cook, T. Porter, L. Carpenter, "Distributed ray tracing", SIGGRAPH 1984; the filter after
//            C. Schied et al., "Spatiotemporal variance-guided filtering", HPG 2017, and D. Zhdan, "Fast denoising with
//            self-stabilizing recurrent blurs", GDC 2020.
// Reads:     receiver depth, normals and motion vectors, acceleration structures of the casters.  Writes: visibility.
// Strong at: penumbrae of lights of any kind, right in contact and far away; converges while nothing moves.
// Weak at:   devices with ray queries only; noise that grows with the penumbra for a few frames after a change.
#include "algorithms/entries.hpp"

#include <algorithm>

#include "algorithms/hybrid/device_trace.hpp"
#include "algorithms/hybrid/light_disc.hpp"
#include "runtime/base/hash.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/hybrid/ray_soft.h"
#include "shaders/hybrid_ray_query_frag.h"
#include "shaders/hybrid_ray_soft_accumulate_frag.h"
#include "shaders/hybrid_ray_soft_blur_frag.h"
#include "shaders/hybrid_ray_soft_tiles_frag.h"
#include "shaders/hybrid_ray_soft_trace_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

enum Setting { kRays, kFrames, kWeighted };

constexpr SettingSpec kSettings[] = {
    {"rays", "Rays a pixel and frame to points of a light with a radius; in its first frame twice as many, 4 at most.",
     1, gpu::SOFT_RAYS, 1},
    {"frames", "Frames whose rays are averaged at most while nothing moves; 1: each is filtered by itself.", 1, 1024,
     256},
    {"weighted",
     "1: points of the light count as much as they light a diffuse surface, for hosts that multiply their own shading "
     "of "
     "the whole light by visibility; 0: by area.",
     0, 1, 0},
};

// Histories are averages of hundreds of frames, and hold depth values: 16-bit floats would do for neither.
constexpr VkFormat kHistoryFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr VkFormat kSeenFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
constexpr VkFormat kFilteredFormat = kSeenFormat;
constexpr VkFormat kMotionFormat = VK_FORMAT_R16G16_SFLOAT; // or others of floats

// Where nothing was asked, as shaders have it: lit.
constexpr VkClearValue kNotAsked{.color = {.float32 = {1.0f, -1.0f, 0.0f, 0.0f}}};

VkExtent2D tilesOf(VkExtent2D extent)
{
    constexpr std::uint32_t side = gpu::SOFT_TILE;
    return {(extent.width + side - 1) / side, (extent.height + side - 1) / side};
}

/// What is kept of a light in a view.
struct History {
    ImageId past, present; ///< One is read, the other written.
    BufferId cameras;      ///< gpu::ViewConstants of both.
    std::uint32_t pastView = 0;
    std::uint32_t number = 0; ///< Frames since it began.
    bool hasPast = false, moved = false;
    bool byMotion = false; ///< The host's motion vectors lead to where it was.
    /// What the past says is checked against this frame's rays.
    bool held() const { return hasPast && (moved || byMotion); }
};

/// Two images take turns, as do the cameras beside them: a frame that is dropped leaves the past as it was.
History openHistory(PassBuilder& passes, const ShadowTask& task)
{
    const CameraView& view = *task.view;
    ImageId images[2];
    for (std::uint32_t i = 0; i < 2; ++i)
        images[i] = passes.persistent(
            ImageInfo{.name = "ray_soft.history", .format = kHistoryFormat, .extent = view.extent, .variant = i});
    History history;
    history.cameras = passes.persistent(BufferInfo{.name = "ray_soft.cameras", .size = 2 * sizeof(gpu::ViewConstants)});
    // What the picture of a camera that stands still depends on.
    const std::uint64_t scene =
        mixed(mixed(mixed(kEmptyHash, task.light->revision), task.casters->staticStamp), task.casters->dynamicStamp);
    const bool changed = passes.stale(history.cameras, scene | 1);
    // And what places of the past must have in common with the present's, beside the world.
    const std::int64_t place[] = {static_cast<std::int64_t>(view.origin[0]),
                                  static_cast<std::int64_t>(view.origin[1]),
                                  static_cast<std::int64_t>(view.origin[2]),
                                  view.area.offset.x,
                                  view.area.offset.y,
                                  view.area.extent.width,
                                  view.area.extent.height};
    std::uint64_t base = mixed(mixed(kEmptyHash, passes.serial(images[0])), passes.serial(images[1]));
    for (const std::int64_t value : place)
        base = mixed(base, static_cast<std::uint64_t>(value));
    base = mixed(base, std::uint64_t{task.settings[kWeighted] != 0.0});
    base |= 1; // 0 is: nothing is known
    const KeptParts before = passes.partsBefore(history.cameras);
    history.hasPast = before.base == base && !view.cut;
    history.moved = changed;
    history.number = history.hasPast ? static_cast<std::uint32_t>(before.covered) + 1 : 0;
    const std::uint64_t before32 = (passes.frame() - 1) & UINT32_MAX; // the frame that motion vectors lead to
    history.byMotion = history.hasPast && task.motion && before.covered >> 32 == before32;
    passes.keepParts(history.cameras, {.base = base, .covered = passes.frame() << 32 | history.number});
    history.pastView = (history.number + 1) % 2;
    history.past = images[history.pastView];
    history.present = images[history.number % 2];
    return history;
}

class RaySoft final : public ShadowAlgorithm {
public:
    explicit RaySoft(const AlgorithmServices& services);
    void declare(PassBuilder& passes, const ShadowTask& task) override;

    const char* refuses(const ShadowTask& task) const override
    {
        const char* const why = refusesDeviceRays(task);
        return why ? why : refusesDisc(*task.light);
    }

private:
    void declareSoft(PassBuilder& passes, const ShadowTask& task) const;
    struct Found {
        ImageId seen, blurred; ///< By the rays of this frame.
    };
    ImageId declareTiles(PassBuilder& passes, const ShadowTask& task, ImageId seen,
                         const gpu::RaySoftConstants* constants) const;
    void declareAccumulation(PassBuilder& passes, const ShadowTask& task, const History& history, const Found& found,
                             const gpu::RaySoftConstants* constants) const;

    struct Blur {
        const char* name;
        ImageId from, tiles, to;
        Part part;
        bool last;
    };
    void declareBlur(PassBuilder& passes, const ShadowTask& task, const Blur& blur,
                     const gpu::RaySoftConstants* constants) const;

    DeviceTrace hard_, trace_;
    PipelineId tiles_, accumulate_[2], blur_[2][2]; ///< [has normals][is last]
};

RaySoft::RaySoft(const AlgorithmServices& services)
    : hard_(services, "ray_soft.hard", k_hybrid_ray_query_frag, VK_FORMAT_R8_UNORM),
      trace_(services, "ray_soft.trace", k_hybrid_ray_soft_trace_frag, kSeenFormat)
{
    const BindingInfo bindings[] = {constantsAt(0),
                                    sampledAt(2, VK_FORMAT_D32_SFLOAT),
                                    sampledAt(3, VK_FORMAT_R16G16B16A16_SFLOAT),
                                    sampledAt(4, kSeenFormat),
                                    sampledAt(5, kHistoryFormat),
                                    bufferAt(6),
                                    sampledAt(7, kFilteredFormat),
                                    sampledAt(8, kMotionFormat)};
    tiles_ = services.pipelines->graphics({.name = "ray_soft.tiles",
                                           .vertex = {.code = k_shared_fullscreen_vert},
                                           .fragment = {.code = k_hybrid_ray_soft_tiles_frag},
                                           .bindings = std::array{constantsAt(0), sampledAt(2, kSeenFormat)},
                                           .colorFormat = kFilteredFormat});
    for (const bool normals : {false, true}) {
        accumulate_[normals] =
            services.pipelines->graphics({.name = "ray_soft.accumulate",
                                          .vertex = {.code = k_shared_fullscreen_vert},
                                          .fragment = {k_hybrid_ray_soft_accumulate_frag, 1, {normals}},
                                          .bindings = bindings,
                                          .colorFormat = kHistoryFormat});
        for (const bool last : {false, true})
            blur_[normals][last] =
                services.pipelines->graphics({.name = "ray_soft.blur",
                                              .vertex = {.code = k_shared_fullscreen_vert},
                                              .fragment = {k_hybrid_ray_soft_blur_frag, 2, {normals, last}},
                                              .bindings = std::span(bindings).first(5),
                                              .colorFormat = last ? VK_FORMAT_R8_UNORM : kFilteredFormat});
    }
}

void RaySoft::declare(PassBuilder& passes, const ShadowTask& task)
{
    if (task.light->constants.sourceRadius > 0.0f) return declareSoft(passes, task);
    hard_.declare(passes, task, rayConstants(task), task.visibility,
                  visibilityIn(*task.view, task.layer, lightPixels(*task.light, *task.view)));
}

void RaySoft::declareSoft(PassBuilder& passes, const ShadowTask& task) const
{
    const VkExtent2D extent = task.view->extent;
    const auto rays = static_cast<std::uint32_t>(task.settings[kRays]);
    // Where a penumbra is about two pixels wide there are too few pixels for a filter to make up for one ray of each.
    const std::uint32_t firstRays = std::min(2 * rays, gpu::SOFT_RAYS);
    const History history = openHistory(passes, task);
    const bool isFirst = history.number == 0;
    const std::uint32_t bits = (history.hasPast ? gpu::SOFT_HAS_PAST : 0u) | (history.moved ? gpu::SOFT_MOVED : 0u) |
                               (history.byMotion ? gpu::SOFT_MOTION : 0u) |
                               (task.settings[kWeighted] != 0.0 ? gpu::SOFT_WEIGHTED : 0u);
    const gpu::RaySoftConstants constants{
        .base = rayConstants(task),
        .state = {bits, rays, isFirst ? 0 : firstRays + (history.number - 1) * rays, history.pastView},
        .disc = {discRadius(*task.light), static_cast<float>(task.settings[kFrames]),
                 static_cast<float>(isFirst ? firstRays : rays), 0.0f},
        .sourceX = glm::vec4(task.light->sourceX, task.light->rectangular() ? 0.0f : 1.0f),
        .sourceY = glm::vec4(task.light->sourceY, 0.0f),
        .motion = glm::vec4(task.view->motionScale, 0.0f)};
    const ImageId seen = passes.transient(ImageInfo{.name = "ray_soft.seen", .format = kSeenFormat, .extent = extent});
    const Part cleared{.clear = true, .value = kNotAsked};
    trace_.declare(passes, task, constants, seen, cleared);
    const auto* const block = passes.arena().make(constants);
    const ImageId tiles = declareTiles(passes, task, seen, block);
    const ImageId once =
        passes.transient(ImageInfo{.name = "ray_soft.blurred", .format = kFilteredFormat, .extent = extent});
    if (history.held()) declareBlur(passes, task, {"ray_soft.blur_now", seen, tiles, once, cleared, false}, block);
    declareAccumulation(passes, task, history, {seen, once}, block);
    declareBlur(passes, task, {"ray_soft.blur", history.present, tiles, once, cleared, false}, block);
    const Part layer = visibilityIn(*task.view, task.layer, lightPixels(*task.light, *task.view));
    declareBlur(passes, task, {"ray_soft.blur_again", once, tiles, task.visibility, layer, true}, block);
}

ImageId RaySoft::declareTiles(PassBuilder& passes, const ShadowTask& task, ImageId seen,
                              const gpu::RaySoftConstants* constants) const
{
    const VkExtent2D extent = tilesOf(task.view->extent);
    const ImageId tiles =
        passes.transient(ImageInfo{.name = "ray_soft.tiles", .format = kFilteredFormat, .extent = extent});
    passes.raster("ray_soft.tiles").samples(seen).writes(tiles).record([=, pipeline = tiles_](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(2, seen)});
        gpu.drawFullscreen();
    });
    return tiles;
}

void RaySoft::declareAccumulation(PassBuilder& passes, const ShadowTask& task, const History& history,
                                  const Found& found, const gpu::RaySoftConstants* constants) const
{
    const ImageId seen = found.seen;
    const bool hasNormals = static_cast<bool>(task.normals);
    const ImageId depth = task.depth, normals = hasNormals ? task.normals : task.depth;
    const bool held = history.held();
    const ImageId past = history.hasPast ? history.past : seen; // nobody looks at what there is not
    const ImageId now = held ? found.blurred : seen;
    const ImageId motion = history.byMotion ? task.motion : seen;
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    PassRef pass = passes.raster("ray_soft.accumulate");
    pass.samples(depth).samples(seen).reads(history.cameras);
    if (hasNormals) pass.samples(normals);
    if (history.hasPast) pass.samples(past);
    if (held) pass.samples(now);
    if (history.byMotion) pass.samples(motion);
    pass.writes(history.present, {.clear = true, .value = kNotAsked})
        .area(drawnArea(*task.view))
        .record([=, cameras = history.cameras, pipeline = accumulate_[hasNormals]](PassContext& gpu) {
            if (!gpu.clipTo(pixels)) return;
            gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(2, depth), gpu.sampled(3, normals),
                                gpu.sampled(4, seen), gpu.sampled(5, past), gpu.storage(6, cameras),
                                gpu.sampled(7, now), gpu.sampled(8, motion)});
            gpu.drawFullscreen();
        });
    passes.transfer("ray_soft.camera")
        .writes(history.cameras)
        .record([=, cameras = history.cameras, slot = history.number % 2](PassContext& gpu) {
            gpu.vk->vkCmdUpdateBuffer(gpu.cmd, gpu.buffer(cameras), slot * sizeof(gpu::ViewConstants),
                                      sizeof(gpu::ViewConstants), &constants->base.view);
        });
}

void RaySoft::declareBlur(PassBuilder& passes, const ShadowTask& task, const Blur& blur,
                          const gpu::RaySoftConstants* constants) const
{
    const bool hasNormals = static_cast<bool>(task.normals);
    const ImageId depth = task.depth, normals = hasNormals ? task.normals : task.depth;
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    PassRef pass = passes.raster(blur.name);
    pass.samples(depth).samples(blur.from).samples(blur.tiles);
    if (hasNormals) pass.samples(normals);
    pass.writes(blur.to, blur.part)
        .area(drawnArea(*task.view))
        .record([=, pipeline = blur_[hasNormals][blur.last]](PassContext& gpu) {
            if (!gpu.clipTo(pixels)) return;
            gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(2, depth), gpu.sampled(3, normals),
                                gpu.sampled(4, blur.from), gpu.sampled(5, blur.tiles)});
            gpu.drawFullscreen();
        });
}

VkDeviceSize softMemory(VkExtent2D extent)
{
    return 2 * storedImageSize(extent, 16) + 2 * storedImageSize(extent, 8) + storedImageSize(tilesOf(extent), 8) +
           pooledSize(2 * sizeof(gpu::ViewConstants));
}

} // namespace

constinit const AlgorithmEntry kRaySoft{
    .name = "ray_soft",
    .source = "Cook et al. 1984; Schied et al. 2017; Heitz et al. 2018; Zhdan 2020",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_FLAT_SOURCE_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_DEVICE_RAYS_BIT,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent, GnLightType) { return softMemory(extent); },
    .missing = [](const DeviceTable& vk) { return vk.rayQueryMissing; },
    .create = makeAlgorithm<RaySoft>,
    .typicalWrongPercent = 0.0f, // ray_query's: lights of shipped scenes have no radius
};

} // namespace gnomon
