#include "algorithms/volumes/mesh_planes.hpp"

#include <algorithm>

#include "runtime/scene/topology.hpp"

#include "shaders/volumes/mesh_planes.h"
#include "shaders/volumes_mesh_planes_comp.h"

namespace gnomon {

PipelineId makeFindPlanes(const AlgorithmServices& services)
{
    constexpr BindingInfo bindings[] = {{.binding = 0, .kind = BindingKind::storageBuffer},
                                        {.binding = 1, .kind = BindingKind::storageBuffer},
                                        {.binding = 2, .kind = BindingKind::storageBuffer}};
    return services.pipelines->compute({.name = "volumes.mesh_planes",
                                        .compute = {.code = k_volumes_mesh_planes_comp},
                                        .bindings = bindings,
                                        .pushBytes = sizeof(gpu::MeshPlanesPush)});
}

BufferId declareCorners(PassBuilder& passes, const MeshView& mesh)
{
    const std::span<const std::uint32_t> corners = mesh.connectivity->faceVerts;
    const auto [list, due] = passes.keptList(
        {.name = "volumes.mesh_corners", .scope = Scope::scene, .size = corners.size_bytes(), .variant = mesh.id},
        mesh.connectivityRevision);
    if (!due) {
        passes.kept();
        return list;
    }
    passes.prepare("volumes.mesh_corners", Scope::scene, mesh.id)
        .writes(list)
        .run([corners, list = list](HostContext& host) {
            std::copy(corners.begin(), corners.end(), host.write<std::uint32_t>(list).begin());
        });
    return list;
}

BufferId declarePlanes(PassBuilder& passes, const MeshView& mesh, PipelineId find)
{
    const auto faces = static_cast<std::uint32_t>(mesh.connectivity->facePlanes.size());
    const BufferId corners = declareCorners(passes, mesh);
    const BufferId planes = passes.persistent(BufferInfo{
        .name = "volumes.mesh_planes", .scope = Scope::scene, .size = sizeof(glm::vec4) * faces, .variant = mesh.id});
    if (!passes.stale(planes, mesh.revision)) {
        passes.kept();
        return planes;
    }
    passes.compute("volumes.mesh_planes", Scope::scene, mesh.id)
        .reads(corners)
        .writes(planes)
        .record([=, positions = mesh.vertexBuffer](PassContext& context) {
            constexpr std::uint32_t kGroupsInRow = 65535; // Vulkan promises no more
            const std::uint32_t groups = (faces + gpu::PLANES_GROUP - 1) / gpu::PLANES_GROUP;
            const std::uint32_t across = std::min(groups, kGroupsInRow);
            context.bind(find,
                         {context.storage(0, positions), context.storage(1, corners), context.storage(2, planes)});
            context.push(gpu::MeshPlanesPush{.faces = faces});
            context.vk->vkCmdDispatch(context.cmd, across, (groups + across - 1) / across, 1);
        });
    return planes;
}

} // namespace gnomon
