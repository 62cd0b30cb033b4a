// No memory on the host, at every allocation that a call makes: what failed is as if it had not been asked for.
#include <doctest/doctest.h>

#include <algorithm>
#include <new>
#include <tuple>

#include "runtime/allocation_count.hpp"
#include "runtime/scene_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct Outcome {
    bool failed = false, struck = false;
};

/// `call` with no memory from its `first`-th allocation on.
template <typename Call>
Outcome without(std::size_t first, Call&& call)
{
    Outcome outcome;
    const NoMemory none(first);
    try {
        call();
    } catch (const std::bad_alloc&) {
        outcome.failed = true;
    }
    outcome.struck = none.struck();
    return outcome;
}

GnMesh make(SceneFixture& scene, const Shape& shape)
{
    Result<GnMesh> mesh = scene.registry->createMesh(shape.info("shape"));
    REQUIRE(mesh);
    return *mesh;
}

GnInstance place(SceneFixture& scene, GnMesh mesh, double x, GnInstanceFlags flags = 0)
{
    Result<GnInstance> instance = scene.registry->createInstance(instanceOf(mesh, at(x), flags, "thing"));
    REQUIRE(instance);
    return *instance;
}

/// What a frame says of a caster: its instance, where it is, whether it rests, its bounds, its mesh.
using Told = std::tuple<std::uint32_t, float, bool, float, std::uint32_t>;

std::vector<Told> told(const SceneFixture& scene, const SceneRegistry::Snapshot& snapshot)
{
    std::vector<Told> all;
    for (const Caster& caster : snapshot.casters) {
        REQUIRE(caster.mesh);
        REQUIRE(scene.alive(caster.mesh->vertexBuffer));
        all.emplace_back(caster.id, caster.translation.x, caster.isStatic, caster.bounds.upper.x, caster.mesh->id);
    }
    return all;
}

/// A scene that frame 1 has seen, and that has changed in every way since: something was destroyed with its mesh,
/// something moved, something static got other positions, and much is new.
struct Changed {
    SceneFixture scene;

    Changed()
    {
        const GnMesh gone = make(scene, cube()), stays = make(scene, cube()), rewritten = make(scene, cube());
        const GnInstance first = place(scene, gone, 1.0), second = place(scene, stays, 2.0);
        place(scene, rewritten, 3.0, GN_INSTANCE_STATIC_BIT);
        scene.begin();
        scene.registry->destroyInstance(first);
        scene.registry->destroyMesh(gone);
        REQUIRE(scene.registry->setInstanceTransform(second, at(20.0)));
        const Shape larger = cube().scaled(2.0f);
        REQUIRE(scene.registry->updateMeshPositions(rewritten, larger.positions.data(), 8, 0));
        for (int i = 0; i < 40; ++i)
            place(scene, stays, 100.0 + i);
        scene.registry->retire(1); // what only frame 1 has seen is gone
    }
};

std::size_t buffersOf(const SceneFixture& scene)
{
    const std::lock_guard lock(scene.stub.mutex);
    return scene.stub.bindings.size();
}

} // namespace

TEST_CASE("objects leave a slot map without an allocation, however many there are")
{
    SlotMap<int> map;
    std::vector<std::uint64_t> handles;
    for (int i = 0; i < 1000; ++i)
        handles.push_back(map.insert(i));
    long sum = 0;
    const Outcome taken = without(0, [&] {
        for (const std::uint64_t handle : handles)
            sum += map.take(handle);
    });
    CHECK_FALSE(taken.struck);
    CHECK(sum == 999 * 1000 / 2);
    CHECK(map.size() == 0);
}

TEST_CASE("a frame that finds no memory for what has changed finds all of it when it is tried again")
{
    const std::array<double, 3> rests = kNoOrigin, shifts = {1024.0, 0.0, 0.0};
    for (const std::array<double, 3>& origin : {rests, shifts}) {
        CAPTURE(origin[0]);
        const std::vector<Told> expected = [&origin] { // one fixture at a time
            Changed whole;
            return told(whole.scene, whole.scene.registry->begin(2, origin));
        }();
        REQUIRE(expected.size() == 42);
        bool struck = true;
        for (std::size_t first = 0; struck; ++first) {
            CAPTURE(first);
            Changed changed;
            SceneRegistry& registry = *changed.scene.registry;
            changed.scene.said();
            const Outcome tried = without(first, [&] { registry.begin(2, origin); });
            struck = tried.struck;
            CHECK(tried.failed == struck);
            if (tried.failed) {
                registry.retire(1);
                registry.begin(2, origin);
            }
            for (std::uint64_t frame = 3; frame < 5; ++frame) { // both copies of the arrays
                CHECK((told(changed.scene, registry.begin(frame, origin)) == expected));
                registry.retire(frame - 1);
            }
            const std::vector<SceneFixture::Said> said = changed.scene.said();
            CHECK(std::any_of(said.begin(), said.end(),
                              [](const SceneFixture::Said& each) { return each.id == "StaticInstanceMoved"; }));
        }
    }
}

TEST_CASE("a mesh or an instance whose destruction finds no memory is still there, for frames in flight as well")
{
    bool struck = true;
    for (std::size_t first = 0; struck; ++first) {
        CAPTURE(first);
        SceneFixture scene;
        const GnMesh other = make(scene, cube()), mesh = make(scene, cube());
        const GnInstance spare = place(scene, other, 0.0), instance = place(scene, mesh, 1.0);
        const VkBuffer vertices = scene.begin().casters[1].mesh->vertexBuffer;
        scene.registry->destroyInstance(spare);
        scene.registry->destroyMesh(other);

        const Outcome mesh1 = without(first, [&] { scene.registry->destroyMesh(mesh); });
        CHECK(scene.alive(vertices)); // frame 1 draws it
        CHECK(bool(scene.registry->createInstance(instanceOf(mesh))) == mesh1.failed);
        const Outcome instance1 = without(first, [&] { scene.registry->destroyInstance(instance); });
        CHECK(bool(scene.registry->setInstanceTransform(instance, at(5.0))) == instance1.failed);
        struck = mesh1.struck || instance1.struck;

        scene.registry->destroyMesh(mesh);
        scene.registry->destroyInstance(instance);
        CHECK(scene.begin().casters.empty());
        scene.registry->retire(2);
        CHECK_FALSE(scene.alive(vertices));
    }
}

TEST_CASE("a dropped frame gives its uploads back without an allocation")
{
    SceneFixture scene({.discrete = true});
    for (int i = 0; i < 20; ++i)
        place(scene, make(scene, cube()), i);
    scene.begin();
    scene.registry->recordUploads(VK_NULL_HANDLE, 1);
    scene.copied.clear();
    for (int i = 0; i < 20; ++i)
        place(scene, make(scene, cube()), i);
    CHECK_FALSE(without(0, [&] { scene.registry->dropUploads(1); }).struck);
    scene.registry->recordUploads(VK_NULL_HANDLE, 2);
    CHECK(scene.copied.size() == 2 * 40); // positions and indices
    CHECK(buffersOf(scene) >= 2 * 2 * 40);
}

TEST_CASE("an array of instances is made as a whole or not at all, whatever allocation fails")
{
    const std::vector<GnTransform> places = {at(10.0), at(11.0), at(12.0), at(13.0), at(14.0)};
    bool struck = true;
    std::size_t failures = 0;
    for (std::size_t first = 0; struck; ++first) {
        CAPTURE(first);
        SceneFixture scene;
        const GnMesh mesh = make(scene, cube());
        for (int i = 0; i < 14; ++i) // lists have to grow within the array
            place(scene, mesh, i);
        const GnInstanceCreateInfo info = instanceOf(mesh, at(0.0), 0, "thing");
        std::vector<GnInstance> made(places.size(), VK_NULL_HANDLE);
        Result<void> result;
        const Outcome outcome =
            without(first, [&] { result = scene.registry->createInstances(info, places, made.data()); });
        CHECK(result);
        struck = outcome.struck;
        failures += outcome.failed;
        CHECK(std::count(made.begin(), made.end(), GnInstance(VK_NULL_HANDLE)) == (outcome.failed ? 5 : 0));
        CHECK(scene.registry->begin(1, kNoOrigin).casters.size() == (outcome.failed ? 14u : 19u));
    }
    if (countsOnlyOurs()) CHECK(failures > 5); // else none is made to fail
}

TEST_CASE("many instances that move are moved without an allocation")
{
    SceneFixture scene;
    const GnMesh mesh = make(scene, cube());
    std::vector<GnInstance> all;
    std::vector<GnTransform> places;
    for (int i = 0; i < 100; ++i) {
        all.push_back(place(scene, mesh, i));
        places.push_back(at(i + 0.5));
    }
    scene.begin();
    const Outcome moved = without(0, [&] { REQUIRE(scene.registry->setInstanceTransforms(all, places)); });
    CHECK_FALSE(moved.struck);
    for (const Caster& caster : scene.registry->begin(2, kNoOrigin).casters)
        CHECK(caster.translation.x == static_cast<float>(caster.index) + 0.5f);
}
