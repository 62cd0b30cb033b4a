#include "demo/scene/primitives.hpp"

#include <glm/geometric.hpp>

#include <cassert>
#include <cmath>
#include <numbers>

namespace gnomon::demo {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

void addTriangle(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c)
{
    mesh.indices.insert(mesh.indices.end(), {a, b, c});
}

/// Corners counter-clockwise; the diagonal runs from a to c.
void addQuad(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    addTriangle(mesh, a, b, c);
    addTriangle(mesh, a, c, d);
}

uint32_t addVertex(Mesh& mesh, const glm::dvec3& position)
{
    mesh.positions.emplace_back(position);
    return static_cast<uint32_t>(mesh.positions.size() - 1);
}

/// An open grid of (columns + 1) x (rows + 1) vertices; `position(u, v)` takes [0, 1] x [0, 1]. It faces u x v.
template <typename Position>
Mesh makeGrid(uint32_t columns, uint32_t rows, Position position)
{
    Mesh mesh;
    mesh.positions.reserve(size_t(columns + 1) * (rows + 1));
    mesh.indices.reserve(size_t(columns) * rows * 6);
    for (uint32_t row = 0; row <= rows; ++row)
        for (uint32_t column = 0; column <= columns; ++column)
            addVertex(mesh, position(double(column) / columns, double(row) / rows));
    const uint32_t stride = columns + 1;
    for (uint32_t row = 0; row < rows; ++row)
        for (uint32_t column = 0; column < columns; ++column) {
            const uint32_t corner = row * stride + column;
            addQuad(mesh, corner, corner + 1, corner + stride + 1, corner + stride);
        }
    return mesh;
}

/// A grid closed in both directions: the last row and column are the first ones again.
template <typename Position>
Mesh makeClosedTube(uint32_t ringSegments, uint32_t tubeSegments, Position position)
{
    Mesh mesh;
    for (uint32_t ring = 0; ring < ringSegments; ++ring)
        for (uint32_t tube = 0; tube < tubeSegments; ++tube)
            addVertex(mesh, position(kTwoPi * ring / ringSegments, kTwoPi * tube / tubeSegments));
    for (uint32_t ring = 0; ring < ringSegments; ++ring)
        for (uint32_t tube = 0; tube < tubeSegments; ++tube) {
            const uint32_t here = ring * tubeSegments, there = (ring + 1) % ringSegments * tubeSegments;
            const uint32_t next = (tube + 1) % tubeSegments;
            addQuad(mesh, here + tube, here + next, there + next, there + tube);
        }
    return mesh;
}

float valueNoise(float x, float z, uint32_t seed)
{
    const float floorX = std::floor(x), floorZ = std::floor(z);
    const auto cellX = int32_t(floorX), cellZ = int32_t(floorZ);
    // Quintic ease: second derivatives are continuous, so that slopes have no creases at the lattice.
    const auto ease = [](float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); };
    const float u = ease(x - floorX), v = ease(z - floorZ);
    const float near0 = latticeValue(cellX, cellZ, seed), near1 = latticeValue(cellX + 1, cellZ, seed);
    const float far0 = latticeValue(cellX, cellZ + 1, seed), far1 = latticeValue(cellX + 1, cellZ + 1, seed);
    const float nearer = near0 + (near1 - near0) * u, farther = far0 + (far1 - far0) * u;
    return nearer + (farther - nearer) * v;
}

} // namespace

// A small integer mixer (constants of the "lowbias32" search by C. Wellons).
float latticeValue(int32_t x, int32_t z, uint32_t seed)
{
    uint32_t h = uint32_t(x) * 0x9e3779b9u ^ (uint32_t(z) * 0x85ebca6bu + seed);
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    h ^= h >> 16;
    return float(h >> 8) / float(0xffffff); // 24 bits: exact in a float
}

Mesh revolve(std::span<const ProfilePoint> outline, uint32_t segments)
{
    assert(outline.size() >= 3 && segments >= 3);
    Mesh mesh;
    const uint32_t bottom = addVertex(mesh, {0.0, outline.front().y, 0.0});
    const uint32_t top = addVertex(mesh, {0.0, outline.back().y, 0.0});
    const auto ringCount = static_cast<uint32_t>(outline.size() - 2);
    for (uint32_t ring = 0; ring < ringCount; ++ring)
        for (uint32_t s = 0; s < segments; ++s) {
            const double angle = kTwoPi * s / segments;
            const ProfilePoint& point = outline[ring + 1];
            addVertex(mesh, {point.radius * std::cos(angle), point.y, point.radius * std::sin(angle)});
        }
    const auto vertex = [segments](uint32_t ring, uint32_t s) { return 2 + ring * segments + s % segments; };
    for (uint32_t s = 0; s < segments; ++s) {
        addTriangle(mesh, bottom, vertex(0, s), vertex(0, s + 1));
        for (uint32_t ring = 0; ring + 1 < ringCount; ++ring)
            addQuad(mesh, vertex(ring, s), vertex(ring + 1, s), vertex(ring + 1, s + 1), vertex(ring, s + 1));
        addTriangle(mesh, vertex(ringCount - 1, s), top, vertex(ringCount - 1, s + 1));
    }
    return mesh;
}

Mesh makePlane(const PlaneShape& shape)
{
    return makeGrid(shape.columns, shape.rows, [&](double u, double v) {
        return glm::dvec3((u - 0.5) * shape.width, 0.0, (0.5 - v) * shape.depth); // v runs to -z: the normal is +y
    });
}

Mesh makeBox(const BoxShape& shape)
{
    Mesh mesh;
    const glm::dvec3 half = glm::dvec3(shape.size) * 0.5;
    for (uint32_t corner = 0; corner < 8; ++corner) // bits 0, 1, 2: the positive side of x, y, z
        addVertex(mesh, {corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y, corner & 4 ? half.z : -half.z});
    addQuad(mesh, 0, 4, 6, 2); // -x
    addQuad(mesh, 1, 3, 7, 5); // +x
    addQuad(mesh, 0, 1, 5, 4); // -y
    addQuad(mesh, 2, 6, 7, 3); // +y
    addQuad(mesh, 0, 2, 3, 1); // -z
    addQuad(mesh, 4, 5, 7, 6); // +z
    return mesh;
}

Mesh makeSphere(const SphereShape& shape)
{
    std::vector<ProfilePoint> outline;
    for (uint32_t stack = 0; stack <= shape.stacks; ++stack) {
        const double angle = std::numbers::pi * stack / shape.stacks;
        const bool pole = stack == 0 || stack == shape.stacks;
        outline.push_back(
            {pole ? 0.0f : float(shape.radius * std::sin(angle)), float(-shape.radius * std::cos(angle))});
    }
    return revolve(outline, shape.slices);
}

Mesh makeTorus(const TorusShape& shape)
{
    return makeClosedTube(shape.ringSegments, shape.tubeSegments, [&](double ring, double tube) {
        const double distance = shape.radius + shape.tube * std::cos(tube);
        return glm::dvec3(distance * std::cos(ring), shape.tube * std::sin(tube), distance * std::sin(ring));
    });
}

Mesh makeTorusKnot(const TorusKnotShape& shape)
{
    const double p = shape.p, q = shape.q;
    return makeClosedTube(shape.knotSegments, shape.tubeSegments, [&](double along, double tube) {
        const double distance = shape.radius + shape.sweep * std::cos(q * along);
        const double change = -shape.sweep * q * std::sin(q * along);
        const double c = std::cos(p * along), s = std::sin(p * along);
        const glm::dvec3 center(distance * c, shape.sweep * std::sin(q * along), distance * s);
        const glm::dvec3 tangent(change * c - distance * p * s, shape.sweep * q * std::cos(q * along),
                                 change * s + distance * p * c);
        // The way off the carrying torus' middle circle is never along the tangent, and comes round with the curve:
        // a frame without a twist at the seam.
        const glm::dvec3 out(std::cos(q * along) * c, std::sin(q * along), std::cos(q * along) * s);
        const glm::dvec3 side = glm::normalize(glm::cross(tangent, out));
        const glm::dvec3 normal = glm::normalize(glm::cross(side, tangent));
        return center + double(shape.tube) * (std::cos(tube) * normal + std::sin(tube) * side);
    });
}

Mesh makeCylinder(const CylinderShape& shape)
{
    std::vector<ProfilePoint> outline = {{0.0f, 0.0f}};
    for (uint32_t ring = 0; ring <= shape.rings; ++ring) {
        const float t = float(ring) / float(shape.rings);
        outline.push_back({shape.radius + (shape.topRadius - shape.radius) * t, shape.height * t});
    }
    outline.push_back({0.0f, shape.height});
    return revolve(outline, shape.segments);
}

Mesh makeColumn(const ColumnShape& shape)
{
    // Proportions by eye: plinth and capital 1.3 shaft radii wide and 0.5 high each, an oblique moulding to the shaft.
    const float r = shape.radius, wide = 1.3f * r, block = 0.5f * r, moulding = 0.25f * r;
    const float shaftFoot = block + moulding, shaftHead = shape.height - block - moulding;
    std::vector<ProfilePoint> outline = {{0.0f, 0.0f}, {wide, 0.0f}, {wide, block}};
    for (uint32_t ring = 0; ring <= shape.rings; ++ring) {
        const float t = float(ring) / float(shape.rings);
        outline.push_back({r * (1.0f - t * t / 6.0f), shaftFoot + (shaftHead - shaftFoot) * t});
    }
    outline.insert(outline.end(), {{wide, shape.height - block}, {wide, shape.height}, {0.0f, shape.height}});
    return revolve(outline, shape.segments);
}

Mesh makeArch(const ArchShape& shape)
{
    Mesh mesh;
    const double half = shape.depth * 0.5;
    for (uint32_t s = 0; s <= shape.segments; ++s) {
        const double angle = std::numbers::pi * s / shape.segments;
        const double c = s == shape.segments ? -1.0 : std::cos(angle), y = s == shape.segments ? 0.0 : std::sin(angle);
        addVertex(mesh, {shape.innerRadius * c, shape.innerRadius * y, -half});
        addVertex(mesh, {shape.outerRadius * c, shape.outerRadius * y, -half});
        addVertex(mesh, {shape.outerRadius * c, shape.outerRadius * y, half});
        addVertex(mesh, {shape.innerRadius * c, shape.innerRadius * y, half});
    }
    for (uint32_t s = 0; s < shape.segments; ++s)
        for (uint32_t side = 0; side < 4; ++side) {
            const uint32_t here = s * 4, there = here + 4, next = (side + 1) % 4;
            addQuad(mesh, here + side, there + side, there + next, here + next);
        }
    const uint32_t last = shape.segments * 4;
    addQuad(mesh, 0, 1, 2, 3);
    addQuad(mesh, last + 3, last + 2, last + 1, last);
    return mesh;
}

float terrainHeight(const TerrainShape& shape, float x, float z)
{
    // Weights 3/4 and 1/4 keep the sum in [0, 1]; the second octave is moved off the first one's lattice.
    const float scale = 1.0f / shape.featureSize;
    const float hills = valueNoise(x * scale, z * scale, shape.seed);
    const float bumps = valueNoise(x * scale * 2.3f + 0.37f, z * scale * 2.3f + 0.71f, shape.seed + 1);
    return shape.height * (0.75f * hills + 0.25f * bumps);
}

Mesh makeTerrain(const TerrainShape& shape)
{
    Mesh mesh = makeGrid(shape.columns, shape.rows, [&](double u, double v) {
        const double x = (u - 0.5) * shape.width, z = (0.5 - v) * shape.depth;
        return glm::dvec3(x, terrainHeight(shape, float(x), float(z)), z);
    });
    if (!(shape.thickness > 0.0f)) return mesh;

    // The border, counter-clockwise from above, as indices into the grid.
    std::vector<uint32_t> border;
    const uint32_t stride = shape.columns + 1;
    for (uint32_t i = 0; i < shape.columns; ++i)
        border.push_back(i);
    for (uint32_t i = 0; i < shape.rows; ++i)
        border.push_back(i * stride + shape.columns);
    for (uint32_t i = shape.columns; i > 0; --i)
        border.push_back(shape.rows * stride + i);
    for (uint32_t i = shape.rows; i > 0; --i)
        border.push_back(i * stride);

    const auto firstLow = static_cast<uint32_t>(mesh.positions.size());
    const auto count = static_cast<uint32_t>(border.size());
    for (const uint32_t top : border)
        addVertex(mesh, {mesh.positions[top].x, -shape.thickness, mesh.positions[top].z});
    const uint32_t middle = addVertex(mesh, {0.0, -shape.thickness, 0.0});
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t next = (i + 1) % count;
        addQuad(mesh, firstLow + i, firstLow + next, border[next], border[i]);
        addTriangle(mesh, middle, firstLow + next, firstLow + i);
    }
    return mesh;
}

Mesh makeCloth(const ClothShape& shape)
{
    return makeGrid(shape.columns, shape.rows, [&](double u, double v) {
        const double x = (u - 0.5) * shape.width, y = (v - 1.0) * shape.height;
        const double swing = shape.amplitude * (1.0 - 0.7 * v); // free at the bottom, gathered at the top
        return glm::dvec3(x, y, swing * std::sin(kTwoPi * (shape.folds * u + 0.15 * v)));
    });
}

Mesh makeCard(const CardShape& shape)
{
    return makeGrid(
        1, 1, [&](double u, double v) { return glm::dvec3((u - 0.5) * shape.width, (v - 0.5) * shape.height, 0.0); });
}

Mesh makeLeaves(const LeavesShape& shape)
{
    Mesh mesh;
    for (uint32_t leaf = 0; leaf < shape.count; ++leaf) {
        // Numbers of a leaf: a column of the lattice.
        const auto random = [&](int32_t row) { return double(latticeValue(int32_t(leaf), row, shape.seed)); };
        const auto direction = [&](int32_t row) { // uniform on the sphere, by Archimedes
            const double z = 2.0 * random(row) - 1.0, angle = kTwoPi * random(row + 1), r = std::sqrt(1.0 - z * z);
            return glm::dvec3(r * std::cos(angle), r * std::sin(angle), z);
        };
        const glm::dvec3 centre = direction(0) * std::cbrt(random(2)) * 0.5 * glm::dvec3(shape.size);
        const glm::dvec3 along = direction(3);
        // Any axis but a parallel one spans the leaf's plane together with it.
        const glm::dvec3 other = std::abs(along.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
        const glm::dvec3 side = glm::normalize(glm::cross(along, other)), up = glm::cross(side, along);
        const double turn = kTwoPi * random(5);
        const glm::dvec3 across = std::cos(turn) * side + std::sin(turn) * up, normal = glm::cross(along, across);
        const uint32_t tip = addVertex(mesh, centre + 0.5 * shape.length * along);
        const uint32_t left = addVertex(mesh, centre + 0.5 * shape.width * across);
        const uint32_t base = addVertex(mesh, centre - 0.5 * shape.length * along);
        const uint32_t right = addVertex(mesh, centre - 0.5 * shape.width * across);
        if (!shape.closed) {
            addQuad(mesh, tip, left, base, right);
            for (uint32_t blade = 1; blade < shape.blades; ++blade) {
                const double angle = std::numbers::pi * blade / shape.blades;
                const glm::dvec3 out = 0.5 * shape.width * (std::cos(angle) * across + std::sin(angle) * normal);
                const uint32_t outer = addVertex(mesh, centre + out), inner = addVertex(mesh, centre - out);
                addQuad(mesh, tip, outer, base, inner);
            }
            continue;
        }
        const uint32_t top = addVertex(mesh, centre + 0.125 * shape.width * normal);
        const uint32_t bottom = addVertex(mesh, centre - 0.125 * shape.width * normal);
        const uint32_t rim[] = {tip, left, base, right};
        for (uint32_t i = 0; i < 4; ++i) {
            addTriangle(mesh, rim[i], rim[(i + 1) % 4], top);
            addTriangle(mesh, rim[(i + 1) % 4], rim[i], bottom);
        }
    }
    return mesh;
}

} // namespace gnomon::demo
