#pragma once
// Closed meshes as unpleasant as a modeller can make them: of any genus, with slivers, coplanar neighbours and vertices
// in several copies.
#include <algorithm>
#include <array>
#include <map>

#include "tests/algorithms/volume_meshes.hpp"

namespace gnomon::test {

inline std::uint32_t below(Random& random, std::uint32_t count)
{
    return static_cast<std::uint32_t>(random.engine() % count);
}
inline bool perhaps(Random& random, float share)
{
    return random(0.0f, 1.0f) < share;
}

/// Places of grid lines, the cells between them from thin to wide.
inline std::vector<float> gridLines(Random& random, std::uint32_t cells)
{
    std::vector<float> lines{-1.0f};
    for (std::uint32_t i = 0; i < cells; ++i)
        lines.push_back(lines.back() + (perhaps(random, 0.3f) ? random(0.0005f, 0.01f) : random(0.2f, 1.0f)));
    return lines;
}

/// A plate of boxes with `genus` holes, in triangles. Its sides are full of coplanar neighbours, its thin cells of
/// slivers.
inline Mesh plate(Random& random, std::uint32_t genus)
{
    using Cell = std::array<std::uint32_t, 3>;
    const Cell cells{genus ? 2 * genus + 1 : 1 + below(random, 4), genus ? 3 : 1 + below(random, 3),
                     1 + below(random, 2)};
    std::array<std::vector<float>, 3> lines;
    for (std::size_t axis = 0; axis < 3; ++axis)
        lines[axis] = gridLines(random, cells[axis]);
    // Unsigned: before the first cell is beyond the last.
    const auto solid = [&](const Cell& c) {
        if (c[0] >= cells[0] || c[1] >= cells[1] || c[2] >= cells[2]) return false;
        return genus == 0 || c[0] % 2 == 0 || c[1] != 1;
    };
    Mesh mesh;
    std::map<Cell, std::uint32_t> known;
    const auto vertex = [&](const Cell& at) {
        const auto [place, fresh] = known.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
        if (fresh) mesh.positions.emplace_back(lines[0][at[0]], lines[1][at[1]], lines[2][at[2]]);
        return place->second;
    };
    const auto addSide = [&](Cell low, std::size_t axis, bool upper) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        if (upper) ++low[axis];
        std::array<std::uint32_t, 4> ring{};
        for (std::size_t i = 0; i < 4; ++i) {
            Cell corner = low;
            corner[u] += i == 1 || i == 2;
            corner[v] += i >= 2;
            ring[upper ? i : 3 - i] = vertex(corner);
        }
        const std::size_t turn = below(random, 2); // either diagonal
        for (const std::size_t i : {0, 1, 2, 0, 2, 3})
            mesh.indices.push_back(ring[(i + turn) % 4]);
    };
    for (Cell c{}; c[2] < cells[2]; ++c[2])
        for (c[1] = 0; c[1] < cells[1]; ++c[1])
            for (c[0] = 0; c[0] < cells[0]; ++c[0])
                for (std::size_t axis = 0; solid(c) && axis < 3; ++axis)
                    for (const bool upper : {false, true}) {
                        Cell beside = c;
                        beside[axis] += upper ? 1u : ~0u;
                        if (!solid(beside)) addSide(c, axis, upper);
                    }
    return mesh;
}

/// An octahedron whose faces are cut into four, several times, on a bumpy ball.
inline Mesh ball(Random& random, std::uint32_t cuts, float bumps)
{
    Mesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
              {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5}};
    for (std::uint32_t cut = 0; cut < cuts; ++cut) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [place, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                            static_cast<std::uint32_t>(mesh.positions.size()));
            if (fresh) mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
            return place->second;
        };
        std::vector<std::uint32_t> finer;
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
            const std::uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
        }
        mesh.indices = std::move(finer);
    }
    for (glm::vec3& p : mesh.positions)
        p *= 1.0f + random(-bumps, bumps);
    return mesh;
}

/// Puts a vertex on an edge: two faces become four, pairwise coplanar; near an end they are slivers.
inline void splitEdge(Mesh& mesh, std::size_t face, std::size_t corner, float share)
{
    const std::uint32_t a = mesh.indices[3 * face + corner], b = mesh.indices[3 * face + (corner + 1) % 3];
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(mesh.positions[a] + share * (mesh.positions[b] - mesh.positions[a]));
    for (std::size_t t = 0, count = mesh.indices.size(); t < count; t += 3)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = mesh.indices[t + i], to = mesh.indices[t + (i + 1) % 3];
            if (!(from == a && to == b) && !(from == b && to == a)) continue;
            const std::uint32_t apex = mesh.indices[t + (i + 2) % 3];
            mesh.indices[t + (i + 1) % 3] = middle;
            mesh.indices.insert(mesh.indices.end(), {middle, to, apex});
            break;
        }
}

/// Puts a vertex into a face: one becomes three, coplanar; near an edge one of them is a sliver.
inline void splitFace(Mesh& mesh, std::size_t face, float toB, float toC)
{
    const std::uint32_t a = mesh.indices[3 * face], b = mesh.indices[3 * face + 1], c = mesh.indices[3 * face + 2];
    const glm::vec3 origin = mesh.positions[a];
    const auto inner = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(origin + toB * (mesh.positions[b] - origin) + toC * (mesh.positions[c] - origin));
    mesh.indices[3 * face + 2] = inner;
    mesh.indices.insert(mesh.indices.end(), {b, c, inner, c, a, inner});
}

inline void cut(Mesh& mesh, Random& random, std::size_t times)
{
    constexpr float kShares[] = {0.5f, 0.3f, 1e-3f, 0.999f, 1e-6f};
    for (std::size_t i = 0; i < times; ++i) {
        const std::uint32_t face = below(random, static_cast<std::uint32_t>(mesh.indices.size() / 3));
        const float share = kShares[below(random, 5)];
        if (perhaps(random, 0.5f))
            splitEdge(mesh, face, below(random, 3), share);
        else
            splitFace(mesh, face, share * 0.5f, perhaps(random, 0.5f) ? share * 0.4f : 0.3f);
    }
}

/// Every face gets vertices of its own: welding must find them again.
inline void duplicateVertices(Mesh& mesh)
{
    Mesh loose;
    for (const std::uint32_t index : mesh.indices) {
        loose.indices.push_back(static_cast<std::uint32_t>(loose.positions.size()));
        loose.positions.push_back(mesh.positions[index]);
    }
    mesh = std::move(loose);
}

/// Faces in another order, each starting at another corner.
inline void shuffle(Mesh& mesh, Random& random)
{
    for (std::size_t t = mesh.indices.size() / 3; t-- > 0;) {
        const std::size_t other = below(random, static_cast<std::uint32_t>(t + 1));
        std::swap_ranges(&mesh.indices[3 * t], &mesh.indices[3 * t] + 3, &mesh.indices[3 * other]);
        std::rotate(&mesh.indices[3 * t], &mesh.indices[3 * t] + below(random, 3), &mesh.indices[3 * t] + 3);
    }
}

struct RandomMesh {
    Mesh mesh;
    std::uint32_t genus = 0;
    std::uint32_t vertices = 0; ///< Before copies were made.
    bool cut = false;           ///< Vertices may have fallen together.
};

inline RandomMesh randomMesh(Random& random)
{
    RandomMesh made;
    const std::uint32_t kind = below(random, 6);
    made.genus = kind < 4 ? kind : kind == 4 ? 0 : 1;
    if (kind < 4)
        made.mesh = plate(random, kind);
    else if (kind == 4)
        made.mesh = ball(random, below(random, 3), perhaps(random, 0.5f) ? 0.2f : 0.0f);
    else {
        const float tube = random(0.05f, 0.6f);
        const std::uint32_t around = 3 + below(random, 10);
        made.mesh = torus(1.0f, tube, around, 3 + below(random, 8));
    }
    made.cut = perhaps(random, 0.6f);
    if (made.cut) cut(made.mesh, random, 1 + below(random, 60));
    constexpr float kJitter[] = {0.0f, 0.0f, 1e-6f, 0.05f, 0.4f};
    const float jitter = kJitter[below(random, 5)];
    for (glm::vec3& p : made.mesh.positions)
        p += random.inBox(glm::vec3(-jitter), glm::vec3(jitter));
    made.vertices = static_cast<std::uint32_t>(made.mesh.positions.size());
    if (perhaps(random, 0.4f)) duplicateVertices(made.mesh);
    if (perhaps(random, 0.5f)) shuffle(made.mesh, random);
    return made;
}

} // namespace gnomon::test
