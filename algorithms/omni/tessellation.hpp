#pragma once
// Casters cut finely enough for a projection that bends edges.
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Largest angle an edge may span as seen from the light, radians.
///
/// Drawn straight on a paraboloid an edge of angle a is off by a^2 / 8 disc radii at the rim, where the disc is densest
/// (a great circle bends there with radius 1), which is resolution / 2 * a^2 / 8 texels. A quarter texel gives
/// a = 2 / sqrt(resolution): 3.6 degrees at 1024. Never above 15 degrees: a plane's depth between the ends of an edge
/// is then off by a^2 / 8 = 0.9 % at most, towards far, which leaks and does not shade.
float maxEdgeAngle(std::uint32_t resolution);

/// Whether no edge of the caster can span more than `angle` from the light. Conservative: by bounds and longest edge.
bool fineEnough(const Caster& caster, glm::vec3 light, float angle);

/// Triangles in world space, ready to be drawn: those of closed casters first, then those of open ones.
struct FineMesh {
    std::vector<glm::vec3> vertices;
    std::vector<std::uint32_t> indices;
    std::uint32_t closedIndices = 0; ///< The first so many.

    void clear();
};

/// Cuts the triangles of `casters` until no edge spans more than `angle` from the light, twenty times and into a
/// million pieces at most; what then still spans more than a right angle is left out. Edges are cut by their two ends
/// alone, so that neighbours agree and no gap opens. Winding is that of unmirrored casters.
void cutToAngle(std::span<const Caster* const> casters, const LightView& light, float angle, FineMesh& out);

} // namespace gnomon
