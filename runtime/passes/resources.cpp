#include "runtime/passes/resources.hpp"

#include <algorithm>

namespace gnomon {

namespace {

// A resource that no frame of the last second (at 60 Hz) used is given back.
constexpr std::uint64_t kIdleFrames = 60;
// Where more than half of what gnomon may have is taken, it goes as soon as no frame in flight can be using it: else what
// one method has left behind keeps the next from serving.
constexpr std::uint64_t kIdleFramesPressed = 4;

VkImageUsageFlags imageUsage(VkFormat format)
{
    const bool depth = (aspectsOf(format) & VK_IMAGE_ASPECT_COLOR_BIT) == 0;
    return VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
           (depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
}

constexpr VkBufferUsageFlags kBufferUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                            VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                            VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

MemoryUse memoryUse(BufferPlace place)
{
    switch (place) {
    case BufferPlace::upload:
        return MemoryUse::upload;
    case BufferPlace::readback:
        return MemoryUse::readback;
    case BufferPlace::device:
        break;
    }
    return MemoryUse::device;
}

bool fits(const GpuImage& image, const ImageInfo& info)
{
    return image.format == info.format && image.extent.width == info.extent.width &&
           image.extent.height == info.extent.height && image.layers == info.layers;
}

} // namespace

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
    Retired entry{.frame = frame, .image = std::move(image), .buffer = {}};
    retired_.push_back(std::move(entry));
}

void ResourcePool::release(GpuBuffer& buffer, std::uint64_t frame)
{
    Retired entry{.frame = frame, .image = {}, .buffer = std::move(buffer)};
    retired_.push_back(std::move(entry));
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
            for (auto& version : entry.second.versions)
                release(version->gpu, entry.second.lastUsed);
            return true;
        });
}

Result<std::unique_ptr<PooledImage>> ResourcePool::makeImage(const ImageInfo& info)
{
    ImageCreate create{.format = info.format,
                       .extent = info.extent,
                       .layers = info.layers,
                       .usage = imageUsage(info.format),
                       .name = info.name,
                       .concurrent = false};
    Result<GpuImage> gpu = memory_.createImage(create);
    if (!gpu) {
        evict(VkDeviceSize{info.extent.width} * info.extent.height * info.layers * 8);
        return gpu.error();
    }
    auto image = std::make_unique<PooledImage>();
    image->gpu = std::move(*gpu);
    image->serial = ++imagesMade_;
    image->layers.resize(info.layers, kFreshSync);
    image->savedLayers.resize(info.layers, kFreshSync);
    return image;
}

Result<std::unique_ptr<PooledBuffer>> ResourcePool::makeBuffer(const BufferInfo& info)
{
    const VkDeviceSize size = pooledSize(info.size);
    Result<GpuBuffer> gpu = memory_.createBuffer(size, kBufferUsage, memoryUse(info.place), info.name);
    if (!gpu) {
        evict(size);
        return gpu.error();
    }
    auto buffer = std::make_unique<PooledBuffer>();
    buffer->gpu = *gpu;
    buffer->place = info.place;
    buffer->sync = buffer->savedSync = kFreshSync;
    return buffer;
}

void ResourcePool::evict(VkDeviceSize wanted)
{
    // Freed once the GPU is done, so it helps the frames after this one; this frame's task goes without.
    VkDeviceSize freed = 0;
    while (freed < wanted) {
        auto oldest = images_.end();
        for (auto it = images_.begin(); it != images_.end(); ++it) {
            const std::uint64_t used = it->second->kept.lastUsed;
            if (used < frame_ && (oldest == images_.end() || used < oldest->second->kept.lastUsed)) oldest = it;
        }
        if (oldest == images_.end()) break;
        freed += oldest->second->gpu.memory.size;
        release(oldest->second->gpu, oldest->second->kept.lastUsed);
        images_.erase(oldest);
    }
    std::erase_if(transients_, [&](auto& image) {
        if (image->kept.lastUsed >= frame_) return false;
        release(image->gpu, image->kept.lastUsed);
        return true;
    });
}

Result<PooledImage*> ResourcePool::transientImage(std::uint64_t, const ImageInfo& info)
{
    for (auto& image : transients_) {
        if (image->kept.lastUsed == frame_ || !fits(image->gpu, info)) continue;
        image->kept.lastUsed = frame_;
        touch(*image);
        for (SyncState& layer : image->layers)
            layer.layout = VK_IMAGE_LAYOUT_UNDEFINED; // content is not wanted
        return image.get();
    }
    auto made = makeImage(info);
    if (!made) return made.error();
    transients_.push_back(std::move(*made));
    PooledImage& image = *transients_.back();
    image.kept.lastUsed = frame_;
    touch(image);
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
    image.kept.lastUsed = frame_;
    touch(image);
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
    KeptState& kept = ring.current->kept;
    if (kept.lastUsed != frame_) kept.usedBefore = kept.lastUsed;
    kept.lastUsed = frame_;
    touch(*ring.current);
    return &ring;
}

Result<void> ResourcePool::replace(BufferRing& ring, const BufferInfo& info)
{
    if (ring.renewed == frame_) return {};
    PooledBuffer* old = ring.current;
    Result<void> renewed = renew(ring, info);  // not to the old one, which this frame has touched
    old->kept.lastUsed = old->kept.usedBefore; // and does not use after all
    return renewed;
}

Result<void> ResourcePool::renew(BufferRing& ring, const BufferInfo& info)
{
    auto usable = [&](const PooledBuffer& version) {
        // The queue orders GPU-only buffers by itself; what the CPU touches must be done with.
        const bool done = version.kept.lastUsed <= completed_ || info.place == BufferPlace::device;
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
    chosen->kept.lastUsed = frame_;
    touch(*chosen);
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

Result<std::unique_ptr<PooledImage>> ResourcePool::ownedImage(const ImageCreate& info)
{
    Result<GpuImage> gpu = memory_.createImage(info);
    if (!gpu) return gpu.error();
    auto image = std::make_unique<PooledImage>();
    image->gpu = std::move(*gpu);
    image->serial = ++imagesMade_;
    image->layers.resize(info.layers, kFreshSync);
    image->savedLayers.resize(info.layers, kFreshSync);
    return image;
}

void ResourcePool::retire(std::unique_ptr<PooledImage> image)
{
    std::erase(touchedImages_, image.get());
    release(image->gpu, frame_);
}

void ResourcePool::touch(PooledImage& image)
{
    if (image.kept.savedFrame == frame_) return;
    image.kept.savedFrame = frame_;
    image.kept.savedStamp = image.kept.stamp;
    std::copy(image.layers.begin(), image.layers.end(), image.savedLayers.begin());
    touchedImages_.push_back(&image);
}

void ResourcePool::touch(PooledBuffer& buffer)
{
    if (buffer.kept.savedFrame == frame_) return;
    buffer.kept.savedFrame = frame_;
    buffer.kept.savedStamp = buffer.kept.stamp;
    buffer.savedSync = buffer.sync;
    touchedBuffers_.push_back(&buffer);
}

void ResourcePool::touch(BufferRing& ring)
{
    if (ring.savedFrame == frame_) return;
    ring.savedFrame = frame_;
    ring.savedCurrent = ring.current;
    touchedRings_.push_back(&ring);
}

void ResourcePool::withdraw()
{
    for (PooledImage* image : touchedImages_) {
        std::copy(image->savedLayers.begin(), image->savedLayers.end(), image->layers.begin());
        image->kept.stamp = image->kept.savedStamp;
        image->kept.savedFrame = image->kept.askedFrame = 0; // the frame may be submitted again
    }
    for (PooledBuffer* buffer : touchedBuffers_) {
        buffer->sync = buffer->savedSync;
        buffer->kept.stamp = buffer->kept.savedStamp;
        buffer->kept.savedFrame = buffer->kept.askedFrame = 0;
    }
    for (BufferRing* ring : touchedRings_) {
        ring->current = ring->savedCurrent;
        ring->savedFrame = ring->renewed = 0;
    }
    touchedImages_.clear();
    touchedBuffers_.clear();
    touchedRings_.clear();
}

} // namespace gnomon
