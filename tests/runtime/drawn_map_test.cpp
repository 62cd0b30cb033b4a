// How long a light's map serves although things move.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "runtime/select/drawn_map.hpp"
#include "tests/runtime/light_fixture.hpp"

using namespace gnomon;

namespace {

constexpr double kSide = 512.0;
const MapKey kKey{.method = 3, .side = kSide, .width = 2.0}; // a face of a point light's
constexpr double kTexel = 2.0 / kSide;                       // at 1 m

/// A point light at the origin, a wall that stands still, and boxes that move.
struct World {
    MeshView mesh{.bounds = {glm::vec3(-0.5f), glm::vec3(0.5f)}, .revision = 1};
    LightView light = test::lightOf(GN_LIGHT_TYPE_POINT, {}, {0, 0, -1}, 100.0f, 0.0f);
    Caster wall{.id = 1, .bounds = {glm::vec3(-9, -9, -21), glm::vec3(9, 9, -20)}, .revision = 1, .isStatic = true};
    std::vector<Caster> boxes;
    std::vector<const Caster*> all;
    LightCasters casters{.staticStamp = 7, .dynamicStamp = 1};
    FrameArena arena;
    DrawnMap map;
    std::uint64_t frame = 100;

    explicit World(std::size_t count, std::uint32_t lightId = 8)
    {
        light.id = lightId;
        light.revision = 1;
        for (std::size_t i = 0; i < count; ++i) {
            boxes.push_back({.id = static_cast<std::uint32_t>(i + 2), .mesh = &mesh, .revision = 1});
            place(i, glm::vec3(2.0f * static_cast<float>(i), 0.0f, -10.0f));
        }
        gather();
    }
    void place(std::size_t i, const glm::vec3& at)
    {
        Caster& box = boxes[i];
        if (box.translation == at) return;
        box.translation = at;
        box.bounds = {at - 0.5f, at + 0.5f};
        ++box.revision;
        ++casters.dynamicStamp;
    }
    void move(std::size_t i, const glm::vec3& by) { place(i, boxes[i].translation + by); }
    void moveLight(const glm::vec3& by)
    {
        light.constants.positionWs += glm::vec4(by, 0.0f);
        ++light.revision;
    }
    void gather()
    {
        all = {&wall};
        for (const Caster& box : boxes)
            all.push_back(&box);
        casters.all = all;
        casters.statics = casters.all.first(1);
        casters.dynamics = casters.all.subspan(1);
    }
    MapPose next(const MapKey& key = kKey)
    {
        gather();
        arena.reset();
        return map.next(++frame, key, {&light, &casters}, arena);
    }
    /// Whether the next frame draws.
    bool draws(const MapKey& key = kKey) { return next(key).casters == &casters; }
};

/// Metres by which a box at 10 m moves so many texels: its nearest side is half a metre nearer.
glm::vec3 texels(double count)
{
    return {static_cast<float>(count * kTexel * 9.5), 0.0f, 0.0f};
}

} // namespace

TEST_CASE("where nothing moves there is nothing to draw, and what is asked for is what there is")
{
    World world(1);
    CHECK(world.draws());
    for (int frame = 0; frame < 40; ++frame)
        CHECK(world.draws()); // the same pose: its stamp says that nothing is to be done
    CHECK(world.map.every() == 0);
    CHECK(world.map.age() == 0);
}

TEST_CASE("a map is drawn in every second, fourth or eighth frame as far as a texel goes, and in every one beyond")
{
    struct Pace {
        double texelsAFrame;
        std::uint32_t every;
    };
    constexpr Pace kCases[] = {{0.01, 8}, {0.12, 8}, {0.2, 4}, {0.4, 2}, {0.6, 1}, {5.0, 1}};
    for (const Pace& pace : kCases) {
        const double texelsAFrame = pace.texelsAFrame;
        const std::uint32_t every = pace.every;
        CAPTURE(texelsAFrame);
        World world(1);
        world.next();
        int drawn = 0;
        for (int frame = 0; frame < 64; ++frame) {
            world.move(0, texels(texelsAFrame));
            drawn += world.draws();
            if (frame > 8) CHECK(world.map.every() == every);
            CHECK(world.map.age() < every);
        }
        CHECK(drawn >= 64 / static_cast<int>(every));
        CHECK(drawn <= 64 / static_cast<int>(every) + 2);
    }
}

TEST_CASE("what a kept map shows is off by a texel at most, whatever moves how")
{
    std::mt19937 random(11);
    const auto in = [&](float low, float high) { return low + (high - low) * static_cast<float>(random()) / 0x1p32f; };
    int kept = 0;
    for (int round = 0; round < 60; ++round) {
        World world(3);
        const float fastest = std::exp(in(-9.0f, -2.0f));
        for (int frame = 0; frame < 60; ++frame) {
            for (std::size_t i = 0; i < 3; ++i)
                world.move(i, fastest * glm::vec3(in(-1, 1), in(-1, 1), in(-1, 1)));
            const MapPose pose = world.next();
            if (pose.casters == &world.casters) continue;
            ++kept;
            REQUIRE(pose.casters->dynamics.size() == 3);
            REQUIRE(pose.casters->all.front() == &world.wall);
            for (std::size_t i = 0; i < 3; ++i) {
                const Caster &shown = *pose.casters->dynamics[i], &now = world.boxes[i];
                const glm::vec3 a = shown.bounds.center(), b = now.bounds.center();
                const float angle = glm::length(glm::normalize(a) - glm::normalize(b));
                REQUIRE(double{angle} <= kTexel * DrawnMap::kBoundTexels * 1.001);
                REQUIRE(shown.id == now.id);
            }
        }
    }
    CHECK(kept > 200);
}

TEST_CASE("a kept map is looked up with the light it was drawn with, under the stamp of its drawing")
{
    World world(1);
    LightView drawnWith;
    std::uint64_t stamp = 0, revision = 0;
    int kept = 0;
    for (int frame = 0; frame < 40; ++frame) {
        world.move(0, texels(0.01));
        world.moveLight({static_cast<float>(0.01 * kTexel), 0.0f, 0.0f});
        const MapPose pose = world.next();
        if (pose.casters == &world.casters) {
            drawnWith = world.light;
            stamp = world.casters.dynamicStamp;
            revision = world.boxes[0].revision;
            continue;
        }
        ++kept;
        CHECK(pose.light->revision == drawnWith.revision);
        CHECK(pose.light->position() == drawnWith.position());
        CHECK(pose.casters->dynamicStamp == stamp);
        CHECK(pose.casters->dynamics[0]->revision == revision);
    }
    CHECK(kept > 30);
}

TEST_CASE("a jump, a caster that comes, another mesh, another side, or a cut draws at once")
{
    const auto slow = [](World& world) {
        for (int frame = 0; frame < 20; ++frame) {
            world.move(0, texels(0.01));
            world.next();
        }
        while (world.map.age() == 0 || world.map.age() > 4) { // somewhere between two drawings
            world.move(0, texels(0.01));
            world.next();
        }
        world.move(0, texels(0.01));
    };
    World world(2);
    world.next();
    slow(world);
    CHECK(!world.draws()); // what the others below are held against
    slow(world);
    world.move(1, texels(3.0));
    CHECK(world.draws());
    slow(world);
    world.moveLight({0.5f, 0.0f, 0.0f});
    CHECK(world.draws());
    slow(world);
    world.boxes.push_back({.id = 9, .mesh = &world.mesh, .bounds = {glm::vec3(4), glm::vec3(5)}, .revision = 1});
    CHECK(world.draws());
    slow(world);
    ++world.casters.staticStamp;
    CHECK(world.draws());
    slow(world);
    ++world.mesh.revision;
    CHECK(world.draws());
    slow(world);
    CHECK(world.draws({.method = 3, .side = 2.0 * kSide, .width = 2.0}));
    slow(world);
    world.map.lose();
    CHECK(world.draws());
    slow(world);
    world.boxes[0].mesh = nullptr; // the host draws it
    world.move(0, texels(0.01));
    CHECK(world.draws());
}

TEST_CASE("lights that are drawn in every eighth frame take turns")
{
    std::set<std::uint64_t> frames;
    for (std::uint32_t id = 1; id <= 8; ++id) {
        World world(1, id);
        world.next();
        for (int frame = 0; frame < 64; ++frame) {
            world.move(0, texels(0.01));
            if (world.draws() && frame > 40 && frame <= 48) frames.insert(world.frame);
        }
    }
    CHECK(frames.size() == 8);
}
