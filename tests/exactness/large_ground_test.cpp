// Grounds of two triangles, kilometres wide. Their corners are rounded where they are, and with them the depths near
// the eye: a bare ground must not shadow itself for that. Answers are known without a truth: all of it is lit.
#include <algorithm>

#include "demo/scene/primitives.hpp"
#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

struct Ground {
    double side, tilt; ///< Metres, and radians about the x axis.
    int place;         ///< Where it lies, and the eye beside it.
};
// Each shadowed itself, half of it or all, when offsets were told by the receiver's and the light's coordinates alone.
constexpr Ground kGrounds[] = {{4000.0, 0.5, 14},  {4000.0, 0.5, 19}, {16000.0, 0.0, 6},
                               {16000.0, 0.0, 14}, {16000.0, 0.5, 1}, {16000.0, 0.5, 5}};

Scene bareGround(const Ground& ground)
{
    Scene scene;
    scene.name = "bare ground";
    demo::Mesh& mesh = scene.meshes.emplace_back(
        demo::makePlane({.width = static_cast<float>(ground.side), .depth = static_cast<float>(ground.side)}));
    mesh.name = "ground";
    demo::Instance& instance = scene.instances.emplace_back();
    instance.name = "ground";
    const double k = ground.place;
    instance.pose.position = {0.37 * k, -1.7 + 0.1137 * k, 0.71 * k};
    instance.pose.rotation = glm::angleAxis(ground.tilt, glm::dvec3(1.0, 0.0, 0.0));
    instance.isStatic = true;
    demo::Light& sun = scene.lights.emplace_back();
    sun.name = "sun";
    sun.kind = LightKind::Directional;
    sun.direction = glm::normalize(glm::dvec3(0.3, -1.0, -0.4));
    demo::Light& lamp = scene.lights.emplace_back();
    lamp.name = "lamp";
    lamp.kind = LightKind::Point;
    lamp.position = {1.0, 7.0, 2.0};
    lamp.range = 60.0f;
    scene.camera = {{.eye = {0.3 * k, 3.0 + 0.21 * k + 4.0 * ground.tilt, 8.0 - 0.17 * k},
                     .target = {0.0, 0.0, 0.0},
                     .verticalFov = 0.8f}};
    return scene;
}

/// A slope of small triangles whose vertices are in world coordinates, `away` metres from their zero, and an eye beside
/// it.
Scene slopeFarFromZero(double away, int place)
{
    Scene scene = bareGround({20.0, 0.0, 0});
    const double k = place;
    const glm::dvec3 at(away + 1.37 * k, 0.3 * away, 0.7 * away - 0.77 * k);
    const glm::dquat turn = glm::angleAxis(0.5, glm::normalize(glm::dvec3(1.0, 0.2, 0.3)));
    scene.meshes[0] = demo::makePlane({.width = 20.0f, .depth = 20.0f, .columns = 20, .rows = 20});
    for (glm::vec3& position : scene.meshes[0].positions)
        position = glm::vec3(turn * glm::dvec3(position) + at);
    scene.instances[0].pose = {};
    scene.lights[1].position += at;
    scene.camera = {{.eye = at + turn * glm::dvec3(0.1 * k, 1.5, 3.0), .target = at, .verticalFov = 0.8f}};
    return scene;
}

/// All that sees a light is lit, by every method that traces.
void checkAllLit(Stage& stage)
{
    size_t asked = 0;
    for (const GnMethodInfo& method : stage.methods()) {
        if ((method.traits & (GN_TRAIT_RAYS_BIT | GN_TRAIT_DEVICE_RAYS_BIT)) == 0 || method.pUnavailable) continue;
        CAPTURE(std::string(method.pName));
        const Pictures pictures = stage.draw(method.pName);
        size_t dark = 0;
        for (size_t layer = 0; layer < pictures.size(); ++layer)
            for (size_t i = 0; i < pictures[layer].texels.size(); ++i)
                dark += stage.counted[layer][i] == 1 && pictures[layer].texels[i] < 128;
        CHECK(dark == 0);
        ++asked;
    }
    CHECK(asked >= 6);
    for (const std::vector<uint8_t>& counted : stage.counted)
        CHECK(std::count(counted.begin(), counted.end(), uint8_t{1}) > 10'000);
}

} // namespace

TEST_CASE("no method that traces finds a bare ground of any size in its own shadow")
{
    const test::DeviceTest silence;
    for (const Ground& ground : kGrounds) {
        CAPTURE(ground.side);
        CAPTURE(ground.tilt);
        CAPTURE(ground.place);
        Stage stage(bareGround(ground), {320, 180});
        checkAllLit(stage);
    }
}

TEST_CASE("nor a slope in world coordinates, however far from their zero")
{
    const test::DeviceTest silence;
    for (const double away : {1000.0, 3000.0, 10000.0})
        for (const int place : {1, 6, 11}) {
            CAPTURE(away);
            CAPTURE(place);
            Stage stage(slopeFarFromZero(away, place), {640, 360});
            checkAllLit(stage);
        }
}

} // namespace gnomon::exact
