// Methods that answer by geometry, in places where the bounds at time 0 of each scene (bounds_test.cpp) say nothing:
// once everything has moved, and with other numbers of lights. MESSAGE prints what is measured.
#include "demo/program/measure.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

/// Pooled over the lights of a frame.
struct FrameError {
    ErrorCount error;
    uint64_t clear = 0; ///< Wrong pixels with a clear answer, all lights together.
};

FrameError errorOf(Stage& stage, const std::string& method, const Settings& settings = {})
{
    const Pictures pictures = stage.draw(method, settings);
    FrameError frame{.error = pooled(stage, pictures)};
    for (size_t layer = 0; layer < pictures.size(); ++layer)
        frame.clear += clearlyWrong(stage.scene(), stage, pictures[layer], layer);
    MESSAGE(stage.scene().name << ", " << stage.present.size() << " lights: " << method << " wrong "
                               << inWords(frame.error) << ", clearly " << frame.clear);
    CHECK(frame.error.counted > 10000); // else a percentage says little
    return frame;
}

/// Those of hard shadows that call themselves exact, but for the truth. @return how many they are
uint32_t checkExactMethods(Stage& stage)
{
    constexpr GnTraits kExact = GN_TRAIT_EXACT_BIT | GN_TRAIT_HARD_BIT;
    const bool standard = stage.scene().depth.convention == demo::DepthConvention::Standard;
    uint32_t methods = 0;
    for (const GnMethodInfo& info : stage.methods()) {
        const std::string method = info.pName;
        if ((info.traits & kExact) != kExact || method == demo::kTruthMethod) continue;
        ++methods;
        CAPTURE(method);
        const FrameError now = errorOf(stage, method);
        CHECK(now.error.percent(now.error.wrong()) <= edgePercent(standard ? 0.04 : 0.005));
        if (!standard) CHECK(now.clear <= 2);
    }
    return methods;
}

} // namespace

TEST_CASE("methods that answer by geometry are as exact once everything has moved")
{
    constexpr double kLater = 3.1; // seconds: all keys have moved on, the scenario has changed its lights
    const test::DeviceTest silence;
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        Stage stage(shippedScene(name), testSize(), kLater);
        const uint32_t methods = checkExactMethods(stage);
        CHECK(methods >= 6);
    }
}

TEST_CASE("they are as exact where a building is one mesh, with its lamps and the eye within its bounds")
{
    const test::DeviceTest silence;
    for (const std::string name : {"room", "rooms", "colonnade"}) {
        CAPTURE(name);
        Scene scene = shippedScene(name);
        demo::mergeStatics(scene);
        Stage stage(std::move(scene), testSize(), 1.7);
        const uint32_t methods = checkExactMethods(stage);
        CHECK(methods >= 6);
    }
}

TEST_CASE("solids of an open mesh cast with both sides, from within and turned inside out")
{
    const test::DeviceTest silence;
    for (const bool inCrate : {false, true}) {
        Stage stage(solidsOfOpenMesh(inCrate), testSize());
        for (const std::string method : {"stencil_volume", "octree_volume", "all_edges_volume"}) {
            for (const double zFail : {0.0, 1.0}) {
                CAPTURE(method);
                CAPTURE(zFail);
                const FrameError now = errorOf(stage, method, {{"z_fail", zFail}});
                CHECK(now.error.percent(now.error.wrong()) <= edgePercent(0.005));
                CHECK(now.clear <= 2);
            }
        }
    }
}

// octree_volume and all_edges_volume show the same picture bit by bit (device tests).
TEST_CASE("stencil_volume is clearly wrong on at most two pixels of a frame with one light and with eight")
{
    const test::DeviceTest silence;
    for (const std::string name : {"torus_grid", "room", "bunny", "colonnade"}) {
        for (const uint32_t lights : {1u, 8u}) {
            CAPTURE(name);
            CAPTURE(lights);
            Scene scene = shippedScene(name);
            demo::limitLights(scene, lights);
            Stage stage(scene, testSize());
            const FrameError now = errorOf(stage, "stencil_volume");
            CHECK(now.error.percent(now.error.wrong()) <= edgePercent(0.005));
            CHECK(now.clear <= 2);
        }
    }
}

} // namespace gnomon::exact
