#pragma once
// A light's map of one or more layers that keeps its content: each layer is drawn again only when its own stamp
// changes, and static casters of a static light are drawn once and copied under the moving ones.
#include <cstdint>
#include <span>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/map_cells.hpp"
#include "runtime/algorithm.hpp"

namespace gnomon {

struct KeptMapInfo {
    const char* name = "";        ///< Of the image that is sampled.
    const char* staticsName = ""; ///< Of the static casters' image.
    const char* stampName = "";   ///< Of the stamps.
    VkFormat format = VK_FORMAT_D32_SFLOAT;
    std::uint32_t resolution = 0; ///< Square; below 2^14.
    std::uint32_t layers = 1;     ///< At most kMaxKeptLayers.
    std::uint32_t form = 0;       ///< Which of maps that differ in more than their resolution; below 2^8.
    Scope scope = Scope::light;   ///< Task: the map depends on the view.

    /// Of all resources and passes: two methods may ask for a light's map in one frame, each in its own way.
    std::uint32_t variant() const { return form << 14 | resolution; }
};
inline constexpr std::uint32_t kMaxKeptLayers = 256;

/// Pass names of one layer, or of many.
struct LayerNames {
    const char* casters; ///< All casters, or the moving ones over the copy.
    const char* statics;
    const char* copyStatics;
};

/// What belongs into one layer.
struct LayerContent {
    std::span<const Caster*const> statics, dynamics; ///< Culled to the layer; alive during the frame.
    std::uint64_t stamp = 0;                         ///< Of everything in the layer.
    std::uint64_t staticsStamp = 0;                  ///< Without the moving casters; 0: do not keep them apart.
};

/// A layer with these casters. Static ones are kept apart for static lights: a copy takes no longer than the clear that
/// it replaces (a software device: 0.33 and 0.4 ns a texel), and drawing them again comes on top (150 ns a triangle
/// and 1.5 to 2 ns a texel they cover).
/// @param projectionStamp whatever the projection depends on besides the light.
LayerContent layerContent(const LightView& light, std::span<const Caster* const> statics,
                          std::span<const Caster* const> dynamics, std::uint64_t projectionStamp);

/// Declared per task and frame; the resources and passes behind it exist once per light, or once per task. The image of
/// the static casters only saves time: where nothing would have room for it, all casters are drawn together.
class KeptMap {
public:
    KeptMap(PassBuilder& passes, const KeptMapInfo& info);

    ImageId image() const { return image_; }

    /// Declares what brings the layer up to date; one that is not asked for may hold anything.
    /// @param draw  `draw(PassContext&, casters, bool statics)` records casters, the static or the moving ones of the
    ///              content; `draw.uses(PassRef&)` declares what else it reads. Copied bytewise. Where it has
    ///              `draw.prepared(PassBuilder&, statics, dynamics)`, passes that come before may be declared there for
    ///              the casters about to be drawn; what it returns draws. Where it has `draw.cells(dynamics)`, moving
    ///              casters cover no texel of other cells, and only cells that they leave are copied.
    /// @return      where the layer holds moving casters, for what is made of it
    template <typename Draw>
    KeptParts update(std::uint32_t layer, const LayerNames& names, const LayerContent& content, const Draw& draw);

    /// After the updates, for maps of which layers are asked that were not asked for long: what goes with the others is
    /// there from the first frame on, and stays.
    void keepOthers();

private:
    BufferId carrier(std::uint32_t layer, ImageId image);
    bool due(BufferId carrier, std::uint64_t stamp, ImageId image);
    void copyStatics(const char* name, std::uint32_t layer, Cells cells);
    std::uint32_t passVariant(std::uint32_t layer) const { return info_.variant() * kMaxKeptLayers + layer; }
    /// Variant of the pass that draws over the copy: not the pass that draws all casters, which a task before this one
    /// declares where it still finds no room.
    static constexpr std::uint32_t kOverCopy = 1u << 31;

    ImageInfo staticsInfo() const;
    bool keepsApart(const LayerContent& content) const;

    PassBuilder& passes_;
    KeptMapInfo info_;
    ImageId image_, statics_;
};

/// The drawing of a pass that is about to be declared.
template <typename Draw>
Draw preparedDraw(const Draw& draw, PassBuilder& passes, std::span<const Caster* const> statics,
                  std::span<const Caster* const> dynamics)
{
    if constexpr (requires { draw.prepared(passes, statics, dynamics); })
        return draw.prepared(passes, statics, dynamics);
    else
        return draw;
}

/// What moving casters may draw into.
template <typename Draw>
Cells coveredCells(const Draw& draw, std::span<const Caster* const> dynamics)
{
    if constexpr (requires { draw.cells(dynamics); })
        return draw.cells(dynamics);
    else
        return kAllCells;
}

template <typename Draw>
KeptParts KeptMap::update(std::uint32_t layer, const LayerNames& names, const LayerContent& content, const Draw& draw)
{
    const Part cleared{.layer = layer, .clear = true, .value = {.depthStencil = {1.0f, 0}}};
    const BufferId whole = carrier(layer, image_);
    if (!due(whole, content.stamp, image_)) {
        passes_.kept();
        return passes_.parts(whole);
    }
    const std::uint32_t variant = passVariant(layer);
    if (!keepsApart(content)) {
        const Draw both = preparedDraw(draw, passes_, content.statics, content.dynamics);
        PassRef all = passes_.raster(names.casters, info_.scope, variant);
        both.uses(all.depthWrite(image_, cleared));
        all.record([=, statics = content.statics, dynamics = content.dynamics](PassContext& gpu) {
            both(gpu, statics, true);
            both(gpu, dynamics, false);
        });
        return {};
    }
    if (!statics_) statics_ = passes_.persistent(staticsInfo());
    if (due(carrier(layer, statics_), content.staticsStamp, statics_)) {
        const Draw first = preparedDraw(draw, passes_, content.statics, {});
        PassRef still = passes_.raster(names.statics, info_.scope, variant);
        first.uses(still.depthWrite(statics_, cleared));
        still.record([=, statics = content.statics](PassContext& gpu) { first(gpu, statics, true); });
    } else {
        passes_.kept();
    }
    const KeptParts parts{Stamp().add(content.staticsStamp).add(passes_.serial(image_)).value(),
                          coveredCells(draw, content.dynamics)};
    if (const Cells cells = changedCells(passes_.partsBefore(whole), {parts.base, 0}); cells != 0)
        copyStatics(names.copyStatics, layer, cells);
    passes_.keepParts(whole, parts);
    const Draw second = preparedDraw(draw, passes_, {}, content.dynamics);
    PassRef over = passes_.raster(names.casters, info_.scope, variant | kOverCopy);
    second.uses(over.depthWrite(image_, {.layer = layer}));
    over.record([=, dynamics = content.dynamics](PassContext& gpu) { second(gpu, dynamics, false); });
    return parts;
}

} // namespace gnomon
