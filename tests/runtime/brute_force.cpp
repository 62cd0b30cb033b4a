#include "runtime/brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace gnomon::brute {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double largest(const glm::dvec3& v)
{
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Distance along the ray, or infinity. Moeller and Trumbore 1997, both sides, borders included.
double hit(const Triangle& t, const glm::dvec3& origin, const glm::dvec3& direction)
{
    const glm::dvec3 ab = t.b - t.a, ac = t.c - t.a;
    const glm::dvec3 p = glm::cross(direction, ac);
    const double determinant = glm::dot(ab, p);
    if (determinant == 0.0) return kInfinity;
    const glm::dvec3 s = origin - t.a;
    const double u = glm::dot(s, p) / determinant;
    const glm::dvec3 q = glm::cross(s, ab);
    const double v = glm::dot(direction, q) / determinant;
    if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) return kInfinity;
    const double distance = glm::dot(ac, q) / determinant;
    return distance >= 0.0 ? distance : kInfinity;
}

/// Whether a ray starts on the triangle itself, whose depths and corners are rounded: long and thin ones only. Metres.
bool ownTriangle(const Triangle& t, const glm::dvec3& origin)
{
    const double longest = std::sqrt(
        std::max({glm::dot(t.b - t.a, t.b - t.a), glm::dot(t.c - t.b, t.c - t.b), glm::dot(t.a - t.c, t.a - t.c)}));
    const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    const double height = glm::length(normal) / longest, off = std::abs(glm::dot(normal, origin - t.a));
    const double shortened = std::min(longest, 64.0);
    const double thin = std::min(std::ldexp(shortened * shortened / height, -22), height / 4.0);
    return off <= glm::length(normal) * std::max(std::ldexp(longest, -22), thin);
}

bool entersBox(const glm::dvec3& lower, const glm::dvec3& upper, const glm::dvec3& origin, const glm::dvec3& direction,
               double tEnd)
{
    double from = 0.0, to = tEnd;
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0) {
            if (origin[axis] < lower[axis] || origin[axis] > upper[axis]) return false;
            continue;
        }
        const double t0 = (lower[axis] - origin[axis]) / direction[axis];
        const double t1 = (upper[axis] - origin[axis]) / direction[axis];
        from = std::max(from, std::min(t0, t1));
        to = std::min(to, std::max(t0, t1));
    }
    return from <= to * (1.0 + 1e-12) + 1e-12; // flat boxes: never lose a triangle to rounding
}

/// Camera algebra in double, from the matrices as given.
class Camera {
public:
    explicit Camera(const View& view) : view_(view)
    {
        glm::dmat4 projection;
        for (int i = 0; i < 16; ++i)
            projection[i / 4][i % 4] = static_cast<double>(view.projection[std::size_t(i)]);
        projection_ = projection;
        viewFromClip_ = glm::inverse(projection);
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column)
                rotation_[column][row] = static_cast<double>(view.viewFromWorld[std::size_t(3 * row + column)]);
        }
    }

    /// World direction from the eye to a point in pixels at a depth value, and its length: relative to the eye.
    glm::dvec3 relative(double px, double py, double depth) const
    {
        const glm::dvec4 clip(2.0 * px / view_.width - 1.0, 2.0 * py / view_.height - 1.0, depth, 1.0);
        const glm::dvec4 v = viewFromClip_ * clip;
        return glm::transpose(rotation_) * (glm::dvec3(v) / v.w);
    }

    /// The way that the view looks there, of any length.
    glm::dvec3 looking(double px, double py, double depth) const
    {
        const double nearer = view_.convention == GN_DEPTH_STANDARD ? 1.0 - 1e-3 : 1.0 + 1e-3;
        return relative(px, py, depth) - relative(px, py, depth * nearer);
    }

    glm::dvec4 clip(const glm::dvec3& relativeToEye) const
    {
        return projection_ * glm::dvec4(rotation_ * relativeToEye, 1.0);
    }

private:
    const View& view_;
    glm::dmat4 projection_{1.0}, viewFromClip_{1.0};
    glm::dmat3 rotation_{1.0};
};

/// Everything about one receiver that stays while it is moved about for the ambiguity test.
struct Receiver {
    const Camera& camera;
    const View& view;
    const Light& light;
    const Scene& scene;
    glm::dvec3 relative; ///< To the eye.
    glm::dvec3 looking;  ///< Unit.
    bool hasNormal;
    glm::dvec3 normal;

    glm::dvec3 lightRelative() const { return light.position - view.eye; }
    glm::dvec3 towardsLight(const glm::dvec3& from) const
    {
        if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return -glm::normalize(light.direction);
        return glm::normalize(lightRelative() - from);
    }
    bool reached() const
    {
        if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return true;
        const glm::dvec3 away = relative - lightRelative();
        if (light.range > 0.0 && glm::length(away) > light.range) return false;
        return light.type != GN_LIGHT_TYPE_SPOT ||
               glm::dot(glm::normalize(away), glm::normalize(light.direction)) >= std::cos(light.coneAngle);
    }
    double factor() const { return view.convention == GN_DEPTH_STANDARD ? 3.0 : 1.0; }
    /// The offset of the definitions: k (u |n.v| + f / 256 + 2^-21 c).
    double offset(int x, int y, float depth) const
    {
        const double px = x + 0.5, py = y + 0.5;
        const double ulp =
            static_cast<double>(std::nextafter(depth, 2.0f)) - static_cast<double>(depth) + view.step / factor();
        const double u = glm::length(camera.relative(px, py, static_cast<double>(depth) + ulp) - relative);
        const double slope = hasNormal ? std::abs(glm::dot(normal, looking)) : 1.0;
        const double f = glm::length(camera.relative(px + 1.0, py, static_cast<double>(depth)) - relative);
        // Scenes of tests lie around the frame's origin.
        double c = std::max(largest(relative), largest(view.eye + relative));
        if (light.type != GN_LIGHT_TYPE_DIRECTIONAL)
            c = std::max({c, largest(lightRelative()), largest(view.eye + lightRelative())});
        return factor() * (u * slope + f / 256.0 + std::ldexp(c, -21));
    }
    /// Which way rays' starts are moved: without a normal between the one that is seen and the eye.
    glm::dvec3 away() const
    {
        if (hasNormal) return normal;
        const glm::dvec3 seen = glm::dot(normal, looking) > 0.0 ? -normal : normal;
        return glm::normalize(seen - looking);
    }
    bool lit(const glm::dvec3& from, double delta) const
    {
        const glm::dvec3 l = towardsLight(from);
        const glm::dvec3 start = from + delta * away();
        if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return !scene.blocked(view.eye + start, l, kInfinity);
        const double distance = glm::length(lightRelative() - start);
        return !scene.blocked(view.eye + start, towardsLight(start), distance - delta);
    }
};

/// The receiver's plane under another point of the screen.
glm::dvec3 movedOnPlane(const Receiver& r, double px, double py, float depth)
{
    const glm::dvec3 ray = r.camera.relative(px, py, static_cast<double>(depth));
    if (!r.hasNormal) return ray;
    const glm::dvec3 looking = r.camera.looking(px, py, static_cast<double>(depth));
    const double along = glm::dot(r.normal, looking);
    return along == 0.0 ? r.relative : ray + looking * (glm::dot(r.normal, r.relative - ray) / along);
}

} // namespace

Scene::Scene(std::vector<Triangle> triangles) : triangles_(std::move(triangles))
{
    nodes_.push_back({});
    split(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

void Scene::split(std::uint32_t node, std::uint32_t first, std::uint32_t count)
{
    glm::dvec3 lower(kInfinity), upper(-kInfinity);
    for (std::uint32_t i = first; i < first + count; ++i) {
        for (const glm::dvec3& corner : {triangles_[i].a, triangles_[i].b, triangles_[i].c}) {
            lower = glm::min(lower, corner);
            upper = glm::max(upper, corner);
        }
    }
    nodes_[node] = {lower, upper, first, count};
    if (count <= 4) return;
    const glm::dvec3 size = upper - lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto begin = triangles_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count, [axis](const Triangle& l, const Triangle& r) {
        return l.a[axis] + l.b[axis] + l.c[axis] < r.a[axis] + r.b[axis] + r.c[axis];
    });
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[node].first = child;
    nodes_[node].count = 0;
    split(child, first, count / 2);
    split(child + 1, first + count / 2, count - count / 2);
}

bool Scene::blocked(const glm::dvec3& origin, const glm::dvec3& direction, double tEnd) const
{
    if (triangles_.empty()) return false;
    std::array<std::uint32_t, 64> stack; // halves at each step: 64 levels hold any count
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        if (!entersBox(node.lower, node.upper, origin, direction, tEnd)) continue;
        if (node.count == 0) {
            stack[depth++] = node.first;
            stack[depth++] = node.first + 1;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const double t = hit(triangles_[i], origin, direction);
            if (t != kInfinity && t <= tEnd && !ownTriangle(triangles_[i], origin)) return true;
        }
    }
    return false;
}

std::vector<Triangle> trianglesOf(std::span<const Caster> casters, std::uint32_t lightMask)
{
    std::vector<Triangle> triangles;
    for (const Caster& caster : casters) {
        if (!caster.mesh || (caster.mask & lightMask) == 0) continue;
        const auto world = [&](std::uint32_t index) {
            const glm::dmat3 basis(caster.basis);
            return basis * glm::dvec3(caster.mesh->positions[index]) + glm::dvec3(caster.translation);
        };
        const auto& indices = caster.mesh->indices;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
            triangles.push_back({world(indices[i]), world(indices[i + 1]), world(indices[i + 2])});
    }
    return triangles;
}

Answer answerAt(const View& view, const Light& light, const Scene& scene, int x, int y, float depth,
                const glm::dvec3& normal, bool given)
{
    Answer answer;
    if (depth == (view.convention == GN_DEPTH_STANDARD ? 1.0f : 0.0f)) return answer;

    const Camera camera(view);
    const glm::dvec3 relative = camera.relative(x + 0.5, y + 0.5, static_cast<double>(depth));
    const glm::dvec3 looking = glm::normalize(camera.looking(x + 0.5, y + 0.5, static_cast<double>(depth)));
    const Receiver r{camera, view, light, scene, relative, looking, given, glm::normalize(normal)};
    answer.receiver = view.eye + relative;
    answer.state = State::unreached;
    if (!r.reached()) return answer;

    const double facing = glm::dot(r.normal, r.towardsLight(relative));
    if (r.hasNormal && facing <= 0.0) {
        answer.state = State::away;
        answer.lit = false;
        return answer;
    }
    answer.state = State::asked;
    answer.grazing = r.hasNormal && facing < 0.03;
    const double delta = r.offset(x, y, depth);
    answer.offset = delta;
    answer.lit = r.lit(relative, delta);
    answer.ambiguous = r.lit(relative, 0.5 * delta) != answer.lit || r.lit(relative, 2.0 * delta) != answer.lit;
    constexpr double step = 1.0 / 128.0; // pixel
    constexpr std::array<std::array<double, 2>, 4> moves{{{step, 0.0}, {-step, 0.0}, {0.0, step}, {0.0, -step}}};
    for (const auto& [dx, dy] : moves) {
        const glm::dvec3 moved = movedOnPlane(r, x + 0.5 + dx, y + 0.5 + dy, depth);
        answer.ambiguous = answer.ambiguous || r.lit(moved, delta) != answer.lit;
    }
    return answer;
}

Surface surfaceAt(const View& view, std::span<const Triangle> triangles, int x, int y)
{
    const Camera camera(view);
    const bool standard = view.convention == GN_DEPTH_STANDARD;
    const glm::dvec3 from = camera.relative(x + 0.5, y + 0.5, standard ? 0.0 : 1.0);
    const glm::dvec3 ray = camera.relative(x + 0.5, y + 0.5, 0.5) - from; // any point on the ray will do
    Surface surface{standard ? 1.0f : 0.0f, glm::dvec3(0.0)};
    double best = kInfinity;
    for (const Triangle& triangle : triangles) {
        const double t = hit(triangle, view.eye + from, ray);
        if (t >= best) continue;
        const glm::dvec4 clip = camera.clip(from + t * ray);
        const double depth = clip.z / clip.w;
        if (!(depth >= 0.0 && depth <= 1.0)) continue;
        best = t;
        surface.depth = static_cast<float>(depth);
        surface.normal = glm::normalize(glm::cross(triangle.b - triangle.a, triangle.c - triangle.a));
    }
    return surface;
}

glm::dvec3 placeOf(const View& view, int x, int y, float depth)
{
    return view.eye + Camera(view).relative(x + 0.5, y + 0.5, static_cast<double>(depth));
}

} // namespace gnomon::brute
