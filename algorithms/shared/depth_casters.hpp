#pragma once
// Drawing casters through a light's matrix, for every map with straight edges.
#include "algorithms/shared/box_cells.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/face_light.hpp"
#include "algorithms/shared/kept_map.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "runtime/scene/bias.hpp"

namespace gnomon {

/// What DepthMapPipelines are made of.
GraphicsPipelineInfo depthCasterPipeline(const AlgorithmServices& services);

/// Records casters into a layer of a depth map; what KeptMap::update takes. Copied bytewise.
class DepthCasters {
public:
    struct Push { ///< shaders/shared/caster_clip.glsl
        glm::mat4 clipFromZero;
        glm::vec4 zeroWs;
    };

    /// @param fit, task the fit and the light live as long as the frame's memory
    DepthCasters(const DepthMapPipelines& pipelines, const LightFit& fit, const ShadowTask& task,
                 std::uint32_t resolution, FrameArena& arena)
        : DepthCasters(pipelines, fit, task, resolution, arena, fit.volume)
    {
    }
    /// @param volume what of the casters is drawn: the fit's volume, or what holds more
    DepthCasters(const DepthMapPipelines& pipelines, const LightFit& fit, const ShadowTask& task,
                 std::uint32_t resolution, FrameArena& arena, std::span<const Plane> volume);
    void uses(PassRef&) const {}
    void operator()(PassContext& gpu, std::span<const Caster* const> casters, bool) const { record(gpu, casters, {}); }
    /// @param bindings of a pipeline that has more than depthCasterPipeline()
    void record(PassContext& gpu, std::span<const Caster* const> casters, std::span<const Bound> bindings) const;
    /// Whether clip z is drawn from depth 1 down (CasterDraw::depthFromOne).
    static bool fromOne(const Push& push) { return push.zeroWs.w != 0.0f; }
    /// For casters that are drawn from a place beside their own (DrawnPart::away).
    static Push moved(Push push, const glm::vec3& away)
    {
        push.zeroWs -= glm::vec4(away, 0.0f);
        return push;
    }
    /// Where their bounds fall; every cell where one reaches the light's plane.
    Cells cells(std::span<const Caster* const> casters) const;

private:
    PipelineId pipeline_;
    const LightView* light_;
    std::span<const Plane> volume_;
    Push push_{};
    const GnCasterProjection* host_ = nullptr; ///< In the frame's memory; null without host-drawn casters.
};

inline DepthCasters::Push casterPush(const MapProjection& projection)
{
    return {projection.clipFromZero, glm::vec4(projection.zeroWs, projection.depthConstant)};
}

} // namespace gnomon
