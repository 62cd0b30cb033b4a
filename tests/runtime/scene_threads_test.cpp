// Two threads stream meshes and instances while a third runs frames. Meant for the thread sanitizer as much as for the
// checks below.
#include <doctest/doctest.h>

#include <atomic>
#include <deque>
#include <random>
#include <thread>

#include "runtime/scene_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Creates, moves, rewrites, swaps and destroys until told to stop, then destroys what it has.
void stream(SceneRegistry& registry, std::uint32_t seed, const std::atomic<bool>& stop, std::atomic<int>& steps,
            std::atomic<int>& errors)
{
    struct Thing {
        GnMesh mesh;
        GnInstance instance;
    };
    std::mt19937 random(seed);
    std::vector<Thing> things;
    const auto somewhere = [&random] { return at(static_cast<double>(random() % 100)); };
    const auto drop = [&](std::size_t index) {
        registry.destroyInstance(things[index].instance);
        registry.destroyMesh(things[index].mesh);
        things.erase(things.begin() + static_cast<std::ptrdiff_t>(index));
    };
    for (; !stop.load(); ++steps) {
        const std::size_t dice = random() % 6;
        const std::size_t index = things.empty() ? 0 : random() % things.size();
        if (things.size() < 4 || (dice == 0 && things.size() < 12)) {
            const Result<GnMesh> mesh = registry.createMesh(cube().info("streamed"));
            const Result<GnInstance> instance =
                mesh ? registry.createInstance(instanceOf(*mesh, somewhere())) : Result<GnInstance>(Error{});
            if (instance)
                things.push_back({*mesh, *instance});
            else
                ++errors;
        } else if (dice == 1) {
            drop(index);
        } else if (dice == 2) {
            const Shape shape = cube().scaled(1.0f + static_cast<float>(random() % 8));
            if (!registry.updateMeshPositions(things[index].mesh, shape.positions.data(), 8, 0)) ++errors;
        } else if (dice == 3) {
            if (!registry.setInstanceMesh(things[index].instance, things[0].mesh)) ++errors;
        } else {
            if (!registry.setInstanceTransform(things[index].instance, somewhere())) ++errors;
        }
    }
    while (!things.empty())
        drop(0);
}

} // namespace

TEST_CASE("meshes and instances stream in and out from two threads while frames run")
{
    for (const bool discrete : {false, true}) {
        SceneFixture scene({.discrete = discrete, .background = true});
        const GnMesh ground = *scene.registry->createMesh(cube().info("ground"));
        REQUIRE(scene.registry->createInstance(instanceOf(ground, {}, GN_INSTANCE_STATIC_BIT)));
        GnLightInfo lamp{};
        lamp.type = GN_LIGHT_TYPE_POINT;
        const GnLight light = *scene.registry->createLight(lamp);

        std::atomic<bool> stop{false};
        std::atomic<int> steps{0}, errors{0};
        std::thread first(stream, std::ref(*scene.registry), 1, std::cref(stop), std::ref(steps), std::ref(errors));
        std::thread second(stream, std::ref(*scene.registry), 2, std::cref(stop), std::ref(steps), std::ref(errors));
        std::size_t triangles = 0, wrong = 0;
        for (std::uint64_t frame = 1; frame <= 300 || steps < 3000; ++frame) {
            if (frame > 2) scene.registry->retire(frame - 3);
            const SceneRegistry::Snapshot& snapshot = scene.begin({frame > 150 ? 1024.0 : 0.0, 0.0, 0.0});
            if (scene.registry->uploadsPending()) scene.registry->recordUploads(VK_NULL_HANDLE, frame);
            for (std::size_t i = 0; i < snapshot.casters.size(); ++i) {
                const Caster& caster = snapshot.casters[i];
                wrong += caster.index != i || !caster.mesh || caster.mesh->positions.size() != 8;
                // The view is of one revision: bounds and positions agree.
                wrong += caster.mesh->bounds.upper != caster.mesh->positions[7];
                wrong += !scene.alive(caster.mesh->vertexBuffer) || !scene.alive(caster.mesh->indexBuffer);
            }
            const LightCasters casters = scene.registry->castersOf(*scene.registry->light(light), scene.arena);
            wrong += casters.all.size() != snapshot.casters.size() || casters.statics.size() != 1;
            triangles += casters.triangles;
        }
        stop = true;
        first.join();
        second.join();
        CHECK(errors == 0);
        CHECK(wrong == 0);
        CHECK(triangles > 300 * 12);
        scene.registry->finishBackground();
        const Caster last = scene.begin().casters[0];
        CHECK((last.mesh->topology != nullptr) == kWithTopology);
        scene.registry->recordUploads(VK_NULL_HANDLE, scene.frame);
        scene.registry->retire(scene.frame);
        CHECK(scene.stub.live("buffer") == 2);
        CHECK(scene.stub.faults.empty());
    }
}

TEST_CASE("one mesh may be rewritten from several threads: a whole revision wins")
{
    SceneFixture scene({.background = true});
    const GnMesh mesh = *scene.registry->createMesh(cube().info("shared"));
    REQUIRE(scene.registry->createInstance(instanceOf(mesh)));
    std::vector<std::thread> threads;
    for (int t = 1; t <= 3; ++t)
        threads.emplace_back([&scene, mesh, t] {
            const Shape shape = cube().scaled(static_cast<float>(t));
            for (int i = 0; i < 50; ++i)
                (void)scene.registry->updateMeshPositions(mesh, shape.positions.data(), 8, 0);
        });
    for (std::thread& thread : threads)
        thread.join();
    scene.registry->finishBackground();
    const MeshView& view = *scene.begin().casters[0].mesh;
    const float size = view.positions[7].x;
    CHECK(view.positions[0].x == -size);
    REQUIRE((view.topology != nullptr) == kWithTopology);
    if (view.topology) CHECK(std::abs(view.topology->facePlanes[0].w) == doctest::Approx(4.0f * size * size * size));
    scene.registry->retire(1);
    CHECK(scene.stub.live("buffer") == 2);
}
