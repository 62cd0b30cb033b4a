// More methods than a machine word has bits: variants of the built-in ones with settings of their own.
#include "runtime/base/method_set.hpp"
#include "tests/device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

std::string variant(std::uint32_t i)
{
    return "variant_" + std::to_string(i);
}

/// Adds variants of shadow_map, each with a map of its own size, until there are so many methods.
void addVariants(Host& host, std::uint32_t methods)
{
    std::uint32_t count = 0;
    host.require(gnEnumerateMethods(host.context, &count, nullptr));
    for (; count < methods; ++count) {
        host.require(gnAddMethod(host.context, variant(count).c_str(), "shadow_map"));
        host.require(gnSetMethodSetting(host.context, variant(count).c_str(), "resolution", 64 + count));
    }
}

std::uint32_t mapSide(Host& host)
{
    GnLightMap map{};
    host.require(gnGetLightMap(host.context, host.lights[0], &map));
    return map.extent.width;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "of a hundred methods each serves with its own settings, by pin and by rule")
{
    constexpr std::uint32_t kMethods = 100;
    Host host(smallScene());
    addVariants(host, kMethods);
    host.require(gnWarmUp(host.context));
    for (const std::uint32_t i : {63u, 64u, 99u}) {
        host.pinAll(variant(i).c_str());
        host.require(host.draw());
        CHECK(std::string(host.decision(0).pMethod) == variant(i));
        CHECK(mapSide(host) == 64 + i);
    }
    host.pin(0, nullptr);
    const std::string rules = "version: 1\nname: many\nvariables:\n  dynamicLights:\n    universe: [0, 8]\n"
                              "    terms: {some: [-.inf, -.inf, .inf, .inf]}\nrules:\n"
                              "  - {id: A, rule: \"if dynamicLights is some then " +
                              variant(90) +
                              " is favoured and shadow_map is acceptable\", because: \"test\"}\n"
                              "  - {id: B, rule: \"if dynamicLights is some then never " +
                              variant(70) + "\", because: \"test\"}\n";
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "many.yaml"));
    host.draw(20, {}); // past a fade
    CHECK(std::string(host.decision(0).pMethod) == variant(90));
    CHECK(mapSide(host) == 64 + 90);

    std::vector<GnCandidate> candidates(kMethods);
    std::uint32_t count = kMethods;
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[0], &count, candidates.data()));
    CHECK(count == kMethods);
    CHECK(std::string(candidates[90].pMethod) == variant(90));
    CHECK(candidates[90].elimination == GN_ELIMINATION_NONE);
    CHECK(candidates[70].elimination == GN_ELIMINATION_NEVER);
    CHECK(candidates[99].elimination == GN_ELIMINATION_NO_OPINION);

    addVariants(host, kMethods + 1); // no candidate of the frame
    CHECK(host.explanation(0).find(variant(kMethods) + ": was added later\n") != std::string::npos);
    candidates.resize(++count);
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[0], &count, candidates.data()));
    CHECK(candidates[kMethods].elimination == GN_ELIMINATION_NOT_READY);
}

TEST_CASE_FIXTURE(DeviceTest, "the first method beyond the most there can be is an error that names it")
{
    Host host(smallScene(), {.warmUp = false});
    addVariants(host, kMaxMethods);
    CHECK(gnAddMethod(host.context, "straw", "shadow_map") == GN_ERROR_TOO_MANY);
    CHECK(host.lastError().find("'straw'") != std::string::npos);
    CHECK(host.lastError().find("255") != std::string::npos);
}
