// Single candidate occluders against the tracer, rings against a search through all pairs.
#include <doctest/doctest.h>

#include <array>
#include <random>
#include <set>
#include <utility>

#include "algorithms/hybrid/candidate_occluder.hpp"
#include "algorithms/hybrid_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct Told {
    int blocked = 0, contradicted = 0;
    int clear = 0, clearBlocked = 0; ///< Blocked well inside the triangle and between the ray's ends.
};

/// A triangle somewhere, under a transform.
struct OneTriangle {
    RayScene rays;
    glm::mat3 basis;
    glm::vec3 translation;
    TracedMesh mesh;
    std::vector<Caster> casters;
    FrameArena arena;
    NumberedTriangles triangles;

    OneTriangle(std::mt19937& random, const glm::mat3& basis_, glm::vec3 translation_)
        : basis(basis_), translation(translation_),
          mesh(rays, randomTriangles(random, 1, 2.0f, 0.7f)), casters{casterOf(mesh, 0, basis, translation)},
          triangles(std::array{&std::as_const(casters[0])}, nullptr, arena)
    {
        rays.update(casters);
    }
    /// In the world; inside where u, v and 1 - u - v are positive.
    glm::vec3 at(float u, float v) const
    {
        const glm::vec3 a = mesh.positions[0];
        return basis * (a + u * (mesh.positions[1] - a) + v * (mesh.positions[2] - a)) + translation;
    }
};

/// One triangle at a time, rays at its corners, edges and inside, from all around.
Told tell(const glm::mat3& basis, glm::vec3 translation, bool finite, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> share(-0.1f, 1.1f);
    Told told;
    for (int i = 0; i < 300; ++i) {
        OneTriangle one(random, basis, translation);
        CandidateOccluders candidates(one.triangles);
        for (int k = 0; k < 100; ++k) {
            // Every fourth through a corner or along an edge, as exactly as floats go.
            const float u = k % 4 == 0 ? static_cast<float>(k % 3 == 0) : share(random);
            const float v = k % 8 == 0 ? 0.0f : share(random);
            const glm::vec3 target = one.at(u, v);
            ShadowRay ray;
            ray.origin = target + randomPoint(random, k % 5 == 0 ? 1e-5f : 3.0f);
            ray.direction = target - ray.origin;
            ray.tfar = std::numeric_limits<float>::infinity();
            if (finite) { // to somewhere beyond or before, or to the surface itself
                ray.direction *= k % 3 == 0 ? 1.0f : 2.0f * share(random);
                ray.tfar = 1.0f;
            }
            std::uint8_t occluded = 0;
            one.rays.occluded({&ray, 1}, 1u, {&occluded, 1});
            const bool blocked = candidates.blocks(0, ray);
            const bool middle = std::min({u, v, 1.0f - u - v}) > 0.1f && k % 5 != 0 && (!finite || k % 3 != 0);
            told.blocked += occluded;
            told.clear += occluded && middle;
            told.clearBlocked += occluded && middle && blocked;
            told.contradicted += blocked && !occluded;
        }
    }
    return told;
}

const glm::mat4 kOne(1.0f);
const glm::mat3 kBases[] = {
    glm::mat3(1.0f), glm::mat3(glm::rotate(kOne, 1.1f, {1, 2, 3})),                        // turned
    glm::mat3(glm::rotate(kOne, 0.7f, {3, 1, 2}) * glm::scale(kOne, {4.0f, 0.5f, -1.0f})), // stretched, mirrored
    glm::mat3(glm::vec3(1, 0, 0), glm::vec3(0.9f, 0.3f, 0), glm::vec3(0.2f, 0.8f, 1)),     // skewed
};

} // namespace

TEST_CASE("what a candidate occluder says blocks, blocks for the tracer, under every transform")
{
    unsigned seed = 1;
    for (const glm::mat3& basis : kBases) {
        for (const float far : {0.0f, 3.0f, 800.0f}) {
            for (const bool finite : {false, true}) {
                const Told told = tell(basis, glm::vec3(far, -0.3f * far, 0.7f * far), finite, seed++);
                CAPTURE(far);
                CAPTURE(finite);
                CHECK(told.contradicted == 0);
                CHECK(told.blocked > 2000);
                // Near edges and ends nothing is claimed; elsewhere that must stay the exception, where coordinates are
                // no hundred times what they span.
                CHECK(told.clear > 500);
                if (far < 100.0f) CHECK(told.clearBlocked > told.clear * 24 / 25);
            }
        }
    }
}

TEST_CASE("what the tracer does not see as a solid testifies to nothing")
{
    RayScene rays;
    const TracedMesh mesh(rays, {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}});
    std::vector<Caster> casters(3, casterOf(mesh, 0));
    casters[1].alphaTested = true;
    casters[1].opacity = [](std::uint32_t, float, float, void*) { return 1.0f; };
    casters[2].basis = glm::mat3(glm::vec3(1, 0, 0), glm::vec3(0), glm::vec3(0, 0, 1)); // flattened
    MeshView bare = mesh.view;
    bare.rays = nullptr; // not built yet
    casters.push_back(casters[0]);
    casters.back().mesh = &bare;
    std::vector<const Caster*> pointers;
    for (const Caster& caster : casters)
        pointers.push_back(&caster);
    FrameArena arena;
    const NumberedTriangles triangles(pointers, nullptr, arena);
    CandidateOccluders candidates(triangles);
    const ShadowRay up{.origin = {0, -1, 0}, .tfar = std::numeric_limits<float>::infinity(), .direction = {0, 1, 0}};
    CHECK(candidates.blocks(0, up));
    CHECK_FALSE(candidates.blocks(1, up));
    CHECK_FALSE(candidates.blocks(2, up));
    CHECK_FALSE(candidates.blocks(3, up));
}

TEST_CASE("numbers change when a caster comes, goes or changes its mesh, not when it moves")
{
    RayScene rays;
    std::mt19937 random(3);
    const TracedMesh few(rays, randomTriangles(random, 3, 2.0f, 0.5f)),
        many(rays, randomTriangles(random, 9, 2.0f, 0.5f));
    std::vector<Caster> casters{casterOf(few, 1), casterOf(many, 2), casterOf(few, 3)};
    const auto stampOf = [&](std::vector<const Caster*> pointers) {
        FrameArena arena;
        return NumberedTriangles(pointers, nullptr, arena).stamp();
    };
    const std::uint64_t all = stampOf({&casters[0], &casters[1], &casters[2]});
    casters[1].translation.x += 1.0f;
    ++casters[1].revision;
    CHECK(stampOf({&casters[0], &casters[1], &casters[2]}) == all);
    CHECK(stampOf({&casters[0], &casters[1]}) != all);
    CHECK(stampOf({&casters[1], &casters[0], &casters[2]}) != all);
    casters[1].mesh = &few.view;
    CHECK(stampOf({&casters[0], &casters[1], &casters[2]}) != all);
}

TEST_CASE("rings are the faces that share an edge or a vertex, whatever the mesh")
{
    RayScene rays;
    TracedMesh mesh = makeScene(rays);
    // A third face on an edge, and corners welded by position alone.
    std::vector<glm::vec3> corners(mesh.view.positions.begin(), mesh.view.positions.end());
    std::vector<std::uint32_t> indices = mesh.indices;
    const auto base = static_cast<std::uint32_t>(corners.size());
    corners.insert(corners.end(), {corners[indices[0]], corners[indices[1]], glm::vec3(0, 7, 0)});
    indices.insert(indices.end(), {base, base + 1, base + 2});
    const Topology topology = buildTopology(corners, indices);
    TriangleRings rings;
    rings.build(topology);
    const auto faces = static_cast<std::uint32_t>(indices.size() / 3);
    const auto shared = [&](std::uint32_t a, std::uint32_t b) {
        int common = 0;
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
                common += corners[indices[3 * a + std::uint32_t(i)]] == corners[indices[3 * b + std::uint32_t(k)]];
        return common;
    };
    int wrong = 0;
    for (std::uint32_t face = 0; face < faces; face += 3) {
        for (const int wanted : {1, 2}) {
            std::multiset<std::uint32_t> found, expected;
            rings.around(topology, face, wanted, [&](std::uint32_t other) {
                found.insert(other);
                return false;
            });
            for (std::uint32_t other = 0; other < faces; ++other)
                if (other != face && shared(face, other) >= wanted) expected.insert(other);
            wrong += found != expected;
        }
    }
    CHECK(wrong == 0);
    CHECK(rings.around(topology, faces - 1, 2, [](std::uint32_t other) { return other == 0; }));
}

TEST_CASE("a mesh whose positions were rewritten has no rings from then on")
{
    RayScene rays;
    const TracedMesh mesh = makeScene(rays);
    const Topology topology = buildTopology(mesh.view.positions, mesh.view.indices);
    MeshView view = mesh.view;
    view.id = 7;
    RingsCache cache;
    CHECK(cache.find(view) == nullptr); // no topology yet
    view.topology = &topology;
    RingsCache::Entry* entry = cache.find(view);
    REQUIRE(entry != nullptr);
    CHECK(cache.find(view) == entry);
    ++view.revision;
    CHECK(cache.find(view) == nullptr);
    --view.revision;
    CHECK(cache.find(view) == nullptr);
}

TEST_CASE("rings stay while their frame lasts, however much is asked, and go when no frame asks")
{
    RayScene rays;
    const TracedMesh mesh = makeScene(rays);
    const Topology topology = buildTopology(mesh.view.positions, mesh.view.indices);
    const auto meshOf = [&](std::uint32_t id) {
        MeshView view = mesh.view;
        view.id = id;
        view.topology = &topology;
        return view;
    };
    RingsCache cache;
    cache.begin(10);
    RingsCache::Entry* first = cache.find(meshOf(1));
    const MeshView second = meshOf(2);
    for (int i = 0; i < 70'000; ++i)
        cache.find(second);
    cache.find(meshOf(3));
    CHECK(cache.size() == 3);
    CHECK(cache.find(meshOf(1)) == first);
    for (std::uint64_t frame = 11; frame < 400; ++frame) {
        cache.begin(frame);
        cache.find(second);
    }
    cache.find(meshOf(4));
    CHECK(cache.size() == 2);
}
