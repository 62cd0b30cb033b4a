#include "runtime/passes/resources.hpp"

#include "runtime/base/make_room.hpp"
#include "runtime/vk/structures.hpp"

namespace gnomon {

namespace {

// A resource that no frame of the last second (at 60 Hz) used is given back.
constexpr std::uint64_t kIdleFrames = 60;
// Where more than half of what gnomon may have is taken, it goes as soon as no frame in flight can be using it: else
// what one method has left behind keeps the next from serving.
constexpr std::uint64_t kIdleFramesPressed = 4;

/// Whether compute passes may write the format: those for which every device has it, and which nothing compresses.
bool isStorable(VkFormat format)
{
    return format == VK_FORMAT_R32_UINT || format == VK_FORMAT_R16G16B16A16_UINT ||
           format == VK_FORMAT_R32G32B32A32_UINT;
}

VkImageUsageFlags imageUsage(VkFormat format)
{
    const bool depth = (aspectsOf(format) & VK_IMAGE_ASPECT_COLOR_BIT) == 0;
    return VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
           (depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT) |
           (isStorable(format) ? VK_IMAGE_USAGE_STORAGE_BIT : 0);
}

constexpr VkBufferUsageFlags kBufferUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                            VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                            VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

MemoryUse memoryUse(BufferPlace place)
{
    switch (place) {
    case BufferPlace::upload:
    case BufferPlace::buildInput:
        return MemoryUse::upload;
    case BufferPlace::readback:
        return MemoryUse::readback;
    default:
        break;
    }
    return MemoryUse::device;
}

VkBufferUsageFlags bufferUsage(BufferPlace place)
{
    return place == BufferPlace::buildInput     ? kBuildInput
           : place == BufferPlace::buildScratch ? kBuildScratch
                                                : kBufferUsage;
}

Result<GpuBuffer> createBuffer(DeviceMemory& memory, const BufferInfo& info)
{
    const VkDeviceSize size = pooledSize(info);
    if (info.place == BufferPlace::bottomLevel)
        return memory.createStructure(size, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, info.name);
    if (info.place == BufferPlace::topLevel)
        return memory.createStructure(size, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, info.name);
    return memory.createBuffer(size, bufferUsage(info.place), memoryUse(info.place), info.name);
}

} // namespace

bool fits(const GpuImage& image, const ImageInfo& info) noexcept
{
    return image.format == info.format && image.extent.width == info.extent.width &&
           image.extent.height == info.extent.height && image.layers == info.layers;
}

ResourcePool::~ResourcePool()
{
    for (auto& [key, image] : images_)
        memory_.destroy(image->gpu);
    for (auto& image : transients_)
        memory_.destroy(image->gpu);
    for (auto* map : {&buffers_, &transientBuffers_})
        for (auto& [key, ring] : *map)
            for (auto& version : ring.versions)
                memory_.destroy(version->gpu);
    for (Retired& entry : retired_) {
        memory_.destroy(entry.image);
        memory_.destroy(entry.buffer);
    }
}

void ResourcePool::release(GpuImage& image, std::uint64_t frame)
{
    if (frame <= completed_) return memory_.destroy(image);
    makeRoom(retired_); // before the image is moved: it would be lost
    Retired entry{.frame = frame, .image = std::move(image), .buffer = {}};
    retired_.push_back(std::move(entry));
}

void ResourcePool::release(GpuBuffer& buffer, std::uint64_t frame)
{
    if (frame <= completed_) return memory_.destroy(buffer);
    makeRoom(retired_);
    Retired entry{.frame = frame, .image = {}, .buffer = std::move(buffer)};
    retired_.push_back(std::move(entry));
}

void ResourcePool::release(const BufferRing& ring)
{
    for (auto& version : ring.versions) {
        structureLosses_ += isStructure(version->place);
        release(version->gpu, ring.lastUsed);
    }
}

void ResourcePool::begin(std::uint64_t frame, std::uint64_t completedFrame)
{
    frame_ = frame;
    completed_ = completedFrame;
    touchedImages_.clear();
    touchedBuffers_.clear();
    touchedRings_.clear();
    std::erase_if(retired_, [&](Retired& entry) {
        if (entry.frame > completedFrame) return false;
        memory_.destroy(entry.image);
        memory_.destroy(entry.buffer);
        return true;
    });

    const std::uint64_t stay = memory_.used() > memory_.limit() / 2 ? kIdleFramesPressed : kIdleFrames;
    auto idle = [&](std::uint64_t lastUsed) { return lastUsed + stay < frame; };
    std::erase_if(images_, [&](auto& entry) {
        if (!idle(entry.second->kept.lastUsed)) return false;
        release(entry.second->gpu, entry.second->kept.lastUsed);
        return true;
    });
    std::erase_if(transients_, [&](auto& image) {
        if (!idle(image->kept.lastUsed)) return false;
        release(image->gpu, image->kept.lastUsed);
        return true;
    });
    for (auto* map : {&buffers_, &transientBuffers_})
        std::erase_if(*map, [&](auto& entry) {
            if (!idle(entry.second.lastUsed)) return false;
            release(entry.second);
            return true;
        });
}

Result<GpuImage> ResourcePool::createImage(const ImageCreate& info)
{
    Result<GpuImage> gpu = memory_.createImage(info);
    if (gpu || gpu.error().result != GN_ERROR_OUT_OF_DEVICE_MEMORY) return gpu;
    // Few formats have more than eight bytes a texel; what this leaves missing, the next attempt evicts.
    const bool room = evict(VkDeviceSize{info.extent.width} * info.extent.height * info.layers * 8);
    return room ? memory_.createImage(info) : gpu;
}

Result<std::unique_ptr<PooledImage>> ResourcePool::makeImage(const ImageCreate& info)
{
    auto image = std::make_unique<PooledImage>(); // what may throw comes before what nobody would destroy
    image->layers.resize(info.layers, kFreshSync);
    image->savedLayers.resize(info.layers, kFreshSync);
    Result<GpuImage> gpu = createImage(info);
    if (!gpu) return gpu.error();
    image->gpu = std::move(*gpu);
    image->serial = ++imagesMade_;
    return image;
}

Result<std::unique_ptr<PooledImage>> ResourcePool::makeImage(const ImageInfo& info)
{
    return makeImage(ImageCreate{.format = info.format,
                                 .extent = info.extent,
                                 .layers = info.layers,
                                 .usage = imageUsage(info.format),
                                 .name = info.name,
                                 .concurrent = false});
}

Result<std::unique_ptr<PooledImage>> ResourcePool::ownedImage(const ImageCreate& info)
{
    return makeImage(info);
}

Result<std::unique_ptr<PooledBuffer>> ResourcePool::makeBuffer(const BufferInfo& info)
{
    auto buffer = std::make_unique<PooledBuffer>();
    Result<GpuBuffer> gpu = createBuffer(memory_, info);
    if (!gpu && evict(pooledSize(info))) gpu = createBuffer(memory_, info);
    if (!gpu) return gpu.error();
    buffer->gpu = *gpu;
    buffer->place = info.place;
    buffer->sync = buffer->savedSync = kFreshSync;
    return buffer;
}

bool ResourcePool::evict(VkDeviceSize wanted)
{
    // What a frame in flight uses is freed when that is done, so it helps the frames after this one.
    VkDeviceSize freed = 0;
    bool now = false;
    const auto give = [&](PooledImage& image) {
        freed += image.gpu.memory.size;
        now |= image.kept.lastUsed <= completed_;
        release(image.gpu, image.kept.lastUsed);
    };
    while (freed < wanted) {
        auto oldest = images_.end();
        for (auto it = images_.begin(); it != images_.end(); ++it) {
            const std::uint64_t used = it->second->kept.lastUsed;
            if (used < frame_ && (oldest == images_.end() || used < oldest->second->kept.lastUsed)) oldest = it;
        }
        if (oldest == images_.end()) break;
        give(*oldest->second);
        images_.erase(oldest);
    }
    std::erase_if(transients_, [&](auto& image) {
        if (image->kept.lastUsed >= frame_) return false;
        give(*image);
        return true;
    });
    return now;
}

void ResourcePool::evictAll()
{
    for (auto& [key, image] : images_)
        release(image->gpu, image->kept.lastUsed);
    for (auto& image : transients_)
        release(image->gpu, image->kept.lastUsed);
    for (auto* map : {&buffers_, &transientBuffers_})
        for (auto& [key, ring] : *map)
            release(ring);
    images_.clear();
    transients_.clear();
    buffers_.clear();
    transientBuffers_.clear();
}

Result<PooledImage*> ResourcePool::transientImage(std::uint64_t, const ImageInfo& info)
{
    for (auto& image : transients_) {
        if (image->kept.lastUsed == frame_ || !fits(image->gpu, info)) continue;
        touch(*image);
        image->kept.lastUsed = frame_;
        for (SyncState& layer : image->layers)
            layer.layout = VK_IMAGE_LAYOUT_UNDEFINED; // content is not wanted
        return image.get();
    }
    auto made = makeImage(info);
    if (!made) return made.error();
    transients_.push_back(std::move(*made));
    PooledImage& image = *transients_.back();
    touch(image);
    image.kept.lastUsed = frame_;
    return &image;
}

Result<PooledImage*> ResourcePool::persistentImage(std::uint64_t key, const ImageInfo& info)
{
    auto found = images_.find(key);
    if (found != images_.end() && !fits(found->second->gpu, info)) {
        release(found->second->gpu, frame_);
        images_.erase(found);
        found = images_.end();
    }
    if (found == images_.end()) {
        auto made = makeImage(info);
        if (!made) return made.error();
        found = images_.emplace(key, std::move(*made)).first;
    }
    PooledImage& image = *found->second;
    touch(image);
    image.kept.lastUsed = frame_;
    return &image;
}

Result<BufferRing*> ResourcePool::transientBuffer(std::uint64_t key, const BufferInfo& info)
{
    BufferRing& ring = transientBuffers_[key];
    touch(ring);
    ring.lastUsed = frame_;
    if (auto renewed = renew(ring, info); !renewed) return renewed.error();
    return &ring;
}

Result<BufferRing*> ResourcePool::persistentBuffer(std::uint64_t key, const BufferInfo& info)
{
    BufferRing& ring = buffers_[key];
    touch(ring);
    ring.lastUsed = frame_;
    if (!ring.current || ring.current->gpu.size < info.size) {
        if (auto renewed = renew(ring, info); !renewed) return renewed.error();
    }
    touch(*ring.current);
    ring.current->kept.lastUsed = frame_;
    return &ring;
}

bool ResourcePool::holds(std::uint64_t key, VkDeviceSize size, std::uint64_t stamp) const
{
    const auto found = buffers_.find(key);
    const PooledBuffer* buffer = found == buffers_.end() ? nullptr : found->second.current;
    return buffer && buffer->kept.stamp == stamp && buffer->gpu.size >= size;
}

KeptParts ResourcePool::parts(std::uint64_t key, VkDeviceSize size) const
{
    return keeps(key, size) ? buffers_.at(key).current->kept.parts : KeptParts{};
}

bool ResourcePool::keeps(std::uint64_t key, VkDeviceSize size) const
{
    const auto found = buffers_.find(key);
    return found != buffers_.end() && found->second.current && found->second.current->gpu.size >= size;
}

bool ResourcePool::keeps(std::uint64_t key, const ImageInfo& info) const
{
    const auto found = images_.find(key);
    return found != images_.end() && fits(found->second->gpu, info);
}

Result<void> ResourcePool::replace(BufferRing& ring, const BufferInfo& info)
{
    if (ring.renewed == frame_) return {};
    PooledBuffer* old = ring.current;
    Result<void> renewed = renew(ring, info); // not to the old one, which this frame has touched
    if (renewed)
        old->kept.lastUsed = usedBefore(old->kept.savedUsed); // and does not use after all
    else
        ring.current = old; // others that share the buffer ask as well
    return renewed;
}

Result<void> ResourcePool::renew(BufferRing& ring, const BufferInfo& info)
{
    auto usable = [&](const PooledBuffer& version) {
        // The queue orders GPU-only buffers by itself; what the CPU touches must be done with.
        const bool done = version.kept.lastUsed <= completed_ || isGpuOnly(info.place);
        return version.gpu.size >= info.size && done && version.kept.lastUsed != frame_;
    };
    PooledBuffer* chosen = nullptr;
    for (auto& version : ring.versions)
        if (usable(*version) && (!chosen || version->kept.lastUsed < chosen->kept.lastUsed)) chosen = version.get();
    if (!chosen) {
        std::erase_if(ring.versions, [&](auto& version) { // outgrown ones
            if (version->gpu.size >= info.size) return false;
            if (ring.savedCurrent == version.get()) ring.savedCurrent = nullptr;
            std::erase(touchedBuffers_, version.get());
            release(version->gpu, frame_);
            return true;
        });
        auto made = makeBuffer(info);
        if (!made) {
            ring.current = nullptr;
            return made.error();
        }
        ring.versions.push_back(std::move(*made));
        chosen = ring.versions.back().get();
    }
    ring.current = chosen;
    ring.renewed = frame_;
    chosen->kept.stamp = 0;
    touch(*chosen);
    chosen->kept.lastUsed = frame_;
    return {};
}

PooledImage* ResourcePool::import(VkImage image, VkImageView view, VkFormat format, VkExtent2D extent)
{
    PooledImage* chosen = nullptr;
    for (auto& entry : imports_) {
        if (entry->kept.lastUsed == frame_ && entry->gpu.image == image) return entry.get();
        if (entry->kept.lastUsed != frame_ && !chosen) chosen = entry.get();
    }
    if (!chosen) {
        imports_.push_back(std::make_unique<PooledImage>());
        chosen = imports_.back().get();
        chosen->layers.resize(1);
        chosen->savedLayers.resize(1);
        chosen->gpu.layerViews.resize(1);
        chosen->gpu.layerSampled.resize(1);
        chosen->imported = true;
    }
    chosen->gpu.image = image;
    chosen->gpu.view = view;
    chosen->gpu.layerViews[0] = chosen->gpu.layerSampled[0] = view;
    chosen->gpu.format = format;
    chosen->gpu.extent = extent;
    // The contract: SHADER_READ_ONLY, what the host wrote is visible to everything.
    chosen->layers[0] = SyncState{.layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                  .writeStages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                  .visibleStages = ~VkPipelineStageFlags2{0},
                                  .visibleAccess = ~VkAccessFlags2{0}};
    chosen->kept.lastUsed = frame_;
    return chosen;
}

void ResourcePool::retire(std::unique_ptr<PooledImage> image, std::uint64_t lastFrame)
{
    std::erase(touchedImages_, image.get());
    release(image->gpu, lastFrame);
}

} // namespace gnomon
