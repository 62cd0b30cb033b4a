#pragma once
// Images and buffers behind the ids of a frame: who owns them, what they hold, what the GPU last did with them.
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "runtime/passes/pass_builder.hpp"
#include "runtime/vk/memory.hpp"

namespace gnomon {

/// What the queue last did with one layer of an image, or with a buffer.
struct SyncState {
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkPipelineStageFlags2 writeStages = 0; ///< Of the last write.
    VkAccessFlags2 writeAccess = 0;
    VkPipelineStageFlags2 readStages = 0;    ///< Reads since the last write.
    VkPipelineStageFlags2 visibleStages = 0; ///< Where the last write is visible already.
    VkAccessFlags2 visibleAccess = 0;

    // What the batch under way will do with it, all its passes together.
    VkImageLayout nextLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    VkPipelineStageFlags2 nextStages = 0;
    VkAccessFlags2 nextAccess = 0;
    bool nextWrite = false;
};

/// Of fresh memory: another resource may have lain there. The CPU knows that the GPU has done with it; a first use
/// after everything on the queue, and after its writes, says so to the queue and to validation as well, once.
inline constexpr SyncState kFreshSync{.writeStages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                      .writeAccess = VK_ACCESS_2_MEMORY_WRITE_BIT};

/// Content kept from frame to frame, and how to take a withdrawn frame back.
struct KeptState {
    std::uint64_t stamp = 0;      ///< 0: nothing worth keeping.
    std::uint64_t since = 0;      ///< Frame in which stale() gave it the stamp.
    std::uint64_t savedStamp = 0; ///< Before the frame `savedFrame`.
    std::uint64_t savedFrame = 0;
    std::uint64_t askedFrame = 0; ///< stale() was answered in this frame ...
    bool answer = false;          ///< ... with this.
    std::uint64_t lastUsed = 0;   ///< Frame.
    std::uint64_t savedUsed = 0;  ///< Before the frame `savedFrame`; 0: it was made in that frame.
    KeptParts parts, savedParts;  ///< Now, and before the frame `savedFrame`.

    /// Nothing is known of the content.
    void lose() { stamp = 0, parts = {}; }
};

struct PooledImage {
    GpuImage gpu;
    std::vector<SyncState> layers, savedLayers;
    KeptState kept;
    std::uint64_t serial = 0; ///< Of all images that were ever made; 0: the host's.
    bool imported = false;    ///< The host's: state starts and ends every frame as the contract says.
};

struct PooledBuffer {
    GpuBuffer gpu;
    SyncState sync, savedSync;
    KeptState kept;
    BufferPlace place = BufferPlace::device;
};

/// Versions of one buffer, so that the CPU never writes what the GPU still reads.
struct BufferRing {
    std::vector<std::unique_ptr<PooledBuffer>> versions;
    PooledBuffer* current = nullptr;
    PooledBuffer* savedCurrent = nullptr;
    std::uint64_t savedFrame = 0;
    std::uint64_t lastUsed = 0;
    std::uint64_t savedUsed = 0; ///< As KeptState's.
    std::uint64_t renewed = 0;   ///< Frame that chose `current`.
};

/// Whether the image can stand for one of this kind.
bool fits(const GpuImage& image, const ImageInfo& info) noexcept;

/// Owns all pooled images and buffers of a context. One thread (the frame's).
class ResourcePool {
public:
    explicit ResourcePool(DeviceMemory& memory) : memory_(memory) {}
    ~ResourcePool();
    ResourcePool(const ResourcePool&) = delete;
    ResourcePool& operator=(const ResourcePool&) = delete;

    /// Starts a frame: frees what waited for `completedFrame` and what was not used for a second (60 frames).
    void begin(std::uint64_t frame, std::uint64_t completedFrame);

    /// An image of this description that nobody else has in this frame; content undefined.
    Result<PooledImage*> transientImage(std::uint64_t key, const ImageInfo& info);
    Result<PooledImage*> persistentImage(std::uint64_t key, const ImageInfo& info);
    /// Ringed: a version whose last use is completed.
    Result<BufferRing*> transientBuffer(std::uint64_t key, const BufferInfo& info);
    Result<BufferRing*> persistentBuffer(std::uint64_t key, const BufferInfo& info);
    /// Moves `ring.current` to a version the GPU has done with.
    Result<void> renew(BufferRing& ring, const BufferInfo& info);
    /// The same, leaving what the current version holds as it is: a withdrawn frame wants it back. Does nothing for a
    /// ring that was renewed in this frame.
    Result<void> replace(BufferRing& ring, const BufferInfo& info);

    /// A buffer kept under the key holds all of this, as stale() was told.
    bool holds(std::uint64_t key, VkDeviceSize size, std::uint64_t stamp) const;
    /// Of a buffer kept under the key, as PassBuilder::keepParts() was told.
    KeptParts parts(std::uint64_t key, VkDeviceSize size) const;
    /// Another number whenever an acceleration structure may have gone, or lost what it held, without being asked for.
    std::uint64_t structureLosses() const noexcept { return structureLosses_; }
    /// A buffer is kept under the key, whatever it holds.
    bool keeps(std::uint64_t key, VkDeviceSize size) const;
    /// The same of an image of this description.
    bool keeps(std::uint64_t key, const ImageInfo& info) const;
    bool uploadIsFar() const noexcept { return memory_.uploadIsFar(); }
    /// Room for what only saves time, with nothing else having to make way for it.
    bool hasRoomFor(VkDeviceSize size) const noexcept
    {
        return memory_.used() + pooledSize(size) <= memory_.limit() / 2;
    }

    /// The host's image for this frame.
    PooledImage* import(VkImage image, VkImageView view, VkFormat format, VkExtent2D extent);
    /// An image of ours that lives until it is retired: the visibility of a view.
    Result<std::unique_ptr<PooledImage>> ownedImage(const ImageCreate& info);
    /// Destroyed when `lastFrame` is completed, the newest frame that anybody may read it in.
    void retire(std::unique_ptr<PooledImage> image, std::uint64_t lastFrame);
    void retire(std::unique_ptr<PooledImage> image) { retire(std::move(image), frame_); }

    /// First touch of a resource in a frame remembers its state for withdraw(); before anything of it changes.
    void touch(PooledImage& image);
    void touch(PooledBuffer& buffer);
    void touch(BufferRing& ring);
    /// The frame begun last will not be submitted: every touched resource is as before it. Does nothing if another
    /// frame was begun last.
    void withdraw(std::uint64_t frame);
    /// The same for a frame of which a part has run, which the GPU has done with: what touched resources hold is lost.
    void abandon(std::uint64_t frame);
    /// A frame before the one begun last, which was withdrawn, will not be submitted: nothing is known any more of what
    /// the pool's resources that it used hold.
    void lose(std::uint64_t frame);
    /// Gives back all that is kept for later frames, to be free once the GPU is done with it: a frame failed for memory
    /// and was withdrawn.
    void evictAll();

    /// As begin() was told.
    std::uint64_t frame() const noexcept { return frame_; }
    std::uint64_t completed() const noexcept { return completed_; }

private:
    struct Retired {
        std::uint64_t frame;
        GpuImage image;
        GpuBuffer buffer;
    };
    void loseContent(PooledImage& image);
    /// Destroys it once `frame` is completed; at once if it is.
    void release(GpuImage& image, std::uint64_t frame);
    void release(GpuBuffer& buffer, std::uint64_t frame);
    void release(const BufferRing& ring);
    /// Gives back what this frame does not use, least recently used first, to be free once the GPU is done with it.
    /// @return whether some of it is free already.
    bool evict(VkDeviceSize wanted);
    Result<GpuImage> createImage(const ImageCreate& info);
    Result<std::unique_ptr<PooledImage>> makeImage(const ImageCreate& info);
    Result<std::unique_ptr<PooledImage>> makeImage(const ImageInfo& info);
    Result<std::unique_ptr<PooledBuffer>> makeBuffer(const BufferInfo& info);
    std::uint64_t usedBefore(std::uint64_t savedUsed) const noexcept { return savedUsed ? savedUsed : completed_; }

    DeviceMemory& memory_;
    std::uint64_t frame_ = 0, completed_ = 0;
    std::uint64_t imagesMade_ = 0;
    std::uint64_t structureLosses_ = 0;
    std::unordered_map<std::uint64_t, std::unique_ptr<PooledImage>> images_; // persistent, by key
    std::unordered_map<std::uint64_t, BufferRing> buffers_;                  // persistent, by key
    std::unordered_map<std::uint64_t, BufferRing> transientBuffers_;         // by key
    std::vector<std::unique_ptr<PooledImage>> transients_;                   // any key, by description
    std::vector<std::unique_ptr<PooledImage>> imports_;
    std::vector<PooledImage*> touchedImages_;
    std::vector<PooledBuffer*> touchedBuffers_;
    std::vector<BufferRing*> touchedRings_;
    std::vector<Retired> retired_;
};

} // namespace gnomon
