#pragma once
// The full-screen pass that asks a map and its bounds for a light's disc (shaders/shared/blocker_search.glsl).
#include <span>

#include "algorithms/shared/depth_bounds.hpp"
#include "algorithms/shared/map_resolve.hpp"

namespace gnomon {

class DiscResolve {
public:
    /// @param name of pass and pipelines. fragment, cube: specialization 0 has normals; binding 1 the bounds
    DiscResolve(const AlgorithmServices& services, const char* name, std::span<const std::uint32_t> fragment,
                std::span<const std::uint32_t> cube);

    /// Writes the task's layer of visibility. @param constants begin with those of mapConstants()
    template <typename Constants>
    void declare(PassBuilder& passes, const ShadowTask& task, ImageId map, BufferId bounds,
                 const Constants& constants) const
    {
        const LookupImages look(task, map);
        const PipelineId pipeline = pipelines_[task.light->type == GN_LIGHT_TYPE_POINT][look.hasNormals];
        const Constants* block = passes.arena().make(constants);
        LookupPass pass(passes, task, name_, look);
        pass.uses.reads(bounds);
        pass.record([=](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, *block), gpu.storage(1, bounds), gpu.sampled(2, look.depth),
                                gpu.sampled(3, look.normals), gpu.sampled(4, look.map, SamplerKind::nearestBorderFar)});
        });
    }

private:
    const char* name_;
    PipelineId pipelines_[2][2]; ///< [point light][has normals]
};

/// Why a map of that side cannot be searched for the light's blockers, or null.
const char* refusesSearch(const DeviceTable& vk, const ShadowTask& task, std::uint32_t resolution);

} // namespace gnomon
