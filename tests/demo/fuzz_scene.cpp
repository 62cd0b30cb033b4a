// libFuzzer entry point of the scene reader. Built on request with clang, see CMakeLists.txt:
//   ninja fuzz_scene && ./tests/fuzz_scene -max_len=8192 CORPUS demo/scenes
#include "demo/scene/scene_file.hpp"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    gnomon::demo::SceneFileOptions options;
    options.buildMeshes = false; // the text is what is under test
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto scene = gnomon::demo::parseScene(text, "fuzz.yaml", options);
    if (!scene) return 0;
    // What was accepted must be fit to be shown.
    for (const double time : {0.0, 1.5, 1e9}) {
        (void)gnomon::demo::cameraAt(*scene, time);
        for (const gnomon::demo::Light& light : scene->lights)
            (void)gnomon::demo::lightAt(light, time);
        for (const gnomon::demo::Instance& instance : scene->instances)
            (void)gnomon::demo::instanceAt(instance, time);
    }
    return 0;
}
