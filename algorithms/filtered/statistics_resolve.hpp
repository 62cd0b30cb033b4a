#pragma once
// The full-screen pass that turns statistics of a light's depths into visibility.
#include <array>
#include <span>

#include "algorithms/shared/map_resolve.hpp"

namespace gnomon {

/// What a resolve shader is called and where its code is.
struct StatisticsResolveInfo {
    const char* name = "";                         ///< Pass and pipelines.
    std::span<const std::uint32_t> fragment, cube; ///< Specialization: 0 has normals, 1 the choice.
    std::uint32_t choices = 1;                     ///< Of specialization constant 1.
    bool levels = false;                           ///< Smaller maps of the statistics: binding 6.
};

class StatisticsResolve {
public:
    StatisticsResolve(const AlgorithmServices& services, const StatisticsResolveInfo& info);

    /// Writes the task's layer of visibility. Binding 5 has the statistics, 4 the depths that they are of.
    /// @param constants begin with those of mapConstants(); kept for the frame @param levels null without
    /// StatisticsResolveInfo::levels
    template <typename Constants>
    void declare(PassBuilder& passes, const ShadowTask& task, ImageId map, ImageId statistics,
                 const Constants& constants, std::uint32_t choice = 0, ImageId levels = {}) const
    {
        const LookupImages look(task, map);
        LookupPass pass(passes, task, name_, look);
        pass.uses.samples(statistics);
        if (levels && levels.index != statistics.index) pass.uses.samples(levels);
        const PipelineId pipeline = pipelines_[task.light->type == GN_LIGHT_TYPE_POINT][look.hasNormals][choice];
        pass.record([=, block = &constants](PassContext& gpu) {
            const std::array bound = {
                gpu.constants(0, *block),     gpu.sampled(2, look.depth),
                gpu.sampled(3, look.normals), gpu.sampled(4, look.map, SamplerKind::nearestBorderFar),
                gpu.sampled(5, statistics),   gpu.sampled(6, levels ? levels : statistics)};
            gpu.bind(pipeline, std::span(bound).first(bound.size() - (levels ? 0 : 1)));
        });
    }

private:
    const char* name_;
    PipelineId pipelines_[2][2][2]; ///< [point light][has normals][choice]
};

} // namespace gnomon
