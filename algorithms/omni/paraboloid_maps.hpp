#pragma once
// Maps of one or two paraboloids around a point light: casters cut finely enough, drawn into the parts that are needed,
// kept, and compared with the receivers. What the parts show is the method's to say.
#include <cstdint>
#include <span>

#include "algorithms/omni/cut_casters.hpp"
#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/kept_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/paraboloid_fit.hpp"
#include "shaders/omni/paraboloid_constants.h"

namespace gnomon {

/// What a method calls its map and its passes.
struct ParaboloidNames {
    const char* resolve;
    const char* depth;
    const char* statics;
    const char* stamp;
    LayerNames parts[2];
};

/// What the host sets of all of these methods.
struct ParaboloidSettings {
    std::uint32_t resolution;
    std::uint32_t filterSide; ///< Texels, odd.
    MapCulling culling;
    double contact; ///< kContactSetting
};

/// One per method.
class ParaboloidMaps {
public:
    ParaboloidMaps(const AlgorithmServices& services, const ParaboloidNames& names);

    /// Declares the parts that are out of date and the pass that writes the task's layer of visibility.
    /// @param reach distance of depth 1, metres: casterReach()
    void declare(PassBuilder& passes, const ShadowTask& task, const ParaboloidSet& set, float reach,
                 const ParaboloidSettings& settings);

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
    ContactShadows contact_;
    CasterCutter cutter_;
    ShadowAlgorithm::Map map_;
};

/// Device bytes of two parts.
inline VkDeviceSize paraboloidMemory(double resolution)
{
    return depthMapMemory(static_cast<std::uint32_t>(resolution), 2);
}

} // namespace gnomon
