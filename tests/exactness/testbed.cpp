#include "exactness/testbed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"

namespace gnomon::exact {

using namespace demo;

Instance& place(Scene& scene, const char* name, Mesh mesh, const glm::dvec3& position)
{
    mesh.name = name;
    scene.meshes.push_back(std::move(mesh));
    Instance& instance = scene.instances.emplace_back();
    instance.name = name;
    instance.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
    instance.pose.position = position;
    return instance;
}

namespace {

glm::dquat turned(const glm::dvec3& axis, double degrees)
{
    return glm::angleAxis(glm::radians(degrees), axis);
}

Light lamp(const char* name, LightKind kind, const glm::dvec3& position, const glm::dvec3& target)
{
    Light light;
    light.name = name;
    light.kind = kind;
    light.position = position;
    light.direction = glm::normalize(target - position);
    if (kind == LightKind::Spot) {
        light.outerAngle = 0.65f;
        light.innerAngle = 0.6f;
    }
    if (kind != LightKind::Directional) light.range = 25.0f;
    return light;
}

constexpr glm::dvec3 kUp(0.0, 1.0, 0.0), kRight(1.0, 0.0, 0.0);

} // namespace

Scene testbed(DepthConvention convention)
{
    Scene scene;
    scene.name = "testbed";
    scene.depth.convention = convention;
    scene.camera = {{.eye = {1.0, 4.2, 9.0}, .target = {0.0, 0.8, 0.0}}};

    place(scene, "floor", makePlane({.width = 24.0f, .depth = 24.0f, .columns = 4, .rows = 4}), {0.0, 0.0, 0.0});
    // Both touch the floor: contact edges.
    place(scene, "crate", makeBox({.size = glm::vec3(1.4f)}), {1.6, 0.7, 0.4}).pose.rotation = turned(kUp, 25.0);
    place(scene, "ball", makeSphere({.radius = 0.8f, .slices = 20, .stacks = 10}), {-1.8, 0.79, 1.0});
    place(scene, "knot",
          makeTorusKnot({.radius = 0.6f, .sweep = 0.25f, .tube = 0.1f, .knotSegments = 24, .tubeSegments = 6}),
          {-0.2, 2.0, -1.0});
    place(scene, "wall", makeBox({.size = glm::vec3(1.6f, 1.2f, 0.003f)}), {-3.2, 0.6, -1.2}).pose.rotation =
        turned(kUp, 40.0);
    place(scene, "cloth", makeCloth({.width = 1.6f, .height = 1.4f, .folds = 2.0f, .columns = 6, .rows = 6}),
          {3.4, 2.4, -1.6})
        .pose.rotation = turned(kUp, -20.0);
    place(scene, "card", makeCard({.width = 1.2f, .height = 0.9f}), {0.2, 0.7, 2.6}).pose.rotation =
        turned(kRight, -50.0);

    scene.lights = {lamp("sun", LightKind::Directional, {4.0, 6.0, 3.0}, {0.0, 0.0, 0.0}),
                    lamp("spot", LightKind::Spot, {-4.5, 6.5, 4.5}, {0.2, 0.5, -0.2}),
                    lamp("point", LightKind::Point, {0.6, 3.6, 1.6}, {0.0, 0.0, 0.0})};
    // Its wide faces stand at 85 degrees to the sun: the normal, z turned about y, is turned that far from the sun's
    // heading. heading.n = cos(85 degrees) / horizontal share of the sun's direction.
    const glm::dvec3 toSun = -scene.lights[0].direction;
    const double heading = std::atan2(toSun.x, toSun.z);
    const double apart = std::acos(std::cos(glm::radians(85.0)) / std::hypot(toSun.x, toSun.z));
    place(scene, "slab", makeBox({.size = glm::vec3(1.2f, 1.6f, 0.2f)}), {3.4, 0.8, 1.8}).pose.rotation =
        glm::angleAxis(heading - apart, kUp);
    // On the sun's rays through the floor before the crate, behind the eye.
    place(scene, "behind_eye", makeBox({.size = glm::vec3(0.9f)}), glm::dvec3(0.6, 0.0, 2.2) + toSun * 13.0);
    place(scene, "behind_spot", makeBox({.size = glm::vec3(0.7f)}),
          scene.lights[1].position - scene.lights[1].direction * 1.2);
    place(scene, "above_point", makeBox({.size = glm::vec3(0.5f)}), {0.6, 4.6, 1.6});
    return scene;
}

Scene hangingCaster(LightKind kind, bool closed, DepthConvention convention)
{
    Scene scene;
    scene.name = "hanging caster";
    scene.depth = {.convention = convention, .nearPlane = 0.5, .farPlane = 200.0};
    place(scene, "floor", makeBox({.size = glm::vec3(30.0f, 0.2f, 30.0f)}), {0.0, -0.1, 0.0});
    place(scene, "post", makeBox({.size = glm::vec3(0.3f, 1.0f, 0.3f)}), {3.5, 0.5, -2.5});
    if (closed) {
        place(scene, "caster", makeBox({.size = glm::vec3(0.8f, 1.6f, 1.6f)}), {-1.0, 2.5, 0.0});
    } else {
        place(scene, "caster", makeCard({.width = 1.6f, .height = 1.6f}), {-1.0, 2.5, 0.0}).pose.rotation =
            turned(kUp, 90.0);
    }
    scene.lights = {lamp("lamp", kind, {-5.0, 4.0, 0.0}, {1.0, 1.75, 0.0})};
    scene.camera = {{.eye = {1.0, 1.8, 0.0}, .target = {4.0, 0.2, -2.5}}};
    return scene;
}

Scene flushLamp(LitFrom held, LightKind kind)
{
    Scene scene;
    scene.name = "flush lamp";
    scene.camera = {{.eye = {0.3, 1.6, 5.0}, .target = {0.0, 0.9, 0.0}}};
    place(scene, "floor", makePlane({.width = 24.0f, .depth = 24.0f}), {0.0, 0.0, 0.0});
    place(scene, "crate", makeBox({.size = glm::vec3(0.8f)}), {0.9, 0.4, 0.6}).pose.rotation = turned(kUp, 25.0);
    place(scene, "ball", makeSphere({.radius = 0.5f}), {-1.3, 1.2, 0.2});
    glm::dvec3 at(0.1, 2.7, 0.2);
    switch (held) {
    case LitFrom::solidOfOpenMesh:
        at.y = std::nextafter(std::nextafter(2.7f, 3.0f), 3.0f);
        [[fallthrough]];
    case LitFrom::solidCeiling:
        place(scene, "ceiling", makeBox({.size = glm::vec3(6.0f, 0.3f, 6.0f)}), {0.1, 2.85, 0.0}).pose.rotation =
            turned(kUp, 20.0);
        break;
    case LitFrom::sheetCeiling:
    case LitFrom::sheetOfOpenMesh:
        place(scene, "ceiling", makePlane({.width = 6.0f, .depth = 6.0f, .columns = 3, .rows = 3}), {0.1, 2.7, 0.0})
            .pose.rotation = turned(kRight, 180.0);
        break;
    case LitFrom::squashedCeiling: {
        Instance& ceiling =
            place(scene, "ceiling", makeBox({.size = glm::vec3(0.01f, 500.0f, 0.02f)}), {0.1, 2.85, 0.0});
        ceiling.pose.scale = {600.0, 0.0006, 300.0};
        break;
    }
    case LitFrom::sheetTurnedUp:
        place(scene, "ceiling", makePlane({.width = 6.0f, .depth = 6.0f}), {0.1, 2.7, 0.0}).pose.rotation =
            turned(kUp, 20.0);
        break;
    case LitFrom::card:
        at = {0.1, 1.2, 0.0};
        place(scene, "card", makeCard({.width = 1.2f, .height = 2.0f}), {0.0, 1.1, 0.0}).pose.rotation =
            turned(kUp, 90.0);
        at = {0.0, 1.2, 0.0};
        break;
    case LitFrom::roomCorner: {
        Mesh room = makeBox({.size = glm::vec3(8.0f, 4.0f, 14.0f)}); // down to below the floor
        for (size_t i = 0; i < room.indices.size(); i += 3)
            std::swap(room.indices[i + 1], room.indices[i + 2]); // seen from within
        place(scene, "room", std::move(room), {0.0, 1.0, 0.0});
        at = {-4.0, 3.0, -7.0}; // to the bit: behind a wall rays that graze it would be right to call it dark
        break;
    }
    }
    scene.lights = {lamp("lamp", kind, at, {0.1, 0.0, 0.2})};
    if (held == LitFrom::sheetOfOpenMesh || held == LitFrom::solidOfOpenMesh) {
        std::ranges::reverse(scene.instances); // its faces come first: the others' numbers are not their places
        for (Instance& instance : scene.instances)
            instance.isStatic = true;
        demo::mergeStatics(scene);
    }
    return scene;
}

Scene cutByNearPlane(LightKind kind, bool aboutEye, DepthConvention convention)
{
    Scene scene = hangingCaster(kind, true, convention);
    scene.camera = {{.eye = {1.0, 1.8, 2.4}, .target = {4.0, 0.2, 0.9}}}; // in the light
    const glm::dvec3 eye = scene.camera[0].eye, ahead = glm::normalize(scene.camera[0].target - eye);
    if (aboutEye)
        place(scene, "crate", makeBox({.size = glm::vec3(1.5f)}), eye);
    else
        place(scene, "ball", makeSphere({.radius = 0.15f}), eye + 0.55 * ahead);
    return scene;
}

namespace {

/// What every odd caster starts from.
Mesh ring()
{
    return makeTorus({.radius = 0.7f, .tube = 0.25f, .ringSegments = 24, .tubeSegments = 12});
}

Mesh crossingRings()
{
    Mesh mesh = ring();
    const auto count = static_cast<uint32_t>(mesh.positions.size());
    const std::vector<uint32_t> indices = mesh.indices;
    for (uint32_t i = 0; i < count; ++i) { // upright, its middle on the other's tube
        const glm::vec3 p = mesh.positions[i];
        mesh.positions.emplace_back(p.x + 0.6f, p.z, -p.y);
    }
    for (const uint32_t index : indices)
        mesh.indices.push_back(count + index);
    return mesh;
}

Mesh finnedRing()
{
    Mesh mesh = ring();
    const std::vector<uint32_t> indices = mesh.indices;
    for (size_t i = 0; i < indices.size(); i += 3 * 11) {
        const glm::vec3 a = mesh.positions[indices[i]], b = mesh.positions[indices[i + 1]];
        const glm::vec3 middle = 0.5f * (a + b);
        mesh.positions.push_back(middle + glm::vec3(0.2f * middle.x, 0.3f, 0.2f * middle.z));
        mesh.indices.insert(mesh.indices.end(),
                            {indices[i], indices[i + 1], static_cast<uint32_t>(mesh.positions.size() - 1)});
    }
    return mesh;
}

Mesh doubledRing()
{
    Mesh mesh = ring();
    const std::vector<uint32_t> indices = mesh.indices;
    mesh.indices.insert(mesh.indices.end(), indices.begin(), indices.end());
    return mesh;
}

Mesh turnedRing()
{
    Mesh mesh = ring();
    for (size_t i = 0; i < mesh.indices.size(); i += 3 * 7)
        std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    return mesh;
}

} // namespace

Scene oddCasters()
{
    Scene scene;
    scene.name = "odd casters";
    scene.camera = {{.eye = {0.5, 6.0, 8.0}, .target = {0.0, 0.4, 0.0}}};
    place(scene, "floor", makeBox({.size = glm::vec3(30.0f, 0.2f, 30.0f)}), {0.0, -0.1, 0.0});
    const auto tilted = [&](const char* name, Mesh mesh, const glm::dvec3& position) {
        place(scene, name, std::move(mesh), position).pose.rotation = turned(glm::normalize(kUp + kRight), 40.0);
    };
    tilted("crossing", crossingRings(), {-2.4, 1.3, -1.2});
    tilted("finned", finnedRing(), {1.8, 1.2, -1.6});
    tilted("doubled", doubledRing(), {-1.4, 1.1, 1.8});
    tilted("turned", turnedRing(), {2.0, 1.3, 1.6});
    scene.lights = {lamp("sun", LightKind::Directional, {4.0, 6.0, 3.0}, {0.0, 0.0, 0.0}),
                    lamp("spot", LightKind::Spot, {-4.5, 6.5, 4.5}, {0.0, 0.5, 0.0}),
                    lamp("point", LightKind::Point, {0.3, 4.6, 0.2}, {0.0, 0.0, 0.0})};
    return scene;
}

Scene solidsOfOpenMesh(bool inCrate)
{
    Scene scene;
    scene.name = inCrate ? "solids of an open mesh, from within" : "solids of an open mesh";
    scene.camera = {{.eye = {0.5, 6.0, 8.0}, .target = {0.0, 0.4, 0.0}}};
    if (inCrate) scene.camera = {{.eye = {-2.2, 0.9, 1.5}, .target = {-4.0, -0.3, 1.2}}};
    place(scene, "floor", makePlane({.width = 30.0f, .depth = 30.0f}), {0.0, 0.0, 0.0});
    for (const glm::dvec3& at : {glm::dvec3(-2.5, 0.8, 1.5), glm::dvec3(0.6, 0.8, 2.4), glm::dvec3(3.0, 0.8, 1.0)})
        place(scene, "crate", makeBox({.size = glm::vec3(1.4f, 1.2f, 1.3f)}), at).pose.rotation = turned(kUp, 25.0);
    Mesh chamber = makeBox({.size = glm::vec3(3.0f, 2.0f, 2.5f)});
    for (size_t i = 0; i < chamber.indices.size(); i += 3)
        std::swap(chamber.indices[i], chamber.indices[i + 1]);
    place(scene, "chamber", std::move(chamber), {0.0, 1.5, -2.0});
    for (Instance& instance : scene.instances)
        instance.isStatic = true;
    mergeStatics(scene);
    scene.lights = {lamp("sun", LightKind::Directional, {4.0, 6.0, 3.0}, {0.0, 0.0, 0.0}),
                    lamp("inside", LightKind::Point, {0.3, 1.6, -2.1}, {0.0, 0.0, 0.0})};
    return scene;
}

Scene softScene(Caster caster, LightKind kind, double height, float radius)
{
    Scene scene;
    scene.name = "soft caster";
    place(scene, "floor", makeBox({.size = glm::vec3(30.0f, 0.2f, 30.0f)}), {0.0, -0.1, 0.0});
    const auto mesh = [&]() -> Mesh {
        switch (caster) {
        case Caster::box:
            return makeBox({.size = glm::vec3(1.0f)});
        case Caster::sphere:
            return makeSphere({.radius = 0.6f, .slices = 32, .stacks = 16});
        case Caster::cylinder:
            return makeCylinder({.radius = 0.4f, .topRadius = 0.4f, .height = 1.2f, .segments = 24});
        case Caster::torus:
            break;
        }
        return makeTorus({.radius = 0.6f, .tube = 0.2f, .ringSegments = 32, .tubeSegments = 12});
    };
    const double below = caster == Caster::cylinder ? 0.6 : 0.0; // its origin is its foot
    place(scene, "caster", mesh(), {0.0, height - below, 0.0}).pose.rotation =
        turned(glm::normalize(glm::dvec3(0.2, 1.0, 0.1)), 25.0);
    Light light = lamp("lamp", kind, {-1.2, 4.0, 1.0}, {0.0, 0.5, 0.0});
    light.radius = radius;
    scene.lights = {light};
    scene.camera = {{.eye = {0.8, 3.2, 4.2}, .target = {0.4, 0.3, -0.4}}};
    return scene;
}

void setRectangle(Light& light, glm::vec2 half)
{
    light.rectangle = half;
    light.rectangleAxis = glm::normalize(glm::dvec3(1.0, 0.2, 0.7));
    light.radius = 2.0f * std::sqrt(half.x * half.y / std::numbers::pi_v<float>);
}

Scene halfPlane(LightKind kind, double height, float radius)
{
    Scene scene;
    scene.name = "half plane";
    place(scene, "floor", makeBox({.size = glm::vec3(60.0f, 0.2f, 60.0f)}), {0.0, -0.1, 0.0});
    place(scene, "sheet", makePlane({.width = 20.0f, .depth = 40.0f}), {-10.0, height, 0.0});
    Light light = lamp("lamp", kind, {0.0, 4.0, 0.3}, {0.1, 0.0, 0.3});
    light.radius = radius;
    scene.lights = {light};
    scene.camera = {{.eye = {3.4, 2.2, 1.2}, .target = {0.2, 0.0, 0.0}}};
    return scene;
}

Scene lampOverPlain(LightKind kind)
{
    Scene scene;
    scene.name = "lamp over a plain";
    place(scene, "plain", makePlane({.width = 1000.0f, .depth = 1000.0f, .columns = 100, .rows = 100}), {});
    place(scene, "card", makeCard({.width = 0.5f, .height = 0.4f}), {0.3, 3.3, 0.0}).pose.rotation =
        turned(kRight, -70.0);
    place(scene, "crate", makeBox({.size = glm::vec3(1.0f)}), {-1.2, 0.5, 0.6}).pose.rotation = turned(kUp, 30.0);
    scene.lights = {lamp("lamp", kind, {0.0, 4.0, 0.0}, {0.3, 0.0, 0.5})};
    scene.lights[0].range = 1e5f;
    scene.camera = {{.eye = {2.0, 7.0, 6.0}, .target = {0.0, 0.5, 0.0}}};
    return scene;
}

Scene lampsOverLargeTriangles(LightKind kind, uint32_t count)
{
    Scene scene;
    scene.name = "lamps over large triangles";
    place(scene, "ground", makePlane({.width = 2000.0f, .depth = 2000.0f}), {});
    place(scene, "crate", makeBox({.size = glm::vec3(1.0f)}), {2.0, 0.5, 0.0});
    std::mt19937 random(11);
    const auto within = [&](double low, double high) { return low + (high - low) * double(random()) / 0x1p32; };
    for (uint32_t i = 0; i < count; ++i) {
        const double x = within(-8.0, 8.0), y = within(0.5, 9.0), z = within(-12.0, 4.0);
        const double aimX = x + within(-4.0, 4.0), aimZ = z + within(-4.0, 4.0);
        Light& light = scene.lights.emplace_back(lamp("lamp", kind, {x, y, z}, {aimX, 0.0, aimZ}));
        light.name += std::to_string(i);
        light.outerAngle = 0.95f;
        light.innerAngle = 0.9f;
    }
    scene.camera = {{.eye = {0.0, 9.0, 16.0}, .target = {0.0, 0.0, -4.0}, .verticalFov = 1.0f}};
    return scene;
}

Scene onlyClosed(Scene scene)
{
    // Every edge is used once in each direction, corners at equal positions being one corner.
    const auto closed = [](const Mesh& mesh) {
        std::map<std::array<float, 3>, uint32_t> corners;
        std::map<std::pair<uint32_t, uint32_t>, int> balance;
        const auto corner = [&](uint32_t index) {
            const glm::vec3& p = mesh.positions[index];
            return corners.emplace(std::array{p.x, p.y, p.z}, static_cast<uint32_t>(corners.size())).first->second;
        };
        for (size_t i = 0; i < mesh.indices.size(); ++i) {
            const uint32_t a = corner(mesh.indices[i]);
            const uint32_t b = corner(mesh.indices[i % 3 == 2 ? i - 2 : i + 1]);
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
        }
        for (const auto& [edge, sum] : balance)
            if (sum != 0) return false;
        return true;
    };
    std::erase_if(scene.instances, [&](const Instance& instance) { return !closed(scene.meshes[instance.mesh]); });
    return scene;
}

} // namespace gnomon::exact
