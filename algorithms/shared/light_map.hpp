#pragma once
// The depth map of a light of any kind: one image for directional and spot lights, six faces around a point light.
#include <cstdint>
#include <span>

#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/map_lookup.hpp"

namespace gnomon {

/// What a directional or spot light's map covers; a point light's faces are whole.
enum class MapFit : std::uint8_t {
    whole, ///< All casters, or the cone.
    seen,  ///< The smallest rectangle around what the view sees of that (fitSeenMap()).
};
inline constexpr SettingSpec kFitSetting = {
    "fit", "0: the map covers all casters or the cone; 1: the smallest rectangle around what the view sees of that.", 0,
    1, 0};
constexpr MapFit mapFit(double setting)
{
    return setting >= 0.5 ? MapFit::seen : MapFit::whole;
}

/// A map as declared in this frame.
struct LightMap {
    ImageId image;                  ///< kMapFormat; a layer per fit.
    std::span<const LightFit> fits; ///< One or six; they live as long as the frame.
    std::uint32_t needed = 0;       ///< Bit i: a receiver of task.view can lie in layer i; other ones may be undefined.
    std::span<const std::uint64_t> stamps; ///< Of the content of the layers needed, for what is made of it.
    std::span<const KeptParts> parts;      ///< DepthMap's, of these.
    Scope scope = Scope::light;            ///< Of the map, and of what is made of it; task: it follows the view.
};

/// The projections of a light's map, for maps that are drawn in another way; memory from the arena.
std::span<const LightFit> fitLightMap(Clamped clamped, const ShadowTask& task, std::uint32_t resolution,
                                      FrameArena& arena);
/// LightMap::needed.
std::uint32_t neededLayers(const ShadowTask& task);

/// The map of a directional or spot light that covers what the view sees.
DepthMap declareSeenMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                        std::uint32_t resolution, std::uint32_t borderTexels);

/// Declares what is missing of the map (declareDepthMap, declareSeenMap, declareCubeMap) and adds to `constants`, from
/// mapConstants(), how receivers are found in it (shaders/shared/agreement.glsl).
LightMap declareLightMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, gpu::MapConstants& constants,
                         std::uint32_t borderTexels = kMapBorderTexels, MapFit fit = MapFit::whole);

/// What hosts are to find of a map with a layer per fit. @param constants with addLightProjection()
ShadowAlgorithm::Map handedOut(ImageId image, std::span<const LightFit> fits, std::uint32_t validLayers,
                               const gpu::MapConstants& constants);

} // namespace gnomon
