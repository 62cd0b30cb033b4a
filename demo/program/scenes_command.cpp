// `gnomon scenes`
#include <cstdio>

#include "demo/program/commands.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {

int scenesCommand()
{
    int exitCode = 0;
    for (const ShippedScene& shipped : shippedScenes()) {
        const Outcome<Scene> scene = loadScene(shipped.file.string(), {.buildMeshes = false});
        if (!scene) {
            std::fprintf(stderr, "%s\n", scene.error().c_str());
            exitCode = 1;
            continue;
        }
        std::printf("%-20s %ux%u, %u frames, %zu lights, %zu instances\n%-20s %s\n", shipped.name.c_str(), scene->width,
                    scene->height, scene->frames, scene->lights.size(), scene->instances.size(), "",
                    scene->description.c_str());
    }
    return exitCode;
}

} // namespace gnomon::demo
