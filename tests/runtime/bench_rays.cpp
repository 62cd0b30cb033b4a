/// Trees of a deforming mesh: what a revision takes that is built, and one whose trees are handed on. No test, since
/// machines differ: ninja bench_rays && ./tests/bench_rays

#include <benchmark/benchmark.h>
#include <cmath>
#include <deque>

#include "runtime/rays/triangle_tree.hpp"
#include "tests/runtime/ray_fixture.hpp"
#include "tests/runtime/wavy_sheet.hpp"

using namespace gnomon;
using test::TracedMesh;

namespace {

/// Side of a sheet of about so many triangles.
std::uint32_t sideOf(const benchmark::State& state)
{
    return static_cast<std::uint32_t>(std::lround(std::sqrt(double(state.range(0)) / 2.0)));
}

/// Both trees of a revision, from nothing.
void build(benchmark::State& state)
{
    const std::uint32_t side = sideOf(state);
    const std::vector<std::uint32_t> indices = test::sheetTriangles(side);
    RayScene scene;
    std::vector<glm::vec3> corners = test::waves(side, 0.0f);
    const std::size_t count = corners.size();
    corners.emplace_back(0.0f);
    for (auto _ : state)
        benchmark::DoNotOptimize(scene.build(std::span<const glm::vec3>(corners).first(count), indices));
    state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(indices.size() / 3));
}

/// Both trees of a revision while three frames look at those of the ones before.
void move(benchmark::State& state)
{
    const std::uint32_t side = sideOf(state);
    const std::vector<std::uint32_t> indices = test::sheetTriangles(side);
    RayScene scene;
    MeshRaysHistory history;
    std::vector<std::vector<glm::vec3>> phases;
    for (int i = 0; i < 8; ++i) {
        phases.push_back(test::waves(side, 0.05f * float(i)));
        phases.back().emplace_back(0.0f);
    }
    std::deque<std::unique_ptr<MeshRays>> inFlight;
    std::size_t next = 0;
    const auto revise = [&] {
        const std::vector<glm::vec3>& corners = phases[next++ % phases.size()];
        inFlight.push_back(
            scene.build(std::span<const glm::vec3>(corners).first(corners.size() - 1), indices, &history));
        if (inFlight.size() > 3) inFlight.pop_front();
    };
    for (int i = 0; i < 8; ++i)
        revise();
    for (auto _ : state)
        revise();
    state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(indices.size() / 3));
}

/// Of that, the tree that may be walked.
void moveWalkable(benchmark::State& state)
{
    const std::uint32_t side = sideOf(state);
    const std::vector<std::uint32_t> indices = test::sheetTriangles(side);
    RayScene scene;
    const TracedMesh sheet(scene, test::waves(side, 0.0f), indices);
    const std::vector<glm::vec3> corners = test::waves(side, 0.1f);
    for (auto _ : state)
        benchmark::DoNotOptimize(sheet.rays->tree()->refitted(corners, indices));
    state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(indices.size() / 3));
}

BENCHMARK(build)->Arg(10000)->Arg(100352)->Unit(benchmark::kMillisecond);
BENCHMARK(move)->Arg(10000)->Arg(100352)->Unit(benchmark::kMillisecond);
BENCHMARK(move)->Arg(50176)->Threads(2)->UseRealTime()->Unit(benchmark::kMillisecond); // a frame of two such meshes
BENCHMARK(moveWalkable)->Arg(10000)->Arg(100352)->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
