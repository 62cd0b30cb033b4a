#include "demo/calibrate/sweep_scene.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "demo/scene/primitives.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kWorlds = 8;
// Objects along the side of a world. Not growing with the triangles: what an instance costs and what a triangle does
// would be the same to a fit.
constexpr uint32_t kObjects[kWorlds] = {2, 4, 5, 3, 4, 5, 3, 2};
constexpr double kWorldSpacing = 400.0; // metres; out of each other's picture
constexpr double kGroundSide = 40.0;
constexpr double kPi = 3.14159265358979323846;

enum Axis : uint32_t { world, distance, reach, map, count, motion, size, angle, kAxes };

/// Between two numbers, evenly in the logarithm.
double logBetween(double low, double high, double t)
{
    return low * std::pow(high / low, t);
}

/// One of the entries, evenly.
template <typename T, size_t n>
T pick(const T (&entries)[n], double t)
{
    return entries[std::min(n - 1, static_cast<size_t>(t * n))];
}

uint32_t maskOf(uint32_t world)
{
    return 1u << world;
}

void addInstance(Scene& scene, uint32_t world, uint32_t mesh, const glm::dvec3& at, bool turns)
{
    Instance instance;
    instance.name = scene.meshes[mesh].name + std::to_string(scene.instances.size());
    instance.mesh = mesh;
    instance.pose.position = glm::dvec3(kWorldSpacing * world, 0.0, 0.0) + at;
    instance.isStatic = !turns;
    if (turns) instance.spin = {glm::normalize(glm::dvec3(1.0, 1.0, 0.3)), kPi / 3.0};
    instance.casterMask = maskOf(world);
    scene.instances.push_back(instance);
}

/// A ball with hills: silhouettes of what has grown or was scanned run all over the surface, not around it.
Mesh makeHilly(const SphereShape& shape)
{
    Mesh mesh = makeSphere(shape);
    for (glm::vec3& position : mesh.positions) {
        const glm::vec3 p = position / shape.radius;
        position *= 1.0f + 0.12f * std::sin(9.0f * p.x + 2.0f * p.y) * std::cos(8.0f * p.y - 3.0f * p.z) *
                               std::sin(7.0f * p.z + 1.0f);
    }
    return mesh;
}

/// Walls around the objects, with a gap to look in through: casters that are large, thin and near the eye.
void addWalls(Scene& scene, uint32_t world)
{
    const auto mesh = static_cast<uint32_t>(scene.meshes.size());
    scene.meshes.push_back(makeBox({.size = {18.0f, 5.0f, 0.3f}}));
    scene.meshes.push_back(makeBox({.size = {0.3f, 5.0f, 18.0f}}));
    scene.meshes.push_back(makeBox({.size = {7.0f, 5.0f, 0.3f}}));
    const char* names[] = {"wall_x", "wall_z", "wall_short"};
    for (uint32_t i = 0; i < 3; ++i)
        scene.meshes[mesh + i].name = names[i] + std::to_string(world);
    addInstance(scene, world, mesh, {0.0, 2.5, -9.0}, false);
    addInstance(scene, world, mesh + 1, {-9.0, 2.5, 0.0}, false);
    addInstance(scene, world, mesh + 1, {9.0, 2.5, 0.0}, false);
    addInstance(scene, world, mesh + 2, {-5.5, 2.5, 9.0}, false);
    addInstance(scene, world, mesh + 2, {5.5, 2.5, 9.0}, false);
}

// A knot of fewer triangles turns inside out where it bends: three corners round its tube, sixteen along it.
constexpr double kKnotTriangles = 500.0;

/// A ground with tori, balls and columns on it; a third of them turn. In every other world it is a hall: walls, tall
/// columns, hilly balls, and knots where there are triangles for them. Triangles grow from world to world.
void addWorld(Scene& scene, uint32_t world, uint32_t ground)
{
    const bool hall = world % 2 == 1;
    const uint32_t side = kObjects[world];
    const double triangles = 400.0 * std::pow(2.45, world); // 400 to 212 000
    const double each = triangles / (side * side);
    const auto segments = [each](double share) { // of a surface of share x 1 segments, two triangles each
        return std::max(3u, static_cast<uint32_t>(std::sqrt(each / 2.0 * share) + 0.5));
    };
    const auto first = static_cast<uint32_t>(scene.meshes.size());
    const SphereShape ball{.radius = 0.9f, .slices = segments(2.0), .stacks = segments(0.5) + 1};
    scene.meshes.push_back(
        hall && each >= kKnotTriangles
            ? makeTorusKnot({.knotSegments = segments(8.0), .tubeSegments = segments(0.125)})
            : makeTorus({.radius = 1.0f, .tube = 0.35f, .ringSegments = segments(2.0), .tubeSegments = segments(0.5)}));
    scene.meshes.push_back(hall ? makeHilly(ball) : makeSphere(ball));
    scene.meshes.push_back(
        makeColumn({.radius = 0.4f, .height = hall ? 6.0f : 3.0f, .segments = segments(1.0), .rings = segments(1.0)}));
    const char* names[] = {"torus", "ball", "column"};
    for (uint32_t i = 0; i < 3; ++i)
        scene.meshes[first + i].name = names[i] + std::to_string(world);
    addInstance(scene, world, ground, {0.0, -0.2, 0.0}, false);
    if (hall) addWalls(scene, world);
    const double spacing = 16.0 / side;
    for (uint32_t x = 0; x < side; ++x)
        for (uint32_t z = 0; z < side; ++z) {
            const uint32_t mesh = (x + 2 * z) % 3;
            const glm::dvec3 at{(x - 0.5 * (side - 1)) * spacing, mesh == 2 ? 0.0 : 1.4,
                                (z - 0.5 * (side - 1)) * spacing};
            addInstance(scene, world, first + mesh, at, mesh == 0);
        }
}

Light makeLight(const SweepPoint& point, uint32_t world, uint32_t number, double reach, double angle)
{
    const glm::dvec3 center(kWorldSpacing * world, 0.0, 0.0);
    const double turn = 2.0 * kPi * (angle + number * 0.381966); // the golden angle keeps a point's lights apart
    const double share = std::fmod(reach + 0.381966 * number, 1.0);
    Light light;
    light.name =
        std::string(nameOf(point.kind)) + std::to_string(static_cast<int>(point.time)) + "_" + std::to_string(number);
    light.kind = point.kind;
    light.casterMask = maskOf(world);
    light.appear = point.time;
    light.disappear = point.time + 1.0;
    light.isStatic = point.motion != SweepMotion::light;
    const glm::dvec3 side{std::sin(turn), 0.0, std::cos(turn)};
    if (point.kind == LightKind::Directional) {
        light.direction = glm::normalize(glm::dvec3(side.x, -0.4 - 1.2 * share, side.z));
    } else if (point.kind == LightKind::Spot) {
        light.position = center + 9.0 * side + glm::dvec3(0.0, 9.0, 0.0);
        light.direction = glm::normalize(center - light.position);
        light.outerAngle = static_cast<float>(logBetween(0.12, 0.75, share)); // 7 to 43 degrees
        light.innerAngle = 0.8f * light.outerAngle;
        light.range = 30.0f;
    } else {
        light.position = center + 3.0 * side + glm::dvec3(0.0, 4.0, 0.0);
        light.range = static_cast<float>(logBetween(6.0, 40.0, share));
    }
    light.intensity = 0.4f;
    if (point.soft) // lamps of a few centimetres to large shades; suns of half a degree to a hazy sky's of four
        light.radius = static_cast<float>(point.kind == LightKind::Directional ? logBetween(0.0047, 0.035, share)
                                                                               : logBetween(0.03, 0.4, share));
    if (point.motion == SweepMotion::light) {
        light.orbit.center = center;
        light.orbit.radiansPerSecond = kPi / 9.0;
    }
    return light;
}

SweepPoint makePoint(Scene& scene, LightKind kind, uint32_t index, double time)
{
    // Each kind has a piece of the sequence of its own.
    const uint32_t n = index + 1000 * static_cast<uint32_t>(kind);
    const auto at = [n](Axis axis) { return sweepCoordinate(n, axis, kAxes); };
    constexpr uint32_t mapSides[] = {512, 1024, 2048};
    constexpr uint32_t cubeSides[] = {256, 512, 1024}; // six of them
    constexpr uint32_t widths[] = {640, 320, 960, 480, 1280};
    constexpr SweepMotion motions[] = {SweepMotion::light, SweepMotion::casters, SweepMotion::light,
                                       SweepMotion::nothing};
    SweepPoint point;
    point.time = time;
    point.kind = kind;
    point.motion = pick(motions, at(motion));
    point.lights = 1 + std::min(kSweepLights - 1, static_cast<uint32_t>(at(count) * kSweepLights));
    point.mapSide = kind == LightKind::Point ? pick(cubeSides, at(map)) : pick(mapSides, at(map));
    point.width = pick(widths, at(size));
    point.height = point.width * 9 / 16;
    point.soft = index % 2 == 1;

    const auto where = std::min(kWorlds - 1, static_cast<uint32_t>(at(world) * kWorlds));
    const double away = logBetween(6.0, 50.0, at(distance)), turn = 2.0 * kPi * at(angle);
    const glm::dvec3 center(kWorldSpacing * where, 0.0, 0.0);
    CameraKey key;
    key.time = time;
    key.target = center + glm::dvec3(0.0, 1.0, 0.0);
    key.eye =
        key.target + away * glm::normalize(glm::dvec3(std::sin(turn) * 0.4, 0.45, std::cos(turn) > 0 ? 0.9 : -0.9));
    key.cut = true;
    scene.camera.push_back(key);
    for (uint32_t i = 0; i < point.lights; ++i)
        scene.lights.push_back(makeLight(point, where, i, at(reach), at(angle)));
    return point;
}

} // namespace

double sweepCoordinate(uint32_t index, uint32_t axis, uint32_t axes)
{
    // The generalised golden ratio g solves g^(axes + 1) = g + 1; multiples of its powers, modulo 1, are an additive
    // sequence of low discrepancy. Source: M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
    double g = 1.5;
    for (int i = 0; i < 60; ++i)
        g = std::pow(1.0 + g, 1.0 / (axes + 1.0));
    const double step = std::pow(1.0 / g, axis + 1.0);
    const double x = 0.5 + step * (index + 1.0);
    return x - std::floor(x);
}

Sweep makeSweep(uint32_t pointsPerKind)
{
    Sweep sweep;
    Scene& scene = sweep.scene;
    scene.name = "calibration";
    scene.meshes.push_back(makeBox({.size = {kGroundSide, 0.4, kGroundSide}}));
    scene.meshes.back().name = "ground";
    for (uint32_t i = 0; i < kWorlds; ++i)
        addWorld(scene, i, 0);
    for (uint32_t i = 0; i < pointsPerKind; ++i)
        for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional})
            sweep.points.push_back(makePoint(scene, kind, i, static_cast<double>(sweep.points.size())));
    return sweep;
}

} // namespace gnomon::demo
