// What the shipped rules choose for lights with a surface, on the scenes that are about them, by the knowledge that
// travels in the library: this machine's times are not learned.
#include <map>
#include <set>

#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kExtent{320, 180};

struct Choices {
    std::set<std::string> methods; ///< With penumbrae, and moments.
    std::string words;
};

/// By the base, submitted and recorded, once every light is decided.
void choose(Host& host, const char* base, float budgetMs, Choices& choices)
{
    const std::string rules = shippedRules(base);
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), base));
    std::map<std::string, GnTraits> traits;
    for (const GnMethodInfo& method : availableMethods(host.context))
        traits[method.pName] = method.traits;
    for (const Call call : {Call::submit, Call::record}) {
        host.renewLights();
        host.draw(4, {.call = call, .adjust = [budgetMs](GnFrameInfo& frame, std::vector<GnViewFrame>&) {
                          frame.budgetMs = budgetMs;
                      }});
        for (size_t light = 0; light < host.lights.size(); ++light) {
            const GnDecision decision = host.decision(light);
            REQUIRE(decision.pMethod);
            const std::string method = decision.pMethod;
            choices.words += std::string(base) + (call == Call::submit ? ", submitted, " : ", recorded, ") +
                             host.scene.lights[light].name + ": " + method + "\n";
            if ((traits[method] & GN_TRAIT_SOFT_PENUMBRA_BIT) || method == "moments") choices.methods.insert(method);
        }
    }
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "over the scenes with soft lights the shipped rules choose four soft methods at least")
{
    Choices choices;
    struct Row {
        const char* scene;
        bool hostDrawn; ///< A caster of which methods know no triangle: maps alone are left.
        float budgetMs; ///< 0: what the rules allow themselves.
    };
    for (const Row& row : {Row{"views/soft_table", false, 0.0f}, Row{"views/soft_table", true, 200.0f},
                           Row{"views/still_life", false, 0.0f}, Row{"views/leaf_shade", false, 0.0f}}) {
        choices.words += std::string(row.scene) + (row.hostDrawn ? ", drawn by the host\n" : "\n");
        Scene scene = demo::valueOf(demo::loadScene(row.scene));
        for (demo::Light& light : scene.lights)
            if (light.kind == demo::LightKind::Directional) light.radius *= 2.0f; // penumbrae of 4 pixels and more
        scene.instances.back().hostDrawn = row.hostDrawn;
        Host host(scene, hooked({.extent = kExtent, .warmAll = true}, {withoutTimestamps()}));
        for (const char* base : {"default", "quality", "battery"})
            choose(host, base, row.budgetMs, choices);
    }
    MESSAGE(choices.words);
    CHECK(choices.methods.size() >= 4); // coherence_sampling, multi_volume, penumbra_wedges, rbssm
}
