// Normals that are no numbers: such receivers face no light, as those of no length, and others are as they would be.
#include <limits>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

TEST_CASE_FIXTURE(DeviceTest,
                  "a receiver whose normal is no number faces no light, and others look as beside no normal")
{
    constexpr VkRect2D kPixels{{30, 28}, {37, 23}}; // the ball, its shadow, and floor that is lit
    Host host(smallScene(), {.extent = {96, 64}});
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        CAPTURE(std::string(method.pName));
        Scene scene = smallScene();
        const demo::LightKind kind = servedKind(method);
        if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
        if (kind == demo::LightKind::Directional) scene.lights[0].kind = kind;
        const auto drawn = [&](float normal) {
            host.beginAnew(scene, method.pName);
            host.draw(2, {.normals = std::pair(kPixels, normal)});
            return host.pictures();
        };
        const std::vector<Image8> wanted = drawn(0.0f), is = drawn(std::numeric_limits<float>::quiet_NaN());
        CHECK(differences(is, wanted) == 0);
        const auto shone = [&](const Image8& picture) {
            size_t count = 0;
            for (uint32_t y = 0; y < kPixels.extent.height; ++y)
                for (uint32_t x = 0; x < kPixels.extent.width; ++x)
                    count +=
                        picture.texels[(size_t(kPixels.offset.y) + y) * picture.width + size_t(kPixels.offset.x) + x] !=
                        0;
            return count;
        };
        CHECK(shone(is[0]) == 0);
        CHECK(lit(is[0]) > 100);
    }
}
