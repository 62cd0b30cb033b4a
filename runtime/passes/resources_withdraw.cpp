// How a frame that is not submitted, or not all of it, is taken back: what resources were before it, and what is lost.
#include <algorithm>

#include "runtime/passes/resources.hpp"

namespace gnomon {

namespace {

// Recorded barriers ran or did not: the next use comes after everything on the queue and takes nothing over.
constexpr SyncState kUnknownSync = kFreshSync;

} // namespace

void ResourcePool::touch(PooledImage& image)
{
    if (image.kept.savedFrame == frame_) return;
    image.kept.savedFrame = frame_;
    image.kept.savedStamp = image.kept.stamp;
    image.kept.savedParts = image.kept.parts;
    image.kept.savedUsed = image.kept.lastUsed;
    std::copy(image.layers.begin(), image.layers.end(), image.savedLayers.begin());
    touchedImages_.push_back(&image);
}

void ResourcePool::touch(PooledBuffer& buffer)
{
    if (buffer.kept.savedFrame == frame_) return;
    buffer.kept.savedFrame = frame_;
    buffer.kept.savedStamp = buffer.kept.stamp;
    buffer.kept.savedParts = buffer.kept.parts;
    buffer.kept.savedUsed = buffer.kept.lastUsed;
    buffer.savedSync = buffer.sync;
    touchedBuffers_.push_back(&buffer);
}

void ResourcePool::touch(BufferRing& ring)
{
    if (ring.savedFrame == frame_) return;
    ring.savedFrame = frame_;
    ring.savedCurrent = ring.current;
    ring.savedUsed = ring.lastUsed;
    touchedRings_.push_back(&ring);
}

void ResourcePool::withdraw(std::uint64_t frame)
{
    if (frame != frame_) return;
    ++structureLosses_;
    // The frame may be submitted again under its number, with all that it had to itself.
    const auto restore = [this](KeptState& kept) {
        kept.stamp = kept.savedStamp;
        kept.parts = kept.savedParts;
        kept.lastUsed = usedBefore(kept.savedUsed);
        kept.savedFrame = kept.askedFrame = 0;
    };
    for (PooledImage* image : touchedImages_) {
        std::copy(image->savedLayers.begin(), image->savedLayers.end(), image->layers.begin());
        restore(image->kept);
    }
    for (PooledBuffer* buffer : touchedBuffers_) {
        buffer->sync = buffer->savedSync;
        restore(buffer->kept);
    }
    for (BufferRing* ring : touchedRings_) {
        ring->current = ring->savedCurrent;
        ring->lastUsed = usedBefore(ring->savedUsed);
        ring->savedFrame = ring->renewed = 0;
    }
    for (auto& image : imports_)
        image->kept.lastUsed = 0;
    touchedImages_.clear();
    touchedBuffers_.clear();
    touchedRings_.clear();
}

void ResourcePool::abandon(std::uint64_t frame)
{
    if (frame != frame_) return;
    for (PooledImage* image : touchedImages_) {
        std::fill(image->savedLayers.begin(), image->savedLayers.end(), kUnknownSync);
        image->serial = ++imagesMade_; // stamps kept elsewhere, of layers that the frame left alone, hold no longer
        image->kept.savedStamp = 0;
        image->kept.savedParts = {};
    }
    for (PooledBuffer* buffer : touchedBuffers_) {
        buffer->savedSync = kUnknownSync;
        buffer->kept.savedStamp = 0;
        buffer->kept.savedParts = {};
    }
    withdraw(frame);
}

void ResourcePool::loseContent(PooledImage& image)
{
    std::fill(image.layers.begin(), image.layers.end(), kUnknownSync);
    image.serial = ++imagesMade_; // as above
    image.kept.lose();
}

void ResourcePool::lose(std::uint64_t frame)
{
    ++structureLosses_;
    for (auto& [key, image] : images_)
        if (image->kept.lastUsed >= frame) loseContent(*image);
    for (auto& image : transients_)
        if (image->kept.lastUsed >= frame) loseContent(*image);
    for (auto* map : {&buffers_, &transientBuffers_})
        for (auto& [key, ring] : *map)
            for (auto& version : ring.versions) {
                if (version->kept.lastUsed < frame) continue;
                version->sync = kUnknownSync;
                version->kept.lose();
            }
}

} // namespace gnomon
