#include "algorithms/hybrid/host_map.hpp"

#include <array>
#include <bit>

#include "runtime/passes/area_copy.hpp"

namespace gnomon {

bool classifiesOnHost(double setting, const DeviceTable& vk, const ShadowTask& task)
{
    const bool wanted = setting == 1.0 || (setting == 2.0 && vk.software);
    return wanted && task.normals && !task.recorded;
}

namespace {

constexpr VkDeviceSize kTexelBytes = 4;

} // namespace

void declareLayerCopy(PassBuilder& passes, const LayerCopy& copy)
{
    passes.transfer(copy.name, copy.scope, copy.variant)
        .copies(copy.from, {.layer = copy.layer})
        .writes(copy.to)
        .record([copy](PassContext& gpu) {
            std::array<VkRect2D, 32> room;
            std::array<VkBufferImageCopy2, 32> regions;
            std::uint32_t count = 0;
            for (const VkRect2D& area : cellRegions(copy.cells, copy.side, room)) {
                regions[count] = areaCopy(area, copy.aspect, copy.side, kTexelBytes);
                regions[count++].imageSubresource.baseArrayLayer = copy.layer;
            }
            const VkCopyImageToBufferInfo2 info{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                                .srcImage = gpu.image(copy.from),
                                                .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                                .dstBuffer = gpu.buffer(copy.to),
                                                .regionCount = count,
                                                .pRegions = regions.data()};
            gpu.vk->vkCmdCopyImageToBuffer2(gpu.cmd, &info);
        });
}

namespace {

std::uint32_t variantOf(std::uint32_t resolution, std::uint32_t layer)
{
    return resolution * 8 + layer;
}

BufferInfo bufferOf(const LightMap& map, std::uint32_t resolution, std::uint32_t layer)
{
    return {.name = "light_map.on_host",
            .scope = map.scope,
            .size = kTexelBytes * resolution * resolution,
            .place = BufferPlace::readback,
            .variant = variantOf(resolution, layer)};
}

} // namespace

HostMapCopy declareHostMap(PassBuilder& passes, const LightMap& map, std::uint32_t resolution)
{
    HostMapCopy result{.layers = static_cast<std::uint32_t>(map.fits.size()), .needed = map.needed, .depth = {}};
    for (std::uint32_t bits = map.needed; bits != 0; bits &= bits - 1) {
        const auto layer = static_cast<std::uint32_t>(std::countr_zero(bits));
        result.depth[layer] = passes.persistent(bufferOf(map, resolution, layer));
        if (!passes.stale(result.depth[layer], map.stamps[layer])) {
            passes.kept();
            continue;
        }
        const KeptParts& parts = map.parts[layer];
        const Cells cells = changedCells(passes.partsBefore(result.depth[layer]), parts);
        passes.keepParts(result.depth[layer], parts);
        if (cells == 0) { // what moved stays beside the map
            passes.kept();
            continue;
        }
        declareLayerCopy(passes, {.name = "light_map.copy_to_host",
                                  .from = map.image,
                                  .layer = layer,
                                  .to = result.depth[layer],
                                  .side = resolution,
                                  .variant = variantOf(resolution, layer),
                                  .cells = cells,
                                  .scope = map.scope});
    }
    return result;
}

VkDeviceSize missingHostMap(const PassBuilder& passes, const LightMap& map, std::uint32_t resolution)
{
    VkDeviceSize bytes = 0;
    for (std::uint32_t bits = map.needed; bits != 0; bits &= bits - 1)
        bytes += passes.missing(bufferOf(map, resolution, static_cast<std::uint32_t>(std::countr_zero(bits))));
    return bytes;
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

simd::MapLookup mapLookupOf(const gpu::MapConstants& constants, bool cube)
{
    const gpu::MapLookup& look = constants.map;
    simd::MapLookup result{};
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
    if (cube) {
        result.inverseSlope = 1.0f / look.slope;
        result.perTexel = 2.0f * look.slope / look.side;
    }
    result.side = static_cast<std::uint32_t>(look.side);
    result.cube = cube;
    return result;
}

simd::MapLookup HostMapCopy::onHost(const HostContext& context, const gpu::MapConstants& constants) const
{
    simd::MapLookup result = mapLookupOf(constants, layers > 1);
    for (std::uint32_t bits = needed; bits != 0; bits &= bits - 1) {
        const auto layer = static_cast<std::size_t>(std::countr_zero(bits));
        result.depth[layer] = context.read<float>(depth[layer]).data();
    }
    return result;
}

} // namespace gnomon
