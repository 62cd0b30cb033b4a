#include "runtime/cost/cost_model.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <vector>

#include "runtime/cost/exponent.hpp"
#include "runtime/cost/method_measures.hpp"
#include "runtime/cost/teach.hpp"
#include "tests/plan/cost_truth.hpp"
#include "tests/rules/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::cost;
using namespace gnomon::cost::test;

TEST_CASE("our logarithm and power agree with libm to a few last bits, also at the edges")
{
    Random random(1);
    double worstLog = 0.0, worstExp = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const double x = random.between(-1000, 1000);
        worstExp = std::max(worstExp, std::fabs(exp2Exactly(x) / std::exp2(x) - 1.0));
        const double y = std::exp2(random.between(-60, 60));
        worstLog =
            std::max(worstLog, std::fabs(log2Exactly(y) - std::log2(y)) / std::max(1.0, std::fabs(std::log2(y))));
    }
    MESSAGE("worst relative error: exp2 ", worstExp, ", log2 ", worstLog);
    CHECK(worstExp < 5e-16);
    CHECK(worstLog < 5e-16);
    constexpr double kInf = std::numeric_limits<double>::infinity();
    for (int e = -1022; e < 1024; ++e) {
        CHECK(exp2Exactly(e) == std::ldexp(1.0, e));
        CHECK(log2Exactly(std::ldexp(1.0, e)) == e);
    }
    CHECK(log2Exactly(0.0) == -kInf);
    CHECK(log2Exactly(kInf) == kInf);
    CHECK(std::isnan(log2Exactly(-1.0)));
    CHECK(exp2Exactly(1024.0) == kInf);
    CHECK(exp2Exactly(-1023.0) == 0.0);
    CHECK(std::isnan(exp2Exactly(kInf - kInf)));
}

TEST_CASE("timed lights are predicted to their noise, also when their workload changes")
{
    Random random(2);
    const Truth truth(random);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model);
    auto workloads = workloadsFor(random);
    for (int frame = 0; frame < 20; ++frame)
        runFrame(model, truth, random, workloads);
    for (uint32_t light = 0; light < kLights; ++light) {
        const uint32_t m = light % kMethods;
        CHECK(std::fabs(errorOf(model, truth, light, m, workloads[light])) < 0.2);
        const Prediction still = model.predict(light, m, workloads[light], false);
        CHECK(still.measured);
        workloads[light].pixels *= 3.0;
        workloads[light].casterTriangles *= 2.0;
        CHECK(std::fabs(errorOf(model, truth, light, m, workloads[light])) < 0.2);
        CHECK(model.predict(light, m, workloads[light], false).sigmaOctaves > still.sigmaOctaves);
    }
}

TEST_CASE("what nobody has timed is never cheap: choices count with what its kind hardly exceeds")
{
    Random random(7);
    const Truth truth(random);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model, 1.0, Kinship::foreign);
    const auto workloads = workloadsFor(random);
    const Prediction cold = model.predict(0, 0, workloads[0], false);
    CHECK_FALSE(cold.measured);
    CHECK(cold.sureMs() > 7.0 * cold.ms); // a device that may take eight times as long
    for (int frame = 0; frame < 20; ++frame)
        runFrame(model, truth, random, workloads);
    const Prediction warm = model.predict(0, 0, workloads[0], false), other = model.predict(0, 1, workloads[0], false);
    CHECK(warm.measured);
    CHECK(warm.sureMs() < 1.1 * warm.ms);
    CHECK_FALSE(other.measured);
    CHECK(other.sureMs() > 1.1 * other.ms);
    CHECK(other.sureMs() < 2.0 * other.ms);
}

TEST_CASE("a map that is drawn in every fourth frame takes a quarter of its update in a mean one")
{
    CostModel model;
    model.resize(1, 1);
    std::array<TrackCost, kTracks> tracks;
    tracks[trackOf(Pass::update, Processor::gpu)] = {.ms = {8.0}, .octaves = 0.2, .samples = 30};
    tracks[trackOf(Pass::resolve, Processor::gpu)] = {.ms = {1.0}, .octaves = 0.2, .samples = 30};
    model.teach(0, tracks, 0.0);
    CHECK(model.predict(0, 0, {}, false).ms == doctest::Approx(9.0));
    CHECK(model.predict(0, 0, {.redrawEvery = 4.0}, false).ms == doctest::Approx(3.0));
    CHECK(model.predict(0, 0, {.redrawEvery = 4.0}, true).ms == doctest::Approx(1.0));
}

TEST_CASE("of casters in range a traced resolve pays for the share of the view that the light reaches")
{
    Workload workload{.pixels = 1e5, .casterTriangles = 2e6, .casters = 3000.0, .viewPixels = 1e6, .treeLevels = 4.0};
    const auto casters = [&](Pass pass) {
        const Terms terms = termsOf(workload, pass);
        return std::pair{terms[size_t(Term::triangles)], terms[size_t(Term::instances)]};
    };
    CHECK(casters(Pass::resolve) == std::pair{0.1 * 2.0, 0.1 * 3.0});
    CHECK(casters(Pass::update) == std::pair{2.0, 3.0});
    workload.treeLevels = 0.0; // draws them all, whatever they reach
    CHECK(casters(Pass::resolve) == std::pair{2.0, 3.0});
    workload = {.pixels = 0.0, .casterTriangles = 2e6, .casters = 3000.0, .viewPixels = 0.0, .treeLevels = 4.0};
    CHECK(casters(Pass::resolve) == std::pair{2.0, 3.0}); // nothing is known of the view
}

TEST_CASE("a light by itself is in more doubt than its part of a sum over many")
{
    Random random(3);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model);
    Workload workload = workloadsFor(random)[0];
    workload.sharing = 1.0;
    const Prediction alone = model.predict(0, 0, workload, false);
    CHECK(alone.ownOctaves == doctest::Approx(alone.sigmaOctaves));
    workload.sharing = 40.0;
    const Prediction ofMany = model.predict(0, 0, workload, false);
    CHECK(ofMany.ownOctaves == doctest::Approx(alone.ownOctaves));
    CHECK(ofMany.sigmaOctaves < ofMany.ownOctaves);
    CHECK(ofMany.luckyMs(1.0) == doctest::Approx(ofMany.ms * std::exp2(-alone.ownOctaves)));
    CHECK(ofMany.luckyMs(4.0) > 0.0);
}

TEST_CASE("a foreign device is known after one frame")
{
    Random random(3);
    Truth truth(random);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model, 7.0, Kinship::foreign);
    const auto workloads = workloadsFor(random);
    const auto worst = [&] {
        double most = 0.0;
        for (uint32_t light = 0; light < kLights; ++light)
            for (uint32_t m = 0; m < kMethods; ++m)
                most = std::max(most, std::fabs(errorOf(model, truth, light, m, workloads[light])));
        return most;
    };
    CHECK(worst() > 2.0);
    runFrame(model, truth, random, workloads);
    MESSAGE("octaves off after one frame, at most: ", worst());
    CHECK(worst() < 0.8);
}

TEST_CASE("spikes, cold starts and disturbed frames leave the prediction where it was")
{
    Random random(4);
    const Truth truth(random);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model);
    const auto workloads = workloadsFor(random);
    for (int frame = 0; frame < 200; ++frame)
        runFrame(model, truth, random, workloads);
    const auto now = [&] { return model.predict(0, 0, Pass::resolve, workloads[0]).ms; };
    const double before = now();
    Observation spike{.light = 0, .method = 0, .workload = workloads[0], .gpuMs = 6.0 * before};
    model.observe(spike); // one timing
    model.endFrame();
    CHECK(now() == doctest::Approx(before).epsilon(0.05));
    for (int frame = 0; frame < 3; ++frame)
        runFrame(model, truth, random, workloads);
    for (uint32_t light = 0; light < kLights; ++light) { // a frame in which everything is slow
        const uint32_t m = light % kMethods;
        model.observe({.light = light,
                       .method = m,
                       .workload = workloads[light],
                       .gpuMs = 4.0 * truth.ms(light, m, Pass::resolve, workloads[light])});
    }
    model.endFrame();
    CHECK(now() == doctest::Approx(before).epsilon(0.06));
    spike.framesSinceSwitch = 0;
    model.observe(spike);
    spike.framesSinceSwitch = 100;
    spike.disturbed = true;
    for (int i = 0; i < 50; ++i) {
        model.observe(spike);
        model.endFrame();
    }
    CHECK(now() == doctest::Approx(before).epsilon(0.06));
    for (const double nonsense :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        model.observe({.light = 0, .method = 0, .workload = workloads[0], .gpuMs = nonsense});
        model.endFrame();
    }
    CHECK(now() == doctest::Approx(before).epsilon(0.06));
}

TEST_CASE("a device that becomes half as fast is noticed within three frames, for methods too that nobody times")
{
    Random random(5);
    Truth truth(random);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model);
    const auto workloads = workloadsFor(random);
    for (int frame = 0; frame < 50; ++frame)
        runFrame(model, truth, random, workloads);
    truth.factor = 2.0;
    for (int frame = 0; frame < 3; ++frame)
        runFrame(model, truth, random, workloads);
    double served = 0.0, others = 0.0;
    for (uint32_t light = 0; light < kLights; ++light) {
        served += errorOf(model, truth, light, light % kMethods, workloads[light]) / kLights;
        others += errorOf(model, truth, light, (light + 1) % kMethods, workloads[light]) / kLights;
    }
    MESSAGE("octaves off after three frames: timed ", served, ", others ", others);
    CHECK(std::fabs(served) < 0.3);
    CHECK(std::fabs(others) < 0.4);
}

TEST_CASE("a method that is costlier than was thought is at once expected to be with every light")
{
    Random random(21);
    Truth truth(random);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model);
    const auto workloads = workloadsFor(random);
    truth.method = 5.0; // of method 2, in this scene
    const double before = model.predict(7, 5, workloads[7], false).ms;
    runFrameWith(model, truth, random, workloads, [](uint32_t light) { return light == 0 ? 2u : 3u; });
    MESSAGE("octaves off with another light after one timing: ", errorOf(model, truth, 5, 2, workloads[5]));
    CHECK(errorOf(model, truth, 5, 2, workloads[5]) > -0.9); // of 2.3
    const double sure = log2Exactly(model.predict(5, 2, workloads[5], false).sureMs());
    const double real = truth.ms(5, 2, Pass::update, workloads[5]) + truth.ms(5, 2, Pass::resolve, workloads[5]);
    CHECK(sure - log2Exactly(real) > -0.6);
    CHECK(std::fabs(log2Exactly(model.predict(7, 5, workloads[7], false).ms / before)) < 0.2); // no other method is
    model.forgetLight(0); // what is known of the scene stays known
    CHECK(errorOf(model, truth, 5, 2, workloads[5]) > -0.9);
}

TEST_CASE("one light that takes three times as long is right after its first timing, and the others stay")
{
    Random random(12);
    Truth truth(random);
    CostModel model;
    model.resize(kMethods, kLights);
    calibrate(model);
    const auto workloads = workloadsFor(random);
    for (int frame = 0; frame < 10; ++frame)
        runFrameWith(model, truth, random, workloads, [](uint32_t light) { return light == 5 ? 1u : 0u; });
    for (uint32_t m = 0; m < kMethods; ++m)
        truth.own[5 * kMethods + m] *= 3.0;
    const double other = errorOf(model, truth, 1, 0, workloads[1]);
    runFrameWith(model, truth, random, workloads, [](uint32_t) { return 0u; }); // light 5 is new to method 0
    CHECK(std::fabs(errorOf(model, truth, 5, 0, workloads[5])) < 0.3);
    CHECK(std::fabs(errorOf(model, truth, 1, 0, workloads[1]) - other) < 0.2);
}

TEST_CASE("what takes next to no time says nothing of the device, whoever agrees")
{
    CostModel model;
    model.setSharedCores(true);
    constexpr uint32_t lights = 6;
    model.resize(2, lights);
    std::array<TrackCost, kTracks> small, large;
    small[trackOf(Pass::resolve, Processor::gpu)] = {.ms = {0.05}, .octaves = 0.2, .samples = 30};
    large[trackOf(Pass::resolve, Processor::cpu)] = {.ms = {4.0}, .octaves = 0.2, .samples = 30};
    model.teach(0, small, 0.0);
    model.teach(1, large, 0.0);
    model.setKinship(Kinship::same);
    const Workload w{.pixels = 1e6};
    const auto frames = [&](int count, double smallMs, double largeMs) {
        for (int frame = 0; frame < count; ++frame) {
            for (uint32_t light = 0; light < lights; ++light) {
                if (light > 0) model.observe({.light = light, .method = 0, .workload = w, .gpuMs = smallMs});
                if (light == 0) model.observe({.light = light, .method = 1, .workload = w, .cpuMs = largeMs});
            }
            model.endFrame();
        }
    };
    frames(8, 0.05, 4.0);
    const double before = model.deviceOctaves()[0];
    frames(8, 0.025, 4.0); // the halved ones are more in number
    CHECK(std::fabs(model.deviceOctaves()[0] - before) < 0.05);
    frames(8, 0.025, 5.2); // what takes the time is slower by a third
    CHECK(model.deviceOctaves()[0] - before > 0.2);
}

TEST_CASE("a GPU of its own has its own factor: the cores beside it are not thought to be as fast")
{
    CostModel model;
    model.resize(1, 1);
    std::array<TrackCost, kTracks> tracks;
    tracks[trackOf(Pass::update, Processor::gpu)] = {.ms = {5.0}, .octaves = 0.2, .samples = 30};
    tracks[trackOf(Pass::resolve, Processor::cpu)] = {.ms = {2.0}, .octaves = 0.2, .samples = 30};
    model.teach(0, tracks, 0.0);
    model.setKinship(Kinship::foreign);
    const Workload w{.pixels = 1e6};
    for (int frame = 0; frame < 10; ++frame) {
        model.observe({.pass = Pass::update, .workload = w, .gpuMs = 0.05});
        model.observe({.pass = Pass::resolve, .workload = w, .cpuMs = 2.2});
        model.endFrame();
    }
    CHECK(model.deviceOctaves()[0] == doctest::Approx(log2Exactly(0.01)).epsilon(0.05));
    CHECK(model.deviceOctaves()[1] == doctest::Approx(log2Exactly(1.1)).epsilon(0.2));
    CHECK(model.predict(0, 0, w, false).ms == doctest::Approx(0.05 + 2.2).epsilon(0.02));
    CHECK(model.predict(0, 0, w, true).ms == doctest::Approx(2.2).epsilon(0.02)); // no update
}

TEST_CASE("a software device that starts from a GPU's base learns a factor for either's work, not one for both")
{
    DeviceKnowledge device{.device = "gpu", .driver = {}, .kind = "discrete"};
    const auto add = [&](const char* name, Processor on) {
        AlgorithmCost cost{.algorithm = name, .tracks = {}};
        cost.tracks[trackOf(Pass::resolve, on)] = {.ms = {1.0}, .octaves = 0.2, .samples = 9};
        device.algorithms.push_back(cost);
    };
    add("map", Processor::gpu), add("rays", Processor::cpu), add("volume", Processor::gpu);
    const Workload w{.pixels = 1e6};
    // What is expected of a method that nobody has timed, after frames with the two others.
    const auto expected = [&](const char* kind) {
        device.kind = kind;
        CostModel model;
        model.setSharedCores(true);
        model.resize(3, 2);
        CHECK(teach(model, device, std::vector<TaughtMethod>{{"map"}, {"rays"}, {"volume"}}) == 3);
        model.setKinship(Kinship::foreign);
        for (int frame = 0; frame < 10; ++frame) {
            model.observe({.light = 0, .method = 0, .workload = w, .gpuMs = 20.0});
            model.observe({.light = 1, .method = 1, .workload = w, .cpuMs = 1.5});
            model.endFrame();
        }
        CHECK(model.predict(1, 1, w, false).ms == doctest::Approx(1.5).epsilon(0.05));
        return model.predict(0, 2, w, false).ms;
    };
    CHECK(expected("discrete") == doctest::Approx(20.0).epsilon(0.15));
    CHECK(expected("software") < 10.0); // its GPU is those cores, too: one factor, in between
}

TEST_CASE("a method that was not measured costs as much as the costliest of its kind")
{
    DeviceKnowledge device;
    const auto add = [&](const char* name, double ms) {
        AlgorithmCost cost{.algorithm = name, .tracks = {}};
        cost.tracks[trackOf(Pass::resolve, Processor::gpu)] = {.ms = {ms}, .octaves = 0.25, .samples = 9};
        device.algorithms.push_back(cost);
    };
    add("a", 1.0), add("b", 3.0), add("c", 50.0);
    const std::vector<TaughtMethod> methods{{"a", 1}, {"b", 1}, {"c", 2}, {"new", 1}, {"odd", 7}};
    CostModel model;
    model.resize(5, 1);
    CHECK(teach(model, device, methods) == 3);
    model.setKinship(Kinship::same);
    const Workload w{.pixels = 1e6};
    CHECK(model.predict(0, 0, w, false).ms == doctest::Approx(1.0));
    CHECK(model.predict(0, 3, w, false).ms == doctest::Approx(3.0));
    CHECK(model.predict(0, 3, w, false).sigmaOctaves > model.predict(0, 1, w, false).sigmaOctaves);
    CHECK(model.predict(0, 4, w, false).ms == doctest::Approx(50.0));
}

TEST_CASE("a method that was timed under point sources alone is dear under a light with a radius")
{
    DeviceKnowledge device;
    const auto add = [&](const char* name, double soft) {
        AlgorithmCost cost{.algorithm = name, .tracks = {}};
        TrackCost& track = cost.tracks[trackOf(Pass::resolve, Processor::gpu)];
        track.ms[static_cast<size_t>(Term::reachedPixels)] = 2.0;
        track.ms[static_cast<size_t>(Term::softPixels)] = soft;
        track.samples = 9;
        device.algorithms.push_back(cost);
    };
    add("timed", 5.0), add("hard alone", 0.0);
    CostModel model;
    model.resize(2, 1);
    CHECK(teach(model, device, std::vector<TaughtMethod>{{"timed"}, {"hard alone"}}) == 2);
    model.setKinship(Kinship::same);
    const Workload hard{.pixels = 1e6}, soft{.pixels = 1e6, .softPixels = 1e6};
    CHECK(model.predict(0, 0, soft, false).ms == doctest::Approx(2.0 + 5.0));
    CHECK(model.predict(0, 1, soft, false).ms == doctest::Approx(2.0 + 8.0 * 2.0));
    CHECK(model.predict(0, 1, hard, false).ms == doctest::Approx(2.0));
}

TEST_CASE("learning allocates nothing, and the same observations give the same bits")
{
    std::array<CostModel, 2> models;
    std::array<std::vector<double>, 2> predicted;
    for (size_t run = 0; run < models.size(); ++run) {
        Random random(8);
        const Truth truth(random);
        CostModel& model = models[run];
        model.resize(kMethods, kLights);
        calibrate(model, 3.0, Kinship::alike);
        std::vector<std::vector<Workload>> frames;
        for (int frame = 0; frame < 300; ++frame)
            frames.push_back(workloadsFor(random));
        predicted[run].reserve(300 * kLights);
        const size_t before = rules::test::allocationCount();
        for (const auto& workloads : frames) {
            runFrame(model, truth, random, workloads);
            for (uint32_t light = 0; light < kLights; ++light)
                predicted[run].push_back(model.predict(light, light % kMethods, workloads[light], false).sureMs());
        }
        CHECK(rules::test::allocationCount() == before);
    }
    CHECK(predicted[0] == predicted[1]);
    CHECK(std::all_of(predicted[0].begin(), predicted[0].end(), [](double ms) { return std::isfinite(ms); }));
}

TEST_CASE("what a method shows wrongly is its author's figure, corrected by every measurement")
{
    KnowledgeBase base;
    base.devices.resize(2);
    base.devices[0].device = "here";
    base.devices[0].algorithms.push_back(
        {.algorithm = "map", .tracks = {}, .wrongPercent = 0.2, .wrongSamples = 2, .firstFrameMs = 4.0});
    base.devices[1].algorithms.push_back(
        {.algorithm = "map", .tracks = {}, .wrongPercent = 0.2, .wrongSamples = 1, .firstFrameMs = 70.0});
    const MethodMeasures measures = measuresOf(base, &base.devices[0], "map", 0.9);
    CHECK(measures.wrongPercent == doctest::Approx((4.0 * 0.9 + 3.0 * 0.2) / 7.0)); // 0.6
    CHECK(measures.firstFrameMs == 4.0);
    CHECK(measures.quality(1024.0) == doctest::Approx(1.0 / 1.6));
    CHECK(measures.quality(4096.0) == doctest::Approx(1.0 / 1.15));
    CHECK(measures.quality(0.0) == doctest::Approx(1.0 / 1.6)); // no map: nothing to scale
    const MethodMeasures unknown = measuresOf(base, nullptr, "another", 0.25);
    CHECK(unknown.wrongPercent == doctest::Approx(0.25));
    CHECK(unknown.firstFrameMs == 0.0);
}
