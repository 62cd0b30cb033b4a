// Levels of trees that rays meet, as the facts estimate them from tiles of receivers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "runtime/scene/topology.hpp"
#include "runtime/select/facts.hpp"
#include "runtime/select/shared_parts.hpp"
#include "tests/runtime/view_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A wall across the view, ten metres away, of 37 x 37 tiles around the middle: a stride of 16 meets every column.
std::vector<ReceiverTile> wall(float flatness)
{
    constexpr std::uint32_t kTiles = 37;
    std::vector<ReceiverTile> tiles;
    for (std::uint32_t y = 0; y < kTiles; ++y)
        for (std::uint32_t x = 0; x < kTiles; ++x) {
            const glm::vec3 at(0.16f * (float(x) - 18.0f), 0.16f * (18.0f - float(y)), -10.0f);
            tiles.push_back({.box = {at - 0.08f, at + 0.08f},
                             .distance = 10.0f,
                             .x = x,
                             .y = y,
                             .plane = {0.1f, 0.0f, 0.0f, flatness},
                             .whole = true});
        }
    return tiles;
}

LightView sun(glm::vec3 direction)
{
    LightView light{};
    light.type = GN_LIGHT_TYPE_DIRECTIONAL;
    light.constants.directionWs = glm::vec4(direction, -2.0f);
    return light;
}

/// Of so many triangles that its tree has so many levels.
struct Box {
    std::vector<std::uint32_t> indices;
    MeshView mesh;
    Caster caster;

    Box(Aabb bounds, std::uint32_t levels) : indices(3 * ((std::size_t{1} << levels) - 1))
    {
        mesh.indices = indices;
        caster.mesh = &mesh;
        caster.bounds = bounds;
    }
};

Reach reachOf(const std::vector<ReceiverTile>& tiles, const LightView& light, std::vector<const Caster*> casters)
{
    TileSample sample;
    return measureReach(camera(), tiles, 1600, light, casters, sample);
}

float levels(const std::vector<ReceiverTile>& tiles, const LightView& light, std::vector<const Caster*> casters)
{
    return reachOf(tiles, light, std::move(casters)).treeLevels;
}

} // namespace

TEST_CASE("a ray counts the levels of every tree whose box it meets, and only those")
{
    const std::vector<ReceiverTile> rough = wall(0.0f); // shows no plane: every receiver may face the light
    const LightView ahead = sun(glm::vec3(0.0f, 0.0f, -1.0f));
    const Box left({glm::vec3(-9.0f, -9.0f, -6.0f), glm::vec3(0.0f, 9.0f, -5.0f)}, 8);
    const Box all({glm::vec3(-9.0f, -9.0f, -4.0f), glm::vec3(9.0f, 9.0f, -3.0f)}, 5);
    const Box behind({glm::vec3(-9.0f, -9.0f, -13.0f), glm::vec3(9.0f, 9.0f, -12.0f)}, 11);
    CHECK(levels(rough, ahead, {}) == 0.0f);
    CHECK(levels(rough, ahead, {&all.caster}) == doctest::Approx(5.0));
    CHECK(levels(rough, ahead, {&left.caster}) == doctest::Approx(4.0).epsilon(0.1)); // half of the ways
    CHECK(levels(rough, ahead, {&behind.caster}) == 0.0f);
    CHECK(levels(rough, ahead, {&all.caster, &left.caster, &behind.caster}) == doctest::Approx(9.0).epsilon(0.1));

    // Towards a light with a position the way ends there.
    LightView lamp{};
    lamp.type = GN_LIGHT_TYPE_POINT;
    lamp.constants.positionWs = glm::vec4(0.0f, 0.0f, -4.5f, 1.0f);
    lamp.constants.directionWs = {0.0f, 0.0f, -1.0f, -2.0f};
    lamp.constants.range = 100.0f;
    CHECK(levels(rough, lamp, {&all.caster}) == 0.0f);
    CHECK(levels(rough, lamp, {&all.caster, &left.caster}) == doctest::Approx(4.0).epsilon(0.1));
}

TEST_CASE("how near receivers are to the light, for the eye's distance, is known at most and on average")
{
    std::vector<ReceiverTile> tiles = wall(0.0f);
    const LightView ahead = sun(glm::vec3(0.0f, 0.0f, -1.0f));
    const Reach even = reachOf(tiles, ahead, {});
    CHECK(even.meanNearness == doctest::Approx(0.1));
    tiles.front().distance = 1.0f; // one of 1369
    const Reach uneven = reachOf(tiles, ahead, {});
    CHECK(uneven.nearness == doctest::Approx(1.0));
    CHECK(uneven.meanNearness == doctest::Approx(0.1 + 0.9 / 1369.0));
    CHECK(reachOf({}, ahead, {}).meanNearness == 0.0f);
}

TEST_CASE("outlines of shadows are as dense as those of the casters, less what other faces hide")
{
    const std::vector<ReceiverTile> rough = wall(0.0f);
    Topology topology;
    Box screen({glm::vec3(-99.0f, -99.0f, -6.5f), glm::vec3(99.0f, 99.0f, -6.0f)}, 3);
    screen.mesh.topology = &topology;
    const float side = 198.0f * 198.0f; // square metres of its bounds, across the wall's normal
    const auto outlines = [&](const LightView& light, float edges, float layers, std::size_t times = 1) {
        topology.whole.meanSideLength = edges * side; // so many metres a square metre
        topology.whole.meanArea = layers * side;
        const std::vector<const Caster*> casters(times, &screen.caster);
        return double{reachOf(rough, light, casters).outlines};
    };
    const LightView ahead = sun(glm::vec3(0.0f, 0.0f, -1.0f));
    CHECK(reachOf(rough, ahead, {}).outlines == 0.0f);
    // A pixel is a centimetre there, 3 % more on the mean.
    CHECK(outlines(ahead, 5.0f, 0.0f) == doctest::Approx(0.05).epsilon(0.05));
    CHECK(outlines(ahead, 5.0f, 0.0f, 3) == doctest::Approx(0.15).epsilon(0.05));
    CHECK(outlines(ahead, 5.0f, 0.6931f) == doctest::Approx(0.025).epsilon(0.05)); // half of the light goes through
    CHECK(outlines(ahead, 5.0f, 0.6931f, 3) == doctest::Approx(0.15 / 8.0).epsilon(0.05));
    CHECK(outlines(ahead, 5000.0f, 0.0f) == doctest::Approx(1.0));        // a pixel shows one at most
    CHECK(outlines(sun(glm::vec3(0.0f, 0.0f, 1.0f)), 5.0f, 0.0f) == 0.0); // on the other side
    const Aabb bounds = screen.caster.bounds;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    screen.caster.bounds = {glm::vec3(-kInfinity, 0.0f, -6.0f), glm::vec3(kInfinity, 0.0f, kInfinity)};
    CHECK(std::isfinite(outlines(ahead, 5.0f, 0.0f)));
    screen.caster.bounds = bounds;

    LightView lamp{};
    lamp.type = GN_LIGHT_TYPE_POINT;
    lamp.constants.positionWs = glm::vec4(0.0f, 0.0f, -3.0f, 1.0f);
    lamp.constants.directionWs = {0.0f, 0.0f, -1.0f, -2.0f};
    lamp.constants.range = 100.0f;
    // Halfway to the lamp: twice as large a shadow. Ways that lean by 25 degrees meet more of the bounds' sides.
    CHECK(outlines(lamp, 5.0f, 0.0f) == doctest::Approx(0.025).epsilon(0.15));
}

TEST_CASE("the penumbra is as wide as similar triangles say, in pixels, of what is nearest and holds no receiver")
{
    const std::vector<ReceiverTile> rough = wall(0.0f);
    const auto pixels = [&](const LightView& light, std::vector<const Caster*> casters) {
        return double{reachOf(rough, light, casters).penumbraPixels};
    };
    // The wall is at z = -10, pixels there are as wide as 10 m times the camera's.
    const double pixel = 10.0 * double{pixelAngleOf(camera())};
    const Box screen({glm::vec3(-99.0f, -99.0f, -6.5f), glm::vec3(99.0f, 99.0f, -6.0f)}, 3);
    const Box nearer({glm::vec3(-99.0f, -99.0f, -8.5f), glm::vec3(99.0f, 99.0f, -8.0f)}, 3);
    const Box own({glm::vec3(-99.0f, -99.0f, -10.5f), glm::vec3(99.0f, 99.0f, -9.99f)}, 3);
    LightView ahead = sun(glm::vec3(0.0f, 0.0f, -1.0f));
    CHECK(pixels(ahead, {&screen.caster}) == 0.0); // a point source
    ahead.constants.sourceRadius = 0.01f;
    CHECK(pixels(ahead, {}) == 0.0);
    CHECK(pixels(ahead, {&own.caster}) == 0.0);
    // Receivers up to 4.1 m beside the middle are farther from the eye: 3 % on the mean.
    CHECK(pixels(ahead, {&screen.caster}) == doctest::Approx(2.0 * 0.01 * 3.5 / pixel).epsilon(0.05));
    CHECK(pixels(ahead, {&screen.caster, &nearer.caster, &own.caster}) ==
          doctest::Approx(2.0 * 0.01 * 1.5 / pixel).epsilon(0.05));

    LightView lamp{};
    lamp.type = GN_LIGHT_TYPE_POINT;
    lamp.constants.positionWs = glm::vec4(0.0f, 0.0f, -3.0f, 1.0f);
    lamp.constants.directionWs = {0.0f, 0.0f, -1.0f, -2.0f};
    lamp.constants.range = 100.0f;
    lamp.constants.sourceRadius = 0.2f;
    CHECK(pixels(lamp, {&screen.caster}) == doctest::Approx(2.0 * 0.2 * 3.5 / 3.5 / pixel).epsilon(0.05)); // half way
    CHECK(penumbraPercent(1.0, 720.0) == 0.0);
    CHECK(penumbraPercent(20.0, 720.0) == doctest::Approx(100.0 * 1.6 * 18.0 / 720.0));
    CHECK(penumbraPercent(1e9, 720.0) == 50.0);
}

TEST_CASE("receivers that face away from the light ask for no ray")
{
    const std::vector<ReceiverTile> flat = wall(1.0f);
    const Box all({glm::vec3(-9.0f, -9.0f, -14.0f), glm::vec3(9.0f, 9.0f, -3.0f)}, 5);
    CHECK(levels(flat, sun(glm::vec3(0.0f, 0.0f, -1.0f)), {&all.caster}) == doctest::Approx(5.0));
    CHECK(levels(flat, sun(glm::vec3(0.0f, 0.0f, 1.0f)), {&all.caster}) == 0.0f);
}

TEST_CASE("of very many casters a part is asked, and stands for all")
{
    const std::vector<ReceiverTile> rough = wall(0.0f);
    std::vector<Box> boxes;
    boxes.reserve(5000);
    for (int i = 0; i < 5000; ++i)
        boxes.emplace_back(Aabb{glm::vec3(-9.0f, -9.0f, -6.0f), glm::vec3(9.0f, 9.0f, -5.0f)}, 3);
    std::vector<const Caster*> casters;
    for (const Box& box : boxes)
        casters.push_back(&box.caster);
    CHECK(levels(rough, sun(glm::vec3(0.0f, 0.0f, -1.0f)), casters) == doctest::Approx(15000.0).epsilon(0.02));
}

TEST_CASE("what moves in every so many frames does not rest in between, what has stopped does")
{
    const auto moveEvery = [](std::uint64_t frames, int times, MotionHistory& motion, int& rested) {
        for (int i = 0; i < times; ++i)
            for (std::uint64_t frame = 0; frame < frames; ++frame) {
                motion.bits = motion.bits << 1 | (frame == 0 ? 1 : 0);
                rested += motion.rests();
            }
    };
    for (const std::uint64_t every : {1, 2, 4, 5, 8, 16}) {
        CAPTURE(every);
        MotionHistory motion;
        int rested = 0;
        CHECK(motion.rests());
        moveEvery(every, 2, motion, rested); // two moves make a rhythm
        rested = 0;
        moveEvery(every, 20, motion, rested);
        CHECK(rested == 0);
        int until = 0;
        while (!motion.rests()) {
            motion.bits <<= 1;
            ++until;
        }
        CHECK(until <= std::max<int>(4, int(every)) + 1);
    }
    MotionHistory rarely;
    int rested = 0;
    moveEvery(40, 5, rarely, rested);
    CHECK(rested == 5 * (40 - 4)); // a move now and then is one of its own
}

TEST_CASE("of eight values the second largest counts: what recurs, not what stands out once")
{
    SecondOfEight shared;
    CHECK(shared.get() == 0.0f);
    shared.add(0.5f);
    CHECK(shared.get() == 0.5f);
    for (int i = 0; i < 20; ++i)
        shared.add(i % 4 ? 0.5f : 2.0f); // one in four brings a grid
    CHECK(shared.get() == 2.0f);
    shared.add(40.0f);
    CHECK(shared.get() == 2.0f);
    for (int i = 0; i < 8; ++i)
        shared.add(3.0f); // what stays is believed
    CHECK(shared.get() == 3.0f);
}

TEST_CASE("of five values the one with half of the weight on either side counts")
{
    WeightedMedianOfFive middle;
    CHECK(middle.get() == 0.0f);
    middle.add(0.7f, 1.0f);
    CHECK(middle.get() == 0.7f);
    middle.add(0.5f, 1.0f);
    middle.add(0.6f, 1.0f);
    CHECK(middle.get() == 0.6f);
    middle.add(0.95f, 20.0f); // more than all the others
    CHECK(middle.get() == 0.95f);
    middle.add(0.9f, 19.0f);
    CHECK(middle.get() == 0.9f);
    middle.add(0.2f, 22.0f); // a spike between its like: the middle of the heavy ones
    CHECK(middle.get() == 0.9f);
    for (int i = 0; i < 5; ++i)
        middle.add(0.4f, 0.0f);
    CHECK(middle.get() == 0.0f);
}

TEST_CASE("work that methods share is known by pass, charged to those that declared it, and scales with the pixels")
{
    SharedParts shared;
    constexpr MethodSet kA{3}, kB{5}, kC{200};
    CHECK(shared.parts(1000.0).empty());
    for (int frame = 0; frame < 5; ++frame) {
        shared.note("view.copy", kA | kB, frame == 2 ? 90.0f : 2.0f); // a spike is none of its
        shared.note("view.hulls", kA, 1.0f);
        shared.note("view.hulls", kA, 3.0f); // of another view
        shared.endFrame(kA | kB, 1000.0);
    }
    const auto of = [&](const MethodSet& methods, double pixels) {
        double ms = 0.0;
        for (const plan::SharedPart& part : shared.parts(pixels))
            if (part.methods == methods) ms += part.ms;
        return ms;
    };
    CHECK(shared.parts(1000.0).size() == 2);
    CHECK(of(kA | kB, 1000.0) == doctest::Approx(2.0));
    CHECK(of(kA, 1000.0) == doctest::Approx(4.0));
    CHECK(of(kA, 250.0) == doctest::Approx(1.0));

    shared.endFrame(kC, 1000.0); // neither ran: both are known all the same
    CHECK(of(kA | kB, 1000.0) == doctest::Approx(2.0));
    shared.note("view.copy", kC, 2.0f);
    shared.endFrame(kA | kC, 1000.0); // A ran and needed nothing
    CHECK(of(kB | kC, 1000.0) == doctest::Approx(2.0));
    CHECK(shared.parts(1000.0).size() == 1); // nobody needs hulls
    for (int frame = 0; frame < 3; ++frame) {
        shared.note(std::string("view.strips").c_str(), kB | kC, 0.5f); // by its text
        shared.endFrame(kB | kC, 1000.0);
    }
    CHECK(of(kB | kC, 1000.0) == doctest::Approx(0.5)); // copies are not needed any more
}

TEST_CASE("work that methods share is known from a knowledge base of this device until a frame has shown it")
{
    const std::vector<std::string_view> algorithms{"map", "stencil", "octree", "stencil"};
    const std::vector<cost::KnowledgePart> base{{"stencil", "view.strips", 1.5e-3},
                                                {"octree", "view.strips", 1.5e-3},
                                                {"unknown", "view.other", 0.5e-3},
                                                {"map", "view.copy", 4.5e-3}};
    SharedParts shared;
    shared.note("view.copy", {0}, 0.5f);
    shared.endFrame({0}, 1000.0);
    shared.teach(base, algorithms);
    REQUIRE(shared.parts(1000.0).size() == 2);
    CHECK(shared.parts(1000.0)[0].methods == MethodSet{0});
    CHECK(shared.parts(1000.0)[0].ms == doctest::Approx(0.5)); // shown: the base has no say
    CHECK(shared.parts(1000.0)[1].methods == MethodSet{1, 2, 3});
    CHECK(shared.parts(1000.0)[1].ms == doctest::Approx(1.5));
    shared.note("view.strips", {1}, 2.5f);
    shared.endFrame({1}, 1000.0);
    CHECK(shared.parts(1000.0)[1].methods == MethodSet{1, 2, 3});
    CHECK(shared.parts(1000.0)[1].ms == doctest::Approx(2.5)); // shown: the base has no say any more
    shared.teach(base, algorithms);
    CHECK(shared.parts(1000.0)[1].ms == doctest::Approx(2.5));
    shared.endFrame({3}, 1000.0); // the other stencil method ran without it
    const std::vector<std::string_view> more{"map", "stencil", "octree", "stencil", "stencil"}; // a host has added one
    shared.teach(base, more);
    CHECK(shared.parts(1000.0)[1].methods == MethodSet{1, 2, 4});
    CHECK(shared.parts(1000.0)[1].ms == doctest::Approx(2.5));
    SharedParts another;
    another.teach(base, algorithms);
    another.teach({}, algorithms); // another base that says nothing
    CHECK(another.parts(1000.0).empty());
}

TEST_CASE("what rays have told of outlines is a mean, and is said anew when it has changed by a seventh")
{
    TracedOutlines traced;
    CHECK(!traced.known());
    traced.add(0.0f, 0.0f);
    CHECK(traced.known());
    CHECK(traced.density() == 0.0f);
    CHECK(traced.texelPixels() == 0.0f); // of no outlines
    traced.add(0.02f, 3.0f);
    CHECK(traced.density() == doctest::Approx(0.01));
    CHECK(traced.texelPixels() == doctest::Approx(3.0)); // each outline counts, not each measurement
    traced.add(0.012f, 3.0f);
    CHECK(traced.density() == doctest::Approx(0.01)); // the mean is 0.0107
    for (int i = 0; i < 40; ++i)
        traced.add(0.04f, 1.0f);
    CHECK(traced.density() == doctest::Approx(0.04).epsilon(0.16));
    CHECK(traced.texelPixels() == doctest::Approx(1.0).epsilon(0.16));
    traced.reset();
    CHECK(!traced.known());
    traced.add(0.5f, 2.0f);
    CHECK(traced.density() == 0.5f); // nothing of before counts
}
