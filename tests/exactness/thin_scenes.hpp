#pragma once
// Scenes of thin and of very long triangles, made in code.
#include "demo/scene/scene.hpp"

namespace gnomon::exact {

/// What the ground of a thinTriangles() scene is made of. Each reaches kilometres beyond what is seen.
enum class LongGround : uint8_t {
    strips, ///< Strips half a metre wide and 10 km long.
    fan,    ///< 300 slivers 10 km long around one vertex in sight.
    joints, ///< Two halves that meet in T-junctions: one edge of 10 km against fifty edges.
    none,   ///< Metre-sized quads, 40 m wide.
};

/// Metre-sized things beside long and thin triangles: closed needles of aspect 1e3 to 1e6, flat closed fans of 400
/// slivers, boxes with slivers on one face that meet the others in T-junctions, a closed beam 10 km long. The far
/// plane is at infinity. Layer 0 sun, 1 spot, 2 point. \param seed Where things lie and how they are turned.
demo::Scene thinTriangles(LongGround ground, uint32_t seed);

} // namespace gnomon::exact
