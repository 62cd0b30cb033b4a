// angular_spans: right but for rows for every kind of light, its tables kept while nothing moves.
#include <algorithm>
#include <cmath>
#include <random>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kSpans = "angular_spans";

Scene litBy(demo::LightKind kind)
{
    Scene scene = smallScene();
    scene.instances[1].isStatic = false;
    if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    if (kind == demo::LightKind::Directional) {
        scene.lights[0].kind = kind;
        scene.lights[0].direction = glm::normalize(glm::dvec3(0.4, -1.0, 0.3));
    }
    return scene;
}

constexpr demo::LightKind kKinds[] = {demo::LightKind::Directional, demo::LightKind::Spot, demo::LightKind::Point};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "with finer rows angular_spans comes near ray_traced, whatever the light")
{
    for (const demo::LightKind kind : kKinds) {
        CAPTURE(static_cast<int>(kind));
        Host traced(litBy(kind), {.extent = {640, 360}}), spans(litBy(kind), {.extent = {640, 360}});
        traced.pinAll("ray_traced");
        spans.pinAll(kSpans);
        traced.require(traced.draw());
        const std::vector<Image8> truth = traced.pictures();
        CHECK(dark(truth[0]) > 1000);
        size_t wrong[2];
        for (int i = 0; i < 2; ++i) {
            spans.require(gnSetMethodSetting(spans.context, kSpans, "rows", i == 0 ? 50.0 : 800.0));
            spans.require(spans.draw());
            REQUIRE(std::string(spans.decision(0).pMethod) == kSpans);
            wrong[i] = differences(truth, spans.pictures());
        }
        MESSAGE("wrong at 50 rows " << wrong[0] << ", at 800 " << wrong[1]);
        CHECK(wrong[0] > 4 * wrong[1]); // four doublings, 1.4 each
        CHECK(wrong[1] < 640 * 360 / 1000);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "where shadows of many casters overlap within a tile of pixels, none is passed over")
{
    for (const demo::LightKind kind : kKinds) {
        CAPTURE(static_cast<int>(kind));
        Scene scene = litBy(kind);
        std::mt19937 random(3);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (int i = 0; i < 60; ++i) {
            demo::Instance crate = scene.instances[1];
            crate.name = "crate" + std::to_string(i);
            crate.pose.position = {1.8 * unit(random), 1.6 + 0.8 * unit(random), 1.8 * unit(random)};
            crate.pose.scale = glm::dvec3(0.15 + 0.1 * unit(random), 0.05, 0.15 + 0.1 * unit(random));
            scene.instances.push_back(crate);
        }
        Host traced(scene), spans(scene);
        traced.pinAll("ray_traced");
        spans.pinAll(kSpans);
        spans.require(gnSetMethodSetting(spans.context, kSpans, "rows", 800.0));
        traced.require(traced.draw());
        spans.require(spans.draw());
        REQUIRE(std::string(spans.decision(0).pMethod) == kSpans);
        const std::vector<Image8> truth = traced.pictures(), seen = spans.pictures();
        size_t falseLit = 0;
        for (size_t i = 0; i < truth[0].texels.size(); ++i)
            falseLit += truth[0].texels[i] < 128 && seen[0].texels[i] >= 128;
        MESSAGE("of " << dark(truth[0]) << " dark pixels " << falseLit << " lit");
        CHECK(dark(truth[0]) > 2000);
        CHECK(falseLit <= 5);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "its tables are made once, again for what moved, and equal those of a fresh context")
{
    for (const demo::LightKind kind : kKinds) {
        CAPTURE(static_cast<int>(kind));
        Host host(litBy(kind), {.viewCount = 2});
        host.pinAll(kSpans);
        host.require(host.draw());
        CHECK(host.passCount("angular_spans.table") == 1); // one for both views
        const uint32_t all = host.stats().indexListsBuilt;
        CHECK(all >= 3);
        for (int frame = 0; frame < 3; ++frame) {
            host.require(host.draw());
            CHECK(host.passCount("angular_spans.table") == 0);
            CHECK(host.stats().indexListsBuilt == 0);
            CHECK(host.stats().passesKept > 0);
        }
        host.scene.instances[1].pose.position.x += 0.4;
        host.require(host.draw());
        CHECK(host.stats().indexListsBuilt == 1); // the ball's
        host.scene.lights[0].position.x -= 0.7;
        host.scene.lights[0].direction = glm::normalize(host.scene.lights[0].direction + glm::dvec3(0.1, 0.0, 0.0));
        host.require(host.draw());
        CHECK(host.stats().indexListsBuilt == all);
        Host fresh(host.scene, {.viewCount = 2});
        fresh.pinAll(kSpans);
        fresh.require(fresh.draw());
        CHECK(dark(host.pictures()[0]) > 100);
        for (const uint32_t view : {0u, 1u})
            CHECK(differences(host.pictures(view), fresh.pictures(view)) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "it serves no recorded frame, and no caster that is alpha-tested")
{
    Host host(litBy(demo::LightKind::Spot));
    host.pinAll(kSpans);
    host.require(host.draw({.call = Call::record}));
    CHECK(std::string(host.decision(0).pMethod) != kSpans);

    Scene scene = litBy(demo::LightKind::Spot);
    scene.instances[1].alphaTested = true;
    Host holes(scene);
    holes.pinAll(kSpans);
    holes.require(holes.draw());
    CHECK(std::string(holes.decision(0).pMethod) != kSpans);
    CHECK(holes.explanation(0).find("alpha-tested casters in range") != std::string::npos);
}

TEST_CASE_FIXTURE(DeviceTest, "a light whose tables would have more rows than a million is served by another method")
{
    Scene scene = litBy(demo::LightKind::Spot);
    const size_t few = scene.instances.size();
    for (int i = 0; i < 256; ++i) {
        demo::Instance crate = scene.instances[1];
        crate.name = "crate" + std::to_string(i);
        crate.pose.position = {0.1 * (i % 16) - 0.8, 1.5, 0.1 * (i / 16) - 0.8};
        crate.pose.scale = glm::dvec3(0.03);
        scene.instances.push_back(crate);
    }
    REQUIRE(few >= 2); // so that there are more than 256 casters
    Host host(scene);
    host.warm("ray_traced");
    host.pinAll(kSpans);
    host.require(gnSetMethodSetting(host.context, kSpans, "rows", 4096.0));
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) != kSpans);
    CHECK(host.explanation(0).find("casters in range times rows are more than 1048576") != std::string::npos);
    host.require(gnSetMethodSetting(host.context, kSpans, "rows", 300.0));
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == kSpans);
    CHECK(host.stats().indexListsBuilt >= 256);
}
