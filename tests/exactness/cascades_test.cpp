// What several maps of a directional light are worth beside one, and that keeping them shows what drawing them anew
// does.
#include <algorithm>

#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

const Settings kCoarse{{"resolution", 512.0}, {"filter", 1.0}};

ErrorCount ofSun(const Stage& stage, const Pictures& pictures)
{
    return pooled(stage, pictures, GN_TRAIT_DIRECTIONAL_BIT);
}

/// The scene with a post far away to all sides, as hosts have that load what lies around.
Scene amidPosts(const std::string& name, double distance)
{
    Scene scene = shippedScene(name);
    const auto small =
        std::find_if(scene.instances.begin(), scene.instances.end(), [&](const demo::Instance& instance) {
            return instance.isStatic && !instance.hostDrawn && instance.keys.empty() &&
                   scene.meshes[instance.mesh].triangleCount() < 100;
        });
    REQUIRE(small != scene.instances.end());
    for (const glm::dvec3 way :
         {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
        demo::Instance post = *small;
        post.name = "post";
        post.pose.position = distance * way;
        scene.instances.push_back(post);
    }
    return scene;
}

} // namespace

TEST_CASE("with four maps a sun is wrong on 1 in 1.7 of the pixels that it is with one, and in a wide scene on a tenth")
{
    const test::DeviceTest silence;
    for (const char* name : {"bunny", "colonnade"}) {
        CAPTURE(name);
        for (const double posts : {0.0, 300.0}) {
            CAPTURE(posts);
            Stage stage(posts > 0.0 ? amidPosts(name, posts) : shippedScene(name), testSize());
            const ErrorCount one = ofSun(stage, stage.draw("shadow_map", kCoarse));
            const ErrorCount four = ofSun(stage, stage.draw("cascades", kCoarse));
            MESSAGE(name << ", posts at " << posts << ": shadow_map " << inWords(one) << ", cascades " << inWords(four)
                         << ", ratio " << double(one.wrong()) / double(four.wrong()));
            CHECK(one.counted == four.counted);
            CHECK(double(one.wrong()) >= (posts > 0.0 ? 10.0 : 1.7) * double(four.wrong()));
        }
    }
}

TEST_CASE("after the camera and casters have moved, kept maps show what new ones do, bit for bit")
{
    const test::DeviceTest silence;
    for (const char* name : {"bunny", "colonnade"}) {
        CAPTURE(name);
        Scene scene = shippedScene(name);
        demo::CameraKey key = scene.camera.front();
        scene.camera.clear();
        constexpr int kFrames = 12;
        for (int i = 0; i <= kFrames; ++i) {
            key.time = i;
            const glm::dvec3 step = 0.15 * glm::dvec3(1.0, 0.2, -0.6);
            key.eye += step;
            key.target += step + 0.1 * glm::dvec3(0.3 * i, 0.0, 0.0);
            scene.camera.push_back(key);
        }
        Stage walked(scene, {640, 360});
        for (int i = 1; i <= kFrames; ++i) {
            walked.goTo(i);
            const Pictures kept = walked.draw("cascades", kCoarse);
            if (i % 4 != 0) continue;
            Stage fresh(scene, {640, 360}, i);
            const Pictures anew = fresh.draw("cascades", kCoarse);
            for (size_t layer = 0; layer < kept.size(); ++layer)
                CHECK(kept[layer].texels == anew[layer].texels);
        }
    }
}

} // namespace gnomon::exact
