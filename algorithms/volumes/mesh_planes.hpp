#pragma once
// Planes of the faces of meshes whose positions the GPU alone knows, found by it: whenever it has moved them, once for
// all methods, lights and casters.
#include "runtime/algorithm.hpp"
#include "runtime/passes/pass_builder.hpp"

namespace gnomon {

PipelineId makeFindPlanes(const AlgorithmServices& services);

/// Three vertices for each face of the mesh's connectivity, in the order of its planes. @pre the mesh has connectivity
BufferId declareCorners(PassBuilder& passes, const MeshView& mesh);

/// The planes where the mesh is now, a vec4 each: xyz unnormalised normal, w distance, object space. @pre likewise
BufferId declarePlanes(PassBuilder& passes, const MeshView& mesh, PipelineId find);

} // namespace gnomon
