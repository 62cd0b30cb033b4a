// The stages of a frame, one after the other, with methods made up here and a Vulkan that keeps books.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "runtime/frame/choose.hpp"
#include "runtime/frame/declare.hpp"
#include "runtime/frame/learn.hpp"
#include "runtime/frame/measure_facts.hpp"
#include "runtime/frame/read_frame.hpp"
#include "runtime/frame/world_origin.hpp"
#include "runtime/scene_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkFormat kAbsent = VK_FORMAT_R16_SFLOAT; // the stub has no images of it

/// One pass that lights the layer; or passes that cannot be made.
class Painter : public ShadowAlgorithm {
public:
    explicit Painter(bool works) : works_(works) {}
    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        if (!works_) (void)passes.transient(ImageInfo{.name = "painter.none", .format = kAbsent, .extent = {4, 4}});
        passes.raster("painter.paint")
            .writes(task.visibility, {.layer = task.layer, .clear = true})
            .record([](PassContext&) {});
    }

private:
    bool works_;
};

template <bool Works>
std::unique_ptr<ShadowAlgorithm> makePainter(const AlgorithmServices&)
{
    return std::make_unique<Painter>(Works);
}

constexpr GnTraits kAllLights = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT;

AlgorithmEntry painter(const char* name, bool works, GnTraits traits = kAllLights)
{
    return {.name = name,
            .source = "this test",
            .traits = traits,
            .create = works ? &makePainter<true> : &makePainter<false>};
}

/// A context's parts, and a frame of one view of two bulbs.
struct Trip {
    SceneFixture scene;
    SamplerSet samplers{scene.stub.table};
    PipelineStore pipelines{scene.stub.table, *scene.memory, samplers};
    std::vector<AlgorithmEntry> entries;
    MethodTable methods{scene.stub.table, pipelines, *scene.jobs, scene.messages, false};
    Selector selector{methods};
    FramePlan plan{methods, false};
    ResourcePool pool{*scene.memory};
    PassGraph graph{pool, scene.arena};
    Views views;
    LightStates lights;
    WorldOrigin origin;
    FrameBudget budget;
    FrameHistory history;
    ProbeRun probe;
    FrameInput input;
    Frame frame;
    HostImages images;

    std::vector<GnLight> bulbs;
    GnView view = VK_NULL_HANDLE;
    GnViewFrame given{};
    GnFrameInfo info{};

    explicit Trip(std::vector<AlgorithmEntry> algorithms) : entries(std::move(algorithms))
    {
        scene.stub.table.properties.limits.maxImageArrayLayers = 256;
        scene.stub.table.properties.limits.maxImageDimension2D = 4096;
        scene.stub.absentFormat = kAbsent;
        for (const AlgorithmEntry& entry : entries)
            methods[*methods.addEntry(entry)].ready = true;
        for (const char* name : {"left", "right"}) {
            GnLightInfo light{};
            light.type = GN_LIGHT_TYPE_POINT;
            light.pName = name;
            light.range = 10.0f;
            bulbs.push_back(*scene.registry->createLight(light));
        }
        GnViewCreateInfo made{};
        made.pName = "eye";
        view = *views.add(made, scene.stub.table, *scene.memory, pool);
        given.view = view;
        for (const int i : {0, 4, 8})
            given.viewFromWorld[i] = 1.0f;
        given.projection[0] = given.projection[5] = 1.0f;
        given.projection[11] = -1.0f;
        given.projection[14] = 0.1f;
        given.depthImage = handleFromBits<VkImage>(1);
        given.depthView = handleFromBits<VkImageView>(2);
        given.depthFormat = VK_FORMAT_D32_SFLOAT;
        given.imageExtent = {64, 32};
        given.lightCount = 2;
        given.pLights = bulbs.data();
        info.frame = 1;
        info.viewCount = 1;
        info.pViews = &given;
    }
    ~Trip()
    {
        views.forEach([&](View& each) {
            if (each.visibility) scene.memory->destroy(each.visibility->gpu);
        });
    }

    Result<void> read() { return readFrame(info, {0, views, *scene.registry, scene.stub.table, nullptr}, input); }
    ChooseParts chooseParts() { return {selector, plan, methods, budget, history, probe, false}; }
    /// Up to the facts.
    void measure()
    {
        REQUIRE(read());
        history.past.begin(info.frame);
        scene.arena.reset();
        pool.begin(info.frame, info.completedFrame);
        graph.reset();
        frame.begin(info.frame, FrameMode::submit);
        for (View* each : input.views)
            frame.views.push_back({.view = each});
        origin.follow({&given, 1}, info.frame);
        const SceneRegistry::Snapshot& snapshot = scene.registry->begin(info.frame, origin.at());
        REQUIRE(openView(frame, 0, given, {pool, graph, origin.at(), snapshot.casters, images}));
        measureFacts(frame, {&given, 1},
                     {.scene = *scene.registry,
                      .methods = methods,
                      .memory = *scene.memory,
                      .arena = scene.arena,
                      .graph = graph,
                      .lights = lights,
                      .frameRate = 60.0});
    }
    /// The whole way to passes. @return the names of those that will run
    std::vector<std::string> declare()
    {
        measure();
        choose(frame, chooseParts());
        declareLights(frame, {graph, methods, selector, scene.messages, scene.arena, {}});
        std::vector<std::string> names;
        for (const std::uint32_t index : graph.order())
            if (const Pass& pass = graph.passes()[index]; pass.fn) names.emplace_back(pass.name); // not taken back
        return names;
    }
    std::string methodOf(std::size_t light) const
    {
        const std::uint32_t method = frame.lights[light].decision->method;
        return method == UINT32_MAX ? "none" : methods[method].name;
    }
};

using Names = std::vector<std::string>;

} // namespace

TEST_CASE("a frame is refused by the name of what is wrong, and nothing has changed")
{
    Trip trip({painter("a", true)});
    CHECK(trip.read());
    const auto refusal = [&](auto&& spoil) {
        GnViewFrame given = trip.given;
        GnFrameInfo info = trip.info;
        info.pViews = &given;
        spoil(info, given);
        FrameInput input;
        const Result<void> read =
            readFrame(info, {4, trip.views, *trip.scene.registry, trip.scene.stub.table, nullptr}, input);
        return read ? std::string("none") : std::string(read.error().id);
    };
    using Info = GnFrameInfo;
    using Given = GnViewFrame;
    CHECK(refusal([](Info&, Given&) {}) == "FrameOrder"); // 1 after 4
    const auto fifth = [&](auto&& spoil) {
        return refusal([&](Info& info, Given& given) {
            info.frame = 5;
            spoil(info, given);
        });
    };
    CHECK(fifth([](Info&, Given&) {}) == "none");
    CHECK(fifth([](Info& info, Given&) { info.completedFrame = 5; }) == "FrameOrder");
    CHECK(fifth([](Info& info, Given&) { info.budgetMs = -1.0f; }) == "BudgetNegative");
    CHECK(fifth([](Info& info, Given&) { info.flags = 1u << 20; }) == "UnknownFlags");
    CHECK(fifth([](Info& info, Given&) { info.waitCount = 1; }) == "SemaphoresMissing");
    CHECK(fifth([](Info& info, Given&) { info.pViews = nullptr; }) == "ViewsMissing");
    CHECK(fifth([](Info&, Given& given) { given.view = VK_NULL_HANDLE; }) == "InvalidHandle");
    CHECK(fifth([](Info&, Given& given) { given.projection[1] = 1.0f; }) == "ProjectionNotPerspective");
    CHECK(fifth([](Info&, Given& given) { given.depthView = VK_NULL_HANDLE; }) == "DepthMissing");
    CHECK(fifth([](Info&, Given& given) { given.imageExtent = {}; }) == "ViewEmpty");
    const GnLight twice[] = {trip.bulbs[0], trip.bulbs[0]};
    CHECK(fifth([&](Info&, Given& given) { given.pLights = twice; }) == "LightTwice");
    CHECK(trip.lights.empty());
    CHECK(trip.views.find(trip.view)->visibility == nullptr);
}

TEST_CASE("facts are measured for every light of a view, in the order of its layers")
{
    Trip trip({painter("a", true)});
    trip.measure();
    REQUIRE(trip.frame.lights.size() == 2);
    for (std::uint32_t i = 0; i < 2; ++i) {
        const ViewLight& light = trip.frame.lights[i];
        CHECK(light.layer == i);
        CHECK(light.light->handle == trip.bulbs[i]);
        CHECK(light.facts.dynamicLights == 2);
        CHECK(light.facts.frameRate == 60.0);
        CHECK(light.decision == nullptr);
    }
    CHECK(trip.frame.visibilities.size() == 1);
    CHECK(trip.lights.size() == 2);
}

TEST_CASE("a light that is new rests if the host calls it static, others once a second frame has shown that they do")
{
    Trip trip({painter("a", true)});
    GnLightInfo fixed{};
    fixed.type = GN_LIGHT_TYPE_POINT;
    fixed.pName = "fixed";
    fixed.range = 10.0f;
    fixed.flags = GN_LIGHT_STATIC_BIT;
    trip.bulbs[1] = *trip.scene.registry->createLight(fixed);
    trip.measure();
    CHECK(!trip.frame.lights[0].facts.still);
    CHECK(trip.frame.lights[1].facts.still);
    trip.info.frame = 2;
    trip.measure();
    CHECK(trip.frame.lights[0].facts.still);
    CHECK(trip.frame.lights[1].facts.still);
}

TEST_CASE("each light is served by the first of equals, and its passes are declared")
{
    Trip trip({painter("a", true), painter("b", true)});
    CHECK(trip.declare() == Names{"painter.paint", "painter.paint"});
    CHECK(trip.methodOf(0) == "a");
    CHECK(trip.methodOf(1) == "a");
    CHECK(trip.frame.stats.switches == 0);
    CHECK(trip.views.find(trip.view)->lastFrame == 1);
}

TEST_CASE("a light that the host pinned has that method")
{
    Trip trip({painter("a", true), painter("b", true)});
    trip.measure(); // the light is known from now on
    trip.lights[trip.frame.lights[1].light->id].pinned = 1;
    trip.declare();
    CHECK(trip.methodOf(0) == "a");
    CHECK(trip.methodOf(1) == "b");
}

TEST_CASE("a light that has left its map forgets how rarely that was drawn")
{
    Trip trip({painter("a", true)}); // looks up none
    trip.measure();
    for (const ViewLight& light : trip.frame.lights)
        light.memory->redrawEvery = 8;
    trip.declare();
    for (const ViewLight& light : trip.frame.lights)
        CHECK(light.memory->redrawEvery == 0);
}

TEST_CASE("what cannot be declared is replaced in the order of the choice, one method after the other")
{
    Trip trip({painter("a", false), painter("b", false), painter("c", true), painter("d", true)});
    CHECK(trip.declare() == Names{"painter.paint", "painter.paint"});
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(trip.methodOf(i) == "c");
        CHECK(trip.frame.lights[i].decision->candidates[0].exclusion == Exclusion::refused);
        CHECK(trip.frame.lights[i].decision->candidates[1].exclusion == Exclusion::refused);
        CHECK(trip.frame.lights[i].memory->incumbent == 2);
        CHECK(trip.frame.lights[i].memory->failures[1].holds(2, 0));
    }
    Names said;
    for (const SceneFixture::Said& each : trip.scene.said())
        said.push_back(each.text.substr(each.text.rfind("; ")));
    CHECK(said == Names{"; 'b' serves it", "; 'c' serves it", "; 'b' serves it", "; 'c' serves it"});
}

TEST_CASE("a light that nothing can serve is lit")
{
    Trip trip({painter("a", false), painter("b", false)});
    CHECK(trip.declare() == Names{"view.lit", "view.lit"});
    CHECK(trip.methodOf(0) == "none");
    CHECK(trip.scene.said().size() == 4);
}

TEST_CASE("replacements come as the choice would make it again each time, and end with none")
{
    std::vector<Candidate> candidates(5);
    const auto suited = [&](std::size_t i, std::int32_t quantised, Exclusion exclusion) {
        candidates[i].quantised = quantised;
        candidates[i].exclusion = exclusion;
    };
    suited(0, 100, Exclusion::none);
    suited(1, 400, Exclusion::refused); // the one that has just failed
    suited(2, 300, Exclusion::none);
    suited(3, 200, Exclusion::notReady);
    suited(4, 50, Exclusion::none);
    const auto order = [&](const ChoiceInput& input) {
        std::vector<std::uint32_t> methods;
        for (const Choice& choice : replacementsInOrder(candidates, input))
            methods.push_back(choice.method);
        return methods;
    };
    using Order = std::vector<std::uint32_t>;
    // What is best suited but not ready lets fallbacks serve, then anything.
    CHECK(order({.incumbent = 0, .fallbacks = {4}}) == Order{2, 4, 0, UINT32_MAX});
    CHECK(order({.pinned = 4}) == Order{4, 2, 0, UINT32_MAX});
    CHECK(replacementsInOrder(candidates, {.fallbacks = {4}})[1].wanted == 3);
    CHECK(replacementsInOrder(candidates, {.fallbacks = {4}})[1].reason == GN_REASON_FALLBACK);
    CHECK(replacementsInOrder({}, {}).size() == 1);
}

TEST_CASE("a timed frame is charged to the methods that declared its passes, once")
{
    Trip trip({painter("a", true), painter("b", true)});
    trip.declare();
    recordDecisions(trip.frame, trip.chooseParts());
    trip.history.past.present().cpuMs = 0.5f;
    const std::uint32_t view = trip.input.views[0]->id;
    const std::uint32_t left = trip.frame.lights[0].light->id, right = trip.frame.lights[1].light->id;
    const auto pass = [](std::uint32_t of, std::uint32_t light, std::uint32_t method, float gpuMs, float cpuMs) {
        return PassTiming{.owner = {.view = of, .light = light, .method = method, .declarer = method},
                          .gpuMs = gpuMs,
                          .cpuMs = cpuMs};
    };
    // The left light fades from b to a, and a draws it a map, whatever the view. Another view's passes are not its own.
    FrameTimings timings{.frame = 1,
                         .timed = true,
                         .totalGpuMs = 20.0f,
                         .passes = {pass(view, left, 0, 1.0f, 0.25f), pass(UINT32_MAX, left, 0, 4.0f, 0.0f),
                                    pass(view, left, 1, 2.0f, 0.0f), pass(view + 1, left, 0, 8.0f, 0.0f),
                                    pass(view, right, 0, 3.0f, 0.0f)}};
    const LearnParts parts{&timings, &timings, true, trip.plan, trip.history, trip.methods.size()};
    learn(trip.frame, parts);
    const auto measuredMs = [&](std::size_t light) { return trip.frame.lights[light].memory->measuredMs; };
    CHECK(measuredMs(0)[0] == doctest::Approx(5.25));
    CHECK(measuredMs(0)[1] == doctest::Approx(2.0));
    CHECK(measuredMs(1)[0] == doctest::Approx(3.0));
    CHECK(trip.frame.stats.gpuMs == doctest::Approx(20.0));
    CHECK(trip.frame.stats.gpuFrame == 1);
    CHECK(trip.frame.stats.gpuFrameCpuMs == doctest::Approx(0.5));
    const TimedLight* timed = trip.plan.timed(*trip.frame.lights[0].memory);
    REQUIRE(timed);
    CHECK(timed->method == 0); // who serves has the last word
    CHECK(timed->timing.updated);
    CHECK(timed->timing.updateGpuMs == doctest::Approx(4.0));
    CHECK(timed->timing.resolveGpuMs == doctest::Approx(1.0));
    DecisionRecord record;
    REQUIRE(trip.views.find(trip.view)->records.find(1, left, record));
    CHECK(record.measuredMs == doctest::Approx(5.25));
    for (PassTiming& each : timings.passes)
        each.gpuMs = 100.0f;
    learn(trip.frame, parts); // of the same frame
    CHECK(measuredMs(1)[0] == doctest::Approx(3.0));
}

TEST_CASE("what a task draws into a map that is kept counts as the light's update, as what all views share does")
{
    Trip trip({painter("a", true), painter("b", true)});
    trip.declare();
    const std::uint32_t view = trip.input.views[0]->id, light = trip.frame.lights[0].light->id;
    const PassOwner task{.view = view, .light = light, .method = 0, .declarer = 0};
    PassOwner page = task;
    page.drawsKept = true;
    const FrameTimings timings{.frame = 1,
                               .timed = true,
                               .totalGpuMs = 8.0f,
                               .passes = {{.owner = page, .gpuMs = 4.0f, .cpuMs = 0.5f},
                                          {.owner = task, .gpuMs = 1.0f},
                                          {.owner = page, .gpuMs = 2.0f}}};
    learn(trip.frame, {&timings, &timings, true, trip.plan, trip.history, trip.methods.size()});
    const TimedLight* timed = trip.plan.timed(*trip.frame.lights[0].memory);
    REQUIRE(timed);
    CHECK(timed->timing.updated);
    CHECK(timed->timing.updateGpuMs == doctest::Approx(6.0));
    CHECK(timed->timing.updateCpuMs == doctest::Approx(0.5));
    CHECK(timed->timing.resolveGpuMs == doctest::Approx(1.0));
}

TEST_CASE("without timings nobody is charged, and without a clock with the time of the processor alone")
{
    Trip trip({painter("a", true)});
    trip.declare();
    const std::uint32_t view = trip.input.views[0]->id, left = trip.frame.lights[0].light->id;
    const FrameTimings timings{
        .frame = 1,
        .timed = true,
        .passes = {{.owner = {.view = view, .light = left, .method = 0, .declarer = 0}, .cpuMs = 1.0f}}}; // GPU: 0
    learn(trip.frame, {nullptr, nullptr, true, trip.plan, trip.history, 1});
    CHECK(trip.frame.lights[0].memory->measuredMs[0] == 0.0f);
    CHECK(trip.frame.stats.gpuFrame == 0);
    learn(trip.frame, {&timings, &timings, false, trip.plan, trip.history, 1});
    CHECK(trip.frame.lights[0].memory->measuredMs[0] == 1.0f);
}

TEST_CASE("decisions are on record once they are settled")
{
    Trip trip({painter("a", false), painter("b", true)});
    trip.declare();
    recordDecisions(trip.frame, trip.chooseParts());
    const RecordRing& records = trip.views.find(trip.view)->records;
    CHECK(records.newest() == 1);
    DecisionRecord record;
    REQUIRE(records.find(1, trip.frame.lights[0].light->id, record));
    CHECK(record.method == 1); // what served, not what was to serve
}
