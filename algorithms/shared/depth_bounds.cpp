#include "algorithms/shared/depth_bounds.hpp"

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/source_size.hpp"
#include "shaders/shared/depth_bounds.h"
#include "shaders/shared_depth_bounds_comp.h"

namespace gnomon {

namespace {

constexpr const char* kNames[gpu::BOUNDS_LEVELS] = {"depth_bounds.4",    "depth_bounds.16",   "depth_bounds.64",
                                                    "depth_bounds.256",  "depth_bounds.1024", "depth_bounds.4096",
                                                    "depth_bounds.16384"};

/// Of one layer.
std::uint32_t squaresOf(std::uint32_t side)
{
    std::uint32_t squares = 0;
    while (side > 1) {
        side = gpu::boundsSide(side);
        squares += side * side;
    }
    return squares;
}

} // namespace

DepthBounds::DepthBounds(const AlgorithmServices& services)
    : reduce_(services.pipelines->compute("depth_bounds.reduce", {k_shared_depth_bounds_comp},
                                          {bufferAt(0), mapAt(1, kMapFormat)}, sizeof(gpu::DepthBoundsPush)))
{
}

VkDeviceSize DepthBounds::memory(std::uint32_t resolution, std::uint32_t layers)
{
    return pooledSize(sizeof(glm::vec2) * VkDeviceSize{squaresOf(resolution)} * layers);
}

BufferId DepthBounds::declare(PassBuilder& passes, const LightMap& map, std::uint32_t resolution) const
{
    const auto layers = static_cast<std::uint32_t>(map.fits.size());
    const std::uint32_t squares = squaresOf(resolution);
    // Of the task: views need other faces of a cube.
    const BufferId buffer = passes.persistent(
        BufferInfo{.name = "depth_bounds", .size = sizeof(glm::vec2) * squares * layers, .variant = resolution});
    Stamp stamp;
    stamp.add(passes.serial(map.image)).add(std::uint64_t{map.needed});
    for (std::uint32_t layer = 0; layer < layers; ++layer)
        if ((map.needed >> layer & 1) != 0) stamp.add(map.stamps[layer]);
    if (!passes.stale(buffer, stamp.value())) {
        passes.kept();
        return buffer;
    }
    std::uint32_t side = resolution, below = 0, first = 0;
    for (std::uint32_t level = 0; side > 1; ++level) {
        const gpu::DepthBoundsPush push{.side = side, .below = below, .first = first, .fromMap = level == 0};
        const std::uint32_t row = gpu::boundsSide(side);
        passes.compute(kNames[level])
            .samples(map.image)
            .updates(buffer)
            .record([=, reduce = reduce_, image = map.image, needed = map.needed](PassContext& gpu) {
                const std::uint32_t groups = (row + gpu::BOUNDS_GROUP - 1) / gpu::BOUNDS_GROUP;
                for (std::uint32_t layer = 0; layer < layers; ++layer) {
                    if ((needed >> layer & 1) == 0) continue;
                    gpu::DepthBoundsPush own = push;
                    own.below += layer * squares;
                    own.first += layer * squares;
                    gpu.bind(reduce, {gpu.storage(0, buffer), gpu.sampled(1, image, SamplerKind::nearest, layer)});
                    gpu.push(own);
                    gpu.vk->vkCmdDispatch(gpu.cmd, groups, groups, 1);
                }
            });
        below = first;
        first += row * row;
        side = row;
    }
    return buffer;
}

VkDeviceSize searchedMapMemory(std::span<const double> settings, VkExtent2D extent, GnLightType type)
{
    return lightMapMemory(settings, extent, type) +
           DepthBounds::memory(static_cast<std::uint32_t>(settings[0]), mapLayers(type));
}

const char* refusesSearch(const DeviceTable& vk, const ShadowTask& task, std::uint32_t resolution)
{
    if (DepthBounds::memory(resolution, mapLayers(task.light->type)) > vk.properties.limits.maxStorageBufferRange)
        return "its depth bounds are larger than a storage buffer may be";
    return refusesDisc(*task.light);
}

} // namespace gnomon
