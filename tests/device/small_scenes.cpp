#include "device/small_scenes.hpp"

#include "demo/host/vulkan.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::test {

std::vector<demo::Scene> smallShippedScenes()
{
    std::vector<demo::Scene> scenes;
    for (const demo::ShippedScene& shipped : demo::shippedScenes()) {
        demo::Scene scene = demo::valueOf(demo::loadScene(shipped.name));
        if (scene.lights.size() <= 16 && demo::triangleCount(scene) <= 150'000) scenes.push_back(std::move(scene));
    }
    return scenes;
}

} // namespace gnomon::test
