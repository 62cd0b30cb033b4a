#pragma once
// A light's depth map whose texels also name the nearest triangle, with a copy on the CPU; kept for as long as light
// and casters stand still.
#include <cstdint>
#include <span>

#include "algorithms/hybrid/candidate_occluder.hpp"
#include "algorithms/hybrid/host_map.hpp"
#include "algorithms/hybrid/map_texels.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"

namespace gnomon {

struct IdMapPipelines {
    PipelineId casters;
    DepthMapPipelines depth; ///< Of what the host draws: depth alone.
};
IdMapPipelines makeIdMapPipelines(const AlgorithmServices& services);

/// A map as declared in this frame.
struct IdMap {
    ImageId depth;                  ///< kMapFormat; a layer per fit. As declareDepthMap() or declareCubeMap() draws it.
    std::span<const LightFit> fits; ///< One or six; they live as long as the frame.
    std::uint32_t needed = 0;       ///< Bit i: a receiver of task.view can lie in layer i; other ones may be undefined.
    std::uint32_t side = 0;
    BufferId depths[6], numbers[6]; ///< On the CPU, of the layers needed.

    void uses(PassRef& host) const;                   ///< What a host pass reads.
    HostMap onHost(const HostContext& context) const; ///< In that pass. Layers not needed are empty.
    HostMapCopy depthOnHost() const;                  ///< Depths alone, for passes that ask all pixels.
};

/// Declares what is missing of the map. \param triangles of task.casters->all.
IdMap declareIdMap(PassBuilder& passes, const IdMapPipelines& pipelines, const ShadowTask& task,
                   std::uint32_t resolution, const NumberedTriangles& triangles);

/// Device and host-visible bytes of one map under which casters move and stand still.
VkDeviceSize idMapMemory(std::uint32_t resolution, std::uint32_t layers);

} // namespace gnomon
