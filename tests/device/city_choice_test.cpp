// What the shipped rules choose in city_night, whose lights are from 5 to 300 m away, by the knowledge that travels in
// the library: this machine's times are not learned. Recorded, since on a software device rays are the cheapest right
// answer at every distance, and then the rules have no say.
#include <map>
#include <string>

#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kExtent{640, 360};
constexpr float kNearestMetres = 5.0f, kFarthestMetres = 300.0f;
constexpr double kMoments[] = {0.0, 6.0}; ///< Seconds of the scene's twelve.

/// "octree_volume", "cube_map at 256": what serves lights whose nearest receiver is within these distances, and how
/// many.
void count(const Host& host, std::map<std::string, uint32_t>& served)
{
    for (size_t light = 0; light < host.lights.size(); ++light) {
        const GnDecision decision = host.decision(light);
        if (!decision.pMethod || !(decision.viewerDistance >= kNearestMetres)) continue;
        if (decision.viewerDistance > kFarthestMetres) continue;
        std::string name = decision.pMethod;
        if (decision.mapSide > 0) name += " at " + std::to_string(decision.mapSide);
        ++served[name];
    }
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "in city_night four methods or map sides at least serve between 5 and 300 m, by every base")
{
    const Scene scene = demo::valueOf(demo::loadScene("city_night"));
    const auto lights = static_cast<uint32_t>(scene.lights.size());
    Host host(scene,
              hooked({.extent = kExtent, .maxLights = lights, .warmAll = true, .mapSide = 0.0}, {withoutTimestamps()}));
    for (const char* base : {"default", "quality", "battery"}) {
        const std::string rules = shippedRules(base);
        host.require(gnLoadRules(host.context, rules.data(), rules.size(), base));
        std::map<std::string, uint32_t> served;
        for (const double time : kMoments) {
            host.renewLights();
            host.draw(3, {.call = Call::record, .time = time}); // distances are measured in the first
            count(host, served);
        }
        std::string words = std::string(base) + ":";
        for (const auto& [name, lightsOf] : served)
            words += " " + name + " (" + std::to_string(lightsOf) + ")";
        MESSAGE(words);
        CHECK_MESSAGE(served.size() >= 4, words);
    }
}
