#include "runtime/passes/pass_builder.hpp"

#include <cassert>

#include "runtime/passes/area_copy.hpp"
#include "runtime/passes/pass_context.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/vk/memory.hpp"

namespace gnomon {

namespace {

AccessKind readOf(PassKind kind)
{
    switch (kind) {
    case PassKind::transfer:
        return AccessKind::copySource;
    case PassKind::prepare:
    case PassKind::host:
        return AccessKind::hostRead;
    default:
        return AccessKind::storageRead;
    }
}

AccessKind writeOf(PassKind kind, bool image, bool blend)
{
    switch (kind) {
    case PassKind::raster:
        return !image ? AccessKind::storageWrite : blend ? AccessKind::colorBlend : AccessKind::color;
    case PassKind::transfer:
        return AccessKind::copyTarget;
    case PassKind::prepare:
    case PassKind::host:
        return AccessKind::hostWrite;
    case PassKind::compute:
        break;
    }
    return AccessKind::storageWrite;
}

} // namespace

PassRef& PassRef::add(ImageId image, AccessKind kind, const Part& part)
{
    graph_.add(image.index, true, kind, part);
    return *this;
}
PassRef& PassRef::add(BufferId buffer, AccessKind kind)
{
    graph_.add(buffer.index, false, kind, {});
    return *this;
}
PassRef& PassRef::writes(ImageId image, Part part)
{
    return add(image, writeOf(graph_.pending_.kind, true, part.blend), part);
}
PassRef& PassRef::reads(BufferId buffer)
{
    return add(buffer, readOf(graph_.pending_.kind));
}
PassRef& PassRef::writes(BufferId buffer)
{
    return add(buffer, writeOf(graph_.pending_.kind, false, false));
}
PassRef& PassRef::updates(BufferId buffer)
{
    const bool cpu = graph_.pending_.kind == PassKind::prepare || graph_.pending_.kind == PassKind::host;
    return add(buffer, cpu ? AccessKind::hostWrite : AccessKind::storageUpdate);
}
PassRef& PassRef::area(Rect rect)
{
    graph_.pending_.area = rect;
    return *this;
}
void PassRef::finish(BodyFn fn, const void* body, std::size_t size, std::size_t alignment)
{
    graph_.close(fn, body, size, alignment);
}

PassRef PassBuilder::open(PassKind kind, const char* name, Scope scope, std::uint32_t variant)
{
    return graph_.open(kind, name, scope, variant);
}

namespace {
// Salts: a transient and a persistent resource of one name are two things.
constexpr std::uint64_t kTransientImage = 0x1, kPersistentImage = 0x2, kTransientBuffer = 0x3, kPersistentBuffer = 0x4;

// Frames without a change after which a list is copied to the GPU's own memory. The copy moves the whole buffer, a
// frame reads what is in it: about as much where that is every edge of a mesh, a hundredth where it is the silhouette
// of a fine one. So the one has cost eight copies by then, and the other's copy has paid for itself after seconds. With
// fewer frames, what moves every now and then would be copied at every halt.
constexpr std::uint64_t kSettledFrames = 8;
} // namespace

std::uint64_t PassGraph::key(const BufferInfo& info, bool persistent) const
{
    // A list and its copy in the GPU's own memory are two persistent buffers of one name.
    const std::uint64_t place = persistent && info.place == BufferPlace::device ? 0x100 : 0;
    return key(info.scope, info.name, info.variant, place | (persistent ? kPersistentBuffer : kTransientBuffer));
}

std::uint64_t PassGraph::key(const ImageInfo& info, bool persistent) const
{
    return key(info.scope, info.name, info.variant, persistent ? kPersistentImage : kTransientImage);
}

ImageId PassGraph::findOrMake(const ImageInfo& info, bool persistent)
{
    const std::uint64_t key = this->key(info, persistent);
    if (const std::uint32_t found = find(key); found != UINT32_MAX) {
        assert(fits(images_[found].pooled->gpu, info));
        return {found};
    }
    auto image = persistent ? pool_.persistentImage(key, info) : pool_.transientImage(key, info);
    if (!image) {
        fail(image.error());
        return {};
    }
    const ImageId id = addImage(**image, info.name);
    images_[id.index].keptDepths = persistent && (aspectsOf(info.format) & VK_IMAGE_ASPECT_DEPTH_BIT) != 0;
    store(key, id.index);
    return id;
}

BufferId PassGraph::findOrMake(const BufferInfo& info, bool persistent)
{
    const std::uint64_t key = this->key(info, persistent);
    if (const std::uint32_t found = find(key); found != UINT32_MAX) {
        assert(buffers_[found].info.size >= info.size && buffers_[found].info.place == info.place);
        return {found};
    }
    auto ring = persistent ? pool_.persistentBuffer(key, info) : pool_.transientBuffer(key, info);
    if (!ring) {
        fail(ring.error());
        return {};
    }
    buffers_.push_back({.key = key, .pooled = (*ring)->current, .ring = *ring, .info = info, .newest = UINT32_MAX});
    const auto index = static_cast<std::uint32_t>(buffers_.size() - 1);
    store(key, index);
    return {index};
}

ImageId PassBuilder::transient(const ImageInfo& info)
{
    return graph_.findOrMake(info, false);
}

ImageId PassBuilder::persistent(const ImageInfo& info)
{
    return graph_.findOrMake(info, true);
}

BufferId PassBuilder::transient(const BufferInfo& info)
{
    return graph_.findOrMake(info, false);
}

BufferId PassBuilder::persistent(const BufferInfo& info)
{
    return graph_.findOrMake(info, true);
}

BufferId PassBuilder::persistentIfPossible(const BufferInfo& info)
{
    if (!graph_.pool_.persistentBuffer(graph_.key(info, true), info)) return {};
    return persistent(info);
}

namespace {

void recordCopy(const PassContext& gpu, BufferId from, BufferId to, VkDeviceSize size)
{
    const VkBufferCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_COPY_2, .size = size};
    const VkCopyBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_INFO_2,
                                 .srcBuffer = gpu.buffer(from),
                                 .dstBuffer = gpu.buffer(to),
                                 .regionCount = 1,
                                 .pRegions = &region};
    gpu.vk->vkCmdCopyBuffer2(gpu.cmd, &copy);
}

} // namespace

bool PassGraph::answeredAgain(KeptState& kept, std::uint64_t stamp)
{
    if (!kept.answer || kept.stamp != 0) return kept.answer;
    taskStale_.push_back(&kept); // it may throw; nothing is promised yet
    kept.stamp = stamp;
    kept.parts = {};
    kept.since = pool_.frame();
    return true;
}

bool PassBuilder::stale(ImageId image, std::uint64_t stamp)
{
    if (!image) return true;
    KeptState& kept = graph_.images_[image.index].pooled->kept;
    if (kept.askedFrame == graph_.pool_.frame()) return graph_.answeredAgain(kept, stamp);
    const bool answer = kept.stamp != stamp;
    if (answer) graph_.taskStale_.push_back(&kept); // it may throw; nothing is promised yet
    kept.askedFrame = graph_.pool_.frame();
    kept.answer = answer;
    kept.stamp = stamp;
    return answer;
}

bool PassBuilder::stale(BufferId buffer, std::uint64_t stamp)
{
    if (!buffer) return true;
    FrameBuffer& entry = graph_.buffers_[buffer.index];
    KeptState& kept = entry.pooled->kept;
    if (kept.askedFrame == graph_.pool_.frame()) return graph_.answeredAgain(kept, stamp);
    if (kept.stamp == stamp) {
        kept.askedFrame = graph_.pool_.frame();
        kept.answer = false;
        return false;
    }
    // Fresh memory if anything in flight may still read the old content.
    if (!isGpuOnly(entry.pooled->place)) {
        if (auto renewed = graph_.pool_.replace(*entry.ring, entry.info); !renewed) {
            graph_.fail(renewed.error());
            return true;
        }
        entry.pooled = entry.ring->current;
    }
    KeptState& fresh = entry.pooled->kept;
    graph_.taskStale_.push_back(&fresh);
    fresh.askedFrame = graph_.pool_.frame();
    fresh.answer = true;
    fresh.stamp = stamp;
    fresh.parts = {};
    fresh.since = graph_.pool_.frame();
    return true;
}

KeptParts PassBuilder::parts(BufferId buffer) const
{
    return buffer ? graph_.buffers_[buffer.index].pooled->kept.parts : KeptParts{};
}

KeptParts PassBuilder::partsBefore(BufferId buffer) const
{
    return buffer ? graph_.buffers_[buffer.index].pooled->kept.savedParts : KeptParts{};
}

void PassBuilder::keepParts(BufferId buffer, const KeptParts& parts)
{
    if (buffer) graph_.buffers_[buffer.index].pooled->kept.parts = parts;
}

KeptList PassBuilder::keptList(const BufferInfo& info, std::uint64_t stamp)
{
    BufferInfo upload = info, own = info;
    upload.place = BufferPlace::upload;
    own.place = BufferPlace::device;
    ResourcePool& pool = graph_.pool_;
    if (pool.uploadIsFar() && pool.holds(graph_.key(own, true), info.size, stamp)) return {.buffer = persistent(own)};
    const BufferId list = persistent(upload);
    if (stale(list, stamp)) return {.buffer = list, .due = true};
    const bool settled = graph_.buffers_[list.index].pooled->kept.since + kSettledFrames <= frame();
    if (!pool.uploadIsFar() || !settled || !pool.hasRoomFor(info.size)) return {.buffer = list};
    const BufferId copy = persistentIfPossible(own);
    if (!copy) return {.buffer = list};
    if (!stale(copy, stamp)) return {.buffer = copy};
    transfer(info.name, info.scope, info.variant)
        .reads(list)
        .writes(copy)
        .record([=, size = info.size](PassContext& gpu) { recordCopy(gpu, list, copy, size); });
    return {.buffer = copy};
}

VkDeviceSize PassBuilder::missing(const BufferInfo& info) const
{
    return graph_.pool_.keeps(graph_.key(info, true), info.size) ? 0 : pooledSize(info);
}

VkDeviceSize PassBuilder::missing(const ImageInfo& info, ImageId twin) const
{
    if (!twin || graph_.pool_.keeps(graph_.key(info, true), info)) return 0;
    return graph_.images_[twin.index].pooled->gpu.memory.size;
}

bool PassBuilder::hasRoomFor(VkDeviceSize bytes) const
{
    return bytes == 0 || graph_.pool_.hasRoomFor(bytes);
}

bool PassBuilder::holds(const BufferInfo& info, std::uint64_t stamp) const
{
    return graph_.pool_.holds(graph_.key(info, true), info.size, stamp);
}

KeptParts PassBuilder::parts(const BufferInfo& info) const
{
    return graph_.pool_.parts(graph_.key(info, true), info.size);
}

std::uint64_t PassBuilder::structureLosses() const
{
    return graph_.pool_.structureLosses();
}

std::uint64_t PassBuilder::serial(ImageId image) const
{
    return image ? graph_.images_[image.index].pooled->serial : 0;
}

std::uint64_t PassBuilder::frame() const
{
    return graph_.pool_.frame();
}

std::uint64_t PassBuilder::completedFrame() const
{
    return graph_.pool_.completed();
}

void PassBuilder::kept(std::uint32_t count)
{
    graph_.taskCounts_.kept += count;
}

void PassBuilder::pages(std::uint32_t evicted, std::uint32_t withoutRoom)
{
    graph_.taskCounts_ += {.pagesEvicted = evicted, .pagesWithoutRoom = withoutRoom};
}

void PassBuilder::fail(const Error& error)
{
    graph_.fail(error);
}

bool PassBuilder::has(ImageId image, std::uint32_t firstLayer, std::uint32_t layers) const
{
    if (image.index >= graph_.images_.size()) return false;
    const std::size_t count = graph_.images_[image.index].pooled->layers.size();
    return firstLayer < count && layers <= count - firstLayer;
}

bool PassBuilder::has(BufferId buffer) const
{
    return buffer.index < graph_.buffers_.size();
}

bool PassBuilder::isHosts(ImageId image) const
{
    return graph_.images_[image.index].pooled->imported;
}

VkDeviceAddress PassBuilder::address(BufferId buffer) const
{
    return buffer ? graph_.buffer(buffer).gpu.address : 0;
}

VkExtent2D PassBuilder::extent(ImageId image) const
{
    return graph_.images_[image.index].pooled->gpu.extent;
}

VkFormat PassBuilder::format(ImageId image) const
{
    return graph_.images_[image.index].pooled->gpu.format;
}

FrameArena& PassBuilder::arena()
{
    return graph_.arena_;
}

BufferId PassGraph::hostCopy(ImageId image, const char* name, VkDeviceSize texelSize)
{
    PassBuilder builder(*this);
    const VkExtent2D extent = this->image(image).gpu.extent;
    const BufferId buffer = builder.transient(BufferInfo{.name = name,
                                                         .scope = Scope::view,
                                                         .size = texelSize * extent.width * extent.height,
                                                         .place = BufferPlace::readback});
    const VkImageAspectFlags aspect = aspectsOf(this->image(image).gpu.format) & ~VK_IMAGE_ASPECT_STENCIL_BIT;
    const VkBufferImageCopy2 region = areaCopy(view_->area, aspect, extent.width, texelSize);
    builder.transfer(name, Scope::view).copies(image).writes(buffer).record([=](PassContext& gpu) {
        const VkCopyImageToBufferInfo2 info{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                            .srcImage = gpu.image(image),
                                            .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                            .dstBuffer = gpu.buffer(buffer),
                                            .regionCount = 1,
                                            .pRegions = &region};
        gpu.vk->vkCmdCopyImageToBuffer2(gpu.cmd, &info);
    });
    return buffer;
}

BufferId PassBuilder::depthOnHost()
{
    return graph_.hostCopy(graph_.depth_, "view.depth_readback", sizeof(float));
}

BufferId PassBuilder::normalsOnHost()
{
    if (!graph_.normals_) return {};
    const VkFormat format = graph_.image(graph_.normals_).gpu.format;
    return graph_.hostCopy(graph_.normals_, "view.normals_readback", format == VK_FORMAT_R32G32B32A32_SFLOAT ? 16 : 8);
}

} // namespace gnomon
