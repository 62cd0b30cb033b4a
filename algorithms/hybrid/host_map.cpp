#include "algorithms/hybrid/host_map.hpp"

#include <bit>

namespace gnomon {

bool classifiesOnHost(double setting, const DeviceTable& vk, const ShadowTask& task)
{
    const bool wanted = setting == 1.0 || (setting == 2.0 && vk.software);
    return wanted && task.normals && !task.recorded;
}

void declareLayerCopy(PassBuilder& passes, const LayerCopy& copy)
{
    passes.transfer(copy.name, Scope::light, copy.variant)
        .copies(copy.from, {.layer = copy.layer})
        .writes(copy.to)
        .record([copy](PassContext& gpu) {
            const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                            .imageSubresource = {copy.aspect, 0, copy.layer, 1},
                                            .imageExtent = {copy.side, copy.side, 1}};
            const VkCopyImageToBufferInfo2 info{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                                .srcImage = gpu.image(copy.from),
                                                .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                                .dstBuffer = gpu.buffer(copy.to),
                                                .regionCount = 1,
                                                .pRegions = &region};
            gpu.vk->vkCmdCopyImageToBuffer2(gpu.cmd, &info);
        });
}

HostMapCopy declareHostMap(PassBuilder& passes, const LightMap& map, std::uint32_t resolution)
{
    HostMapCopy result{.layers = static_cast<std::uint32_t>(map.fits.size()), .needed = map.needed, .depth = {}};
    for (std::uint32_t layer = 0; layer < result.layers; ++layer) {
        if ((map.needed >> layer & 1) == 0) continue;
        const std::uint32_t variant = resolution * 8 + layer;
        result.depth[layer] = passes.persistent(BufferInfo{.name = "light_map.on_host",
                                                           .scope = Scope::light,
                                                           .size = VkDeviceSize{4} * resolution * resolution,
                                                           .place = BufferPlace::readback,
                                                           .variant = variant});
        if (!passes.stale(result.depth[layer], map.stamps[layer])) {
            passes.kept();
            continue;
        }
        declareLayerCopy(passes, {.name = "light_map.copy_to_host",
                                  .from = map.image,
                                  .layer = layer,
                                  .to = result.depth[layer],
                                  .side = resolution,
                                  .variant = variant});
    }
    return result;
}

void HostMapCopy::uses(PassRef& host) const
{
    for (std::uint32_t bits = needed; bits != 0; bits &= bits - 1)
        host.reads(depth[std::countr_zero(bits)]);
}

namespace {

template <int Count>
void copyTo(float (&to)[Count], const glm::vec4& from)
{
    for (int i = 0; i < Count; ++i)
        to[i] = from[i];
}

} // namespace

lanes::MapLook HostMapCopy::onHost(const HostContext& context, const gpu::MapConstants& constants) const
{
    const gpu::MapLook& look = constants.map;
    lanes::MapLook result{};
    copyTo(result.clipOfEye, look.clipOfEye);
    for (int column = 0; column < 3; ++column)
        copyTo(result.clipFromRay[column], look.clipFromRay[column]);
    copyTo(result.texelDx, look.texelDx);
    copyTo(result.texelDy, look.texelDy);
    copyTo(result.axis, look.axisWs);
    copyTo(result.eyeFromLight, look.eyeFromLight);
    copyTo(result.offset, look.offset);
    result.depthConstant = look.depthConstant;
    result.depthScale = look.depthScale;
    result.positional = look.positional;
    if (layers > 1) {
        result.inverseSlope = 1.0f / look.slope;
        result.perTexel = 2.0f * look.slope / look.side;
    }
    result.side = static_cast<std::uint32_t>(look.side);
    result.cube = layers > 1;
    for (std::uint32_t bits = needed; bits != 0; bits &= bits - 1) {
        const auto layer = static_cast<std::size_t>(std::countr_zero(bits));
        result.depth[layer] = context.read<float>(depth[layer]).data();
    }
    return result;
}

VkDeviceSize hostMapMemory(std::uint32_t resolution, std::uint32_t layers)
{
    return layers * pooledSize(VkDeviceSize{4} * resolution * resolution);
}

} // namespace gnomon
