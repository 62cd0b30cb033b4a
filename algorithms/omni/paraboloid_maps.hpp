#pragma once
// Maps of one or two paraboloids around a point light: casters cut finely enough, drawn into the parts that are needed,
// kept, and compared with the receivers. What the parts show is the method's to say.
#include <array>
#include <cstdint>
#include <span>

#include "algorithms/omni/cut_casters.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/frusta.hpp"
#include "algorithms/shared/kept_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/omni/paraboloid_constants.h"

namespace gnomon {

/// Texels of a map's side that receivers just past its rim and 8 x 8 filters around them have at each end.
inline constexpr float kParaboloidBorderTexels = 5.0f;

/// How much of a map's half side is left for what it shows.
constexpr float innerShare(std::uint32_t resolution)
{
    return 1.0f - 2.0f * kParaboloidBorderTexels / static_cast<float>(resolution);
}

/// What the parts of a light's map show in one frame.
struct ParaboloidSet {
    std::array<gpu::Paraboloid, 2> parts{};
    std::array<std::array<Plane, 4>, 2> volumes{}; ///< Around all that a part shows; planes that are not needed are 0.
    glm::vec3 firstWs{0.0f};   ///< A receiver in direction v is in part 0 where dot(v, firstWs) >= 0, else in part 1.
    std::uint32_t needed = 3;  ///< Bit i: part i is drawn.
    std::uint32_t cutSide = 0; ///< Texels per side of two plain halves whose casters are cut as finely.
    bool followsView = false;  ///< The parts depend on the view: each view has a map of its own.
};

/// A plane through the light around directions v with dot(v, inward) >= -past, for casters at most `reach` away.
inline Plane planeThrough(glm::vec3 light, glm::vec3 inward, float past, float reach)
{
    return {inward, past * reach - glm::dot(inward, light)};
}

/// What a method calls its map and its passes.
struct ParaboloidNames {
    const char* resolve;
    const char* depth;
    const char* statics;
    const char* stamp;
    LayerNames parts[2];
};

/// One per method.
class ParaboloidMaps {
public:
    ParaboloidMaps(const AlgorithmServices& services, const ParaboloidNames& names);

    /// Declares the parts that are out of date and the pass that writes the task's layer of visibility.
    /// @param reach distance of depth 1, metres: casterReach()
    /// @param filterSide texels, odd
    void declare(PassBuilder& passes, const ShadowTask& task, const ParaboloidSet& set, std::uint32_t resolution,
                 float reach, std::uint32_t filterSide, MapCulling culling);

    const ShadowAlgorithm::Map& map() const { return map_; }

private:
    struct Pipelines {
        PipelineId objects; ///< Meshes through the table of transforms.
        PipelineId cut;     ///< World-space triangles.
    };
    struct Draw;
    static Pipelines makePipelines(const AlgorithmServices& services);
    ImageId declareParts(PassBuilder& passes, const ShadowTask& task, const ParaboloidSet& set,
                         std::uint32_t resolution, float reach, MapCulling culling);
    std::span<const Caster* const> fineOnes(std::span<const Caster* const> casters, const LightView& light,
                                            std::uint32_t cutSide, FrameArena& arena);

    const ParaboloidNames& names_;
    Pipelines pipelines_;
    MapResolve resolve_;
    CasterCutter cutter_;
    ShadowAlgorithm::Map map_;
};

/// Device bytes of two parts.
inline VkDeviceSize paraboloidMemory(double resolution)
{
    return depthMapMemory(static_cast<std::uint32_t>(resolution), 2);
}

} // namespace gnomon
