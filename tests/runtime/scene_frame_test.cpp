// What one frame sees: against a slow and obvious model, and in what it costs.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "runtime/allocation_count.hpp"
#include "runtime/scene_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct World {
    SceneFixture scene;
    GnMesh mesh;
    explicit World(const SceneOptions& options = {}) : scene(options)
    {
        mesh = *scene.registry->createMesh(cube().info("box"));
    }
    GnInstance place(const GnTransform& transform, GnInstanceFlags flags = 0, const char* name = "thing")
    {
        return *scene.registry->createInstance(instanceOf(mesh, transform, flags, name));
    }
    GnLight bulb(double x, float range = 0.0f, GnLightFlags flags = 0)
    {
        GnLightInfo info{};
        info.type = GN_LIGHT_TYPE_POINT;
        info.pName = "bulb";
        info.flags = flags;
        info.position[0] = x;
        info.range = range;
        return *scene.registry->createLight(info);
    }
    LightCasters castersOf(GnLight light)
    {
        return scene.registry->castersOf(*scene.registry->light(light), scene.arena);
    }
};

} // namespace

TEST_CASE("a caster carries its transform, relative to the origin in double precision")
{
    World world;
    GnTransform transform = at(1e7 + 0.25, -3.0, 1e7);
    const float rows[9] = {0, -2, 0, 1, 0, 0.5f, 0, 0, 3}; // det > 0
    std::copy_n(rows, 9, transform.basis);
    world.place(transform);
    transform.basis[8] = -3.0f;
    world.place(transform);
    const SceneRegistry::Snapshot& snapshot = world.scene.begin({1e7, 0.0, 1e7 - 1024.0});
    const Caster& caster = snapshot.casters[0];
    CHECK(caster.translation == glm::vec3(0.25f, -3.0f, 1024.0f));
    CHECK(caster.basis * glm::vec3(1, 2, 3) + caster.translation == glm::vec3(-4 + 0.25f, 1 + 1.5f - 3, 9 + 1024));
    CHECK_FALSE(caster.mirrored);
    CHECK(snapshot.casters[1].mirrored);
    CHECK(caster.bounds.upper.z == doctest::Approx(1027.0f));
    const InstanceTransform& table = snapshot.transforms[caster.index];
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            CHECK(table.rows[4 * row + column] == rows[3 * row + column]);
        CHECK(table.rows[4 * row + 3] == caster.translation[row]);
    }
    CHECK(caster.closed == kWithTopology);
    CHECK(caster.id != snapshot.casters[1].id);
}

TEST_CASE("what stands still keeps its revision, what is set to where it is too")
{
    World world;
    const GnInstance still = world.place(at(1));
    const GnInstance moving = world.place(at(2));
    const SceneRegistry::Snapshot& first = world.scene.begin();
    const std::uint64_t revision = first.revision;
    const std::uint64_t a = first.casters[0].revision, b = first.casters[1].revision;
    CHECK(a != b);
    GnTransform same = at(1);
    same.basis[0] = same.basis[4] = same.basis[8] = 1.0f; // the identity, spelled out
    REQUIRE(world.scene.registry->setInstanceTransform(still, same));
    REQUIRE(world.scene.registry->setInstanceMesh(still, world.mesh));
    const SceneRegistry::Snapshot& second = world.scene.begin();
    CHECK(second.revision == revision);
    CHECK(second.casters.data() == first.casters.data());
    REQUIRE(world.scene.registry->setInstanceTransform(moving, at(3)));
    const SceneRegistry::Snapshot& third = world.scene.begin();
    CHECK(third.revision != revision);
    CHECK(third.casters[0].revision == a);
    CHECK(third.casters[1].revision != b);
}

TEST_CASE("a static instance that moves is reported once and counts as moving from then on")
{
    World world;
    const GnInstance tower = world.place(at(0), GN_INSTANCE_STATIC_BIT, "tower");
    CHECK(world.scene.begin().casters[0].isStatic);
    REQUIRE(world.scene.registry->setInstanceTransform(tower, at(0)));
    CHECK(world.scene.said().empty());
    for (int i = 1; i < 4; ++i)
        REQUIRE(world.scene.registry->setInstanceTransform(tower, at(i)));
    const auto said = world.scene.said();
    REQUIRE(said.size() == 1);
    CHECK(said[0].severity == GN_SEVERITY_WARNING);
    CHECK(said[0].id == "StaticInstanceMoved");
    CHECK(said[0].text.find("'tower'") != std::string::npos);
    CHECK_FALSE(world.scene.begin().casters[0].isStatic);
}

TEST_CASE("a static instance whose mesh is rewritten counts as moving; one that swaps its mesh stays static")
{
    World world;
    const GnInstance flag = world.place(at(0), GN_INSTANCE_STATIC_BIT, "flag");
    const GnMesh coarse = *world.scene.registry->createMesh(cube().info("coarse"));
    world.scene.begin();
    REQUIRE(world.scene.registry->setInstanceMesh(flag, coarse));
    CHECK(world.scene.begin().casters[0].isStatic);
    const Shape shape = cube().scaled(2.0f);
    for (int i = 0; i < 2; ++i) {
        REQUIRE(world.scene.registry->updateMeshPositions(coarse, shape.positions.data(), 8, 0));
        CHECK_FALSE(world.scene.begin().casters[0].isStatic);
    }
    const auto said = world.scene.said();
    REQUIRE(said.size() == 1);
    CHECK(said[0].text.find("'flag'") != std::string::npos);
}

TEST_CASE("snapshots equal a model after any sequence of changes, and the one before stays as it was")
{
    struct Expected {
        GnInstance handle;
        GnTransform transform;
        GnMesh mesh;
    };
    SceneFixture scene;
    std::mt19937 random(99);
    std::vector<GnMesh> meshes;
    std::map<GnMesh, float> sizes; // of living meshes
    std::vector<Expected> model;   // by creation
    std::vector<Caster> before;
    const Caster* beforeAt = nullptr;
    std::array<double, 3> origin{};
    std::uint64_t frame = 0;
    for (int step = 0; step < 3000; ++step) {
        const std::uint32_t dice = static_cast<std::uint32_t>(random() % 100);
        const auto pick = [&random](std::size_t count) { return static_cast<std::size_t>(random() % count); };
        if (dice < 8 || meshes.empty()) {
            meshes.push_back(*scene.registry->createMesh(cube().info("m")));
            sizes[meshes.back()] = 1.0f;
        } else if (dice < 20) {
            const GnMesh mesh = meshes[pick(meshes.size())];
            model.push_back({*scene.registry->createInstance(instanceOf(mesh, at(step))), at(step), mesh});
        } else if (dice < 24) {
            const std::size_t index = pick(meshes.size());
            scene.registry->destroyMesh(meshes[index]);
            sizes.erase(meshes[index]);
            meshes.erase(meshes.begin() + static_cast<std::ptrdiff_t>(index));
        } else if (dice < 30) {
            const GnMesh mesh = meshes[pick(meshes.size())];
            sizes[mesh] = static_cast<float>(step + 2);
            const Shape shape = cube().scaled(sizes[mesh]);
            REQUIRE(scene.registry->updateMeshPositions(mesh, shape.positions.data(), 8, 0));
        } else if (dice < 40 && !model.empty()) {
            const std::size_t index = pick(model.size());
            scene.registry->destroyInstance(model[index].handle);
            model.erase(model.begin() + static_cast<std::ptrdiff_t>(index));
        } else if (dice < 60 && !model.empty()) {
            Expected& entry = model[pick(model.size())];
            entry.transform = at(-step, step, 1);
            REQUIRE(scene.registry->setInstanceTransform(entry.handle, entry.transform));
        } else if (dice < 65 && !model.empty()) {
            Expected& entry = model[pick(model.size())];
            entry.mesh = meshes[pick(meshes.size())];
            REQUIRE(scene.registry->setInstanceMesh(entry.handle, entry.mesh));
        } else {
            if (dice == 99) origin[0] += 1024.0;
            const SceneRegistry::Snapshot& snapshot = scene.begin(origin);
            ++frame;
            // The arrays of the frame before are untouched.
            for (std::size_t i = 0; i < before.size(); ++i) {
                REQUIRE(beforeAt[i].id == before[i].id);
                REQUIRE(beforeAt[i].revision == before[i].revision);
                REQUIRE(beforeAt[i].translation == before[i].translation);
                REQUIRE(beforeAt[i].mesh == before[i].mesh);
            }
            std::size_t index = 0;
            for (const Expected& entry : model) {
                if (!sizes.contains(entry.mesh)) continue;
                REQUIRE(index < snapshot.casters.size());
                const Caster& caster = snapshot.casters[index];
                REQUIRE(caster.index == index);
                REQUIRE(caster.translation.x == static_cast<float>(entry.transform.translation[0] - origin[0]));
                REQUIRE(caster.mesh->positions[7].x == sizes[entry.mesh]);
                REQUIRE(snapshot.transforms[index].rows[3] == caster.translation.x);
                REQUIRE(caster.bounds.upper.x == doctest::Approx(caster.translation.x + sizes[entry.mesh]));
                ++index;
            }
            REQUIRE(index == snapshot.casters.size());
            before.assign(snapshot.casters.begin(), snapshot.casters.end());
            beforeAt = snapshot.casters.data();
            if (frame > 2) scene.registry->retire(frame - 2);
        }
    }
    CHECK(frame > 500);
}

TEST_CASE("a new origin is a new revision for everything, the same origin for nothing")
{
    World world;
    world.place(at(1));
    const GnLight light = world.bulb(0.0);
    const std::uint64_t caster = world.scene.begin().casters[0].revision;
    const std::uint64_t lamp = world.scene.registry->light(light)->revision;
    CHECK(world.scene.begin().casters[0].revision == caster);
    CHECK(world.scene.begin({1024.0, 0.0, 0.0}).casters[0].revision != caster);
    CHECK(world.scene.registry->light(light)->revision != lamp);
    CHECK(world.scene.registry->light(light)->position() == glm::vec3(-1024, 0, 0));
}

TEST_CASE("frames allocate nothing while things move, meshes come to an end and lights change")
{
    World world;
    std::vector<GnInstance> things;
    for (int i = 0; i < 200; ++i)
        things.push_back(world.place(at(i), i % 2 ? GN_INSTANCE_STATIC_BIT : 0));
    const GnLight light = world.bulb(0.0);
    const GnMesh doomed = *world.scene.registry->createMesh(cube().info("doomed"));
    REQUIRE(world.scene.registry->createInstance(instanceOf(doomed)));
    for (int i = 0; i < 3; ++i) {
        world.scene.begin();
        world.castersOf(light);
    }
    GnLightInfo info{};
    info.type = GN_LIGHT_TYPE_POINT;
    std::size_t inFrames = 0;
    for (std::uint64_t i = 0; i < 20; ++i) {
        for (std::size_t k = 0; k < things.size(); k += 2)
            REQUIRE(world.scene.registry->setInstanceTransform(things[k], at(static_cast<double>(i + k) + 0.5)));
        info.position[0] = static_cast<double>(i);
        REQUIRE(world.scene.registry->updateLight(light, info));
        if (i == 10) world.scene.registry->destroyInstance(things[1]);
        if (i == 12) world.scene.registry->destroyMesh(doomed);
        const std::size_t before = allocationCount();
        world.scene.begin({i == 5 ? 1024.0 : 0.0, 0.0, 0.0});
        world.castersOf(light);
        (void)world.scene.registry->uploadsPending();
        inFrames += allocationCount() - before;
    }
    CHECK(inFrames == 0);
}

TEST_CASE("a light's casters match its mask and reach, statics first")
{
    World world;
    const auto with = [&world](double x, GnInstanceFlags flags, std::uint32_t mask) {
        GnInstanceCreateInfo info = instanceOf(world.mesh, at(x), flags);
        info.casterMask = mask;
        return *world.scene.registry->createInstance(info);
    };
    with(0, 0, 0);
    with(3, GN_INSTANCE_STATIC_BIT, 2);
    with(4, 0, 4);
    with(50, GN_INSTANCE_STATIC_BIT, 2);
    GnLightInfo info{};
    info.type = GN_LIGHT_TYPE_POINT;
    info.range = 10.0f;
    info.casterMask = 3;
    const GnLight light = *world.scene.registry->createLight(info);
    const SceneRegistry::Snapshot& snapshot = world.scene.begin();
    LightCasters casters = world.castersOf(light);
    REQUIRE(casters.all.size() == 2);
    REQUIRE(casters.statics.size() == 1);
    CHECK(casters.statics[0] == &snapshot.casters[1]);
    CHECK(casters.dynamics[0] == &snapshot.casters[0]);
    CHECK(casters.all[0] == casters.statics[0]);
    CHECK(casters.triangles == 24);
    CHECK(casters.hostDrawn == 0);

    GnInstanceCreateInfo grass = instanceOf(VK_NULL_HANDLE, {}, GN_INSTANCE_HOST_DRAWN_BIT);
    grass.pfnDrawCasters = [](VkCommandBuffer, const GnCasterProjection*, void*) {};
    REQUIRE(world.scene.registry->createInstance(grass));
    grass.flags |= GN_INSTANCE_MAY_BE_MISSED_BIT;
    REQUIRE(world.scene.registry->createInstance(grass));
    world.scene.begin();
    casters = world.castersOf(light);
    CHECK(casters.all.size() == 4);
    CHECK(casters.hostDrawn == 1);
}

TEST_CASE("what the host draws is another caster in every frame, unless it is promised to rest")
{
    World world;
    const GnLight light = world.bulb(0.0, 10.0f);
    GnInstanceCreateInfo grass = instanceOf(VK_NULL_HANDLE, {}, GN_INSTANCE_HOST_DRAWN_BIT);
    grass.pfnDrawCasters = [](VkCommandBuffer, const GnCasterProjection*, void*) {};
    const GnInstance moving = *world.scene.registry->createInstance(grass);
    grass.flags |= GN_INSTANCE_STATIC_BIT;
    REQUIRE(world.scene.registry->createInstance(grass));
    world.place(at(1));
    const auto revisions = [&] {
        world.scene.begin();
        std::vector<std::uint64_t> result;
        const LightCasters casters = world.castersOf(light);
        for (const Caster* caster : casters.all)
            result.push_back(caster->revision);
        return result; // the static one first
    };
    const std::vector<std::uint64_t> first = revisions(), second = revisions();
    REQUIRE(first.size() == 3);
    REQUIRE(second.size() == 3);
    CHECK(second[0] == first[0]);
    CHECK(second[1] != first[1]);
    CHECK(second[2] == first[2]);
    world.scene.registry->destroyInstance(moving);
    const std::vector<std::uint64_t> third = revisions();
    CHECK(third == std::vector{first[0], first[2]});
}

TEST_CASE("stamps change exactly when the set or a member does")
{
    World world;
    const GnLight light = world.bulb(0.0, 10.0f);
    const auto stamps = [&] {
        world.scene.begin();
        const LightCasters casters = world.castersOf(light);
        return std::pair(casters.staticStamp, casters.dynamicStamp);
    };
    const auto empty = stamps();
    CHECK(empty.first != 0);
    CHECK(empty.second == 0);
    world.place(at(0), GN_INSTANCE_STATIC_BIT);
    const auto one = stamps();
    CHECK(one.first != empty.first);
    const GnInstance walker = world.place(at(1));
    const auto two = stamps();
    CHECK(two.first == one.first);
    CHECK(two.second != 0);
    CHECK(stamps() == two); // a moving instance that stands still
    REQUIRE(world.scene.registry->setInstanceTransform(walker, at(2)));
    const auto moved = stamps();
    CHECK(moved.first == one.first);
    CHECK(moved.second != two.second);
    // Far away things do not matter, whatever they do.
    const GnInstance far = world.place(at(100), GN_INSTANCE_STATIC_BIT);
    CHECK(stamps() == moved);
    REQUIRE(world.scene.registry->setInstanceTransform(far, at(200)));
    CHECK(stamps() == moved);
    world.scene.registry->destroyInstance(far);
    CHECK(stamps() == moved);
    REQUIRE(world.scene.registry->setInstanceTransform(walker, at(100)));
    CHECK(stamps() == one);
    world.scene.registry->destroyMesh(world.mesh);
    CHECK(stamps() == empty);
}

TEST_CASE("a light set to what it is keeps its revision; weight alone makes no new one")
{
    World world;
    const GnLight light = world.bulb(1.0, 5.0f);
    const auto update = [&](auto change) {
        GnLightInfo info{};
        info.type = GN_LIGHT_TYPE_POINT;
        info.position[0] = 1.0;
        info.range = 5.0f;
        change(info);
        REQUIRE(world.scene.registry->updateLight(light, info));
        world.scene.begin();
        return world.scene.registry->light(light)->revision;
    };
    const std::uint64_t first = update([](GnLightInfo&) {});
    CHECK(update([](GnLightInfo& info) { info.direction[0] = 3.0f; }) == first); // a point light has none
    CHECK(update([](GnLightInfo& info) { info.importance = 4.0f; }) == first);
    CHECK(world.scene.registry->light(light)->importance == 4.0f);
    CHECK(update([](GnLightInfo& info) { info.sourceRadius = 0.1f; }) != first);
    const std::uint64_t back = update([](GnLightInfo&) {});
    CHECK(back != first);
    CHECK(update([](GnLightInfo& info) { info.range = 6.0f; }) != back);
}

TEST_CASE("a static light that moves is reported once and counts as moving from then on")
{
    World world;
    const GnLight light = world.bulb(0.0, 5.0f, GN_LIGHT_STATIC_BIT);
    world.scene.begin();
    CHECK(world.scene.registry->light(light)->isStatic);
    GnLightInfo info{};
    info.type = GN_LIGHT_TYPE_POINT;
    info.flags = GN_LIGHT_STATIC_BIT;
    info.range = 5.0f;
    info.sourceRadius = 0.5f; // not a move
    REQUIRE(world.scene.registry->updateLight(light, info));
    CHECK(world.scene.said().empty());
    for (int i = 1; i < 4; ++i) {
        info.position[0] = i;
        REQUIRE(world.scene.registry->updateLight(light, info));
    }
    const auto said = world.scene.said();
    REQUIRE(said.size() == 1);
    CHECK(said[0].id == "StaticLightMoved");
    CHECK(said[0].text.find("'bulb'") != std::string::npos);
    world.scene.begin();
    CHECK_FALSE(world.scene.registry->light(light)->isStatic);
}

TEST_CASE("a frame's view of a light stays as it is while the light is updated and destroyed")
{
    World world;
    const GnLight light = world.bulb(1.0);
    world.scene.begin();
    const LightView* first = world.scene.registry->light(light);
    GnLightInfo info{};
    info.type = GN_LIGHT_TYPE_POINT;
    info.position[0] = 2.0;
    REQUIRE(world.scene.registry->updateLight(light, info));
    CHECK(first->position().x == 1.0f);
    CHECK(world.scene.registry->light(light) == first);
    world.scene.begin();
    const LightView* second = world.scene.registry->light(light);
    CHECK(first->position().x == 1.0f);
    CHECK(second->position().x == 2.0f);
    const std::uint32_t id = second->id;
    world.scene.registry->destroyLight(light);
    CHECK(world.scene.registry->light(light) == nullptr);
    CHECK(second->position().x == 2.0f);
    world.scene.registry->retire(1);
    CHECK(std::string(second->name) == "bulb"); // frame 2 is not done yet
    const GnLight other = world.bulb(3.0);
    world.scene.begin();
    CHECK(world.scene.registry->light(other)->id != id);
}

TEST_CASE("names are copied, and stay until the frame that saw their instance is done")
{
    World world;
    std::string name = "short-lived";
    const GnInstance thing = world.place(at(0), 0, name.c_str());
    name.assign("overwritten");
    const Caster& caster = world.scene.begin().casters[0];
    CHECK(std::string(caster.name) == "short-lived");
    world.scene.registry->destroyInstance(thing);
    CHECK(std::string(caster.name) == "short-lived");
    CHECK(world.scene.begin().casters.empty());
}

TEST_CASE("an instance of a destroyed mesh casts nothing until it gets another")
{
    World world;
    const GnInstance thing = world.place(at(0));
    CHECK(world.scene.begin().casters.size() == 1);
    world.scene.registry->destroyMesh(world.mesh);
    CHECK(world.scene.begin().casters.empty());
    const GnMesh other = *world.scene.registry->createMesh(cube().info("other"));
    CHECK(world.scene.begin().casters.empty());
    REQUIRE(world.scene.registry->setInstanceMesh(thing, other));
    const SceneRegistry::Snapshot& snapshot = world.scene.begin();
    REQUIRE(snapshot.casters.size() == 1);
    CHECK(std::string(snapshot.casters[0].mesh->name) == "other");
}

TEST_CASE("instances made and removed without any frame pile up nothing")
{
    World world;
    for (int i = 0; i < 5000; ++i)
        world.scene.registry->destroyInstance(world.place(at(i)));
    const GnInstance last = world.place(at(1));
    CHECK(world.scene.begin().casters.size() == 1);
    world.scene.registry->destroyInstance(last);
    CHECK(world.scene.begin().casters.empty());
}
