#pragma once
// What passes are given while they run.
#include <cstdint>
#include <cstring>
#include <span>

#include "runtime/passes/pass_builder.hpp"
#include "runtime/vk/device_table.hpp"

namespace gnomon {

/// Something bound to a binding of set 0.
struct Bound {
    std::uint32_t binding = 0;
    BindingKind kind = BindingKind::constants;
    ImageId image;
    BufferId buffer;
    std::uint32_t layer = VK_REMAINING_ARRAY_LAYERS; ///< One layer as a 2D view, or all as an array view.
    SamplerKind sampler = SamplerKind::nearest;
    bool stencil = false;                ///< Stencil aspect.
    VkBuffer rawBuffer = VK_NULL_HANDLE; ///< Instead of `buffer`: a mesh's own.
    std::uint32_t offset = 0;            ///< constants: into the frame's ring.
    std::uint32_t size = 0;
};

/// How drawCasters looks at the scene: the pipeline (its vertex shader includes shared/casters.glsl) and which casters.
struct CasterDraw {
    PipelineId pipeline;
    std::span<const Caster* const> casters;
    std::span<const Plane> volume; ///< Casters, and chunks of them, whose bounds lie outside any plane are skipped.
    std::span<const Bound> bindings;
    const void* push = nullptr; ///< Push constants.
    std::uint32_t pushSize = 0;
    bool depthFromOne = false; ///< Depth is 1 - z / w of our own casters' clip space; hosts draw z / w.
    std::uint32_t firstFace = 0, faceCount = UINT32_MAX; ///< Of their meshes: for a part of one caster.
    bool numbered = false; ///< Behind `push` the pipeline is told each draw's first triangle, a uint.
    bool biasOpen = true;  ///< Open casters get the depth bias of the house's policy (runtime/scene/bias.hpp).
    const GnCasterProjection* hostProjection = nullptr; ///< Null: host-drawn casters are left out.
};

/// Recording of one GPU pass.
class PassContext {
public:
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    const DeviceTable* vk = nullptr;
    VkRect2D area{}; ///< Raster: the rendering area; viewport and scissor are set to it.

    // Things to bind.
    Bound sampled(std::uint32_t binding, ImageId image, SamplerKind sampler = SamplerKind::nearest,
                  std::uint32_t layer = VK_REMAINING_ARRAY_LAYERS) const;
    Bound stencilOf(std::uint32_t binding, ImageId image) const;
    Bound storage(std::uint32_t binding, ImageId image, std::uint32_t layer = VK_REMAINING_ARRAY_LAYERS) const;
    Bound storage(std::uint32_t binding, BufferId buffer) const;
    Bound storage(std::uint32_t binding, VkBuffer buffer) const;
    Bound structure(std::uint32_t binding, BufferId topLevel) const;
    /// Copies a block into the frame's ring of uniform memory.
    template <typename T>
    Bound constants(std::uint32_t binding, const T& block)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        return constantsBytes(binding, &block, sizeof(T));
    }

    /// Binds the pipeline and its set. Sets are cached by content: a steady frame makes none.
    void bind(PipelineId pipeline, std::span<const Bound> bindings);
    void bind(PipelineId pipeline, std::initializer_list<Bound> bindings)
    {
        bind(pipeline, std::span<const Bound>(bindings.begin(), bindings.size()));
    }
    template <typename T>
    void push(const T& block)
    {
        static_assert(sizeof(T) <= 128);
        pushBytes(&block, sizeof(T));
    }

    /// Limits what is drawn to these pixels. @return false: there are none
    bool clipTo(const VkRect2D& pixels) const;
    /// One triangle over the area (shared/fullscreen.vert).
    void drawFullscreen();
    void drawCasters(const CasterDraw& draw);

    // Raw handles, for what the helpers do not cover.
    VkImage image(ImageId id) const;
    VkImageView imageView(ImageId id, std::uint32_t layer) const; ///< 2D, one layer, for sampling.
    VkExtent2D extent(ImageId id) const;
    VkBuffer buffer(BufferId id) const;
    VkAccelerationStructureKHR structure(BufferId id) const;
    /// Whether the frame has them: for ids that are not our own.
    bool has(ImageId id, std::uint32_t layer) const;
    bool has(BufferId id) const;

private:
    friend class PassExecutor;
    void setArea() const;                            ///< Viewport and scissor.
    void setViewport(float first, float last) const; ///< Of the area; depths of z / w = 0 and 1.
    Bound constantsBytes(std::uint32_t binding, const void* data, std::size_t size);
    void pushBytes(const void* data, std::size_t size, std::size_t offset = 0);
    void drawFaces(const CasterDraw& draw, const Caster& caster);
    class PassExecutor* executor_ = nullptr;
    PipelineId bound_;
};

/// Given to prepare and host passes; on a worker, or on the calling thread.
class HostContext {
public:
    JobSystem* jobs = nullptr;      ///< parallelFor within the pass.
    const RayScene* rays = nullptr; ///< Brought to this frame's casters; null without Embree.
    FrameArena* arena = nullptr;

    /// Content of a readback buffer.
    template <typename T>
    std::span<const T> read(BufferId buffer) const
    {
        std::span<std::byte> bytes = mapped(buffer);
        return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
    }
    /// Memory of an upload buffer.
    template <typename T>
    std::span<T> write(BufferId buffer) const
    {
        std::span<std::byte> bytes = mapped(buffer);
        return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
    }

    bool has(BufferId buffer) const; ///< As PassContext's.

    void countRays(std::uint64_t count) const; ///< Adds to the frame's statistics.
    void countIndexList() const;               ///< A silhouette or index list was built.

    /// Host passes: declares further passes, which form the next rounds (at most the algorithm's maxRounds). Called on
    /// the frame's thread after all host passes of the round have run. The closure is copied bytewise.
    template <typename Body>
    void declareLater(const Body& body)
    {
        static_assert(std::is_trivially_copyable_v<Body> && std::is_trivially_destructible_v<Body>);
        later([](const void* self, PassBuilder& passes) { (*static_cast<const Body*>(self))(passes); }, &body,
              sizeof(Body), alignof(Body));
    }

private:
    friend class PassExecutor;
    std::span<std::byte> mapped(BufferId buffer) const;
    void later(void (*fn)(const void*, PassBuilder&), const void* body, std::size_t size, std::size_t alignment);
    class PassExecutor* executor_ = nullptr;
    std::uint32_t pass_ = 0;
};

} // namespace gnomon
