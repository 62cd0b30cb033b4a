#include "scene_analysis.hpp"

#include "demo/scene/mesh_file.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace gnomon::demo {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Box {
    glm::dvec3 low{kFar}, high{-kFar};

    void add(const glm::dvec3& p)
    {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    glm::dvec3 center() const { return (low + high) * 0.5; }
};

struct Part {
    Box world;
    double thinnest = 0.0; ///< Smallest extent in object space, in metres after scaling.
    bool closed = false;
    bool behindEye = true;
};

Part examine(const Scene& scene, const Instance& instance, const CameraState& camera, double time)
{
    const Mesh& mesh = scene.meshes[instance.mesh];
    const Transform transform = instanceAt(instance, time);
    Part part;
    Box object;
    for (const glm::vec3& p : mesh.positions) {
        const glm::dvec3 positionWs = transform.apply(p);
        object.add(p);
        part.world.add(positionWs);
        if (glm::dot(positionWs - camera.eye, camera.forward()) >= 0.0) part.behindEye = false;
    }
    const glm::dvec3 extent = (object.high - object.low) * instance.pose.scale;
    part.thinnest = std::min({extent.x, extent.y, extent.z});
    part.closed = countEdges(mesh).closed();
    return part;
}

/// Width of a texel of a light's 1024 map at a point. A directional light is taken to cover 40 m, as a fit to any of
/// the shipped scenes does at least.
double texelAt(const Light& light, const LightState& state, const glm::dvec3& point)
{
    constexpr double kMap = 1024.0;
    if (light.kind == LightKind::Directional) return 40.0 / kMap;
    const double distance = glm::length(point - state.position);
    const double halfAngle = light.kind == LightKind::Spot ? light.outerAngle : 0.785398; // a cube face
    return 2.0 * distance * std::tan(halfAngle) / kMap;
}

bool wholeInstanceBehind(const Scene& scene, const Instance& instance, const Part& part, const Light& light,
                         const LightState& state, double time)
{
    // Behind a directional light: nearer to where it comes from than everything that is in the picture's middle.
    const glm::dvec3 from = light.kind == LightKind::Spot ? state.position : cameraAt(scene, time).target;
    if (light.kind == LightKind::Point) return false;
    const Transform transform = instanceAt(instance, time);
    for (const glm::vec3& p : scene.meshes[instance.mesh].positions)
        if (glm::dot(transform.apply(p) - from, state.direction) >= 0.0) return false;
    // Near enough to the axis that a projection without a sign would draw it.
    const glm::dvec3 away = part.world.center() - from;
    return light.kind == LightKind::Spot &&
           glm::dot(-glm::normalize(away), state.direction) > std::cos(light.outerAngle);
}

} // namespace

EdgeCount countEdges(const Mesh& original)
{
    Mesh mesh = original;
    weldPositions(mesh);
    struct Use {
        int balance = 0, total = 0;
    };
    std::map<std::pair<uint32_t, uint32_t>, Use> uses;
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
        const uint32_t from = mesh.indices[i], to = mesh.indices[i % 3 == 2 ? i - 2 : i + 1];
        Use& use = uses[std::minmax(from, to)];
        use.balance += from < to ? 1 : -1;
        ++use.total;
    }
    EdgeCount count;
    count.edges = uses.size();
    for (const auto& [edge, use] : uses) {
        count.border += use.total == 1;
        count.unbalanced += use.total > 1 && use.balance != 0;
        count.crowded += use.total > 2;
    }
    return count;
}

double signedVolume(const Mesh& mesh)
{
    double six = 0.0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                         c = mesh.positions[mesh.indices[i + 2]];
        six += glm::dot(a, glm::cross(b, c));
    }
    return six / 6.0;
}

double smallestArea(const Mesh& mesh)
{
    double smallest = kFar;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                         c = mesh.positions[mesh.indices[i + 2]];
        smallest = std::min(smallest, 0.5 * glm::length(glm::cross(b - a, c - a)));
    }
    return smallest;
}

std::vector<WorldTriangle> worldTriangles(const Scene& scene, double time)
{
    std::vector<WorldTriangle> triangles;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
        const Transform transform = instanceAt(scene.instances[i], time);
        for (size_t t = 0; t < mesh.indices.size(); t += 3)
            triangles.push_back({transform.apply(mesh.positions[mesh.indices[t]]),
                                 transform.apply(mesh.positions[mesh.indices[t + 1]]),
                                 transform.apply(mesh.positions[mesh.indices[t + 2]]), i});
    }
    return triangles;
}

double distanceToTriangle(const glm::dvec3& point, const WorldTriangle& t)
{
    const auto toSegment = [&point](const glm::dvec3& a, const glm::dvec3& b) {
        const double along = std::clamp(glm::dot(point - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
        return glm::length(point - (a + (b - a) * along));
    };
    const glm::dvec3 normal = glm::normalize(glm::cross(t.b - t.a, t.c - t.a));
    const auto inside = [&](const glm::dvec3& a, const glm::dvec3& b) {
        return glm::dot(glm::cross(b - a, point - a), normal) >= 0.0;
    };
    if (inside(t.a, t.b) && inside(t.b, t.c) && inside(t.c, t.a)) return std::abs(glm::dot(point - t.a, normal));
    return std::min({toSegment(t.a, t.b), toSegment(t.b, t.c), toSegment(t.c, t.a)});
}

glm::dvec3 towardsLight(const Light& light, const LightState& state, const glm::dvec3& point)
{
    return light.kind == LightKind::Directional ? -state.direction : glm::normalize(state.position - point);
}

bool reaches(const Light& light, const LightState& state, const glm::dvec3& point)
{
    if (light.kind == LightKind::Directional) return true;
    if (glm::length(point - state.position) > light.range) return false;
    return light.kind == LightKind::Point ||
           glm::dot(-towardsLight(light, state, point), state.direction) > std::cos(light.outerAngle);
}

FailFeatures findFailFeatures(const Scene& scene, double time)
{
    FailFeatures found;
    const CameraState camera = cameraAt(scene, time);
    std::vector<Part> parts;
    for (const Instance& instance : scene.instances)
        parts.push_back(examine(scene, instance, camera, time));

    for (size_t i = 0; i < parts.size(); ++i) {
        const Part& part = parts[i];
        found.casterBehindEye |= part.behindEye;
        for (size_t j = 0; j < parts.size(); ++j) {
            const Box& under = parts[j].world;
            const bool over = part.world.low.x > under.low.x && part.world.high.x < under.high.x &&
                              part.world.low.z > under.low.z && part.world.high.z < under.high.z;
            if (i == j || !over) continue;
            // Touches, or stands in it like the meshes that sink into the terrain.
            found.contactEdge |= part.world.low.y >= under.low.y - 1e-6 && part.world.low.y <= under.high.y + 1e-6;
            found.openPart |= !part.closed;
        }
        for (const Light& light : scene.lights) {
            const LightState state = lightAt(light, time);
            if (!state.present) continue;
            const glm::dvec3 center = part.world.center();
            if (part.closed && reaches(light, state, center) && part.thinnest < texelAt(light, state, center))
                found.thinWall = true;
            found.casterBehindLight |= wholeInstanceBehind(scene, scene.instances[i], part, light, state, time);
        }
    }

    for (const WorldTriangle& triangle : worldTriangles(scene, time)) {
        const glm::dvec3 doubleArea = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
        const double area = 0.5 * glm::length(doubleArea);
        if (area < 0.5) continue;
        const glm::dvec3 middle = (triangle.a + triangle.b + triangle.c) / 3.0;
        for (const Light& light : scene.lights) {
            const LightState state = lightAt(light, time);
            if (!state.present || !reaches(light, state, middle)) continue;
            const double cosine = glm::dot(doubleArea, towardsLight(light, state, middle)) / (2.0 * area);
            found.grazedReceiver |= cosine > 0.0698 && cosine < 0.1045; // 86 and 84 degrees
        }
    }
    return found;
}

} // namespace gnomon::demo
