// Six hundred random closed meshes under random lights: facing against double precision, silhouettes against loops,
// volumes against closedness.
#include <doctest/doctest.h>

#include "runtime/scene/light_fit.hpp"
#include "tests/algorithms/random_meshes.hpp"
#include "tests/algorithms/volume_lists.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::uint32_t kMeshes = 600;
constexpr std::uint32_t kLights = 5;

/// Turned, stretched, mirrored, sheared, now and then flattened.
glm::mat3 randomBasis(Random& random)
{
    const glm::vec3 axis = glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)) + glm::vec3(0, 0, 1e-3f));
    const glm::mat3 turned(glm::rotate(glm::mat4(1.0f), random(0.0f, 6.0f), axis));
    const float scale = std::pow(10.0f, random(-2.0f, 2.0f));
    glm::mat3 stretch(scale);
    for (int i = 0; i < 3; ++i)
        if (perhaps(random, 0.3f)) stretch[i][i] *= random(0.05f, 3.0f);
    if (perhaps(random, 0.2f)) stretch[1][0] = random(-1.0f, 1.0f) * scale;
    if (perhaps(random, 0.3f)) stretch[0] = -stretch[0];
    if (perhaps(random, 0.05f)) stretch[2] = glm::vec3(0.0f);
    return turned * stretch;
}

Placed randomPlaced(Random& random)
{
    RandomMesh made = randomMesh(random);
    const glm::mat3 basis = randomBasis(random);
    return Placed(std::move(made.mesh), basis, random.inBox(glm::vec3(-30.0f), glm::vec3(30.0f)));
}

/// Anywhere: far away, among the faces, in a vertex, in the plane of a face; along an axis, or any way.
LightView randomLight(Random& random, const Placed& placed)
{
    const Aabb& box = placed.caster.bounds;
    const glm::vec3 size = box.upper - box.lower + 1e-3f;
    const std::size_t face = below(random, static_cast<std::uint32_t>(placed.mesh.indices.size() / 3));
    const auto corner = [&](std::size_t i) { return placed.world(placed.mesh.indices[3 * face + i]); };
    switch (below(random, 6)) {
    case 0: {
        glm::vec3 axis(0.0f);
        axis[static_cast<int>(below(random, 3))] = perhaps(random, 0.5f) ? 1.0f : -1.0f;
        return directionalLight(perhaps(random, 0.5f) ? axis : placed.caster.basis * axis + glm::vec3(0, 0, 1e-9f));
    }
    case 1:
        return directionalLight(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)) + glm::vec3(0, 1e-3f, 0));
    case 2:
        return pointLight(random.inBox(box.lower, box.upper));
    case 3:
        return pointLight(corner(0));
    case 4: {
        const float toB = random(-5.0f, 5.0f), toC = random(-5.0f, 5.0f);
        return pointLight(corner(0) + toB * (corner(1) - corner(0)) + toC * (corner(2) - corner(0)));
    }
    default:
        return pointLight(random.inBox(box.lower - 9.0f * size, box.upper + 9.0f * size));
    }
}

/// What floats can be wrong by in the facing sum, in units of |edge| |edge| (|light| + |corner| |determinant|), light
/// and determinant as the adjugate gives them: 8 halves of a last place for the normal, 3 more for the plane's
/// distance, 1 for the light and 4 for the sum; 16 * 2^-24.
constexpr double kSlack = 1.0 / (1 << 20);

struct Truth {
    double towards = 0.0; ///< Above 0: the face's winding in the world looks towards the light.
    double slack = 0.0;
    double touch = 0.0; ///< Not above it, either way: the face may touch the light, and does unless it is near it.
};

/// touchingDistance() of a light within the caster's bounds, or so near that roundings decide; 0 elsewhere.
double touchOf(const Placed& placed, const LightView& light)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return 0.0;
    const Aabb& box = placed.caster.bounds;
    const glm::dvec3 lower(box.lower), upper(box.upper), at(light.position());
    const glm::dvec3 far = glm::max(glm::abs(lower), glm::abs(upper));
    const double touch = touchingDistance(light, std::max({far.x, far.y, far.z}));
    const glm::dvec3 outside = glm::max(lower - at, at - upper);
    return std::max({outside.x, outside.y, outside.z}) <= 1.5 * touch ? touch : 0.0;
}

/// In world space: no adjugate, no homogeneous light.
Truth truthOf(const Placed& placed, const LightView& light, std::uint32_t face)
{
    const glm::dmat3 basis(placed.caster.basis);
    const glm::dvec3 translation(placed.caster.translation);
    const std::uint32_t* v = &placed.mesh.indices[3 * face];
    const glm::dvec3 a(placed.mesh.positions[v[0]]);
    const glm::dvec3 ab = glm::dvec3(placed.mesh.positions[v[1]]) - a, ac = glm::dvec3(placed.mesh.positions[v[2]]) - a;
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const glm::dvec3 away = directional ? -glm::dvec3(light.direction())
                                        : glm::dvec3(light.position()) - translation; // of the caster's origin
    const glm::dvec3 ray = directional ? away : away - basis * a;
    const glm::dmat3 cofactors(glm::cross(basis[1], basis[2]), glm::cross(basis[2], basis[0]),
                               glm::cross(basis[0], basis[1]));
    double cofactorSize = 0.0;
    for (int column = 0; column < 3; ++column)
        cofactorSize += glm::dot(cofactors[column], cofactors[column]);
    const double determinant = directional ? 0.0 : std::abs(glm::dot(basis[0], cofactors[0]));
    return {.towards = glm::dot(glm::cross(basis * ab, basis * ac), ray),
            .slack = kSlack * glm::length(ab) * glm::length(ac) *
                     (glm::length(glm::transpose(cofactors) * away) + glm::length(a) * determinant),
            .touch = touchOf(placed, light) * std::sqrt(cofactorSize) * glm::length(glm::cross(ab, ac))};
}

/// Directed edges that have no partner in the other direction.
std::size_t unmatched(std::vector<std::pair<std::uint64_t, int>> uses)
{
    std::sort(uses.begin(), uses.end());
    std::size_t open = 0;
    for (std::size_t i = 0; i < uses.size();) {
        const std::uint64_t edge = uses[i].first;
        int sum = 0;
        for (; i < uses.size() && uses[i].first == edge; ++i)
            sum += uses[i].second;
        open += sum != 0;
    }
    return open;
}

std::size_t openEdges(const Lists& lists)
{
    std::vector<std::pair<std::uint64_t, int>> uses;
    for (const std::vector<std::uint32_t>* list : {&lists.sides, &lists.caps})
        for (std::size_t t = 0; t < list->size(); t += 3)
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint64_t a = (*list)[t + i], b = (*list)[t + (i + 1) % 3];
                if (a != b) uses.emplace_back(std::min(a, b) << 32 | std::max(a, b), a < b ? 1 : -1);
            }
    return unmatched(std::move(uses));
}

/// Vertices at which not as many silhouette edges end as start.
std::size_t openVertices(const Lists& lists)
{
    std::vector<std::pair<std::uint64_t, int>> ends;
    for (std::size_t i = 0; i < lists.sides.size(); i += 6) {
        ends.emplace_back(lists.sides[i], 1);
        ends.emplace_back(lists.sides[i + 5], -1);
    }
    return unmatched(std::move(ends));
}

std::size_t usedVertices(const Topology& topology)
{
    std::vector<std::uint32_t> used = topology.faceVerts;
    std::sort(used.begin(), used.end());
    return static_cast<std::size_t>(std::unique(used.begin(), used.end()) - used.begin());
}

} // namespace

TEST_CASE("random meshes are closed and of the genus that was asked for")
{
    Random random(2);
    std::size_t ofGenus[4] = {}, slivers = 0, copies = 0;
    for (std::uint32_t i = 0; i < kMeshes; ++i) {
        CAPTURE(i);
        const RandomMesh made = randomMesh(random);
        const Topology topology = buildTopology(made.mesh.positions, made.mesh.indices);
        REQUIRE(topology.whole.watertight); // one may be inside out
        const std::size_t vertices = usedVertices(topology), faces = made.mesh.indices.size() / 3;
        if (vertices == made.vertices) {
            REQUIRE(topology.manifold);
            const auto euler = static_cast<int>(vertices + faces) - static_cast<int>(topology.edges.size());
            REQUIRE(euler == 2 - 2 * static_cast<int>(made.genus));
            ++ofGenus[made.genus];
        } else {
            REQUIRE(made.cut); // a cut so close to a vertex that both are one
        }
        copies += made.mesh.positions.size() > vertices;
        for (std::uint32_t face = 0; face < faces; ++face) {
            const std::uint32_t* v = &made.mesh.indices[3 * face];
            const glm::vec3 a = made.mesh.positions[v[0]], b = made.mesh.positions[v[1]], c = made.mesh.positions[v[2]];
            const float longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
            slivers += glm::length(glm::cross(b - a, c - a)) < 0.01f * longest * longest;
        }
    }
    MESSAGE("genus 0 to 3: " << ofGenus[0] << ", " << ofGenus[1] << ", " << ofGenus[2] << ", " << ofGenus[3] << "; "
                             << slivers << " slivers, " << copies << " meshes with copied vertices");
    for (const std::size_t count : ofGenus)
        CHECK(count > 50);
    CHECK(slivers > 5000);
    CHECK(copies > 100);
}

TEST_CASE("faces of random meshes look towards the light where double precision says so")
{
    Random random(3);
    std::size_t certain = 0, doubtful = 0, towards = 0, wrong = 0, touched = 0, wrongTouched = 0;
    for (std::uint32_t i = 0; i < kMeshes; ++i) {
        const Placed placed = randomPlaced(random);
        for (std::uint32_t j = 0; j < kLights; ++j) {
            const LightView light = randomLight(random, placed);
            const Lists lists(placed, light);
            for (std::uint32_t face = 0; face < lists.facing.size(); ++face) {
                const Truth truth = truthOf(placed, light, face);
                const double off = std::abs(truth.towards);
                if (off > truth.slack && off + truth.slack < 0.99 * truth.touch) {
                    ++touched;
                    wrongTouched += lists.blocks(placed, face);
                    continue;
                }
                if (off <= truth.slack + 1.01 * truth.touch) {
                    ++doubtful;
                    continue;
                }
                ++certain;
                towards += truth.towards > 0.0;
                wrong += (lists.facing[face] != 0) != (truth.towards > 0.0);
            }
        }
    }
    MESSAGE(certain << " faces certain, " << towards << " of them towards the light, " << doubtful << " doubtful, "
                    << touched << " touched");
    CHECK(wrong == 0);
    CHECK(wrongTouched == 0);
    CHECK(touched > 100);
    CHECK(certain > 100000);
    CHECK(towards > certain / 4);
    CHECK(towards < certain * 3 / 4);
    CHECK(doubtful < certain / 4);
}

TEST_CASE("silhouettes of random meshes are loops, and sides and caps enclose a volume without a hole")
{
    Random random(4);
    std::size_t silhouettes = 0, empty = 0;
    for (std::uint32_t i = 0; i < kMeshes; ++i) {
        CAPTURE(i);
        const Placed placed = randomPlaced(random);
        REQUIRE(placed.topology.whole.watertight);
        for (std::uint32_t j = 0; j < kLights; ++j) {
            CAPTURE(j);
            const Lists lists(placed, randomLight(random, placed));
            REQUIRE(openVertices(lists) == 0);
            REQUIRE(openEdges(lists) == 0);
            silhouettes += lists.sides.size() / 6;
            empty += lists.sides.empty();
        }
    }
    MESSAGE(silhouettes << " silhouette edges, " << empty << " lights inside a mesh, or beside one without thickness");
    CHECK(silhouettes > 50000);
    CHECK(empty < kMeshes * kLights / 10);
}

TEST_CASE("a mesh with a hole is not enclosed, so the tests above can fail")
{
    const Placed placed(torus(1.0f, 0.3f, 12, 8), glm::mat3(1.0f), glm::vec3(0.0f));
    Lists lists(placed, pointLight(glm::vec3(1.0f, 7.0f, 2.0f)));
    REQUIRE(openEdges(lists) == 0);
    lists.caps.resize(lists.caps.size() - 3);
    CHECK(openEdges(lists) == 3);
    lists.sides.resize(lists.sides.size() - 6);
    CHECK(openVertices(lists) == 2);
}
