#pragma once
// The depth map of a directional or spot light: declared once per light and resolution, whoever asks (shadow_map,
// pcf_hybrid), and kept for as long as light and casters stand still.
#include <cstdint>

#include "algorithms/shared/kept_map.hpp"
#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"

namespace gnomon {

inline constexpr VkFormat kMapFormat = VK_FORMAT_D32_SFLOAT;

/// Which casters of a map are clamped to its near end where they are nearer, so that they cast on what lies beyond;
/// others are clipped.
enum class Clamped : std::uint8_t {
    none,
    own, ///< Gnomon's (depthClamp); pipelines of the host may clip.
    all, ///< The host draws none into the map.
};

/// Pipelines that draw casters into depth maps through a 4x4 matrix. Equal descriptions are one pipeline, so every
/// algorithm may hold a copy.
struct DepthMapPipelines {
    PipelineId casters;
    Clamped clamped = Clamped::none;
};
DepthMapPipelines makeDepthMapPipelines(const AlgorithmServices& services);

/// A map as declared in this frame.
///
/// Depth is DepthKind::clip of `fit`, 0 near to 1 far; texels without a caster hold 1. Closed casters appear with the
/// faces turned away from the light, open ones with both and a slope-scaled bias (runtime/scene/bias.hpp). A
/// directional map covers all casters: a receiver beside it is lit. A spot light's covers all its receivers and a
/// border for filters. One beyond the far end compares as depth 1. Where the device clamps depth, the near end may lie
/// past the nearest caster of gnomon's own (raiseNearEnd()); what is nearer appears as depth 0.
struct DepthMap {
    ImageId image;                 ///< kMapFormat, one layer, resolution x resolution.
    const LightFit* fit = nullptr; ///< Lives as long as the frame.
    std::uint32_t resolution = 0;
    std::uint64_t stamp = 0; ///< Of the content, for what is made of it; never 0.
    KeptParts parts;         ///< Cells of it that hold moving casters (shared/map_cells.hpp).
};

/// Texels between what a map has to cover, a cone's square or a cube's face, and its edge: as many as filters reach,
/// half of 7 and the fraction. Wider filters ask for more.
inline constexpr std::uint32_t kMapBorderTexels = 4;

/// How far the near end of the light's maps may be raised where casters are clamped (raiseNearEnd()), so that none that
/// may be clipped lies before it: metres, a power of two, so that not each step of a figure changes the map of the
/// static casters; infinite without such casters. The light has a position.
float nearLimit(Clamped clamped, const ShadowTask& task);

/// The projection of a directional or spot light's map of `resolution` texels; memory from the arena.
/// @param borderTexels around what has to be covered, at most a quarter of the side; a directional map has as many
///                     texels without casters around them where it is more than the standard
LightFit* fitDepthMap(Clamped clamped, const ShadowTask& task, std::uint32_t resolution, FrameArena& arena,
                      std::uint32_t borderTexels = kMapBorderTexels);

/// Declares what is missing of the map: nothing if light, casters and resolution are those of the content kept.
/// The light is directional or spot.
DepthMap declareDepthMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, std::uint32_t borderTexels = kMapBorderTexels);

/// KeptMapInfo::form of a map with that border. @param borderTexels below 2^8
constexpr std::uint32_t borderForm(std::uint32_t borderTexels)
{
    return borderTexels == kMapBorderTexels ? 0 : borderTexels;
}

/// What a map that follows a view is called, and the passes that draw it.
struct ViewMapNames {
    const char *depth, *statics, *stamp;
    LayerNames passes;
};

/// The same for a map of task scope, whose fit follows the view: it is drawn whenever `fit`, light or casters change.
/// @param fit in the frame's memory
DepthMap declareViewMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                        std::uint32_t resolution, const LightFit* fit, const ViewMapNames& names);

/// Maps around a light: six for a point light.
constexpr std::uint32_t mapLayers(GnLightType type)
{
    return type == GN_LIGHT_TYPE_POINT ? 6 : 1;
}

/// Device bytes of one map, a kept copy of the static casters included.
VkDeviceSize depthMapMemory(std::uint32_t resolution, std::uint32_t layers = 1);

/// The same as AlgorithmEntry::memoryPerLight, of methods whose first setting is the side of a light's map.
VkDeviceSize lightMapMemory(std::span<const double> settings, VkExtent2D extent, GnLightType type);

} // namespace gnomon
