// The ray tracer among others: what its caller has set and started stays as it is, and threads do not disturb each
// other.
#include <doctest/doctest.h>

#include <array>
#include <filesystem>
#include <thread>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "runtime/ray_fixture.hpp"

using namespace gnomon;
using test::casterOf;
using test::randomRays;
using test::trace;
using test::TracedMesh;

#if defined(__SSE2__)
TEST_CASE("the caller's floating-point mode is neither used nor changed")
{
    std::mt19937 random(7);
    RayScene scene;
    const std::vector<glm::vec3> corners = test::randomTriangles(random, 500, 4.0f, 0.6f);
    const std::vector<ShadowRay> rays = randomRays(random, 2000, 6.0f);
    const TracedMesh mesh(scene, corners);
    scene.update(std::vector<Caster>{casterOf(mesh, 0)});
    const std::vector<std::uint8_t> expected = trace(scene, rays);

    const unsigned saved = _mm_getcsr();
    const unsigned upwards = 0x1f80u | _MM_ROUND_UP;
    _mm_setcsr(upwards);
    RayScene other;
    const TracedMesh same(other, corners);
    other.update(std::vector<Caster>{casterOf(same, 0)});
    const std::vector<std::uint8_t> actual = trace(other, rays);
    const unsigned after = _mm_getcsr();
    _mm_setcsr(saved);
    CHECK((after & ~0x3fu) == upwards); // the low bits only say which exceptions have occurred
    CHECK(actual == expected);
}
#endif

#if defined(__linux__)
TEST_CASE("building, updating and tracing start no threads")
{
    const auto threads = [] { return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {}); };
    const auto before = threads();
    std::mt19937 random(8);
    RayScene scene;
    const TracedMesh mesh(scene, test::randomTriangles(random, 200000, 40.0f, 0.6f));
    scene.update(std::vector<Caster>{casterOf(mesh, 0)});
    trace(scene, randomRays(random, 4000, 40.0f));
    CHECK(threads() == before);
    CHECK(mesh.rays->memoryBytes() > 200000 * 12);          // the tree is counted,
    CHECK(scene.memoryBytes() >= mesh.rays->memoryBytes()); // and the scene's total holds it
}
#endif

TEST_CASE("several threads build and trace at once and get the answers of one")
{
    std::mt19937 random(9);
    RayScene scene;
    const std::vector<glm::vec3> corners = test::randomTriangles(random, 3000, 8.0f, 0.5f);
    {
        std::array<std::unique_ptr<MeshRays>, 4> trees;
        const TracedMesh source(scene, corners);
        std::vector<std::thread> builders;
        for (auto& tree : trees)
            builders.emplace_back([&] { tree = scene.build(source.view.positions, source.indices); });
        for (std::thread& builder : builders)
            builder.join();
        for (const auto& tree : trees)
            REQUIRE(tree);
    }
    const TracedMesh mesh(scene, corners);
    scene.update(std::vector<Caster>{casterOf(mesh, 0)});
    const std::vector<ShadowRay> rays = randomRays(random, 20000, 9.0f);
    const std::vector<std::uint8_t> expected = trace(scene, rays);
    std::array<std::vector<std::uint8_t>, 4> answers;
    std::vector<std::thread> tracers;
    for (std::size_t i = 0; i < answers.size(); ++i)
        tracers.emplace_back([&, i] { answers[i] = trace(scene, rays); });
    for (std::thread& tracer : tracers)
        tracer.join();
    for (const auto& answer : answers)
        CHECK(answer == expected);
}
