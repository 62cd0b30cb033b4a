#include "exactness/thin_scenes.hpp"

#include <cmath>
#include <random>
#include <utility>

#include "demo/scene/primitives.hpp"

namespace gnomon::exact {

using namespace demo;

namespace {

/// Numbers that are the same with every C++ library.
class Random {
public:
    explicit Random(uint32_t seed) : engine_(seed) {}
    double within(double low, double high) { return low + (high - low) * double(engine_()) / 0x1p32; }
    glm::dvec3 direction()
    {
        const double y = within(-1.0, 1.0), angle = within(0.0, 6.283185307179586), across = std::sqrt(1.0 - y * y);
        return {across * std::cos(angle), y, across * std::sin(angle)};
    }

private:
    std::mt19937 engine_;
};

uint32_t add(Mesh& mesh, const glm::dvec3& position)
{
    mesh.positions.emplace_back(position);
    return static_cast<uint32_t>(mesh.positions.size() - 1);
}

Instance& place(Scene& scene, std::string name, Mesh mesh, const glm::dvec3& position)
{
    mesh.name = name;
    scene.meshes.push_back(std::move(mesh));
    Instance& instance = scene.instances.emplace_back();
    instance.name = std::move(name);
    instance.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
    instance.pose.position = position;
    instance.isStatic = true;
    return instance;
}

/// A closed prism over an equilateral triangle, along x.
Mesh makeNeedle(double length, double width)
{
    Mesh mesh;
    for (const double end : {-0.5, 0.5})
        for (int i = 0; i < 3; ++i) {
            const double angle = 2.0943951023931953 * i;
            add(mesh, {end * length, 0.577 * width * std::cos(angle), 0.577 * width * std::sin(angle)});
        }
    mesh.indices = {0, 2, 1, 3, 4, 5};
    for (uint32_t i = 0; i < 3; ++i) {
        const uint32_t next = (i + 1) % 3;
        mesh.indices.insert(mesh.indices.end(), {i, next, next + 3, i, next + 3, i + 3});
    }
    return mesh;
}

/// Two flat cones rim to rim, of `count` slivers each.
Mesh makeFan(double radius, double height, uint32_t count)
{
    Mesh mesh;
    const uint32_t top = add(mesh, {0.0, height, 0.0}), bottom = add(mesh, {0.0, -height, 0.0});
    for (uint32_t i = 0; i < count; ++i) {
        const double angle = 6.283185307179586 * i / count;
        add(mesh, {radius * std::cos(angle), 0.0, radius * std::sin(angle)});
    }
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t from = 2 + i, to = 2 + (i + 1) % count;
        mesh.indices.insert(mesh.indices.end(), {top, to, from, bottom, from, to});
    }
    return mesh;
}

/// A box whose upper face is `count` strips; their ends lie on edges of the sides.
Mesh makeJointedBox(const glm::vec3& size, uint32_t count)
{
    Mesh mesh = makeBox({.size = size}), kept = mesh;
    kept.indices.clear();
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        bool upper = true;
        for (size_t k = i; k < i + 3; ++k)
            upper = upper && mesh.positions[mesh.indices[k]].y > 0.0f;
        if (!upper)
            kept.indices.insert(kept.indices.end(), mesh.indices.begin() + long(i), mesh.indices.begin() + long(i) + 3);
    }
    const glm::dvec3 half = 0.5 * glm::dvec3(size);
    uint32_t last[2] = {};
    for (uint32_t i = 0; i <= count; ++i) {
        const double x = half.x * (2.0 * i / count - 1.0);
        const uint32_t at[2] = {add(kept, {x, half.y, -half.z}), add(kept, {x, half.y, half.z})};
        if (i > 0) kept.indices.insert(kept.indices.end(), {last[0], last[1], at[1], last[0], at[1], at[0]});
        last[0] = at[0];
        last[1] = at[1];
    }
    return kept;
}

/// Strips along x from `low` to `high`, at z of `edges`.
void addStrips(Mesh& mesh, double low, double high, const std::vector<double>& edges)
{
    uint32_t last[2] = {};
    for (size_t i = 0; i < edges.size(); ++i) {
        const uint32_t at[2] = {add(mesh, {low, 0.0, edges[i]}), add(mesh, {high, 0.0, edges[i]})};
        if (i > 0) mesh.indices.insert(mesh.indices.end(), {last[0], at[0], at[1], last[0], at[1], last[1]});
        last[0] = at[0];
        last[1] = at[1];
    }
}

Mesh makeGround(LongGround kind)
{
    constexpr double kFar = 5000.0;
    Mesh mesh;
    if (kind == LongGround::none) return makePlane({.width = 40.0f, .depth = 40.0f, .columns = 40, .rows = 40});
    if (kind == LongGround::strips) {
        std::vector<double> edges{-kFar};
        for (int i = -60; i <= 20; ++i)
            edges.push_back(0.5 * i);
        edges.push_back(kFar);
        addStrips(mesh, -kFar, kFar, edges);
    } else if (kind == LongGround::fan) {
        const uint32_t centre = add(mesh, {0.3, 0.0, -0.4});
        constexpr uint32_t kCount = 300;
        for (uint32_t i = 0; i < kCount; ++i) {
            const double angle = 6.283185307179586 * i / kCount;
            add(mesh, {2.0 * kFar * std::cos(angle), 0.0, 2.0 * kFar * std::sin(angle)});
        }
        for (uint32_t i = 0; i < kCount; ++i)
            mesh.indices.insert(mesh.indices.end(), {centre, centre + 1 + (i + 1) % kCount, centre + 1 + i});
    } else {
        addStrips(mesh, -kFar, kFar, {0.0, kFar});
        for (int i = 0; i < 50; ++i) { // against them, across the seam
            const double low = i == 0 ? -kFar : i - 25.0, high = i == 49 ? kFar : i - 24.0;
            addStrips(mesh, low, high, {-kFar, 0.0});
        }
    }
    return mesh;
}

/// All of a scene turned about the world's zero: no coordinate stays a round number.
void turn(Scene& scene, const glm::dquat& rotation)
{
    for (Instance& instance : scene.instances) {
        instance.pose.position = rotation * instance.pose.position;
        instance.pose.rotation = rotation * instance.pose.rotation;
    }
    for (Light& light : scene.lights) {
        light.position = rotation * light.position;
        light.direction = glm::normalize(rotation * light.direction);
    }
    for (CameraKey& key : scene.camera) {
        key.eye = rotation * key.eye;
        key.target = rotation * key.target;
    }
}

} // namespace

Scene thinTriangles(LongGround ground, uint32_t seed)
{
    Random random(seed);
    Scene scene;
    scene.name = "thin triangles";
    const auto turnedPlace = [&](const char* name, Mesh mesh, double low, double high) {
        const glm::dvec3 at(random.within(-4.0, 4.0), random.within(low, high), random.within(-4.0, 3.0));
        place(scene, name, std::move(mesh), at).pose.rotation =
            glm::angleAxis(random.within(0.0, 3.0), random.direction());
    };
    place(scene, "ground", makeGround(ground), {0.0, 0.0, 0.0});
    for (int i = 0; i < 12; ++i) {
        const double length = random.within(2.0, 12.0);
        turnedPlace("needle", makeNeedle(length, length * std::pow(10.0, random.within(-4.0, -2.0))), 0.3, 3.0);
    }
    for (int i = 0; i < 3; ++i)
        turnedPlace("fan", makeFan(random.within(0.5, 1.5), 0.1, 400), 0.8, 2.5);
    for (int i = 0; i < 4; ++i) {
        const glm::vec3 size(random.within(0.5, 1.5), random.within(0.3, 1.0), random.within(0.5, 1.5));
        place(scene, "box", makeJointedBox(size, 40),
              {random.within(-4.0, 4.0), 0.5 * double(size.y), random.within(-4.0, 3.0)})
            .pose.rotation = glm::angleAxis(random.within(0.0, 3.0), glm::dvec3(0.0, 1.0, 0.0));
    }
    if (ground != LongGround::none)
        place(scene, "beam", makeNeedle(10000.0, 0.3), {0.0, 2.5, random.within(-4.0, 1.0)}).pose.rotation =
            glm::angleAxis(random.within(-0.3, 0.3), glm::dvec3(0.0, 1.0, 0.0));

    const auto lamp = [&](const char* name, LightKind kind, const glm::dvec3& position) {
        Light& light = scene.lights.emplace_back();
        light.name = name;
        light.kind = kind;
        light.position = position;
        light.direction = -glm::normalize(position);
        if (kind == LightKind::Spot) light.innerAngle = 0.7f, light.outerAngle = 0.75f;
        if (kind != LightKind::Directional) light.range = 40.0f;
    };
    lamp("sun", LightKind::Directional, {random.within(-4.0, 4.0), 5.0, random.within(-4.0, 4.0)});
    lamp("spot", LightKind::Spot, {random.within(-6.0, 6.0), 7.0, random.within(-3.0, 5.0)});
    lamp("point", LightKind::Point, {random.within(-2.0, 2.0), 3.5, random.within(-2.0, 2.0)});
    scene.camera = {{.eye = {random.within(-3.0, 3.0), random.within(2.0, 6.0), 9.0}, .target = {0.0, 0.6, 0.0}}};
    turn(scene, glm::angleAxis(random.within(0.1, 0.6), random.direction()));
    return scene;
}

} // namespace gnomon::exact
