#include "demo/scene/scene.hpp"

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::demo {
namespace {

/// Where a time falls in a track: keys a and b and the weight of b. Outside the track both are its end.
struct Bracket {
    size_t a = 0, b = 0;
    double weight = 0.0;
};

template <typename Key>
Bracket findBracket(const std::vector<Key>& keys, double time)
{
    const auto after =
        std::upper_bound(keys.begin(), keys.end(), time, [](double t, const Key& key) { return t < key.time; });
    if (after == keys.begin()) return {0, 0, 0.0};
    const auto a = static_cast<size_t>(after - keys.begin()) - 1;
    if (after == keys.end()) return {a, a, 0.0};
    return {a, a + 1, (time - keys[a].time) / (keys[a + 1].time - keys[a].time)};
}

template <typename Vector>
Vector blend(const Vector& a, const Vector& b, double weight)
{
    return a + (b - a) * weight; // exact at weight 0, which held keys rely on
}

/// Shortest arc between unit vectors. Opposite ones turn about any axis across them.
glm::dvec3 slerpDirection(const glm::dvec3& a, const glm::dvec3& b, double weight)
{
    if (weight == 0.0) return a;
    const double cosine = std::clamp(glm::dot(a, b), -1.0, 1.0);
    glm::dvec3 across = b - a * cosine;
    // Below this the arc is shorter than a float's direction can show.
    constexpr double kParallel = 1e-9;
    if (glm::length(across) < kParallel) {
        if (cosine > 0.0) return a;
        across =
            std::abs(a.y) < 0.9 ? glm::cross(a, glm::dvec3(0.0, 1.0, 0.0)) : glm::cross(a, glm::dvec3(1.0, 0.0, 0.0));
    }
    const double angle = std::acos(cosine) * weight;
    return glm::normalize(a * std::cos(angle) + glm::normalize(across) * std::sin(angle));
}

/// How far an orbit has turned.
glm::dquat turnAt(const Orbit& orbit, double time)
{
    return glm::angleAxis(std::remainder(orbit.radiansPerSecond * time, 2.0 * std::numbers::pi), orbit.axis);
}

Pose poseAt(const Instance& instance, double time)
{
    if (instance.keys.empty()) return instance.pose;
    const auto [a, b, weight] = findBracket(instance.keys, time);
    const Pose& from = instance.keys[a].pose;
    const Pose& to = instance.keys[b].pose;
    return {blend(from.position, to.position, weight), glm::slerp(from.rotation, to.rotation, weight),
            blend(from.scale, to.scale, weight)};
}

} // namespace

const char* nameOf(LightKind kind) noexcept
{
    switch (kind) {
    case LightKind::Directional:
        return "directional";
    case LightKind::Spot:
        return "spot";
    case LightKind::Point:
        return "point";
    }
    return "?";
}

const char* nameOf(DepthConvention convention) noexcept
{
    return convention == DepthConvention::Standard ? "standard" : "reversed_infinite";
}

std::array<float, 9> Transform::linearRowMajor() const
{
    std::array<float, 9> rows;
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 3; ++column)
            rows[row * 3 + column] = static_cast<float>(linear[int(column)][int(row)]);
    return rows;
}

glm::dvec3 CameraState::forward() const
{
    return glm::normalize(target - eye);
}

double frameTime(const Scene& scene, uint32_t frame) noexcept
{
    return frame / scene.framesPerSecond;
}

Transform instanceAt(const Instance& instance, double time)
{
    Pose pose = poseAt(instance, time);
    if (instance.spin.radiansPerSecond != 0.0) {
        // Whole turns are taken off first: sine and cosine of a large angle would lose digits over a long run.
        const double angle = std::remainder(instance.spin.radiansPerSecond * time, 2.0 * std::numbers::pi);
        pose.rotation = pose.rotation * glm::angleAxis(angle, instance.spin.axis);
    }
    if (instance.orbit.radiansPerSecond != 0.0) {
        const glm::dquat turn = turnAt(instance.orbit, time);
        pose.position = instance.orbit.center + turn * (pose.position - instance.orbit.center);
        pose.rotation = turn * pose.rotation;
    }
    Transform transform{glm::mat3_cast(pose.rotation), pose.position};
    for (int axis = 0; axis < 3; ++axis)
        transform.linear[axis] *= pose.scale[axis];
    return transform;
}

CameraState cameraAt(const Scene& scene, double time)
{
    auto [a, b, weight] = findBracket(scene.camera, time);
    if (scene.camera[b].cut) b = a;
    const CameraKey& from = scene.camera[a];
    const CameraKey& to = scene.camera[b];
    CameraState state;
    state.eye = blend(from.eye, to.eye, weight);
    state.target = blend(from.target, to.target, weight);
    state.verticalFov = static_cast<float>(blend(double(from.verticalFov), double(to.verticalFov), weight));
    // Looking straight up or down, +y is no guide; -z takes its place.
    const glm::dvec3 forward = state.forward();
    const glm::dvec3 guide = std::abs(forward.y) > 0.9999 ? glm::dvec3(0.0, 0.0, -1.0) : glm::dvec3(0.0, 1.0, 0.0);
    state.up = glm::normalize(guide - forward * glm::dot(guide, forward));
    return state;
}

bool cameraCutsBetween(const Scene& scene, double after, double upTo) noexcept
{
    return std::any_of(scene.camera.begin(), scene.camera.end(),
                       [=](const CameraKey& key) { return key.cut && key.time > after && key.time <= upTo; });
}

LightState lightAt(const Light& light, double time)
{
    LightState state{time >= light.appear && time < light.disappear, light.position, light.direction};
    if (!light.keys.empty()) {
        const auto [a, b, weight] = findBracket(light.keys, time);
        state.position = blend(light.keys[a].position, light.keys[b].position, weight);
        state.direction = slerpDirection(light.keys[a].direction, light.keys[b].direction, weight);
    }
    if (light.orbit.radiansPerSecond != 0.0) {
        const glm::dquat turn = turnAt(light.orbit, time);
        state.position = light.orbit.center + turn * (state.position - light.orbit.center);
        state.direction = glm::normalize(turn * state.direction);
    }
    return state;
}

bool moves(const Instance& instance) noexcept
{
    return !instance.keys.empty() || instance.spin.radiansPerSecond != 0.0 || instance.orbit.radiansPerSecond != 0.0;
}

bool moves(const Light& light) noexcept
{
    return !light.keys.empty() || light.orbit.radiansPerSecond != 0.0;
}

uint64_t triangleCount(const Scene& scene) noexcept
{
    uint64_t count = 0;
    for (const Instance& instance : scene.instances)
        count += scene.meshes[instance.mesh].triangleCount();
    return count;
}

uint32_t lightCountAt(const Scene& scene, double time, bool dynamicOnly) noexcept
{
    return static_cast<uint32_t>(std::count_if(scene.lights.begin(), scene.lights.end(), [=](const Light& light) {
        return time >= light.appear && time < light.disappear && !(dynamicOnly && light.isStatic);
    }));
}

void limitLights(Scene& scene, uint32_t count)
{
    std::vector<Light> originals = scene.lights;
    originals.insert(originals.end(), scene.spareLights.begin(), scene.spareLights.end());
    const auto unused = originals.begin() + std::min<ptrdiff_t>(count, std::ssize(originals));
    scene.lights.assign(originals.begin(), unused);
    scene.spareLights.assign(unused, originals.end());
    if (originals.empty()) return;

    // Multiples of the golden angle never meet again, and spread evenly whatever their number.
    constexpr double kGoldenAngle = std::numbers::pi * (3.0 - 2.2360679774997896964);
    while (scene.lights.size() < count) {
        const size_t round = scene.lights.size() / originals.size();
        Light copy = originals[scene.lights.size() % originals.size()];
        const glm::dquat turn = glm::angleAxis(kGoldenAngle * double(round), glm::dvec3(0.0, 1.0, 0.0));
        const auto move = [&](glm::dvec3& position) { position = scene.center + turn * (position - scene.center); };
        const auto aim = [&](glm::dvec3& direction) { direction = glm::normalize(turn * direction); };
        copy.name += '+';
        copy.name += std::to_string(round);
        while (
            std::any_of(scene.lights.begin(), scene.lights.end(), [&](const Light& l) { return l.name == copy.name; }))
            copy.name += '+'; // the file has a light of that name
        move(copy.position);
        aim(copy.direction);
        for (LightKey& key : copy.keys) {
            move(key.position);
            aim(key.direction);
        }
        move(copy.orbit.center);
        aim(copy.orbit.axis);
        scene.lights.push_back(std::move(copy));
    }
}

glm::dmat4 viewFromWorld(const CameraState& camera)
{
    const glm::dvec3 forward = camera.forward();
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    const glm::dvec3 up = glm::cross(right, forward);
    glm::dmat4 view(1.0);
    for (int column = 0; column < 3; ++column)
        view[column] = {right[column], up[column], -forward[column], 0.0};
    view[3] = {-glm::dot(right, camera.eye), -glm::dot(up, camera.eye), glm::dot(forward, camera.eye), 1.0};
    return view;
}

glm::dmat4 clipFromView(const DepthSettings& depth, float verticalFov, double aspect)
{
    const double cotangent = 1.0 / std::tan(double(verticalFov) * 0.5);
    glm::dmat4 clip(0.0);
    clip[0][0] = cotangent / aspect;
    clip[1][1] = -cotangent; // Vulkan's y points down
    clip[2][3] = -1.0;       // w is the distance along the view direction
    if (depth.convention == DepthConvention::ReversedInfinite) {
        clip[3][2] = depth.nearPlane;
    } else {
        const double span = depth.farPlane - depth.nearPlane;
        clip[2][2] = -depth.farPlane / span;
        clip[3][2] = -depth.farPlane * depth.nearPlane / span;
    }
    return clip;
}

} // namespace gnomon::demo
