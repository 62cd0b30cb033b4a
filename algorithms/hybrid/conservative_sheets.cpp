#include "algorithms/hybrid/conservative_sheets.hpp"

#include <algorithm>

#include "algorithms/hybrid/sheet_edges.hpp"
#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/face_light.hpp"
#include "shaders/hybrid_conservative_sheets_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

// --- names ---

constexpr LayerNames kLayers{"sheets.casters", "sheets.statics", "sheets.copy_statics"};
constexpr LayerNames kThesisLayers{"sheets.thesis_casters", "sheets.thesis_statics", "sheets.thesis_copy_statics"};
// The passes that find the sheets of a layer's static and of its moving casters.
constexpr const char* kSlopes[2] = {"sheets.slope", "sheets.moving_slope"};
constexpr const char* kCentres[2] = {"sheets.centre", "sheets.moving_centre"};

// --- lists that the CPU makes ---

/// Sheets are known of casters with a topology in which every face stops light.
bool hasSheets(const Caster& caster)
{
    return castsVolume(caster) && !caster.alphaTested;
}

std::span<const Turned> turnedFaces(const LightView& light, const Caster& caster, FrameArena& arena)
{
    const Topology& topology = *caster.mesh->topology;
    const std::span<Turned> turned = arena.array<Turned>(caster.mesh->triangleCount());
    findTurned(topology, caster.mesh->positions, lightInObjectSpace(light, caster).at, caster.mirrored, turned);
    return turned;
}

/// A list of the light and the caster, made again when either moves.
template <typename Write>
BufferId declareList(PassBuilder& passes, const LightView& light, const Caster& caster, const char* name,
                     std::uint64_t words, const Write& write)
{
    const BufferId list = passes.persistent(BufferInfo{.name = name,
                                                       .scope = Scope::light,
                                                       .size = words * sizeof(std::uint32_t),
                                                       .place = BufferPlace::upload,
                                                       .variant = caster.id});
    if (!passes.stale(list, Stamp().add(light.revision).add(caster).value())) {
        passes.kept();
        return list;
    }
    passes.prepare(name, Scope::light, caster.id).writes(list).run([=, from = &light, by = &caster](HostContext& host) {
        write(*by, turnedFaces(*from, *by, *host.arena), host.write<std::uint32_t>(list).first(words), *host.arena);
        host.countIndexList();
    });
    return list;
}

BufferId declareBorders(PassBuilder& passes, const LightView& light, const Caster& caster)
{
    const auto write = [](const Caster& of, std::span<const Turned> turned, std::span<std::uint32_t> out, FrameArena&) {
        writeSheetEdges(*of.mesh->topology, turned, of.closed, out);
    };
    return declareList(passes, light, caster, "sheets.borders", sheetListWords(caster.mesh->topology->edges.size()),
                       write);
}

BufferId declareKeptEdges(PassBuilder& passes, const LightView& light, const Caster& caster)
{
    const auto write = [](const Caster& of, std::span<const Turned> turned, std::span<std::uint32_t> out,
                          FrameArena& arena) {
        // Bits are set one by one, and upload memory may be write-combined.
        const std::span<std::uint32_t> words = arena.array<std::uint32_t>(out.size());
        setKeptEdges(*of.mesh->topology, turned, words);
        std::ranges::copy(words, out.begin());
    };
    return declareList(passes, light, caster, "sheets.kept_edges", keptEdgeWords(caster.mesh->triangleCount()), write);
}

// --- sheets ---

/// The sheets of one group of casters, as two images of this frame; null ids: none.
struct Sheets {
    ImageId slopes, centres;
    gpu::SheetErrors errors{};
};

gpu::SheetErrors errorsOf(const ConservativeProjection& projection, std::span<const Caster* const> casters)
{
    gpu::SheetErrors errors{};
    errors.side = projection.side;
    errors.depthConstant = projection.depthConstant;
    errors.inverseScale = projection.perspective ? 1.0f / projection.depthScale : 0.0f;
    for (const Caster* caster : casters) {
        const gpu::ConservativePush push = conservativePush(projection, *caster, true);
        errors.texelError = std::max(errors.texelError, push.texelError);
        // Of the centre's corners and of the truth's.
        errors.depthError = std::max(errors.depthError, 2.0f * push.depthError);
        errors.depthErrorSquare = std::max(errors.depthErrorSquare, 2.0f * push.depthErrorSquare);
    }
    return errors;
}

/// Draws a layer of the under-estimated map; what KeptMap::update takes.
class SheetCasters {
public:
    SheetCasters(const ConservativeCasters& covered, const ConservativeSheets::Pipelines& pipelines,
                 const ShadowTask& task, const ConservativeMapView& view, std::uint32_t layer)
        : covered_(covered), pipelines_(pipelines), light_(task.light), projection_(&view.projections[layer]),
          resolution_(view.resolution), layer_(layer)
    {
    }

    SheetCasters prepared(PassBuilder& passes, std::span<const Caster* const> statics,
                          std::span<const Caster* const> dynamics) const
    {
        SheetCasters ready = *this;
        ready.sheets_[0] = declareSheets(passes, statics, 0);
        ready.sheets_[1] = declareSheets(passes, dynamics, 1);
        return ready;
    }

    void uses(PassRef& pass) const
    {
        for (const Sheets& sheets : sheets_)
            if (sheets.slopes) pass.samples(sheets.slopes).samples(sheets.centres);
    }

    void operator()(PassContext& gpu, std::span<const Caster* const> casters, bool statics) const
    {
        covered_(gpu, casters, statics);
        const Sheets& sheets = sheets_[statics ? 0 : 1];
        if (!sheets.slopes) return;
        gpu.bind(pipelines_.sheets, {gpu.sampled(1, sheets.slopes), gpu.sampled(2, sheets.centres)});
        gpu.push(sheets.errors);
        gpu.drawFullscreen();
    }

private:
    ImageId image(PassBuilder& passes, const char* name, std::uint32_t group) const
    {
        return passes.transient(ImageInfo{.name = name,
                                          .scope = Scope::light,
                                          .format = kMapFormat,
                                          .extent = {resolution_, resolution_},
                                          .variant = 2 * resolution_ + group});
    }
    Sheets declareSheets(PassBuilder& passes, std::span<const Caster* const> casters, std::uint32_t group) const;

    ConservativeCasters covered_;
    ConservativeSheets::Pipelines pipelines_;
    const LightView* light_;
    const ConservativeProjection* projection_;
    std::uint32_t resolution_, layer_;
    Sheets sheets_[2];
};

Sheets SheetCasters::declareSheets(PassBuilder& passes, std::span<const Caster* const> casters,
                                   std::uint32_t group) const
{
    const std::span<const Caster*> found = passes.arena().array<const Caster*>(casters.size());
    const auto end = std::copy_if(casters.begin(), casters.end(), found.begin(), [](auto* c) { return hasSheets(*c); });
    const std::span<const Caster* const> with(found.begin(), end);
    if (with.empty()) return {};
    const std::span<BufferId> borders = passes.arena().array<BufferId>(with.size());
    for (std::size_t i = 0; i < with.size(); ++i)
        borders[i] = declareBorders(passes, *light_, *with[i]);

    const Part cleared{.clear = true, .value = {.depthStencil = {1.0f, 0}}};
    const Sheets sheets{.slopes = image(passes, "sheets.slopes", group),
                        .centres = image(passes, "sheets.centres", group),
                        .errors = errorsOf(*projection_, with)};
    const std::uint32_t variant = 8 * resolution_ + layer_;
    PassRef slope = passes.raster(kSlopes[group], Scope::light, variant);
    for (const BufferId list : borders)
        slope.reads(list).indirect(list);
    const ConservativeCasters faces(pipelines_.slope, ConservativeLayer::slope, projection_);
    slope.depthWrite(sheets.slopes, cleared).record([=](PassContext& gpu) {
        faces(gpu, with, false);
        for (std::size_t i = 0; i < with.size(); ++i)
            faces.drawEdges(gpu, *with[i], borders[i]);
    });
    const ConservativeCasters centres(pipelines_.centre, ConservativeLayer::centre, projection_);
    passes.raster(kCentres[group], Scope::light, variant)
        .depthWrite(sheets.centres, cleared)
        .record([=](PassContext& gpu) { centres(gpu, with, false); });
    return sheets;
}

// --- kept edges ---

/// Draws a layer of the thesis's map.
class KeptCasters {
public:
    KeptCasters(const ConservativeCasters& covered, const LightView& light) : covered_(covered), light_(&light) {}

    KeptCasters prepared(PassBuilder& passes, std::span<const Caster* const> statics,
                         std::span<const Caster* const> dynamics) const
    {
        const std::span<KeptEdges> kept = passes.arena().array<KeptEdges>(statics.size() + dynamics.size());
        std::size_t count = 0;
        for (const auto casters : {statics, dynamics})
            for (const Caster* caster : casters)
                if (hasSheets(*caster)) kept[count++] = {caster, declareKeptEdges(passes, *light_, *caster)};
        KeptCasters ready = *this;
        ready.covered_.keep(kept.first(count));
        return ready;
    }
    void uses(PassRef& pass) const { covered_.uses(pass); }
    void operator()(PassContext& gpu, std::span<const Caster* const> casters, bool statics) const
    {
        covered_(gpu, casters, statics);
    }

private:
    ConservativeCasters covered_;
    const LightView* light_;
};

// --- the layer ---

/// Of casters whose topology is there: sheets come with it, and what was kept without has to go.
std::uint64_t sheetSalt(const ShadowTask& task)
{
    const auto count = std::ranges::count_if(task.casters->all, [](auto* caster) { return hasSheets(*caster); });
    return static_cast<std::uint64_t>(count) + 1;
}

/// @param drawing of a layer's number
template <typename Drawing>
ImageId declareLayers(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                      const KeptMapInfo& info, const LayerNames& names, const Drawing& drawing)
{
    KeptMap map(passes, info);
    const std::uint64_t salt = sheetSalt(task);
    for (std::uint32_t layer = 0; layer < info.layers; ++layer) {
        if ((view.needed & (1u << layer)) == 0) continue;
        const LayerContent content = conservativeContent(task, view, layer, salt, passes.arena());
        map.update(layer, names, content, drawing(layer));
    }
    return map.image();
}

} // namespace

ConservativeSheets::ConservativeSheets(const AlgorithmServices& services)
{
    pipelines_.slope = makeConservativePipeline(services, "sheets.slope", ConservativeLayer::slope);
    pipelines_.centre = makeConservativePipeline(services, "sheets.centre", ConservativeLayer::centre);
    pipelines_.sheets =
        services.pipelines->graphics({.name = "sheets.covered",
                                      .vertex = {.code = k_shared_fullscreen_vert},
                                      .fragment = {.code = k_hybrid_conservative_sheets_frag},
                                      .bindings = std::array{mapAt(1, kMapFormat), mapAt(2, kMapFormat)},
                                      .pushBytes = sizeof(gpu::SheetErrors),
                                      .depthTest = true,
                                      .depthWrite = true,
                                      .depthCompare = VK_COMPARE_OP_LESS,
                                      .depthFormat = kMapFormat});
}

ImageId ConservativeSheets::declareCovered(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                                           const ConservativeMaps& maps) const
{
    const KeptMapInfo info{.name = "sheets.map",
                           .staticsName = "sheets.map_statics",
                           .stampName = "sheets.stamp",
                           .format = kMapFormat,
                           .resolution = view.resolution,
                           .layers = static_cast<std::uint32_t>(view.fits.size()),
                           .form = formOf(view)};
    return declareLayers(passes, task, view, info, kLayers, [&](std::uint32_t layer) {
        const ConservativeCasters covered(maps.coveredPipeline(false), ConservativeLayer::covered,
                                          &view.projections[layer]);
        return SheetCasters(covered, pipelines_, task, view, layer);
    });
}

ImageId ConservativeSheets::declareThesis(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                                          const ConservativeMaps& maps) const
{
    const KeptMapInfo info{.name = "sheets.thesis_map",
                           .staticsName = "sheets.thesis_map_statics",
                           .stampName = "sheets.thesis_stamp",
                           .format = kMapFormat,
                           .resolution = view.resolution,
                           .layers = static_cast<std::uint32_t>(view.fits.size()),
                           .form = formOf(view)};
    return declareLayers(passes, task, view, info, kThesisLayers, [&](std::uint32_t layer) {
        const ConservativeCasters covered(maps.coveredPipeline(true), ConservativeLayer::thesisCovered,
                                          &view.projections[layer]);
        return KeptCasters(covered, *task.light);
    });
}

VkDeviceSize ConservativeSheets::memory(std::uint32_t resolution)
{
    return VkDeviceSize{resolution} * resolution * 4 * 4; // slopes and centres of static and of moving casters
}

} // namespace gnomon
