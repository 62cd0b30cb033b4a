#include "algorithms/common/kept_map.hpp"

#include <array>

#include "runtime/vk/memory.hpp"

namespace gnomon {

namespace {
constexpr std::uint32_t kMaxLayers = 8;
} // namespace

LayerContent layerContent(const LightView& light, std::span<const Caster* const> statics,
                          std::span<const Caster* const> movings, std::uint64_t projectionStamp)
{
    LayerContent content{.statics = statics, .movings = movings};
    Stamp stamp;
    stamp.add(light.revision).add(projectionStamp).add(statics);
    if (light.isStatic && !statics.empty()) content.staticsStamp = stamp.value();
    content.stamp = stamp.add(movings).value();
    return content;
}

KeptMap::KeptMap(PassBuilder& passes, const KeptMapInfo& info) : passes_(passes), info_(info)
{
    image_ = passes.persistent(ImageInfo{.name = info.name,
                                         .scope = Scope::light,
                                         .format = info.format,
                                         .extent = {info.resolution, info.resolution},
                                         .layers = info.layers,
                                         .variant = info.variant()});
}

ImageInfo KeptMap::staticsInfo() const
{
    return {.name = info_.staticsName,
            .scope = Scope::light,
            .format = info_.format,
            .extent = {info_.resolution, info_.resolution},
            .layers = info_.layers,
            .variant = info_.variant()};
}

bool KeptMap::keepsApart(const LayerContent& content) const
{
    if (content.staticsStamp == 0 || content.movings.empty()) return false;
    return statics_ || passes_.hasRoomFor(passes_.missing(staticsInfo(), image_));
}

// A stamp belongs to a whole resource, layers need one each: the smallest buffer there is carries it.
BufferId KeptMap::carrier(std::uint32_t layer, ImageId image)
{
    const std::uint32_t slot = layer + (image.index == image_.index ? 0 : kMaxLayers);
    return passes_.persistent(BufferInfo{
        .name = info_.stampName, .scope = Scope::light, .size = 4, .variant = info_.variant() * 2 * kMaxLayers + slot});
}

// It may outlive the image, so the stamp is of this very image.
bool KeptMap::due(BufferId carrier, std::uint64_t stamp, ImageId image)
{
    return passes_.stale(carrier, Stamp().add(stamp).add(passes_.serial(image)).value());
}

void KeptMap::copyStatics(const char* name, std::uint32_t layer, Cells cells)
{
    const ImageId from = statics_, to = image_;
    const VkImageAspectFlags aspect = aspectsOf(info_.format);
    passes_.transfer(name, Scope::light, info_.variant())
        .copies(from, {.layer = layer})
        .writes(to, {.layer = layer})
        .record([=, side = info_.resolution](PassContext& gpu) {
            std::array<VkRect2D, 32> room;
            std::array<VkImageCopy2, 32> regions;
            std::uint32_t count = 0;
            for (const VkRect2D& rect : cellRegions(cells, side, room)) {
                const VkOffset3D at{rect.offset.x, rect.offset.y, 0};
                regions[count++] = {.sType = VK_STRUCTURE_TYPE_IMAGE_COPY_2,
                                    .srcSubresource = {aspect, 0, layer, 1},
                                    .srcOffset = at,
                                    .dstSubresource = {aspect, 0, layer, 1},
                                    .dstOffset = at,
                                    .extent = {rect.extent.width, rect.extent.height, 1}};
            }
            const VkCopyImageInfo2 info{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_INFO_2,
                                        .srcImage = gpu.image(from),
                                        .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                        .dstImage = gpu.image(to),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = count,
                                        .pRegions = regions.data()};
            gpu.vk->vkCmdCopyImage2(gpu.cmd, &info);
        });
}

} // namespace gnomon
