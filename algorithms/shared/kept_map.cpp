#include "algorithms/shared/kept_map.hpp"

#include "runtime/vk/memory.hpp"

namespace gnomon {

LayerContent layerContent(const LightView& light, std::span<const Caster* const> statics,
                          std::span<const Caster* const> dynamics, std::uint64_t projectionStamp)
{
    LayerContent content{.statics = statics, .dynamics = dynamics};
    Stamp stamp;
    stamp.add(light.revision).add(projectionStamp).add(statics);
    if (light.isStatic && !statics.empty()) content.staticsStamp = stamp.value();
    content.stamp = stamp.add(dynamics).value();
    return content;
}

KeptMap::KeptMap(PassBuilder& passes, const KeptMapInfo& info) : passes_(passes), info_(info)
{
    image_ = passes.persistent(ImageInfo{.name = info.name,
                                         .scope = info.scope,
                                         .format = info.format,
                                         .extent = {info.resolution, info.resolution},
                                         .layers = info.layers,
                                         .variant = info.variant()});
}

ImageInfo KeptMap::staticsInfo() const
{
    return {.name = info_.staticsName,
            .scope = info_.scope,
            .format = info_.format,
            .extent = {info_.resolution, info_.resolution},
            .layers = info_.layers,
            .variant = info_.variant()};
}

bool KeptMap::keepsApart(const LayerContent& content) const
{
    if (content.staticsStamp == 0 || content.dynamics.empty()) return false;
    return statics_ || passes_.hasRoomFor(passes_.missing(staticsInfo(), image_));
}

// A stamp belongs to a whole resource, layers need one each: the smallest buffer there is carries it.
BufferId KeptMap::carrier(std::uint32_t layer, ImageId image)
{
    const std::uint32_t slot = layer + (image.index == image_.index ? 0 : kMaxKeptLayers);
    return passes_.persistent(BufferInfo{.name = info_.stampName,
                                         .scope = info_.scope,
                                         .size = 4,
                                         .variant = info_.variant() * 2 * kMaxKeptLayers + slot});
}

void KeptMap::keepOthers()
{
    for (std::uint32_t layer = 0; layer < info_.layers; ++layer) {
        carrier(layer, image_);
        if (statics_) carrier(layer, statics_);
    }
}

// It may outlive the image, so the stamp is of this very image.
bool KeptMap::due(BufferId carrier, std::uint64_t stamp, ImageId image)
{
    return passes_.stale(carrier, Stamp().add(stamp).add(passes_.serial(image)).value());
}

void KeptMap::copyStatics(const char* name, std::uint32_t layer, Cells cells)
{
    declareCellCopy(passes_, {.name = name,
                              .scope = info_.scope,
                              .variant = passVariant(layer),
                              .from = statics_,
                              .to = image_,
                              .fromLayer = layer,
                              .toLayer = layer,
                              .aspect = aspectsOf(info_.format),
                              .side = info_.resolution,
                              .cells = cells});
}

} // namespace gnomon
