// A method that may be cheaper than predicted is measured beside the one that serves, and nobody sees it.
#include "device/fixture.hpp"
#include "runtime/cost/cost_model.hpp"
#include "runtime/cost/knowledge_base.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char *kServes = "ray_traced", *kProbed = "tile_shafts";
constexpr uint32_t kEvery = 20;
// Small pictures: what a probe may waste follows from the frames a second, and takes 25 of them here.
constexpr VkExtent2D kExtent{96, 54};

/// The two exact methods, more than either takes in any build. The second one is expected to be cheaper by a third,
/// but so little is known of it that it counts as costlier: its upper bound wastes little.
std::string knowledge()
{
    cost::DeviceKnowledge known{device().properties.deviceName, "", "software", {}, {}};
    for (const char* name : {kServes, kProbed}) {
        cost::AlgorithmCost cost{.algorithm = name, .tracks = {}};
        cost.tracks[trackOf(cost::Pass::resolve, cost::Processor::cpu)] = {
            .ms = {name == kServes ? 20.0 : 14.0}, .octaves = name == kServes ? 0.1 : 0.6, .samples = 40};
        known.algorithms.push_back(cost);
    }
    return cost::writeKnowledge({&known, 1});
}

void load(Host& host, uint32_t everyFrames)
{
    const std::string base = knowledge();
    host.require(gnLoadKnowledge(host.context, base.data(), base.size(), "base.csv"));
    const std::string rules =
        std::string("version: 1\n"
                    "options: {allocation: budget}\n"
                    "variables: {lightRadius: {universe: [0, 2], unit: m, terms: "
                    "{all: [-.inf, -.inf, .inf, .inf]}}}\n"
                    "rules:\n"
                    "  - {rule: if lightRadius is all then ") +
        kServes +
        " is favoured}\n"
        "  - {rule: if lightRadius is all then " +
        kProbed + " is favoured}\npolicy: {probing: {everyFrames: " + std::to_string(everyFrames) + ", sigma: 1}}\n";
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "probing"));
}

struct Seen {
    std::vector<uint64_t> frames; ///< In which a method was probed.
    size_t wrong = 0;             ///< Pixels that differ from the picture of the method that serves.
};

Seen draw(Host& host, float budgetMs, uint32_t frames, const std::vector<Image8>& expected)
{
    Seen seen;
    for (uint32_t i = 0; i < frames; ++i) {
        host.require(
            host.draw({.adjust = [=](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.budgetMs = budgetMs; }}));
        const GnDecision decision = host.decision(0);
        REQUIRE(decision.pMethod);
        CHECK(host.stats().fading == 0);
        if (!decision.pProbed) continue; // nothing is read back where nothing is looked for: slow frames are few
        seen.wrong += differences(host.pictures(), expected);
        CHECK(std::string(decision.pProbed) != decision.pMethod);
        CHECK(decision.fade == 1.0f);
        CHECK(host.passCount("view.fade") == 0);
        CHECK(host.explanation(0).find("is measured, not shown") != std::string::npos);
        seen.frames.push_back(host.frame());
    }
    return seen;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a probe runs unseen for as long as it takes to time it, and not again too soon")
{
    Host host(smallScene(), {.extent = kExtent});
    load(host, kEvery);
    host.pinAll(kServes);
    host.require(host.draw());
    const std::vector<Image8> expected = host.pictures();
    draw(host, 1e5f, kEvery, expected); // what serves is timed first
    host.pinAll(nullptr);
    Seen seen; // a slow second leaves no room for one
    for (int round = 0; round < 10 && seen.frames.empty(); ++round)
        seen = draw(host, 1e5f, 4 * kEvery, expected);
    REQUIRE(!seen.frames.empty());
    CHECK(seen.wrong == 0); // both methods are exact, and only one is shown
    uint64_t begun = seen.frames.front(), last = begun;
    for (const uint64_t frame : seen.frames) {
        if (frame > last + 1) {
            CHECK(frame >= begun + kEvery);
            begun = frame;
        }
        CHECK(frame < begun + cost::kLearnFrames);
        last = frame;
    }
}

TEST_CASE_FIXTURE(DeviceTest, "nothing is probed where the rules say never, or the budget has no room")
{
    Host host(smallScene(), {.extent = kExtent});
    load(host, 0);
    host.pinAll(kServes);
    host.require(host.draw());
    const std::vector<Image8> expected = host.pictures();
    host.pinAll(nullptr);
    CHECK(draw(host, 1e5f, 2 * kEvery, expected).frames.empty());
    load(host, kEvery);
    CHECK(draw(host, 0.001f, 2 * kEvery, expected).frames.empty()); // less than what serves takes
    CHECK(draw(host, 0.0f, 2 * kEvery, expected).frames.empty());   // no budget says what may be spent
}
