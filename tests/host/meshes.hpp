// What the stranger's renderer shows: three meshes of about 19 500 triangles as they come from modelling programs, open
// and non-manifold, and six lamps that circle above them.
#ifndef GNOMON_TESTS_HOST_MESHES_HPP
#define GNOMON_TESTS_HOST_MESHES_HPP

#include <array>
#include <cstdint>
#include <vector>

namespace stranger {

using Vec3 = std::array<float, 3>;

/// Triangles in world space, metres, y up.
struct Mesh {
    const char* name;
    Vec3 colour;
    std::vector<Vec3> positions;
    std::vector<uint32_t> indices;
};

/// A statue with holes and fins, an uneven floor with crates and crossed cards on it, a cloth with a flap.
std::array<Mesh, 3> makeMeshes();

/// How often the edges of a mesh are used.
struct EdgeCount {
    uint32_t boundary = 0;    ///< By one triangle.
    uint32_t nonManifold = 0; ///< By three or more.
};
EdgeCount countEdges(const Mesh& mesh);

constexpr int kLampCount = 6;
struct Lamp {
    Vec3 position, colour;
    float range; ///< Metres.
};
/// Where the lamps are at a time. Each circles at its own radius, height and speed.
std::array<Lamp, kLampCount> lampsAt(double seconds);

} // namespace stranger
#endif
