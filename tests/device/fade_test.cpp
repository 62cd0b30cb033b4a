// A light whose method changes is shown as a mix of both for some frames: the mix of their own pictures, exactly.
#include <algorithm>
#include <limits>

#include "device/fade_support.hpp"
#include "runtime/plan/plan.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr uint32_t kUntilMeasured = 6; ///< Frames, without pins, until it is known what lights reach.

struct Pictures {
    std::vector<Image8> a, b;
};

/// What `a` and `b` show alone; afterwards the light has had `a` for long, by rules.
Pictures settle(Host& host, const char* a, const char* b, const FrameOptions& options = {})
{
    Pictures out;
    out.b = alone(host, b, options);
    out.a = alone(host, a, options);
    CHECK(differences(out.a, out.b) > 50); // or a mix could not be told
    favour(host, a);
    host.pinAll(nullptr);
    host.draw(kUntilMeasured, options); // what was chosen before does not fade
    CHECK(differences(host.pictures(), out.a) == 0);
    return out;
}

/// R8 rounds to nearest, and the hardware's mix may be off by a little more.
constexpr double kRounding = 0.51;

void checkMix(const Host& host, const std::vector<Image8>& shown, const Pictures& own, const char* outgoing,
              uint32_t step)
{
    const double share = double(step) / (kFadeFrames + 1);
    CAPTURE(share);
    for (size_t light = 0; light < shown.size(); ++light) {
        CHECK(worstMix(shown[light], own.a[light], own.b[light], share) <= kRounding);
        const GnDecision decision = host.decision(light);
        CHECK(decision.fade == doctest::Approx(share));
        REQUIRE(decision.pOutgoing);
        CHECK(std::string(decision.pOutgoing) == outgoing);
    }
    CHECK(host.stats().fading == shown.size() * host.views.size());
    CHECK(host.passCount("view.fade") == shown.size() * host.views.size());
}

void checkAlone(const Host& host, const std::vector<Image8>& shown, const std::vector<Image8>& own)
{
    CHECK(differences(shown, own) == 0);
    for (size_t light = 0; light < shown.size(); ++light) {
        const GnDecision decision = host.decision(light);
        CHECK(decision.fade == 1.0f);
        CHECK(decision.pOutgoing == nullptr);
    }
    CHECK(host.stats().fading == 0);
    CHECK(host.passCount("view.fade") == 0);
}

void checkWholeFade(Host& host, const char* a, const char* b, const FrameOptions& options)
{
    CAPTURE(std::string(a));
    CAPTURE(std::string(b));
    const Pictures own = settle(host, a, b, options);
    favour(host, b);
    for (uint32_t step = 1; step <= kFadeFrames; ++step) {
        host.require(host.draw(options));
        CHECK(std::string(host.decision(0).pMethod) == b); // the decision does not wait
        CHECK(host.stats().switches == (step == 1 ? host.lights.size() * host.views.size() : 0));
        checkMix(host, host.pictures(), own, a, step);
    }
    for (int frame = 0; frame < 3; ++frame) {
        host.require(host.draw(options));
        checkAlone(host, host.pictures(), own.b);
    }
}

std::vector<GnCandidate> candidatesOf(const Host& host, size_t light)
{
    uint32_t count = 0;
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[light], &count, nullptr));
    std::vector<GnCandidate> candidates(count);
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[light], &count, candidates.data()));
    return candidates;
}

GnCandidate candidateOf(const Host& host, size_t light, const std::string& method)
{
    for (const GnCandidate& candidate : candidatesOf(host, light))
        if (method == candidate.pMethod) return candidate;
    FAIL(method);
    return {};
}

float predictedOf(const Host& host, size_t light, const std::string& method)
{
    return candidateOf(host, light, method).predictedMs;
}

/// The least that any method the rules speak for counts for, with what its view needs for it.
float cheapestOf(const Host& host, size_t light)
{
    float least = std::numeric_limits<float>::infinity();
    for (const GnCandidate& candidate : candidatesOf(host, light))
        if (candidate.suitability >= 0) least = std::min(least, candidate.sureMs + candidate.sharedMs);
    return least;
}

/// What the passes of one method, or of all, took in the newest frame whose timings are known.
float timedMs(const Host& host, const std::string& prefix)
{
    uint64_t frame = 0;
    uint32_t count = 0;
    host.require(gnGetPassTimings(host.context, &frame, &count, nullptr));
    std::vector<GnPassTiming> passes(count);
    host.require(gnGetPassTimings(host.context, &frame, &count, passes.data()));
    float sum = 0.0f;
    for (const GnPassTiming& pass : passes)
        if (std::string(pass.pName).starts_with(prefix)) sum += pass.gpuMs + pass.cpuMs;
    return sum;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "every frame of a fade shows the mix of both methods' own pictures, then the new one's")
{
    FadeHost host;
    checkWholeFade(host, "shadow_map", "stencil_volume", {});
    checkWholeFade(host, "stencil_volume", "shadow_map", {.call = Call::record});
    checkWholeFade(host, "shadow_map", "tile_shafts", {}); // one round trip
    checkWholeFade(host, "ray_traced", "shadow_map", {});  // one on its way out
    checkWholeFade(host, "shadow_map", "ray_traced", {});
}

TEST_CASE_FIXTURE(DeviceTest, "methods that differ in one setting alone share nothing that depends on it")
{
    Scene scene = smallScene();
    scene.meshes[1] = demo::makeLeaves({.size = glm::vec3(2.5f), .count = 300}); // more edges than `few` has room for
    Host host(scene, {.extent = {640, 360}});
    host.require(gnAddMethod(host.context, "few", "mccool"));
    host.fixMapSides();
    host.require(gnSetMethodSetting(host.context, "few", "edges", 1));
    checkWholeFade(host, "mccool", "few", {});
    checkWholeFade(host, "few", "mccool", {});
}

TEST_CASE_FIXTURE(DeviceTest, "several lights in several views fade at once, each from its own picture")
{
    Scene scene = smallScene();
    scene.lights.push_back(spotLight("second", {-4.0, 6.0, 3.0}, {0.0, 0.0, 0.0}, true));
    scene.lights.push_back(spotLight("third", {0.0, 8.0, -3.0}, {0.0, 0.0, 0.0}, false));
    FadeHost host(scene, {.viewCount = 2});
    std::vector<demo::CameraState> cameras(2, demo::cameraAt(scene, 0.0));
    cameras[1].eye.x += 2.0;
    const FrameOptions options{.cameras = &cameras};
    for (uint32_t view = 0; view < 2; ++view) {
        CAPTURE(view);
        const std::vector<Image8> b = alone(host, "stencil_volume", options, view);
        const std::vector<Image8> a = alone(host, "shadow_map", options, view);
        favour(host, "shadow_map");
        host.pinAll(nullptr);
        host.draw(kUntilMeasured, options);
        favour(host, "stencil_volume");
        for (uint32_t step = 1; step <= kFadeFrames; ++step) {
            host.require(host.draw(options));
            checkMix(host, host.pictures(view), {a, b}, "shadow_map", step);
        }
        host.require(host.draw(options));
        checkAlone(host, host.pictures(view), b);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a dropped frame takes no step of a fade, the first no more than one in the middle")
{
    FadeHost host;
    const FrameOptions record{.call = Call::record}, drop{.call = Call::record, .drop = true};
    const Pictures own = settle(host, "shadow_map", "stencil_volume", record);
    favour(host, "stencil_volume");
    host.require(host.draw(drop));
    for (uint32_t step = 1; step <= kFadeFrames; ++step) {
        host.require(host.draw(record));
        checkMix(host, host.pictures(), own, "shadow_map", step);
        if (step == 2) host.draw(2, drop);
    }
    host.require(host.draw(drop)); // the one that would have ended it
    CHECK(host.decision(0).fade == 1.0f);
    host.require(host.draw(record));
    checkAlone(host, host.pictures(), own.b);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a pin, a camera cut, a light that was away and crossFadeFrames 0 show the method at once")
{
    FadeHost host;
    const FrameOptions cut{
        .adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].cameraCut = VK_TRUE; }};
    const std::vector<GnLight> none;
    const Pictures own = settle(host, "shadow_map", "stencil_volume");
    auto backToA = [&] {
        host.pinAll("shadow_map");
        host.require(host.draw());
        checkAlone(host, host.pictures(), own.a);
        favour(host, "shadow_map");
        host.pinAll(nullptr);
        host.require(host.draw());
    };

    host.pinAll("stencil_volume");
    host.require(host.draw());
    checkAlone(host, host.pictures(), own.b);
    CHECK(host.explanation(0).find("no fade: the host pinned the method") != std::string::npos);

    backToA();
    favour(host, "stencil_volume");
    host.require(host.draw(cut));
    checkAlone(host, host.pictures(), own.b);
    CHECK(host.explanation(0).find("no fade: the camera was cut") != std::string::npos);

    backToA();
    favour(host, "stencil_volume");
    host.draw(2, {}); // in the middle of a fade
    checkMix(host, host.pictures(), own, "shadow_map", 2);
    CHECK(host.explanation(0).find("fade: 0.40, the rest is shadow_map's") != std::string::npos);
    host.require(host.draw(cut));
    checkAlone(host, host.pictures(), own.b);

    backToA();
    favour(host, "stencil_volume");
    host.require(host.draw({.lights = &none}));
    host.require(host.draw());
    checkAlone(host, host.pictures(), own.b);
    CHECK(host.explanation(0).find("no fade: the light was not in the frame before") != std::string::npos);

    backToA();
    favour(host, "stencil_volume", 0);
    host.require(host.draw());
    checkAlone(host, host.pictures(), own.b);
}

TEST_CASE_FIXTURE(DeviceTest, "a change that is taken back turns the fade round; a third method drops the fainter one")
{
    FadeHost host;
    const std::vector<Image8> c = alone(host, "ray_traced");
    const Pictures own = settle(host, "shadow_map", "stencil_volume");
    favour(host, "stencil_volume");
    host.draw(3, {});
    checkMix(host, host.pictures(), own, "shadow_map", 3);
    favour(host, "shadow_map");
    host.require(host.draw());
    CHECK(worstMix(host.pictures()[0], own.a[0], own.b[0], 2.0 / 5.0) <= kRounding);
    CHECK(std::string(host.decision(0).pOutgoing) == "stencil_volume");
    CHECK(host.decision(0).fade == doctest::Approx(3.0 / 5.0));
    favour(host, "ray_traced"); // 3/5 of what is shown is the map's
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pOutgoing) == "shadow_map");
    CHECK(worstMix(host.pictures()[0], own.a[0], c[0], 1.0 / 5.0) <= kRounding);
    host.draw(kFadeFrames, {});
    checkAlone(host, host.pictures(), c);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "from one exact method to another nothing fades, and says so; a fade to one of them runs on")
{
    FadeHost host;
    const Pictures own = settle(host, "shadow_map", "stencil_volume");
    favour(host, "stencil_volume");
    host.draw(kFadeFrames + 1, {});
    checkAlone(host, host.pictures(), own.b);
    favour(host, "ray_traced");
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == "ray_traced");
    CHECK(host.decision(0).fade == 1.0f);
    CHECK(host.passCount("view.fade") == 0);
    CHECK(host.explanation(0).find("no fade: both methods are exact") != std::string::npos);
    favour(host, "shadow_map");
    host.draw(3, {}); // the exact one fades most of the way out,
    favour(host, "stencil_volume");
    host.require(host.draw()); // then back to one like it: the mix goes on from the map
    CHECK(std::string(host.decision(0).pOutgoing) == "shadow_map");
    CHECK(host.decision(0).fade < 1.0f);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "exact methods do fade where their pictures may differ: missable casters, coarser settings")
{
    const auto fades = [](GnInstanceFlags grass, double mode) {
        FadeHost host;
        if (grass) addHostDrawn(host, grass, 0.0, 0xffffffffu);
        host.require(gnSetMethodSetting(host.context, "conservative_map", "mode", mode));
        settle(host, "shadow_map", "conservative_map");
        favour(host, "conservative_map");
        host.draw(kFadeFrames + 1, {});
        favour(host, "tile_shafts");
        host.require(host.draw());
        CHECK(std::string(host.decision(0).pMethod) == "tile_shafts");
        return host.decision(0).fade < 1.0f;
    };
    CHECK_FALSE(fades(0, 0.0));
    CHECK(fades(GN_INSTANCE_MAY_BE_MISSED_BIT, 0.0));
    CHECK(fades(0, 1.0));
}

TEST_CASE_FIXTURE(DeviceTest, "a method that cannot serve any more does not fade: recorded frames have no round trips")
{
    FadeHost host;
    settle(host, "ray_traced", "shadow_map");
    const std::vector<Image8> pictures = alone(host, "shadow_map", {.call = Call::record});
    favour(host, "ray_traced");
    host.pinAll(nullptr);
    host.draw(kFadeFrames + 1, {});
    favour(host, "shadow_map");
    host.draw(2, {});
    CHECK(host.stats().fading == 1);
    host.require(host.draw({.call = Call::record})); // in the middle
    checkAlone(host, host.pictures(), pictures);
    CHECK(host.explanation(0).find("no fade: the method before can no longer serve") != std::string::npos);
}

TEST_CASE_FIXTURE(DeviceTest, "the outgoing method is counted: a fade that does not fit the budget is not begun")
{
    FadeHost host;
    auto within = [&](float ms) {
        return FrameOptions{.adjust = [ms](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.budgetMs = ms; }};
    };
    const Pictures own = settle(host, "shadow_map", "stencil_volume");
    favour(host, "shadow_map", kFadeFrames, "", "budget");
    host.draw(12, within(1000.0f));
    const float before = host.stats().predictedMs;
    CHECK(before == host.decision(0).predictedMs);
    CHECK(host.stats().budgetMs == 1000.0f);

    favour(host, "stencil_volume", kFadeFrames, "", "budget");
    host.require(host.draw(within(1000.0f)));
    checkMix(host, host.pictures(), own, "shadow_map", 1);
    CHECK(host.stats().predictedMs > 0.0f);
    CHECK(host.stats().predictedMs ==
          doctest::Approx(host.decision(0).predictedMs + predictedOf(host, 0, "shadow_map")));

    // One that runs ends as soon as it does not fit.
    host.require(host.draw(within(1e-3f)));
    checkAlone(host, host.pictures(), own.b);
    CHECK(host.stats().predictedMs == host.decision(0).predictedMs);
    CHECK(host.explanation(0).find("no fade: both methods do not fit the budget") != std::string::npos);

    favour(host, "shadow_map", kFadeFrames, "", "budget");
    host.require(host.draw(within(1e-3f)));
    checkAlone(host, host.pictures(), own.a);
    host.require(host.draw(within(1000.0f))); // and it is not made up for
    checkAlone(host, host.pictures(), own.a);
}

TEST_CASE_FIXTURE(DeviceTest, "while a light fades each method is charged with its own passes")
{
    FadeHost host(smallScene(), {.flags = GN_CONTEXT_NO_BACKGROUND_BIT | GN_CONTEXT_TIME_EVERY_FRAME_BIT});
    favour(host, "ray_traced", 12);
    host.draw(6, {});
    favour(host, "shadow_map", 12);
    host.draw(5, {}); // timings come two frames late
    for (int frame = 0; frame < 6; ++frame) {
        const float map = timedMs(host, "shadow_map"), rays = timedMs(host, "ray_traced");
        CHECK(map > 0.0f);
        CHECK(rays > 0.0f);
        CHECK(timedMs(host, "view.fade") > 0.0f);
        host.require(host.draw());
        CHECK(host.stats().fading == 1);
        CHECK(host.decision(0).measuredMs == doctest::Approx(map));
        // The mix has its price, too.
        CHECK(host.stats().predictedMs > host.decision(0).predictedMs + predictedOf(host, 0, "ray_traced"));
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "budget auto: the cheapest plan is measured, then 1.3 times that is the budget, and follows it")
{
    FadeHost host;
    const std::string text = "version: 1\n"
                             "variables: {lightRadius: {universe: [0, 2], unit: m, terms: "
                             "{all: [-.inf, -.inf, .inf, .inf]}}}\n"
                             "options: {allocation: budget}\n"
                             "rules: [{rule: if lightRadius is all then any exact is favoured}]\n"
                             "otherwise: shadow_map is acceptable\n"
                             "policy: {budget: auto}\n";
    host.require(gnLoadRules(host.context, text.data(), text.size(), "auto"));
    host.require(gnWarmUp(host.context));
    std::vector<float> took;
    uint32_t frames = 0, clearlyMore = 0;
    while (frames < 80) {
        host.require(host.draw());
        ++frames;
        const GnFrameStats stats = host.stats();
        if (stats.budgetMs > 0.0f) break;
        CHECK(stats.fading == 0); // it would be measured along
        // The one that serves may stay where another takes less, but not clearly.
        const GnCandidate serves = candidateOf(host, 0, host.decision(0).pMethod);
        // Another one's first frame, which a candidate does not tell, counts with a sixtieth.
        const float least = (0.95f - float(plan::kClearlyLess)) * (serves.sureMs + serves.sharedMs);
        clearlyMore = least <= cheapestOf(host, 0) ? 0 : clearlyMore + 1;
        CHECK(clearlyMore <= 1); // a single frame has been seen, on busy machines; why is not known
        took.push_back(stats.gpuMs + stats.cpuMs);
    }
    REQUIRE(frames > 32);
    REQUIRE(frames < 80);
    const float budget = host.stats().budgetMs;
    CHECK(budget >= 1.3f * *std::min_element(took.begin(), took.end()) * 0.5f);
    CHECK(budget <= 1.3f * *std::max_element(took.begin(), took.end()) * 2.0f);
    // From then on it is 1.3 times what the cheapest is predicted to take, as far as that was true.
    host.draw(10, {});
    const auto follows = [&host, budget] {
        const float now = host.stats().budgetMs;
        constexpr float most = 1.3f * float(plan::kLeash * plan::kLeash); // either may be off; times differ by a third
        return now > budget / most && now < budget * most;
    };
    CHECK(follows());
    // The host's word counts for more, and rules that ask for none have none.
    host.require(host.draw({.adjust = [](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.budgetMs = 7.0f; }}));
    CHECK(host.stats().budgetMs == 7.0f);
    host.require(host.draw());
    CHECK(follows());
    favour(host, "shadow_map", kFadeFrames, "", "budget");
    host.require(host.draw());
    CHECK(host.stats().budgetMs == 0.0f);
}
