#pragma once
#include <span>

#include <glm/vec3.hpp>

namespace gnomon {

struct Topology;

/// Finds clusters with a shell that is inside out, and sets Cluster::insideOut and all that follows from it: which
/// clusters are closed, and whether the mesh is.
///
/// The rule: where a mesh is solid its shells wind about each point at least 0 times. A watertight shell of negative
/// volume takes one turn away from all that it holds, so it is inside out unless the other shells wind about it, as
/// they do about a cavity. Where that is not clear, at a cavity that touches another shell or beyond a budget of work,
/// the shell is taken for inside out: then it casts as an open surface does, which is right for either and costs more.
/// @pre Cluster::watertight is known
void judgeOrientation(Topology& topology, std::span<const glm::vec3> positions);

} // namespace gnomon
