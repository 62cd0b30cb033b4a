// Rule bases over recorded traces (tests/traces): what they would have chosen, without a device.
#include <doctest/doctest.h>

#include "demo/program/rule_support.hpp"
#include "demo/replay/replay.hpp"
#include "tests/plan/recorded_trace.hpp"

using namespace gnomon::demo;

namespace {

using Names = std::vector<std::string>;

/// What `gnomon replay TRACE --rules NAME --rate 0` prints: the methods in the order in which they served all lights.
/// Only recorded frames: in between, facts that count lights would go over for those that stay, and not for those that
/// leave.
Names replayed(Trace trace, const char* rules)
{
    const gnomon::rules::RuleBase base = parseRules(rules);
    CHECK(applyRules(trace, base).empty());
    const ReplayOptions options{.policy = base.policy, .allocation = base.options.allocation};
    const std::vector<ReplayMetrics> all = compare(trace, options, nullptr);
    Names names;
    for (const uint32_t method : all.front().sequence)
        names.push_back(trace.methods[method]);
    return names;
}

} // namespace

// The runtime's own answer to the same scenes: tests/device/scenario_test.cpp.
TEST_CASE("the thesis's rules replayed over its scenario give its sequence of methods, forwards and backwards")
{
    CHECK(replayed(gnomon::test::recordedTrace("thesis"), "thesis") ==
          Names{"octree_volume", "chan_durand", "shadow_map", "chan_durand"});
    CHECK(replayed(gnomon::test::recordedTrace("thesis_reverse"), "thesis") ==
          Names{"chan_durand", "shadow_map", "chan_durand", "octree_volume"});
}

TEST_CASE("rules over a trace name the methods they would have chosen that it does not hold")
{
    Trace trace = gnomon::test::recordedTrace("stress");
    CHECK(applyRules(trace, parseRules("thesis")) == Names{"chan_durand", "octree_volume"});
}
