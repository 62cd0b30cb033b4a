#pragma once
// Maps of one or two paraboloids around a point light: casters cut finely enough, drawn into the parts that are needed,
// kept, and compared with the receivers. What the parts show is the method's to say.
#include <cstdint>
#include <span>

#include "algorithms/omni/culling.hpp"
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

/// Setting of all of these methods, the second.
inline constexpr SettingSpec kParaboloidFilter{
    "filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1};

/// A method with such maps. Its settings begin with `resolution`, kParaboloidFilter and kCullingSetting, and end with
/// kContactSetting.
class ParaboloidMaps : public ShadowAlgorithm {
public:
    ParaboloidMaps(const AlgorithmServices& services, const ParaboloidNames& names);

    /// Declares the parts that are out of date and the pass that writes the task's layer of visibility.
    void declare(PassBuilder& passes, const ShadowTask& task) final;
    const Map* lightMap() const final { return &map_; }

    /// Of two parts.
    static VkDeviceSize memory(std::span<const double> settings, VkExtent2D extent, GnLightType type);

private:
    /// @param reach distance of depth 1, metres: casterReach()
    virtual ParaboloidSet partsOf(const ShadowTask& task, std::uint32_t resolution, float reach,
                                  MapCulling culling) const = 0;

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
    Map map_;
};

} // namespace gnomon
