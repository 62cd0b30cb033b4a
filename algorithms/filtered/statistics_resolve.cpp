#include "algorithms/filtered/statistics_resolve.hpp"

#include <algorithm>

#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

StatisticsResolve::StatisticsResolve(const AlgorithmServices& services, const StatisticsResolveInfo& info)
    : name_(info.name)
{
    for (const bool cube : {false, true}) {
        const std::array look = lookupBindings(cube);
        std::array<BindingInfo, look.size() + 2> bindings{};
        std::ranges::copy(look, bindings.begin());
        bindings[look.size()] = {.binding = 5,
                                 .kind = BindingKind::sampledImage,
                                 .format = VK_FORMAT_R32G32B32A32_UINT,
                                 .array = true,
                                 .powerOfTwo = true};
        bindings.back() = bindings[look.size()];
        bindings.back().binding = 6;
        GraphicsPipelineInfo pipeline;
        pipeline.name = info.name;
        pipeline.vertex.code = k_shared_map_resolve_vert;
        pipeline.fragment.code = cube ? info.cube : info.fragment;
        pipeline.fragment.specializationCount = 2;
        pipeline.bindings = std::span(bindings).first(bindings.size() - (info.levels ? 0 : 1));
        pipeline.colorFormat = VK_FORMAT_R8_UNORM;
        for (const bool normals : {false, true}) {
            for (std::uint32_t choice = 0; choice < info.choices; ++choice) {
                pipeline.fragment.specialization[0] = normals;
                pipeline.fragment.specialization[1] = choice;
                pipelines_[cube][normals][choice] = services.pipelines->graphics(pipeline);
            }
        }
    }
}

} // namespace gnomon
