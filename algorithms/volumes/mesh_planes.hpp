#pragma once
// Planes of the faces of meshes for the device, once for all methods, lights and casters: of those whose positions the
// GPU alone knows found by it whenever it has moved them, of others the CPU's.
#include "runtime/algorithm.hpp"
#include "runtime/passes/pass_builder.hpp"

namespace gnomon {

/// A list of a mesh that all lights and casters share. `write(HostContext&, BufferId)` fills it when the topology's
/// positions, or the connectivity, are new.
template <typename Write>
BufferId declareMeshList(PassBuilder& passes, const MeshView& mesh, const char* name, VkDeviceSize bytes,
                         const Write& write)
{
    const auto [list, due] = passes.keptList({.name = name, .scope = Scope::scene, .size = bytes, .variant = mesh.id},
                                             mesh.topology ? mesh.revision : mesh.connectivityRevision);
    if (due)
        passes.prepare(name, Scope::scene, mesh.id).writes(list).run([write, list = list](HostContext& host) {
            write(host, list);
        });
    else
        passes.kept();
    return list;
}

/// A group of `size` invocations for so many of `items`. Vulkan promises no more than 65535 groups in a row.
void dispatchInRows(PassContext& gpu, std::uint32_t items, std::uint32_t size);

PipelineId makeFindPlanes(const AlgorithmServices& services);

/// Three vertices for each face of the mesh's connectivity, in the order of its planes. @pre the mesh has connectivity
BufferId declareCorners(PassBuilder& passes, const MeshView& mesh);

/// The planes where the mesh is now, a vec4 each: xyz unnormalised normal, w distance, object space. @pre a topology,
/// or connectivity
BufferId declarePlanes(PassBuilder& passes, const MeshView& mesh, PipelineId find);

VkDeviceSize planesBytes(const Topology& topology);

} // namespace gnomon
