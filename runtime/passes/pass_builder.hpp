#pragma once
// How an algorithm speaks: it declares passes and what they touch; barriers, pools, semaphores and order follow.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>

#include "runtime/base/arena.hpp"
#include "runtime/base/jobs.hpp"
#include "runtime/base/result.hpp"
#include "runtime/scene/scene_view.hpp"
#include "runtime/vk/pipelines.hpp"

namespace gnomon {

class RayScene;
class PassGraph;   // the frame's list of passes and resources; pass_graph.hpp
class PassContext; // given to GPU passes while recording; pass_context.hpp
class HostContext; // given to prepare and host passes; pass_context.hpp

enum class PassKind : std::uint8_t {
    raster, ///< A rendering scope with the declared attachments.
    compute,
    transfer,
    prepare, ///< CPU work that needs no GPU result of this frame; runs on workers before recording.
    host,    ///< CPU work between GPU passes; sees buffers only. Ends a round.
};

constexpr std::uint32_t kMaxColorAttachments = 4; ///< Of a raster pass; every device has as many.

/// How often a pass or resource exists: once per view (whatever the lights), once per light (whatever the views), once
/// per (view, light, method), or once (whatever asks: what depends on a mesh alone, with the mesh's id as the variant).
/// The same scope, name and variant is the same pass or resource.
enum class Scope : std::uint8_t { view, light, task, scene };

struct ImageId {
    std::uint32_t index = UINT32_MAX;
    explicit operator bool() const { return index != UINT32_MAX; }
};
struct BufferId {
    std::uint32_t index = UINT32_MAX;
    explicit operator bool() const { return index != UINT32_MAX; }
};

struct ImageInfo {
    const char* name = ""; ///< "algorithm.what", static storage.
    Scope scope = Scope::task;
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D extent{};
    std::uint32_t layers = 1;
    std::uint32_t variant = 0; ///< Distinguishes settings (a resolution) where name and scope are the same.
};

/// What lies where in content that is made again in parts. Whoever makes it says what a part is.
struct KeptParts {
    std::uint64_t base = 0;    ///< Stamp of what all parts would hold but for `covered`; 0: nothing is known.
    std::uint64_t covered = 0; ///< Bits of the parts that hold more.
};

enum class BufferPlace : std::uint8_t {
    device,   ///< GPU only.
    upload,   ///< Written by prepare or host passes, read by the GPU.
    readback, ///< Cached by the host: written by the GPU or host passes, read by host passes.
    // For rays on the device (DeviceTable::rayQuery()).
    buildInput,   ///< As upload; builds read it by address.
    buildScratch, ///< GPU only: builds work in it.
    bottomLevel,  ///< An acceleration structure of triangles. `size` is that of the structure.
    topLevel,     ///< And of instances.
};

/// The CPU has no part in it: its queue orders what is done with it.
constexpr bool isGpuOnly(BufferPlace place)
{
    return place != BufferPlace::upload && place != BufferPlace::readback && place != BufferPlace::buildInput;
}

constexpr bool isStructure(BufferPlace place)
{
    return place == BufferPlace::bottomLevel || place == BufferPlace::topLevel;
}

struct BufferInfo {
    const char* name = "";
    Scope scope = Scope::task;
    VkDeviceSize size = 0; ///< Rounded up to a power of two and kept.
    BufferPlace place = BufferPlace::device;
    std::uint32_t variant = 0;
};

/// Casters as shaders trace them (shaders/shared/device_rays.glsl); made by DeviceRays.
struct TracedScene {
    BufferId order;    ///< Stands for all structures: whoever traces says so of it alone, PassRef::traces().
    BufferId topLevel; ///< PassContext::structure().
    BufferId casters;  ///< gpu::TracedCaster by custom index: PassRef::reads(), PassContext::storage().
};

/// What PassBuilder::keptList() found.
struct KeptList {
    BufferId buffer;
    bool due = false; ///< A prepare pass has to write all of it in this frame.
};

/// Device bytes of a buffer of that size.
constexpr VkDeviceSize pooledSize(VkDeviceSize size)
{
    return std::bit_ceil(std::max<VkDeviceSize>(size, 256));
}

/// The same by place: structures are as large as they are said to be, in whole steps.
constexpr VkDeviceSize pooledSize(const BufferInfo& info)
{
    return isStructure(info.place) ? (info.size + 255) / 256 * 256 : pooledSize(info.size);
}

/// And of an image, at most: devices may store whole tiles. Of NVIDIA's 580.159 (H100) they are 64 bytes wide and 128
/// rows high, whatever the format, so that 1280x720 takes what 1280x768 does; lavapipe has none.
constexpr VkDeviceSize storedImageSize(VkExtent2D extent, VkDeviceSize texelBytes)
{
    const VkDeviceSize row = (texelBytes * extent.width + 63) / 64 * 64, rows = (extent.height + 127u) / 128 * 128;
    return row * rows;
}

struct Rect {
    std::int32_t x = 0, y = 0;
    std::uint32_t width = 0, height = 0; ///< 0: everything.
};

/// What part of an image an access touches and how it starts. Writes to different layers, or to disjoint rectangles of
/// one layer, are unordered and get no barrier.
struct Part {
    std::uint32_t layer = 0;
    std::uint32_t layerCount = 1;
    Rect rect{};
    bool clear = false; ///< Attachments: clear to `value` on load (within `rect`).
    VkClearValue value{};
    bool blend = false; ///< Attachments: what is there is read as well.
};
inline constexpr Part kAllLayers{.layer = 0, .layerCount = VK_REMAINING_ARRAY_LAYERS};

/// A layer of visibility of which a pass writes these pixels only: 1 in all others.
inline Part visibilityIn(const CameraView& view, std::uint32_t layer, const VkRect2D& pixels)
{
    const bool whole = pixels.extent.width == view.area.extent.width && pixels.extent.height == view.area.extent.height;
    return {.layer = layer, .clear = !whole, .value = {.color = {{1.0f, 0.0f, 0.0f, 0.0f}}}};
}

/// The view's area, of passes that draw it.
inline Rect drawnArea(const CameraView& view)
{
    const auto& [offset, extent] = view.area;
    return {offset.x, offset.y, extent.width, extent.height};
}

/// How a pass touches a resource.
enum class AccessKind : std::uint8_t {
    sampled,
    storageRead,
    storageWrite,
    storageUpdate,
    color,
    colorBlend,
    depthTest,
    depthWrite,
    stencilTest,
    stencilWrite,
    copySource,
    copyTarget,
    vertex,
    index,
    indirect,
    hostRead,
    hostWrite,
    build, ///< An acceleration structure, or what its build works in.
    buildInput,
    trace,
};

/// One pass under declaration; finished by record() or run(). Chained, then forgotten.
class PassRef {
public:
    /// Sampled in the fragment or compute stage.
    PassRef& samples(ImageId image, Part part = kAllLayers) { return add(image, AccessKind::sampled, part); }
    PassRef& writes(ImageId image, Part part = {}); ///< Colour attachment, storage image or copy target.
    /// Storage image, read and write (atomics).
    PassRef& updates(ImageId image, Part part = {}) { return add(image, AccessKind::storageUpdate, part); }
    /// Source of a transfer.
    PassRef& copies(ImageId image, Part part = kAllLayers) { return add(image, AccessKind::copySource, part); }
    /// Depth attachment, read only.
    PassRef& depthTest(ImageId image, Part part = {}) { return add(image, AccessKind::depthTest, part); }
    /// Depth attachment, tested and written.
    PassRef& depthWrite(ImageId image, Part part = {}) { return add(image, AccessKind::depthWrite, part); }
    PassRef& stencilTest(ImageId image, Part part = {}) { return add(image, AccessKind::stencilTest, part); }
    /// Combines with depthTest of the same image.
    PassRef& stencilWrite(ImageId image, Part part = {}) { return add(image, AccessKind::stencilWrite, part); }
    // Buffers.
    PassRef& reads(BufferId buffer);   ///< Storage read, host read, or source of a transfer.
    PassRef& writes(BufferId buffer);  ///< Storage write, host write, or target of a transfer.
    PassRef& updates(BufferId buffer); ///< Read and written.
    PassRef& vertices(BufferId buffer) { return add(buffer, AccessKind::vertex); }
    PassRef& indices(BufferId buffer) { return add(buffer, AccessKind::index); }
    PassRef& indirect(BufferId buffer) { return add(buffer, AccessKind::indirect); }
    /// A structure, TracedScene::order, or what a build works in.
    PassRef& builds(BufferId buffer) { return add(buffer, AccessKind::build); }
    /// A build reads it: instances.
    PassRef& buildsFrom(BufferId buffer) { return add(buffer, AccessKind::buildInput); }
    /// TracedScene::order. Shaders trace what was built before.
    PassRef& traces(BufferId order) { return add(order, AccessKind::trace); }

    /// Raster passes: limits rendering, viewport and scissor; default: the first attachment's whole extent.
    PassRef& area(Rect rect);

    /// Ends the declaration of a GPU pass: `body(PassContext&)` records it. The closure is copied bytewise.
    template <typename Body>
    void record(const Body& body)
    {
        static_assert(std::is_trivially_copyable_v<Body> && std::is_trivially_destructible_v<Body>);
        finish([](void* self, PassContext* gpu, HostContext*) { (*static_cast<Body*>(self))(*gpu); }, &body,
               sizeof(Body), alignof(Body));
    }
    /// Ends the declaration of a prepare or host pass: `body(HostContext&)` runs on a worker.
    template <typename Body>
    void run(const Body& body)
    {
        static_assert(std::is_trivially_copyable_v<Body> && std::is_trivially_destructible_v<Body>);
        finish([](void* self, PassContext*, HostContext* host) { (*static_cast<Body*>(self))(*host); }, &body,
               sizeof(Body), alignof(Body));
    }

private:
    friend class PassBuilder;
    friend class PassGraph;
    using BodyFn = void (*)(void* self, PassContext* gpu, HostContext* host);
    explicit PassRef(PassGraph& graph) : graph_(graph) {}
    void finish(BodyFn fn, const void* body, std::size_t size, std::size_t alignment);
    PassRef& add(ImageId image, AccessKind kind, const Part& part);
    PassRef& add(BufferId buffer, AccessKind kind);
    PassGraph& graph_;
};

/// Given to ShadowAlgorithm::declare. Declaring the same (scope, name, variant) again is free: the pass or resource
/// already exists, the new closure is dropped.
class PassBuilder {
public:
    explicit PassBuilder(PassGraph& graph) : graph_(graph) {}

    // Resources of this frame; content undefined at first use.
    ImageId transient(const ImageInfo& info);
    BufferId transient(const BufferInfo& info);

    // Resources that keep their content from frame to frame under (scope object, name, variant).
    ImageId persistent(const ImageInfo& info);
    BufferId persistent(const BufferInfo& info);
    /// The same of what the task can do without: null, and nothing has failed, where it cannot be made.
    BufferId persistentIfPossible(const BufferInfo& info);

    /// True if the content kept does not carry `stamp` and must be made in this frame; it carries it from then on.
    /// Asked twice in one frame for a shared resource, it answers the same. `stamp` is not 0. An upload buffer gets
    /// fresh memory when the old content is still in flight.
    bool stale(ImageId image, std::uint64_t stamp);
    bool stale(BufferId buffer, std::uint64_t stamp);
    /// Of what stale() has called so, which need not be made again as a whole: the parts that the very memory to be
    /// written held before this frame.
    KeptParts partsBefore(BufferId buffer) const;
    /// And what they are from now on; stale() has forgotten them.
    void keepParts(BufferId buffer, const KeptParts& parts);
    /// As kept last.
    KeptParts parts(BufferId buffer) const;
    /// The persistent buffer of what prepare passes write seldom and GPU passes read in every frame. It is an upload
    /// buffer; where such lie far from the GPU, what has carried its stamp for eight frames is copied to the GPU's own
    /// memory, once, and the copy is the answer from then on. `info.place` means nothing; the copying pass has the
    /// buffer's name.
    KeptList keptList(const BufferInfo& info, std::uint64_t stamp);
    /// Bytes of a persistent buffer that would have to be made: 0 where it is kept from an earlier frame.
    VkDeviceSize missing(const BufferInfo& info) const;
    /// The same of a persistent image of which `twin` has the size and format.
    VkDeviceSize missing(const ImageInfo& info, ImageId twin) const;
    /// Whether there is room for what only saves time, with nothing else having to make way for it.
    bool hasRoomFor(VkDeviceSize bytes) const;
    /// Whether the persistent buffer is kept and carries the stamp. Asking is no use of it: what is not used goes.
    bool holds(const BufferInfo& info, std::uint64_t stamp) const;
    /// Its parts as kept last, likewise; none where it is not kept.
    KeptParts parts(const BufferInfo& info) const;
    /// ResourcePool::structureLosses().
    std::uint64_t structureLosses() const;
    /// Another number for every image that was ever made: a stamp kept beside an image takes it in, since the image may
    /// have been freed and made again. 0: there is none.
    std::uint64_t serial(ImageId image) const;

    /// Whether the frame has them: for ids that are not our own.
    bool has(ImageId image, std::uint32_t firstLayer, std::uint32_t layers) const;
    bool has(BufferId buffer) const;
    VkDeviceAddress address(BufferId buffer) const; ///< Of a structure, build input or scratch; 0: none.
    VkExtent2D extent(ImageId image) const;         ///< Of an image that the frame has.
    VkFormat format(ImageId image) const;           ///< Of an image that the frame has.
    bool isHosts(ImageId image) const;              ///< The host's depth or normals, of images that the frame has.

    // Passes. `variant` as for resources. Names are "algorithm.stage", static storage.
    PassRef raster(const char* name, Scope scope = Scope::task, std::uint32_t variant = 0)
    {
        return open(PassKind::raster, name, scope, variant);
    }
    PassRef compute(const char* name, Scope scope = Scope::task, std::uint32_t variant = 0)
    {
        return open(PassKind::compute, name, scope, variant);
    }
    PassRef transfer(const char* name, Scope scope = Scope::task, std::uint32_t variant = 0)
    {
        return open(PassKind::transfer, name, scope, variant);
    }
    PassRef prepare(const char* name, Scope scope = Scope::task, std::uint32_t variant = 0)
    {
        return open(PassKind::prepare, name, scope, variant);
    }
    PassRef host(const char* name, Scope scope = Scope::task, std::uint32_t variant = 0)
    {
        return open(PassKind::host, name, scope, variant);
    }

    /// The frame under declaration: grows from frame to frame.
    std::uint64_t frame() const;
    /// The newest frame that the GPU has finished.
    std::uint64_t completedFrame() const;

    /// Counts `count` update passes that were not declared because their result was kept.
    void kept(std::uint32_t count = 1);
    /// Counts pages of maps in a pool of fixed size. @param evicted made way for others @param withoutRoom were asked
    /// for, and coarser ones answer for them
    void pages(std::uint32_t evicted, std::uint32_t withoutRoom);

    // Shared view-scope resources, made at most once per view and frame, on first use. Readback, with a place for every
    // pixel of the image, row by row; those of the view's area are copied, the rest is undefined.
    BufferId depthOnHost();   ///< A float a pixel.
    BufferId normalsOnHost(); ///< Raw texels of the normal image (CameraView::normalFormat); none: null id.

    /// The task cannot run; its passes are taken back and another method serves the light, if one can.
    void fail(const Error& error);

    /// Memory of this frame for closures to share (counts set by a prepare pass, read while recording).
    FrameArena& arena();

private:
    friend class PassGraph;
    PassRef open(PassKind kind, const char* name, Scope scope, std::uint32_t variant);
    PassGraph& graph_;
};

} // namespace gnomon
