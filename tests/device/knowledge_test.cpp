// Knowledge bases through the C API: what is accepted, what is refused, and what predictions make of it.
#include <algorithm>
#include <cmath>

#include "device/hooks.hpp"
#include "device/posts.hpp"
#include "runtime/cost/knowledge_base.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Algorithms take their milliseconds whatever the workload, on a device of that name.
std::string knowledge(const std::string& name, const std::vector<std::pair<std::string, double>>& times)
{
    cost::DeviceKnowledge device{name, "", "software", {}, {}};
    for (const auto& [algorithm, ms] : times) {
        cost::AlgorithmCost cost{.algorithm = algorithm, .tracks = {}};
        for (const cost::Pass pass : {cost::Pass::update, cost::Pass::resolve})
            cost.tracks[trackOf(pass, cost::Processor::gpu)] = {.ms = {ms}, .octaves = 0.1, .samples = 40};
        device.algorithms.push_back(cost);
    }
    return cost::writeKnowledge({&device, 1});
}

/// shadow_map alone.
std::string knowledge(const std::string& device, double ms)
{
    return knowledge(device, {{"shadow_map", ms}});
}

GnResult load(const Host& host, const std::string& text)
{
    return gnLoadKnowledge(host.context, text.data(), text.size(), "base.csv");
}

float predicted(Host& host)
{
    host.require(host.draw());
    return host.decision(0).predictedMs;
}

bool anyContains(const std::vector<std::string>& messages, const std::string& part)
{
    for (const std::string& message : messages)
        if (message.find(part) != std::string::npos) return true;
    return false;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a knowledge base of this device decides what is predicted, for lights added later too")
{
    Host host(smallScene());
    host.pinAll("shadow_map");
    host.draw(2, {});
    REQUIRE(load(host, knowledge(device().properties.deviceName, 4.0)) == GN_SUCCESS);
    CHECK(predicted(host) == doctest::Approx(4.0).epsilon(0.2)); // the light rests: no update is due
    // More than it takes, also where other programs share the processors.
    REQUIRE(load(host, knowledge(device().properties.deviceName, 40.0)) == GN_SUCCESS);
    CHECK(predicted(host) == doctest::Approx(40.0).epsilon(0.2)); // again, not on top

    // Twenty more lights than the cost model has room for at first.
    const GnLightInfo info{.type = GN_LIGHT_TYPE_SPOT, .position = {0, 5, 0}, .direction = {0, -1, 0}, .range = 10};
    std::vector<GnLight> lights = host.lights;
    const auto newest = [&] {
        GnDecision decision{};
        host.require(gnGetDecision(host.context, host.views[0], lights.back(), &decision));
        return decision.predictedMs;
    };
    float first = 0.0f;
    for (int i = 0; i < 20; ++i) {
        GnLight light = VK_NULL_HANDLE;
        host.require(gnCreateLight(host.context, &info, &light));
        host.require(gnSetLightMethod(host.context, light, "shadow_map"));
        lights.resize(1);
        lights.push_back(light);
        host.require(host.draw({.lights = &lights}));
        if (i > 0 && i < 19) continue;
        host.require(host.draw({.lights = &lights})); // once more: at rest
        if (i == 0) first = newest();
    }
    CHECK(first > 0.0f);
    CHECK(newest() > 0.0f);
    CHECK(newest() <= 1.5f * first); // meanwhile it has learned from real, shorter times
}

TEST_CASE_FIXTURE(DeviceTest, "a prediction stands while what it rests on stands, and not a frame longer")
{
    Host host(smallScene());
    host.pinAll("shadow_map");
    cost::DeviceKnowledge known{device().properties.deviceName, "", "software", {}, {}};
    cost::AlgorithmCost map{.algorithm = "shadow_map", .tracks = {}}; // a millisecond per 1000 triangles
    for (const cost::Pass pass : {cost::Pass::update, cost::Pass::resolve})
        map.tracks[trackOf(pass, cost::Processor::gpu)] = {.ms = {0.0, 1000.0}, .octaves = 0.1, .samples = 40};
    known.algorithms.push_back(map);
    REQUIRE(load(host, cost::writeKnowledge({&known, 1})) == GN_SUCCESS);
    host.draw(20, {}); // settled: pixels reached are the median of five looks
    std::vector<float> standing;
    while (standing.size() < 5) { // between two timed frames
        const float ms = predicted(host);
        if (!standing.empty() && ms != standing.back()) standing.clear();
        standing.push_back(ms);
        REQUIRE(host.frame() < 200);
    }
    // Eight times the triangles: predicted in the very frame.
    GnTransform place{};
    place.basis[0] = place.basis[4] = place.basis[8] = 0.1f;
    place.translation[1] = 0.5;
    for (int i = 0; i < 8; ++i) {
        const GnInstanceCreateInfo info{.mesh = host.meshes[1], .transform = place};
        GnInstance instance = VK_NULL_HANDLE;
        host.require(gnCreateInstance(host.context, &info, &instance));
    }
    CHECK(predicted(host) > 2.0f * standing.back());
}

TEST_CASE_FIXTURE(DeviceTest, "a knowledge base that cannot be used is refused and what was known stays")
{
    Host host(smallScene());
    host.pinAll("shadow_map");
    const std::string good = knowledge(device().properties.deviceName, 40.0);
    REQUIRE(load(host, good) == GN_SUCCESS);
    const float before = predicted(host);
    host.takeMessages();

    CHECK(gnLoadKnowledge(host.context, nullptr, 0, "base.csv") == GN_ERROR_NULL_ARGUMENT);
    CHECK(load(host, "") == GN_ERROR_KNOWLEDGE);
    CHECK(load(host, "not a table") == GN_ERROR_KNOWLEDGE);
    std::string older = good;
    older.replace(0, older.find('\n'), "# gnomon knowledge 0");
    CHECK(load(host, older) == GN_ERROR_KNOWLEDGE);
    CHECK(anyContains(host.takeMessages(), "base.csv: knowledge base of version '0'"));
    std::string nonsense = good; // every time becomes NaN
    for (size_t at = nonsense.find(",0.1,40,"); at != std::string::npos; at = nonsense.find(",0.1,40,"))
        nonsense.replace(at, 8, ",0.1,nan,");
    CHECK(load(host, nonsense) == GN_ERROR_KNOWLEDGE);
    CHECK(anyContains(host.takeMessages(), "base.csv: line 3: fixed_ms 'nan' is no measurement"));
    CHECK(load(host, cost::writeKnowledge({})) == GN_SUCCESS); // an empty one: a remark
    CHECK(anyContains(host.takeMessages(), "no row of an algorithm of this build"));
    CHECK(predicted(host) == doctest::Approx(before).epsilon(0.05));
}

TEST_CASE_FIXTURE(DeviceTest, "after a knowledge base with one damaged row a context goes on with the library's own")
{
    Host host(smallScene());
    host.pinAll("shadow_map");
    host.draw(1, {});
    const float before = predicted(host); // no frame was timed yet
    REQUIRE(before > 0.0f);
    REQUIRE(before < 1000.0f);
    std::string text = knowledge(device().properties.deviceName, 100000.0); // rows that are fine, and one that is not
    text.replace(text.rfind(",1e+05,"), 7, ",1e30,");
    host.takeMessages();
    CHECK(load(host, text) == GN_ERROR_KNOWLEDGE);
    CHECK(anyContains(host.takeMessages(), "base.csv: line 4: fixed_ms '1e30' is no measurement"));
    CHECK(predicted(host) == doctest::Approx(before).epsilon(0.5));
}

TEST_CASE_FIXTURE(DeviceTest, "a foreign knowledge base is corrected by one factor from the first timed frames")
{
    Host host(smallScene(), {.flags = GN_CONTEXT_NO_BACKGROUND_BIT | GN_CONTEXT_TIME_EVERY_FRAME_BIT});
    host.pinAll("shadow_map");
    REQUIRE(load(host, knowledge("another device", 1000.0)) == GN_SUCCESS);
    CHECK(predicted(host) > 500.0f);
    host.draw(40, {});
    // Of several frames the middle one: a single frame may be held up by whatever else runs.
    std::vector<float> octavesOff;
    for (int frame = 0; frame < 15; ++frame) {
        host.require(host.draw());
        const GnDecision decision = host.decision(0);
        REQUIRE(decision.measuredMs > 0.0f);
        octavesOff.push_back(std::log2(decision.predictedMs / decision.measuredMs));
    }
    std::nth_element(octavesOff.begin(), octavesOff.begin() + 7, octavesOff.end());
    CHECK(std::fabs(octavesOff[7]) < 1.5f);
}

TEST_CASE_FIXTURE(DeviceTest, "a timed light tells what it cost and what that depends on")
{
    Host host(smallScene(), {.flags = GN_CONTEXT_NO_BACKGROUND_BIT | GN_CONTEXT_TIME_EVERY_FRAME_BIT});
    host.pinAll("shadow_map");
    GnLightTiming timing{};
    GnLightWorkload workload{};
    CHECK(gnGetLightTiming(host.context, host.views[0], host.lights[0], nullptr) == GN_ERROR_NULL_ARGUMENT);
    CHECK(gnGetLightWorkload(host.context, host.views[0], host.lights[0], nullptr) == GN_ERROR_NULL_ARGUMENT);
    host.require(host.draw());
    host.require(gnGetLightTiming(host.context, host.views[0], host.lights[0], &timing));
    host.require(gnGetLightWorkload(host.context, host.views[0], host.lights[0], &workload));
    CHECK(timing.frame == 0); // two frames late
    CHECK(workload.frame == 0);
    host.draw(6, {});
    host.require(gnGetLightTiming(host.context, host.views[0], host.lights[0], &timing));
    host.require(gnGetLightWorkload(host.context, host.views[0], host.lights[0], &workload));
    CHECK(timing.frame > 0);
    CHECK(workload.frame == timing.frame);
    CHECK(std::string(timing.pMethod) == "shadow_map");
    CHECK(timing.resolveGpuMs > 0.0f);
    CHECK(!timing.updated); // the map was kept
    CHECK(workload.type == GN_LIGHT_TYPE_SPOT);
    CHECK(workload.still);
    CHECK(workload.viewPixels == 320.0 * 180.0);
    CHECK(workload.drawnPixels <= workload.viewPixels);
    CHECK(workload.casterTriangles > 0.0);
    CHECK(workload.sharing == 1.0);
    CHECK(gnGetLightTiming(host.context, host.views[0], VK_NULL_HANDLE, &timing) == GN_ERROR_INVALID_HANDLE);
    CHECK(gnGetLightWorkload(host.context, VK_NULL_HANDLE, host.lights[0], &workload) == GN_ERROR_INVALID_HANDLE);
    CHECK(workload.frame == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "maps that follow the view are timed as updates, as pixels are not, and rest with it")
{
    for (const char* method : {"cascades", "virtual_map"}) {
        CAPTURE(std::string(method));
        Host host(land(), {.flags = GN_CONTEXT_NO_BACKGROUND_BIT | GN_CONTEXT_TIME_EVERY_FRAME_BIT});
        host.pinAll(method);
        GnLightTiming timing{};
        uint32_t updates = 0;
        std::vector<demo::CameraState> cameras{walked(host.scene, 0.0)};
        for (int frame = 0; frame < 8; ++frame) {
            host.require(host.draw({.cameras = &cameras}));
            host.require(gnGetLightTiming(host.context, host.views[0], host.lights[0], &timing));
            updates += timing.frame == 1 && timing.updated;
            if (timing.frame == 1) CHECK(timing.updateGpuMs > 0.0f);
        }
        CHECK(updates > 0);
        CHECK(timing.frame > 4);
        CHECK(!timing.updated); // the maps are kept
        CHECK(timing.resolveGpuMs > 0.0f);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a map that follows the view is predicted to be drawn while that moves")
{
    for (const char* method : {"cascades", "shadow_map"}) {
        const bool updates = std::string_view(method) == "cascades";
        CAPTURE(std::string(method));
        Host host(land(), hooked({}, {withoutTimestamps()})); // nothing is learned
        host.pinAll(method);
        std::vector<demo::CameraState> cameras{walked(host.scene, 0.0)};
        host.draw(7, {.cameras = &cameras});
        REQUIRE(load(host, knowledge(device().properties.deviceName, {{method, 40.0}})) == GN_SUCCESS);
        const auto predictedAt = [&](double metres) {
            cameras[0] = walked(host.scene, metres);
            host.require(host.draw({.cameras = &cameras}));
            return double{host.decision(0).predictedMs};
        };
        CHECK(predictedAt(0.0) == doctest::Approx(40.0).epsilon(0.01)); // pixels alone
        CHECK(predictedAt(0.1) == doctest::Approx(updates ? 80.0 : 40.0).epsilon(0.01));
        for (int frame = 0; frame < 3; ++frame)
            predictedAt(0.1);
        CHECK(predictedAt(0.1) == doctest::Approx(40.0).epsilon(0.01)); // at rest again
    }
}

TEST_CASE_FIXTURE(DeviceTest, "without a budget the cheapest that shows as much serves, unless time has no say")
{
    Host host(smallScene());
    host.pinAll(nullptr);
    const std::string base = shippedRules("default");
    std::string none = base;
    const std::string says = "allocation: budget";
    none.replace(none.find(says), says.size(), "allocation: none");
    const auto timesWith = [&](double ray) {
        return knowledge(device().properties.deviceName, {{"stencil_volume", 40.0},
                                                          {"octree_volume", 40.0},
                                                          {"all_edges_volume", 40.0},
                                                          {"chan_durand", 40.0},
                                                          {"pcf_hybrid", 40.0},
                                                          {"contour_chain", 40.0},
                                                          {"tile_shafts", 40.0},
                                                          {"shadow_map", 1.0}, // cheaper still, but shows less
                                                          {"ray_traced", ray}});
    };
    REQUIRE(load(host, timesWith(4.0)) == GN_SUCCESS);
    host.require(gnLoadRules(host.context, none.data(), none.size(), "none"));
    host.draw(12, {});
    REQUIRE(std::string(host.decision(0).pMethod) == "stencil_volume"); // what the rules like best
    host.require(gnLoadRules(host.context, base.data(), base.size(), "default"));
    host.draw(1, {});
    CHECK(std::string(host.decision(0).pMethod) == "ray_traced");
    CHECK(host.decision(0).reason == GN_REASON_PRICE);
    uint32_t count = 32;
    std::vector<GnCandidate> candidates(count);
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[0], &count, candidates.data()));
    candidates.resize(count);
    for (const GnCandidate& candidate : candidates)
        if (std::string(candidate.pMethod) == "stencil_volume") CHECK(candidate.elimination == GN_ELIMINATION_PRICE);
    // With much time to give, none of it is spent on the same picture.
    Host rich(smallScene());
    rich.pinAll(nullptr);
    REQUIRE(load(rich, timesWith(4.0)) == GN_SUCCESS);
    rich.require(gnLoadRules(rich.context, base.data(), base.size(), "default"));
    rich.draw(2, {.adjust = [](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.budgetMs = 1000.0f; }});
    CHECK(std::string(rich.decision(0).pMethod) == "ray_traced");
    CHECK(rich.decision(0).reason == GN_REASON_PRICE);
    // And nothing is taken for a price that is no better.
    Host dear(smallScene());
    dear.pinAll(nullptr);
    REQUIRE(load(dear, timesWith(80.0)) == GN_SUCCESS);
    dear.require(gnLoadRules(dear.context, base.data(), base.size(), "default"));
    dear.draw(2, {}); // no frame was timed yet
    CHECK(std::string(dear.decision(0).pMethod) == "stencil_volume");
}
