// What the plan counts of a method for a light: the side of its maps, the width of penumbrae, and what it has shown.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "explain/plan_table.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr float kUsualOutlines = 0.03f; // Reach::outlines of lights for which knowledge holds: frame_plan_quality.cpp

rules::RuleBase pricedBase()
{
    rules::RuleBase base;
    base.options.allocation = rules::Options::Allocation::Budget;
    return base;
}

/// The quality that is counted for a lamp's method.
float qualityOf(const PlanTable::Lamp& lamp, std::string_view method)
{
    return lamp.candidates[methodNamed(method)].quality;
}

/// Wrong percent from a quality.
double wrongOf(float quality)
{
    return 1.0 / double{quality} - 1.0;
}

/// A near floor of quality 0.875.
rules::RuleBase flooredBase()
{
    rules::RuleBase base = pricedBase();
    base.policy.floor.when.emplace_back();
    base.policy.floor.minimumQuality = 0.875;
    return base;
}

/// Lights that it holds for.
std::vector<PlanTable::Lamp> nearLamps(std::size_t count)
{
    std::vector<PlanTable::Lamp> lamps(count);
    for (PlanTable::Lamp& lamp : lamps) {
        lamp.able = {methodNamed("shadow_map"), methodNamed("ray_traced")};
        lamp.suited = lamp.memory.incumbent = methodNamed("ray_traced");
        lamp.memory.measured = true;
        lamp.floorTruth = 1.0;
    }
    return lamps;
}

} // namespace

TEST_CASE("within the near floor a light asks for the least side of map that reaches it")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    rules::RuleBase base = pricedBase();
    base.policy.floor.when.emplace_back();
    const std::uint32_t map = methodNamed("shadow_map"), rays = methodNamed("ray_traced");
    std::vector<PlanTable::Lamp> lamps(1);
    PlanTable::Lamp& lamp = lamps[0];
    lamp.able = {map, rays};
    lamp.suited = lamp.memory.incumbent = map;
    lamp.memory.measured = true;
    lamp.memory.outlines.add(kUsualOutlines);
    std::uint64_t frame = 0;
    const auto asked = [&](double minimum, float texelPixels) {
        base.policy.floor.minimumQuality = minimum;
        lamp.memory.texelPixels = texelPixels;
        table.predict(plan, lamps, ++frame, {}, &base);
        return lamp.memory.nearSide;
    };
    CHECK(asked(0.5, 0.45f) == 0); // the light is not near
    lamp.floorTruth = 1.0;
    // Errors fall as 1 / side and grow with the width of a texel: 0.45 pixels are the usual ones.
    const double wrongAt1024 = 1.0 / double{gnomon::qualityOf(table.methods()[map], {})} - 1.0;
    REQUIRE(wrongAt1024 > 0.0);
    for (const double wideness : {0.5, 1.0, 3.0})
        for (const std::uint32_t side : {128u, 512u, 1024u, 4096u}) {
            CAPTURE(side);
            CAPTURE(wideness);
            const double wrong = wrongAt1024 * wideness * 1024.0 / side;
            const auto texel = static_cast<float>(0.45 * wideness);
            CHECK(asked(1.0 / (1.0 + 1.01 * wrong), texel) == side);
            if (side < 4096) CHECK(asked(1.0 / (1.0 + 0.99 * wrong), texel) == 2 * side);
        }
    CHECK(asked(1.0 / (1.0 + 0.9 * wrongAt1024 / 4.0), 0.45f) == 0); // none reaches it
    // The quality that counts is that of the side which is asked for, as far as memory allows it.
    REQUIRE(asked(1.0 / (1.0 + 1.01 * wrongAt1024 / 2.0), 0.45f) == 2048);
    CHECK(wrongOf(qualityOf(lamp, "shadow_map")) == doctest::Approx(wrongAt1024).epsilon(0.01));
    lamp.mostSide = 4096;
    REQUIRE(asked(1.0 / (1.0 + 1.01 * wrongAt1024 / 2.0), 0.45f) == 2048);
    CHECK(wrongOf(qualityOf(lamp, "shadow_map")) == doctest::Approx(wrongAt1024 / 2.0).epsilon(0.01));
    lamp.pinned = map;
    CHECK(asked(0.5, 0.45f) == 0);
    lamp.pinned = UINT32_MAX;
    lamp.suited = rays; // has no map
    CHECK(asked(0.5, 0.45f) == 0);
    lamp.suited = map;
    REQUIRE(table.methods().set("shadow_map", "resolution", 512.0, frame)); // the host's word
    CHECK(asked(0.5, 0.45f) == 0);
}

TEST_CASE("within the near floor lights that reach few pixels may be wronger, and all together hardly are")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    rules::RuleBase base = flooredBase();
    const double asked = wrongOf(0.875f);
    std::vector<PlanTable::Lamp> lamps = nearLamps(5);
    lamps.back().floorTruth = 0.0; // far: nothing is asked of it
    std::uint64_t frame = 0;
    // What each light may have wrong, as a multiple of the floor's.
    const auto times = [&](const std::array<float, 5>& shares) {
        std::array<double, 5> out{};
        for (std::size_t i = 0; i < lamps.size(); ++i)
            for (int newest = 0; newest < 5; ++newest) // the middle of five counts
                lamps[i].memory.share.add(shares[i]);
        table.predict(plan, lamps, ++frame, {}, &base);
        for (std::size_t i = 0; i < lamps.size(); ++i)
            out[i] = wrongOf(lamps[i].decision.minimumQuality) / asked;
        return out;
    };
    for (const double each : times({1.0f, 0.5f, 0.1f, 0.01f, 1.0f})) // by a rule base that does not say so
        CHECK(each == doctest::Approx(1.0).epsilon(1e-3));
    base.policy.floor.oneLightTimes = 7.0;
    constexpr double kAll = 1.0 / 1.5; // kScenesDiffer
    for (PlanTable::Lamp& lamp : lamps)
        lamp.memory.floorTimes = 0.0; // nothing is kept from before
    const std::array shares{1.0f, 0.5f, 0.06f, 0.04f, 1.0f};
    const std::array wronger = times(shares); // near ones reach 0.4 on average, a quarter of which is 0.1
    CHECK(wronger[0] == doctest::Approx(kAll).epsilon(1e-3));
    CHECK(wronger[1] == doctest::Approx(kAll).epsilon(1e-3));
    CHECK(wronger[2] == doctest::Approx(kAll * 0.1 / 0.06).epsilon(1e-2));
    CHECK(wronger[3] == doctest::Approx(kAll * 0.1 / 0.04).epsilon(1e-2));
    double wrong = 0.0, reached = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
        wrong += wronger[i] * double{shares[i]}, reached += double{shares[i]};
    CHECK(wrong < kAll * 1.25 * reached);
    CHECK(times({1.0f, 0.5f, 0.08f, 0.001f, 1.0f})[3] == doctest::Approx(kAll * 7.0).epsilon(1e-2)); // at most
    // A light in a doorway keeps what it has been allowed until that is a quarter too much, or half as much more.
    const double kept = times({1.0f, 0.5f, 0.08f, 0.03f, 1.0f})[3];
    CHECK(times({1.0f, 0.5f, 0.08f, 0.035f, 1.0f})[3] == doctest::Approx(kept));
    CHECK(times({1.0f, 0.5f, 0.08f, 0.025f, 1.0f})[3] == doctest::Approx(kept));
    CHECK(times({1.0f, 0.5f, 0.08f, 0.06f, 1.0f})[3] < 0.6 * kept);
    CHECK(times({1.0f, 0.5f, 0.08f, 0.4f, 1.0f})[3] == doctest::Approx(kAll).epsilon(1e-3));
    lamps[3].memory.measured = false; // what a light reaches is a guess
    CHECK(times({1.0f, 0.5f, 0.08f, 0.01f, 1.0f})[3] == doctest::Approx(1.0).epsilon(1e-3));
}

TEST_CASE("the near floor is of all near lights: outlines allow more to some and less to others")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    rules::RuleBase base = flooredBase();
    const double asked = wrongOf(0.875f);
    std::vector<PlanTable::Lamp> lamps = nearLamps(3);
    for (PlanTable::Lamp& lamp : lamps)
        lamp.memory.share.add(0.5f);
    std::uint64_t frame = 0;
    const auto times = [&](const std::array<float, 3>& densities) {
        std::array<double, 3> out{};
        for (std::size_t i = 0; i < lamps.size(); ++i) {
            lamps[i].memory.traced.reset();
            lamps[i].memory.traced.add(densities[i], 0.45f);
            lamps[i].memory.floorTimes = 0.0; // nothing is kept from before
        }
        table.predict(plan, lamps, ++frame, {}, &base);
        for (std::size_t i = 0; i < lamps.size(); ++i)
            out[i] = wrongOf(lamps[i].decision.minimumQuality) / asked;
        return out;
    };
    for (const double each : times({0.001f, 0.01f, 0.1f})) // each light keeps it by itself
        CHECK(each == doctest::Approx(1.0).epsilon(1e-3));
    base.policy.floor.oneLightTimes = 7.0;
    for (const double each : times({0.02f, 0.02f, 0.02f}))
        CHECK(each == doctest::Approx(1.0 / 1.5).epsilon(1e-3)); // kScenesDiffer
    // 1, 8 and 27 times as hard: by maps of sides 1, 2 and 3 they are 1, 4 and 9 times as wrong.
    const std::array by = times({0.001f, 8.0f * 0.002f - 0.001f, 27.0f * 0.002f - 0.001f});
    CHECK(by[1] == doctest::Approx(4.0 * by[0]).epsilon(1e-2));
    CHECK(by[2] == doctest::Approx(9.0 * by[0]).epsilon(1e-2));
    CHECK(by[0] + by[1] + by[2] == doctest::Approx(3.0 / 1.5).epsilon(1e-2)); // all together
    CHECK(times({0.0f, 0.0f, 0.5f})[0] == doctest::Approx(1.0 / 8.0 / 1.5).epsilon(1e-2));
    base.policy.floor.oneLightTimes = 2.0;
    CHECK(times({0.0f, 0.0f, 0.5f})[2] == doctest::Approx(2.0 / 1.5).epsilon(1e-2)); // at most
    for (PlanTable::Lamp& lamp : lamps)
        lamp.floorTruth = 0.0;
    times({0.0f, 0.0f, 0.5f}); // nobody is near
    CHECK(std::isfinite(lamps[0].decision.minimumQuality));
}

TEST_CASE("a map that is not drawn yet counts with the side that it has now")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    rules::RuleBase base = pricedBase();
    base.policy.floor.when.emplace_back();
    const std::uint32_t map = methodNamed("shadow_map"), rays = methodNamed("ray_traced");
    const double wrongAt1024 = wrongOf(gnomon::qualityOf(table.methods()[map], {}));
    base.policy.floor.minimumQuality = 1.0 / (1.0 + 1.01 * wrongAt1024 / 2.0); // that of 2048
    std::vector<PlanTable::Lamp> lamps(1);
    PlanTable::Lamp& lamp = lamps[0];
    lamp.able = {map, rays};
    lamp.suited = map;
    lamp.floorTruth = 1.0;
    lamp.mostSide = 4096;
    lamp.memory.measured = true;
    lamp.memory.texelPixels = 0.45f;
    lamp.memory.outlines.add(kUsualOutlines);
    table.predict(plan, lamps, 1, {}, &base);
    CHECK(lamp.memory.nearSide == 2048); // it grows meanwhile
    CHECK(wrongOf(qualityOf(lamp, "shadow_map")) == doctest::Approx(wrongAt1024).epsilon(0.01));
    lamp.memory.incumbent = map;
    table.predict(plan, lamps, 2, {}, &base);
    CHECK(wrongOf(qualityOf(lamp, "shadow_map")) == doctest::Approx(wrongAt1024 / 2.0).epsilon(0.01));
}

TEST_CASE("where rays tell of outlines, wrong pixels go by their density and by the texels that they fall on")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    std::vector<PlanTable::Lamp> lamps(1);
    PlanTable::Lamp& lamp = lamps[0];
    lamp.memory.measured = true;
    lamp.memory.texelPixels = 0.45f;
    lamp.memory.outlines.add(kUsualOutlines);
    std::uint64_t frame = 0;
    const auto wrong = [&](std::string_view method) {
        table.predict(plan, lamps, ++frame);
        return wrongOf(qualityOf(lamp, method));
    };
    const double usual = wrong("shadow_map"), usualCascades = wrong("cascades");
    lamp.memory.traced.add(0.009f - 0.001f, 0.45f); // kUsualTraced, kUntraced
    CHECK(wrong("shadow_map") == doctest::Approx(usual).epsilon(1e-3));
    CHECK(wrong("cascades") == doctest::Approx(usualCascades).epsilon(1e-3));
    lamp.memory.traced.reset();
    lamp.memory.traced.add(3.0f * 0.009f - 0.001f, 0.9f); // outlines where texels are twice as wide as elsewhere
    CHECK(wrong("shadow_map") == doctest::Approx(6.0 * usual).epsilon(1e-3));
    CHECK(wrong("cascades") == doctest::Approx(3.0 * usualCascades).epsilon(1e-3)); // its texels follow the view
    CHECK(wrong("ray_traced") == 0.0);
    lamp.memory.traced.reset();
    lamp.memory.traced.add(0.0f, 0.0f); // rays met none: some may lie between them
    CHECK(wrong("shadow_map") == doctest::Approx(usual / 9.0).epsilon(1e-3));
}

TEST_CASE("hard edges cost a method what penumbrae are wide, unless its settings sample the source")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    std::vector<PlanTable::Lamp> lamps(1);
    PlanTable::Lamp& lamp = lamps[0];
    lamp.memory.measured = true;
    lamp.memory.share.add(0.5f);
    lamp.memory.penumbraPixels.add(20.0f);
    lamp.memory.texelPixels = 0.45f;
    std::uint64_t frame = 0;
    const auto predict = [&] { table.predict(plan, lamps, ++frame); };
    predict();
    const double map = wrongOf(qualityOf(lamp, "shadow_map")), soft = wrongOf(qualityOf(lamp, "pcss")),
                 rays = wrongOf(qualityOf(lamp, "ray_traced"));
    CHECK(rays == 0.0);
    lamp.light.constants.sourceRadius = 0.2f;
    predict();
    // 18 of the picture's 360 lines are off, along edges of 1.6 heights: facts.cpp.
    const double hard = 100.0 * 1.6 * 18.0 / 360.0;
    CHECK(wrongOf(qualityOf(lamp, "shadow_map")) == doctest::Approx(map + hard).epsilon(1e-3));
    CHECK(wrongOf(qualityOf(lamp, "ray_traced")) == doctest::Approx(hard).epsilon(1e-3));
    CHECK(wrongOf(qualityOf(lamp, "pcss")) == doctest::Approx(soft).epsilon(1e-3));
    const float hardRayMs = lamp.candidates[methodNamed("ray_traced")].predictedMs;
    lamp.memory.measured = false; // not known: nothing is counted
    predict();
    CHECK(wrongOf(qualityOf(lamp, "ray_traced")) == 0.0);
    lamp.memory.measured = true;

    REQUIRE(table.methods().set("ray_traced", "samples", 16.0, frame));
    predict();
    CHECK(wrongOf(qualityOf(lamp, "ray_traced")) == 0.0);
    CHECK(lamp.candidates[methodNamed("ray_traced")].predictedMs >= hardRayMs);
    REQUIRE(table.methods().set("ray_traced", "reasons", 1.0, frame)); // of the ray to the centre
    predict();
    CHECK(wrongOf(qualityOf(lamp, "ray_traced")) == doctest::Approx(hard).epsilon(1e-3));
}

TEST_CASE("a method that takes five times what it should is on one light, until that is expected of all")
{
    const std::uint32_t own = methodNamed("ray_traced"), other = methodNamed("tile_shafts"); // which show the same
    const rules::RuleBase base = pricedBase();
    constexpr std::uint64_t kAlone = 40, kFrames = 80, kLag = 2;
    for (const double budgetMs : {0.0, 1e6}) {
        CAPTURE(budgetMs);
        PlanTable table;
        FramePlan plan(table.methods(), true);
        const cost::KnowledgeBase& shipped = cost::shippedKnowledge();
        REQUIRE(plan.teach(shipped, {shipped.devices.front().device, shipped.devices.front().kind}).methods > 0);
        std::vector<PlanTable::Lamp> lamps(8);
        for (PlanTable::Lamp& lamp : lamps) {
            lamp.able = {own};
            lamp.suited = lamp.memory.incumbent = own;
            lamp.memory.measured = true;
        }
        struct Served {
            std::uint64_t frame;
            std::array<std::uint32_t, 8> methods;
        };
        std::deque<Served> inFlight;
        std::array<bool, 8> tried{};
        float ownMs = 0.0f, otherMs = 0.0f;
        bool isKnown = false;
        for (std::uint64_t frame = 1; frame <= kFrames; ++frame) {
            table.predict(plan, lamps, frame, {}, &base, -1.0, budgetMs);
            if (frame == 1) {
                otherMs = 5.0f * lamps[0].candidates[other].predictedMs;
                ownMs = 2.0f * lamps[0].candidates[other].sureMs; // the other one seems to take half of it
            }
            Served now{frame, {}};
            std::size_t others = 0;
            for (std::size_t i = 0; i < lamps.size(); ++i) {
                LightMemory& memory = lamps[i].memory;
                now.methods[i] = lamps[i].decision.method;
                tried[i] |= now.methods[i] == other;
                others += tried[i];
                if (now.methods[i] != memory.incumbent) memory.methodSince = frame;
                memory.incumbent = now.methods[i];
            }
            if (!isKnown) CHECK(others <= 1);
            if (isKnown && others == 1)
                for (std::size_t i = 0; i < lamps.size(); ++i)
                    if (!tried[i]) CHECK(2.0f * lamps[i].candidates[other].predictedMs >= otherMs);
            inFlight.push_back(now);
            for (; inFlight.size() > kLag; inFlight.pop_front())
                for (std::size_t i = 0; i < lamps.size(); ++i) {
                    const Served& then = inFlight.front();
                    plan.observe(lamps[i].memory, then.methods[i],
                                 {.frame = then.frame, .resolveCpuMs = then.methods[i] == own ? ownMs : otherMs},
                                 false);
                    isKnown |= then.methods[i] == other && then.frame > lamps[i].memory.methodSince;
                }
            plan.endFrame();
            if (frame == kAlone)
                for (PlanTable::Lamp& lamp : lamps)
                    lamp.able.add(other);
        }
        CHECK(isKnown);
        CHECK(std::count(tried.begin(), tried.end(), true) == 1);
        for (const PlanTable::Lamp& lamp : lamps)
            CHECK(lamp.memory.incumbent == own);
    }
}
