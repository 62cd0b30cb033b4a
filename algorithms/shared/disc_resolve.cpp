#include "algorithms/shared/disc_resolve.hpp"

#include <algorithm>

#include "algorithms/shared/source_size.hpp"
#include "shaders/shared_map_resolve_vert.h"

namespace gnomon {

DiscResolve::DiscResolve(const AlgorithmServices& services, const char* name, std::span<const std::uint32_t> fragment,
                         std::span<const std::uint32_t> cube)
    : name_(name)
{
    for (const bool layers : {false, true}) {
        const std::array lookup = lookupBindings(layers);
        std::array<BindingInfo, lookup.size() + 1> bindings{};
        std::ranges::copy(lookup, bindings.begin());
        bindings.back() = {.binding = 1, .kind = BindingKind::storageBuffer};
        GraphicsPipelineInfo pipeline;
        pipeline.name = name;
        pipeline.vertex.code = k_shared_map_resolve_vert;
        pipeline.fragment.code = layers ? cube : fragment;
        pipeline.fragment.specializationCount = 1;
        pipeline.bindings = bindings;
        pipeline.colorFormat = VK_FORMAT_R8_UNORM;
        for (const bool normals : {false, true}) {
            pipeline.fragment.specialization[0] = normals;
            pipelines_[layers][normals] = services.pipelines->graphics(pipeline);
        }
    }
}

const char* refusesSearch(const DeviceTable& vk, const ShadowTask& task, std::uint32_t resolution)
{
    if (DepthBounds::memory(resolution, mapLayers(task.light->type)) > vk.properties.limits.maxStorageBufferRange)
        return "its depth bounds are larger than a storage buffer may be";
    return refusesDisc(*task.light);
}

} // namespace gnomon
