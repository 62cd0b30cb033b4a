#include "runtime/frame/host_images.hpp"

#include "runtime/frame/frame.hpp"
#include "runtime/passes/pass_context.hpp"
#include "shaders/runtime_host_depth_array_frag.h"
#include "shaders/runtime_host_depth_frag.h"
#include "shaders/runtime_host_depth_samples_array_frag.h"
#include "shaders/runtime_host_depth_samples_frag.h"
#include "shaders/runtime_host_normals_array_frag.h"
#include "shaders/runtime_host_normals_frag.h"
#include "shaders/runtime_host_normals_samples_array_frag.h"
#include "shaders/runtime_host_normals_samples_frag.h"
#include "shaders/runtime_view_pack_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

constexpr VkFormat kDepthCopy = VK_FORMAT_D32_SFLOAT, kNormalCopy = VK_FORMAT_R16G16B16A16_SFLOAT;

constexpr BindingInfo kFlat[] = {{.binding = 0, .kind = BindingKind::sampledImage, .format = kDepthCopy}};
constexpr BindingInfo kLayered[] = {
    {.binding = 0, .kind = BindingKind::sampledImage, .format = kDepthCopy, .array = true}};

/// Block of host_image.glsl.
struct CopyPush {
    glm::vec4 straight;
    float skyDepth;
    std::int32_t layer, sample;
    std::uint32_t way;
};

std::uint32_t kindOf(const ImageSource& source)
{
    return (source.layered ? 1u : 0u) | (source.samples > 1 ? 2u : 0u);
}

/// Which of the pipelines packs.
constexpr std::uint32_t kPack = 8;

/// Each pipeline has an owner of its own in the store.
constexpr std::uint32_t ownerOf(std::uint32_t pipeline)
{
    return kRuntimeOwner + 1 + pipeline;
}

} // namespace

bool copiesDepth(const CameraView& view)
{
    const bool float32 = view.depthFormat == VK_FORMAT_D32_SFLOAT || view.depthFormat == VK_FORMAT_D32_SFLOAT_S8_UINT;
    return !float32 || view.oblique || kindOf(view.source) != 0;
}

bool copiesNormals(const CameraView& view)
{
    const bool floats =
        view.normalFormat == VK_FORMAT_R16G16B16A16_SFLOAT || view.normalFormat == VK_FORMAT_R32G32B32A32_SFLOAT;
    return !floats || view.source.encoding != GN_NORMAL_SIGNED || kindOf(view.source) != 0;
}

void HostImages::describe(PipelineStore& store)
{
    store_ = &store;
    const std::span<const std::uint32_t> depth[] = {k_runtime_host_depth_frag, k_runtime_host_depth_array_frag,
                                                    k_runtime_host_depth_samples_frag,
                                                    k_runtime_host_depth_samples_array_frag};
    const std::span<const std::uint32_t> normals[] = {k_runtime_host_normals_frag, k_runtime_host_normals_array_frag,
                                                      k_runtime_host_normals_samples_frag,
                                                      k_runtime_host_normals_samples_array_frag};
    for (std::uint32_t i = 0; i < kPack; ++i) {
        const bool ofDepth = i < kKinds;
        GraphicsPipelineInfo info{.name = ofDepth ? "view.depth" : "view.normals",
                                  .vertex = {.code = k_shared_fullscreen_vert},
                                  .fragment = {.code = ofDepth ? depth[i] : normals[i - kKinds]},
                                  .bindings = i & 1u ? kLayered : kFlat,
                                  .pushBytes = sizeof(CopyPush)};
        info.depthTest = info.depthWrite = ofDepth;
        info.colorFormat = ofDepth ? VK_FORMAT_UNDEFINED : kNormalCopy;
        info.depthFormat = ofDepth ? kDepthCopy : VK_FORMAT_UNDEFINED;
        store.setOwner(ownerOf(i));
        pipelines_[i] = store.graphics(info);
    }
    store.setOwner(ownerOf(kPack));
    pipelines_[kPack] = store.graphics({.name = "view.pack",
                                        .vertex = {.code = k_shared_fullscreen_vert},
                                        .fragment = {.code = k_runtime_view_pack_frag},
                                        .bindings = kLayered,
                                        .pushBytes = 2 * sizeof(std::int32_t),
                                        .colorFormat = VK_FORMAT_R8G8B8A8_UNORM});
}

std::string HostImages::make(std::uint32_t pipeline)
{
    const std::uint32_t owner = ownerOf(pipeline);
    while (!store_->created(owner) && store_->createNext(owner)) { // one
    }
    return store_->failure(owner);
}

Result<ImageId> HostImages::declare(PassGraph& graph, const CameraView& view, ImageId host, std::uint32_t pipeline,
                                    const Copy& copy)
{
    if (const std::string why = make(pipeline); !why.empty())
        return Error{GN_ERROR_UNSUPPORTED, "HostImage", std::string(copy.name) + " cannot be copied: " + why};
    graph.beginTask({.view = view.id}, &view, host, {});
    PassBuilder passes(graph);
    const ImageId to = passes.transient(
        ImageInfo{.name = copy.name, .scope = Scope::view, .format = copy.format, .extent = view.extent});
    const CopyPush push{.straight = view.source.straight,
                        .skyDepth = view.source.skyDepth,
                        .layer = static_cast<std::int32_t>(view.source.layer),
                        .sample = static_cast<std::int32_t>(view.source.sample),
                        .way = copy.way};
    PassRef pass = passes.raster(copy.name, Scope::view);
    pass.samples(host).area({view.area.offset.x, view.area.offset.y, view.area.extent.width, view.area.extent.height});
    if (copy.format == kDepthCopy)
        pass.depthWrite(to);
    else
        pass.writes(to);
    pass.record([=, id = pipelines_[pipeline]](PassContext& gpu) {
        gpu.bind(id, {gpu.sampled(0, host)});
        gpu.push(push);
        gpu.drawFullscreen();
    });
    if (std::optional<Error> error = graph.endTask()) return std::move(*error);
    return to;
}

Result<ImageId> HostImages::copyDepth(PassGraph& graph, const CameraView& view, ImageId host)
{
    return declare(graph, view, host, kindOf(view.source), {"view.depth", kDepthCopy, view.oblique ? 1u : 0u});
}

Result<ImageId> HostImages::copyNormals(PassGraph& graph, const CameraView& view, ImageId host)
{
    return declare(graph, view, host, kKinds + kindOf(view.source),
                   {"view.normals", kNormalCopy, static_cast<std::uint32_t>(view.source.encoding)});
}

Result<ImageId> HostImages::layersFor(PassGraph& graph, const CameraView& view, std::uint32_t lights)
{
    if (const std::string why = make(kPack); !why.empty())
        return Error{GN_ERROR_UNSUPPORTED, "ViewPacked", "visibility cannot be packed: " + why};
    graph.beginTask({.view = view.id}, &view, {}, {});
    const ImageId layers =
        PassBuilder(graph).transient(ImageInfo{.name = "view.layers",
                                               .scope = Scope::view,
                                               .format = VK_FORMAT_R8_UNORM,
                                               .extent = view.extent,
                                               .layers = (lights + kPackedLights - 1) / kPackedLights * kPackedLights});
    if (std::optional<Error> error = graph.endTask()) return std::move(*error);
    return layers;
}

void HostImages::pack(PassGraph& graph, const CameraView& view, ImageId layers, ImageId packed, std::uint32_t lights)
{
    graph.beginTask({.view = view.id}, &view, {}, {});
    for (std::uint32_t first = 0; first < lights; first += kPackedLights) {
        const glm::ivec2 push(first, lights);
        PassBuilder(graph)
            .raster("view.pack", Scope::view, first)
            .samples(layers)
            .writes(packed, {.layer = first / kPackedLights})
            .area({view.area.offset.x, view.area.offset.y, view.area.extent.width, view.area.extent.height})
            .record([=, id = pipelines_[kPack]](PassContext& gpu) {
                gpu.bind(id, {gpu.sampled(0, layers)});
                gpu.push(push);
                gpu.drawFullscreen();
            });
    }
    (void)graph.endTask(); // makes nothing, so nothing can fail
}

} // namespace gnomon
