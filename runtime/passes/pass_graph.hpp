#pragma once
// The frame's passes and resources as declared, and their order: rounds (GPU-CPU-GPU round trips) and batches (passes
// that need no barrier between them).
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/base/method_set.hpp"
#include "runtime/passes/pass_builder.hpp"
#include "runtime/passes/resources.hpp"

namespace gnomon {

/// Layout, stages and access bits of an access.
struct AccessTraits {
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED; ///< Images.
    VkPipelineStageFlags2 stages = 0;
    VkAccessFlags2 access = 0;
    bool write = false;
};
AccessTraits accessTraits(AccessKind kind, PassKind pass);

struct Access {
    std::uint32_t resource = 0; ///< Into images() or buffers().
    bool isImage = false;
    AccessKind kind = AccessKind::sampled;
    Part part;                       ///< layerCount resolved to a number.
    std::uint32_t next = UINT32_MAX; ///< Older access to the same resource.
    std::uint32_t pass = 0;
};
/// The same of an access with its part: what is cleared is written, where it is only tested then, too.
AccessTraits accessTraits(const Access& access, PassKind pass);

/// Whose pass it is: what the timings and the log say.
struct PassOwner {
    std::uint32_t view = UINT32_MAX;  ///< CameraView::id; max: none.
    std::uint32_t light = UINT32_MAX; ///< LightView::id; max: none.
    std::uint32_t method = UINT32_MAX;
    std::uint32_t declarer = UINT32_MAX; ///< The method that declared it; of a shared pass, the first that did.
    MethodSet declarers;                 ///< The methods that did.
    bool drawsKept = false;              ///< All that it writes are depths that are kept.

    /// Whether its time is the light's update (runtime/cost), not what the view's pixels take.
    bool isUpdate() const { return drawsKept || view == UINT32_MAX; }
};

struct Pass {
    const char* name = "";
    PassKind kind = PassKind::raster;
    PassOwner owner;
    std::uint32_t firstAccess = 0, accessCount = 0;
    Rect area{};
    void (*fn)(void* self, PassContext* gpu, HostContext* host) = nullptr;
    void* body = nullptr;
    std::uint32_t task = 0; ///< Under which beginTask() it was declared.
    std::uint32_t round = 0;
    std::uint32_t batch = 0; ///< Within the round, among passes of its side (GPU or CPU).
    float cpuMs = 0.0f;      ///< Host and prepare passes, once run.
};

struct FrameImage {
    std::uint64_t key = 0;
    PooledImage* pooled = nullptr;
    const char* name = "";
    bool keptDepths = false;           ///< Persistent, of a depth format.
    std::uint32_t newest = UINT32_MAX; ///< Newest access.
};
struct FrameBuffer {
    std::uint64_t key = 0;
    PooledBuffer* pooled = nullptr;
    BufferRing* ring = nullptr; ///< Persistent ones.
    BufferInfo info;            ///< As asked for; of somebody else's, the size alone.
    std::uint32_t newest = UINT32_MAX;
};

/// What became of kept results: members of GnFrameStats.
struct KeptCounts {
    std::uint32_t kept = 0, pagesEvicted = 0, pagesWithoutRoom = 0;

    KeptCounts& operator+=(const KeptCounts& more)
    {
        kept += more.kept;
        pagesEvicted += more.pagesEvicted;
        pagesWithoutRoom += more.pagesWithoutRoom;
        return *this;
    }
};

/// Filled by PassBuilder, read by PassExecutor. Reused from frame to frame: a steady frame allocates nothing.
class PassGraph {
public:
    PassGraph(ResourcePool& pool, FrameArena& arena) : pool_(pool), arena_(arena) {}

    void reset();

    /// Passes declared from now on belong to this task.
    void beginTask(const PassOwner& owner, const CameraView* view, ImageId depth, ImageId normals);
    /// Why a resource of the task could not be made; the task's passes are then taken back.
    std::optional<Error> endTask();
    /// Declarations go on in the task of an earlier pass.
    void resumeTask(std::uint32_t task);

    /// Resources that somebody else owns. An image that is there already keeps its id.
    ImageId addImage(PooledImage& image, const char* name);
    BufferId addBuffer(PooledBuffer& buffer);

    std::span<Pass> passes() { return passes_; }
    std::span<const Pass> passes() const { return passes_; }
    std::span<const Access> accesses(const Pass& pass) const
    {
        return std::span<const Access>(accesses_).subspan(pass.firstAccess, pass.accessCount);
    }
    PooledImage& image(ImageId id) const { return *images_[id.index].pooled; }
    PooledImage& imageAt(std::uint32_t index) const { return *images_[index].pooled; }
    PooledBuffer& buffer(BufferId id) const { return *buffers_[id.index].pooled; }
    PooledBuffer& bufferAt(std::uint32_t index) const { return *buffers_[index].pooled; }
    /// Bytes that shaders are given of it: in memory that has held more, as many as this frame asked for.
    VkDeviceSize boundSize(BufferId id) const
    {
        const FrameBuffer& buffer = buffers_[id.index];
        return std::min(buffer.pooled->gpu.size, pooledSize(buffer.info));
    }

    /// Indices into passes(), ordered by round, side (prepare, GPU, host) and batch; valid until the next declaration.
    std::span<const std::uint32_t> order();
    std::uint32_t rounds() const { return rounds_; }
    const KeptCounts& counts() const { return counts_; }
    /// Passes declared from now on come at this round or later (declared by host passes).
    void setFirstRound(std::uint32_t round) { firstRound_ = round; }

    FrameArena& arena() { return arena_; }

private:
    friend class PassRef;
    friend class PassBuilder;

    std::uint64_t key(Scope scope, const char* name, std::uint32_t variant, std::uint64_t salt) const;
    /// Index stored under the key this frame, or max.
    std::uint32_t find(std::uint64_t key) const;
    void store(std::uint64_t key, std::uint32_t index);
    void fail(const Error& error);
    ImageId findOrMake(const ImageInfo& info, bool persistent);
    BufferId findOrMake(const BufferInfo& info, bool persistent);
    std::uint64_t key(const ImageInfo& info, bool persistent) const;
    std::uint64_t key(const BufferInfo& info, bool persistent) const;
    PassRef open(PassKind kind, const char* name, Scope scope, std::uint32_t variant);
    void add(std::uint32_t resource, bool isImage, AccessKind kind, const Part& part);
    void close(void (*fn)(void*, PassContext*, HostContext*), const void* body, std::size_t size,
               std::size_t alignment);
    bool drawsKept(const Pass& pass) const;
    void place(Pass& pass, std::uint32_t index);
    /// The frame's answer about a stamp, given once more; who is the next to promise what a task has taken back.
    bool answeredAgain(KeptState& kept, std::uint64_t stamp);
    BufferId hostCopy(ImageId image, const char* name, VkDeviceSize texelSize);

    ResourcePool& pool_;
    FrameArena& arena_;
    std::vector<Pass> passes_;
    std::vector<Access> accesses_;
    std::vector<FrameImage> images_;
    std::vector<FrameBuffer> buffers_;
    std::vector<std::uint32_t> order_;
    struct Slot {
        std::uint64_t key = 0;
        std::uint32_t index = 0;
        std::uint32_t epoch = 0;
    };
    std::vector<Slot> table_ = std::vector<Slot>(1024); ///< Open addressing; entries of other epochs are empty.
    std::uint32_t epoch_ = 0;
    std::uint32_t tableUsed_ = 0;

    struct TaskScope {
        PassOwner owner;
        const CameraView* view;
        ImageId depth, normals;
    };
    std::vector<TaskScope> tasks_;
    std::uint32_t task_ = 0;
    PassOwner owner_;
    const CameraView* view_ = nullptr;
    ImageId depth_, normals_;
    std::size_t taskFirstPass_ = 0;
    std::vector<KeptState*> taskStale_; ///< What the task has promised to make.
    std::optional<Error> error_;

    Pass pending_;                ///< Under declaration.
    bool pendingDropped_ = false; ///< Exists already.
    bool pendingBroken_ = false;  ///< Touches a resource that could not be made.
    std::uint64_t pendingKey_ = 0;
    std::uint32_t rounds_ = 1;
    std::uint32_t firstRound_ = 0;
    KeptCounts counts_, taskCounts_;
};

} // namespace gnomon
