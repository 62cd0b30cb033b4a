// Whoever asks a map, the device or the CPU in a copy of it, the answers are the same.
#include "exactness/stage.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{640, 360};

bool traced(uint8_t reason)
{
    return reason == gpu::REASON_RT_LIT || reason == gpu::REASON_RT_SHADOW;
}
bool known(uint8_t reason)
{
    return reason == gpu::REASON_MAP_LIT || reason == gpu::REASON_MAP_SHADOW || reason == gpu::REASON_TC_LIT ||
           reason == gpu::REASON_TC_SHADOW;
}

struct Compared {
    uint64_t pixels = 0;
    uint64_t different = 0; ///< Other reasons: within rounding of a comparison or of n.l.
    uint64_t opposed = 0;   ///< The map says lit to the one and dark to the other.
    uint64_t known = 0, traced = 0;
};

Compared compare(Stage& stage, const char* method)
{
    Settings settings{{"resolution", 512.0}, {"reasons", 1.0}, {"classify", 0.0}};
    if (std::string(method) == "contour_chain") settings.insert(settings.begin(), {"mode", 0.0});
    const Pictures byDevice = stage.draw(method, settings);
    settings.back().value = 1.0;
    const Pictures byHost = stage.draw(method, settings);
    Compared result;
    for (size_t layer = 0; layer < byDevice.size(); ++layer)
        for (size_t i = 0; i < byDevice[layer].texels.size(); ++i) {
            const uint8_t device = byDevice[layer].texels[i], host = byHost[layer].texels[i];
            const bool outside = device == 255 && host == gpu::REASON_OUTSIDE; // beyond what the light reaches
            ++result.pixels;
            result.different += device != host && !outside;
            result.opposed += device != host && known(device) && known(host);
            result.known += known(host);
            result.traced += traced(host);
        }
    return result;
}

} // namespace

TEST_CASE("maps say the same whoever asks them")
{
    const test::DeviceTest silence;
    for (const char* name : {"torus_grid", "torus_grid_standard", "room", "colonnade", "bunny"}) {
        Stage stage(shippedScene(name), kSize);
        for (const char* method : {"pcf_hybrid", "contour_chain"}) {
            const Compared result = compare(stage, method);
            MESSAGE(std::string(name) << ", " << std::string(method) << ": " << result.different << " of "
                                      << result.pixels << " pixels differ, " << result.traced << " traced");
            CHECK(result.opposed <= result.pixels / 100000);
            CHECK(result.different <= result.pixels / 4000);
            CHECK(result.known > result.pixels / 20);
            CHECK(result.traced > 0);
        }
    }
}

} // namespace gnomon::exact
