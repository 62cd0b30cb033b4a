// What several maps of a directional light are worth beside one, and that keeping them shows what drawing them again
// does.
#include <algorithm>
#include <cmath>
#include <functional>

#include "demo/scene/primitives.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

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

/// A long wall to the left, whose shadow's edge runs away from the eye over the ground, through all maps.
Scene alongWall()
{
    Scene scene;
    scene.name = "along a wall";
    place(scene, "ground", demo::makeBox({.size = {400.0f, 1.0f, 400.0f}}), {0.0, -0.5, -150.0});
    place(scene, "wall", demo::makeBox({.size = {0.2f, 6.0f, 300.0f}}), {-8.0, 3.0, -140.0});
    demo::Light& sun = scene.lights.emplace_back();
    sun.name = "sun";
    sun.kind = LightKind::Directional;
    sun.direction = glm::normalize(glm::dvec3(0.6, -0.8, 0.17));
    scene.camera = {{.eye = {0.0, 2.5, 4.0}, .target = {-2.0, 0.5, -8.0}}};
    return scene;
}

constexpr double kEdgeX = -7.9 + 6.0 * 0.6 / 0.8; // of the wall's shadow on the ground

/// Visibility along a line x = constant of the ground, row by row of the picture away from the eye, to `farthest`
/// metres.
std::vector<double> alongLine(const Stage& stage, const Image8& picture, double x, double farthest)
{
    const demo::CameraMatrices& camera = stage.camera;
    const glm::dvec3 corner(camera.rayCorner), dx(camera.rayDx), dy(camera.rayDy);
    std::vector<double> values;
    for (int row = int(picture.height) - 1; row >= 0; --row) {
        const glm::dvec3 start = corner + (row + 0.5) * dy; // the picture's rows are level
        if (start.y >= 0.0) break;
        const double depth = -camera.eye.y / start.y;
        if (depth > farthest) break;
        const double column = ((x - camera.eye.x) / depth - start.x) / dx.x - 0.5;
        if (column < 0.0 || column >= double(picture.width) - 1.0) continue;
        const auto left = static_cast<size_t>(column);
        const uint8_t* texel = &picture.texels[size_t(row) * picture.width + left];
        const double share = column - double(left);
        values.push_back(((1.0 - share) * texel[0] + share * texel[1]) / 255.0);
    }
    return values;
}

std::vector<double> jumpsOf(const std::vector<double>& values)
{
    std::vector<double> jumps;
    for (size_t i = 1; i < values.size(); ++i)
        jumps.push_back(std::fabs(values[i] - values[i - 1]));
    return jumps;
}

/// Of the pixels of a picture that show what lies amid pixels of one visibility in the frame before, the share whose
/// own is the other one, per cent: edges that move over what stands still.
double flipped(const Stage& now, const Image8& picture, const Seen& before, const Image8& pictureBefore)
{
    const int width = int(picture.width), height = int(picture.height);
    size_t still = 0, flips = 0;
    for (int i = 0; i < width * height; ++i) {
        if (now.counted[0][size_t(i)] != 1) continue;
        const demo::CameraMatrices& camera = now.camera;
        const glm::dvec3 ray = glm::dvec3(camera.rayCorner) + (i % width + 0.5) * glm::dvec3(camera.rayDx) +
                               (i / width + 0.5) * glm::dvec3(camera.rayDy);
        const double depth =
            double(camera.depthScale) / (double(now.surfaces.depth.texels[size_t(i)]) + double(camera.depthAdd));
        const glm::dvec3 place = camera.eye + depth * ray - before.camera.eye;
        const glm::dvec4 clip = glm::dmat4(before.camera.clipFromEye) * glm::dvec4(place, 1.0);
        if (!(clip.w > 0.0)) continue;
        const int x = int(std::floor(0.5 * (clip.x / clip.w + 1.0) * width)),
                  y = int(std::floor(0.5 * (clip.y / clip.w + 1.0) * height));
        if (x < 1 || y < 1 || x + 1 >= width || y + 1 >= height) continue;
        const auto at = [&](int dx, int dy) { return size_t((y + dy) * width + x + dx); };
        const double seen = double(before.camera.depthScale) /
                            (double(before.surfaces.depth.texels[at(0, 0)]) + double(before.camera.depthAdd));
        if (std::fabs(seen - clip.w) > 0.02 * clip.w) continue; // something else was there
        bool amid = true;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                amid = amid && before.counted[0][at(dx, dy)] == 1 &&
                       demo::isLit(pictureBefore.texels[at(dx, dy)]) == demo::isLit(pictureBefore.texels[at(0, 0)]);
        if (!amid) continue;
        ++still;
        flips += demo::isLit(picture.texels[size_t(i)]) != demo::isLit(pictureBefore.texels[at(0, 0)]);
    }
    REQUIRE(still > 10'000);
    return 100.0 * double(flips) / double(still);
}

/// The scene under its sun alone, by a camera that has a key each second.
Scene moved(const std::string& name, int frames, const std::function<void(demo::CameraKey&)>& step)
{
    Scene scene = shippedScene(name);
    std::erase_if(scene.lights, [](const demo::Light& light) { return light.kind != LightKind::Directional; });
    scene.lights.resize(1);
    scene.lights[0].keys.clear();
    scene.lights[0].orbit = {};
    for (demo::Instance& instance : scene.instances) {
        instance.keys.clear();
        instance.isStatic = true;
    }
    demo::CameraKey key = scene.camera.front();
    scene.camera.clear();
    for (int i = 0; i <= frames; ++i) {
        key.time = i;
        scene.camera.push_back(key);
        step(key);
    }
    return scene;
}

} // namespace

TEST_CASE("where filtered maps meet, a penumbra jumps by no more than can be seen")
{
    const test::DeviceTest silence;
    Stage stage(alongWall(), {640, 480});
    const auto draw = [&](double fade) {
        const Settings settings{{"resolution", 512.0}, {"filter", 5.0}, {"fade", fade}};
        return jumpsOf(alongLine(stage, stage.draw("cascades", settings)[0], kEdgeX + 0.03, 30.0));
    };
    const std::vector<double> cut = draw(0.0), faded = draw(0.25);
    REQUIRE(cut.size() > 100);
    double seam = 0.0, inside = 0.0, left = 0.0;
    const double isSeam = 0.1;
    for (size_t i = 0; i < cut.size(); ++i) {
        (cut[i] > isSeam ? seam : inside) = std::max(cut[i] > isSeam ? seam : inside, cut[i]);
        left = std::max(left, faded[i]);
    }
    MESSAGE("largest jump from row to row: at a seam " << seam << ", within a map " << inside << ", faded " << left);
    CHECK(seam > 0.2);                                  // or there is nothing to fade
    CHECK(left <= std::max(2.0 * inside, 4.0 / 256.0)); // within a map it is one grey level; four are no line
}

TEST_CASE("a slow walk and a slow turn move the shadows of no more than one still pixel in a thousand")
{
    const test::DeviceTest silence;
    constexpr int kFrames = 16;
    const auto walk = [](demo::CameraKey& key) {
        const glm::dvec3 step(0.03, 0.0, -0.02);
        key.eye += step;
        key.target += step;
    };
    const auto turn = [](demo::CameraKey& key) {
        const double angle = 0.008;
        const glm::dvec3 ahead = key.target - key.eye;
        key.target = key.eye + glm::dvec3(std::cos(angle) * ahead.x - std::sin(angle) * ahead.z, ahead.y,
                                          std::sin(angle) * ahead.x + std::cos(angle) * ahead.z);
    };
    double sum = 0.0, plainSum = 0.0;
    for (const char* name : {"bunny", "colonnade"}) {
        for (const bool turns : {false, true}) { // trapezoidal's map follows the view
            Stage stage(turns ? moved(name, kFrames, turn) : moved(name, kFrames, walk), {320, 180});
            double worst = 0.0, plainWorst = 0.0;
            Pictures before, plainBefore;
            for (int i = 0; i <= kFrames; ++i) {
                const Seen seen = stage;
                if (i > 0) stage.goTo(i);
                const Pictures now = stage.draw("cascades", kCoarse), plain = stage.draw("trapezoidal", kCoarse);
                if (i > 0) {
                    worst = std::max(worst, flipped(stage, now[0], seen, before[0]));
                    plainWorst = std::max(plainWorst, flipped(stage, plain[0], seen, plainBefore[0]));
                }
                before = now;
                plainBefore = plain;
            }
            MESSAGE(std::string(name) << (turns ? " turned" : " walked") << ": at most " << worst
                                      << " % a frame, trapezoidal " << plainWorst << " %");
            CHECK(worst <= 0.1);
            sum += worst;
            plainSum += plainWorst;
        }
    }
    CHECK(plainSum > 1.5 * sum);
}

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
            const Pictures again = fresh.draw("cascades", kCoarse);
            for (size_t layer = 0; layer < kept.size(); ++layer)
                CHECK(kept[layer].texels == again[layer].texels);
        }
    }
}

} // namespace gnomon::exact
