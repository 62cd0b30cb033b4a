#include "algorithms/volumes/mesh_planes.hpp"

#include <algorithm>

#include "runtime/scene/topology.hpp"

#include "shaders/volumes/mesh_planes.h"
#include "shaders/volumes_mesh_planes_comp.h"

namespace gnomon {

void dispatchInRows(PassContext& gpu, std::uint32_t items, std::uint32_t size)
{
    const std::uint32_t groups = (items + size - 1) / size, across = std::clamp(groups, 1u, 65535u);
    gpu.vk->vkCmdDispatch(gpu.cmd, across, (groups + across - 1) / across, 1);
}

PipelineId makeFindPlanes(const AlgorithmServices& services)
{
    return services.pipelines->compute("volumes.mesh_planes", {k_volumes_mesh_planes_comp},
                                       {bufferAt(0), bufferAt(1), bufferAt(2)}, sizeof(gpu::MeshPlanesPush));
}

BufferId declareCorners(PassBuilder& passes, const MeshView& mesh)
{
    const std::span<const std::uint32_t> corners = mesh.connectivity->faceVerts;
    return declareMeshList(passes, mesh, "volumes.mesh_corners", corners.size_bytes(),
                           [corners](HostContext& host, BufferId list) {
                               std::copy(corners.begin(), corners.end(), host.write<std::uint32_t>(list).begin());
                           });
}

VkDeviceSize planesBytes(const Topology& topology)
{
    return sizeof(glm::vec4) * topology.facePlanes.size();
}

BufferId declarePlanes(PassBuilder& passes, const MeshView& mesh, PipelineId find)
{
    if (const Topology* topology = mesh.topology)
        return declareMeshList(passes, mesh, "volumes.mesh_planes", planesBytes(*topology),
                               [topology](HostContext& host, BufferId list) {
                                   const std::span<glm::vec4> planes = host.write<glm::vec4>(list);
                                   for (std::size_t face = 0; face < topology->facePlanes.size(); ++face)
                                       planes[face] = topology->facePlanes[face];
                               });
    const auto faces = static_cast<std::uint32_t>(mesh.connectivity->facePlanes.size());
    const BufferId corners = declareCorners(passes, mesh);
    const BufferId planes = passes.persistent(BufferInfo{.name = "volumes.mesh_planes",
                                                         .scope = Scope::scene,
                                                         .size = planesBytes(*mesh.connectivity),
                                                         .variant = mesh.id});
    if (!passes.stale(planes, mesh.revision)) {
        passes.kept();
        return planes;
    }
    passes.compute("volumes.mesh_planes", Scope::scene, mesh.id)
        .reads(corners)
        .writes(planes)
        .record([=, positions = mesh.vertexBuffer](PassContext& context) {
            context.bind(find,
                         {context.storage(0, positions), context.storage(1, corners), context.storage(2, planes)});
            context.push(gpu::MeshPlanesPush{.faces = faces});
            dispatchInRows(context, faces, gpu::PLANES_GROUP);
        });
    return planes;
}

} // namespace gnomon
