#include "meshes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace stranger {
namespace {

constexpr float kPi = 3.14159265f;

uint32_t addVertex(Mesh& mesh, float x, float y, float z)
{
    mesh.positions.push_back({x, y, z});
    return static_cast<uint32_t>(mesh.positions.size() - 1);
}

void addQuad(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
}

/// Half width of the statue over its height, both in metres: base, legs, waist, shoulders, neck, head.
float statueRadius(float y)
{
    constexpr float kProfile[][2] = {{0.0f, 1.0f}, {0.3f, 0.95f}, {0.4f, 0.45f}, {1.2f, 0.4f},  {1.8f, 0.55f},
                                     {2.5f, 0.8f}, {2.8f, 0.3f},  {3.0f, 0.25f}, {3.3f, 0.38f}, {3.6f, 0.1f}};
    for (size_t i = 1; i < std::size(kProfile); ++i) {
        const float *low = kProfile[i - 1], *high = kProfile[i];
        if (y <= high[0]) return low[1] + (high[1] - low[1]) * (y - low[0]) / (high[0] - low[0]);
    }
    return kProfile[std::size(kProfile) - 1][1];
}

/// A displaced tube without ends. One quad in 29 is missing, and two windows; every tenth column carries a fin, whose
/// edge on the tube belongs to three triangles.
Mesh makeStatue()
{
    constexpr uint32_t kRows = 60, kColumns = 80;
    Mesh mesh{.name = "statue", .colour = {0.8f, 0.78f, 0.72f}, .positions = {}, .indices = {}};
    const auto place = [&](uint32_t row, uint32_t column, float outward) {
        const float y = 3.6f * static_cast<float>(row) / kRows;
        const float angle = 2.0f * kPi * static_cast<float>(column) / kColumns;
        const float bumps = 0.04f * std::sin(9.0f * angle + 5.0f * y) + 0.03f * std::sin(23.0f * y - 4.0f * angle);
        const float radius = statueRadius(y) + bumps + outward;
        return addVertex(mesh, radius * std::cos(angle), y, radius * std::sin(angle));
    };
    for (uint32_t row = 0; row <= kRows; ++row)
        for (uint32_t column = 0; column < kColumns; ++column)
            place(row, column, 0.0f);
    const auto at = [](uint32_t row, uint32_t column) { return row * kColumns + column % kColumns; };
    const auto isHole = [](uint32_t row, uint32_t column) {
        const bool window = row > 33 && row < 40 && (column % 40) < 6;
        return window || (row * 7 + column * 13) % 29 == 0;
    };
    for (uint32_t row = 0; row < kRows; ++row)
        for (uint32_t column = 0; column < kColumns; ++column)
            if (!isHole(row, column))
                addQuad(mesh, at(row, column), at(row + 1, column), at(row + 1, column + 1), at(row, column + 1));
    for (uint32_t column = 0; column < kColumns; column += 10) {
        uint32_t below = place(0, column, 0.15f);
        for (uint32_t row = 0; row < kRows; ++row) {
            const uint32_t above = place(row + 1, column, 0.15f + 0.1f * std::sin(0.4f * static_cast<float>(row)));
            addQuad(mesh, at(row, column), at(row + 1, column), above, below);
            below = above;
        }
    }
    return mesh;
}

/// Four walls, neither bottom nor lid, each of 2 x 2 quads.
void addCrate(Mesh& mesh, float x, float z, float size, float alternation)
{
    constexpr uint32_t kAround = 8, kLevels = 2;
    const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
    for (uint32_t level = 0; level <= kLevels; ++level)
        for (uint32_t i = 0; i < kAround; ++i) {
            const float angle = alternation + 2.0f * kPi * static_cast<float>(i) / kAround;
            const float reach = i % 2 ? size * 0.7071068f : size; // corners are farther out than middles of walls
            addVertex(mesh, x + reach * std::cos(angle), size * static_cast<float>(level) - 0.05f,
                      z + reach * std::sin(angle));
        }
    for (uint32_t level = 0; level < kLevels; ++level)
        for (uint32_t i = 0; i < kAround; ++i) {
            const uint32_t a = first + level * kAround + i, b = first + level * kAround + (i + 1) % kAround;
            addQuad(mesh, a, a + kAround, b + kAround, b);
        }
}

/// Two cards through one another, as plants are made of: all four halves share the edge in the middle.
void addCards(Mesh& mesh, float x, float z, float size, float alternation)
{
    const uint32_t low = addVertex(mesh, x, -0.05f, z), high = addVertex(mesh, x, 2.0f * size, z);
    for (int half = 0; half < 4; ++half) {
        const float angle = alternation + 0.5f * kPi * static_cast<float>(half);
        const float outX = x + size * std::cos(angle), outZ = z + size * std::sin(angle);
        addQuad(mesh, low, high, addVertex(mesh, outX, 2.0f * size, outZ), addVertex(mesh, outX, -0.05f, outZ));
    }
}

Mesh makeFloor()
{
    constexpr uint32_t kCells = 40, kCrates = 40, kCards = 40;
    constexpr float kHalf = 12.0f;
    Mesh mesh{.name = "floor", .colour = {0.55f, 0.6f, 0.55f}, .positions = {}, .indices = {}};
    for (uint32_t row = 0; row <= kCells; ++row)
        for (uint32_t column = 0; column <= kCells; ++column) {
            const float x = kHalf * (2.0f * static_cast<float>(column) / kCells - 1.0f);
            const float z = kHalf * (2.0f * static_cast<float>(row) / kCells - 1.0f);
            addVertex(mesh, x, 0.03f * std::sin(1.7f * x) * std::cos(1.3f * z), z);
        }
    for (uint32_t row = 0; row < kCells; ++row)
        for (uint32_t column = 0; column < kCells; ++column) {
            const uint32_t corner = row * (kCells + 1) + column;
            addQuad(mesh, corner, corner + kCells + 1, corner + kCells + 2, corner + 1);
        }
    // The golden angle spreads things evenly over a disc, whatever their number.
    for (uint32_t i = 0; i < kCrates + kCards; ++i) {
        const float angle = 2.3999632f * static_cast<float>(i);
        const float reach = 1.8f + 9.0f * std::sqrt(static_cast<float>(i) / (kCrates + kCards));
        const float size = 0.18f + 0.04f * static_cast<float>(i % 5);
        const auto add = i % 2 ? addCrate : addCards;
        add(mesh, reach * std::cos(angle), reach * std::sin(angle), size, 0.7f * angle);
    }
    return mesh;
}

/// A sheet that hangs and waves; a flap is sewn on along its middle row.
Mesh makeCloth()
{
    constexpr uint32_t kRows = 48, kColumns = 46;
    Mesh mesh{.name = "cloth", .colour = {0.75f, 0.35f, 0.3f}, .positions = {}, .indices = {}};
    const auto place = [&](uint32_t row, uint32_t column, float outward) {
        const float u = static_cast<float>(column) / kColumns, v = static_cast<float>(row) / kRows;
        const float wave = 0.25f * std::sin(14.0f * u) * (1.0f - 0.7f * v) + 0.1f * std::sin(9.0f * v + 5.0f * u);
        return addVertex(mesh, -4.5f + 5.0f * u, 0.4f + 3.4f * v - outward, -3.6f + wave + outward);
    };
    for (uint32_t row = 0; row <= kRows; ++row)
        for (uint32_t column = 0; column <= kColumns; ++column)
            place(row, column, 0.0f);
    const auto at = [](uint32_t row, uint32_t column) { return row * (kColumns + 1) + column; };
    for (uint32_t row = 0; row < kRows; ++row)
        for (uint32_t column = 0; column < kColumns; ++column)
            addQuad(mesh, at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column));
    uint32_t left = place(kRows / 2, 0, 0.35f);
    for (uint32_t column = 0; column < kColumns; ++column) {
        const uint32_t right = place(kRows / 2, column + 1, 0.35f);
        addQuad(mesh, at(kRows / 2, column), at(kRows / 2, column + 1), right, left);
        left = right;
    }
    return mesh;
}
} // namespace

std::array<Mesh, 3> makeMeshes()
{
    return {makeStatue(), makeFloor(), makeCloth()};
}

EdgeCount countEdges(const Mesh& mesh)
{
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> uses;
    for (size_t i = 0; i < mesh.indices.size(); i += 3)
        for (size_t side = 0; side < 3; ++side) {
            const uint32_t a = mesh.indices[i + side], b = mesh.indices[i + (side + 1) % 3];
            ++uses[std::minmax(a, b)];
        }
    EdgeCount result;
    for (const auto& [edge, count] : uses) {
        result.boundary += count == 1;
        result.nonManifold += count > 2;
    }
    return result;
}

std::array<Lamp, kLampCount> lampsAt(double seconds)
{
    constexpr Vec3 kColours[kLampCount] = {{1.0f, 0.85f, 0.6f}, {0.6f, 0.8f, 1.0f}, {1.0f, 0.55f, 0.4f},
                                           {0.6f, 1.0f, 0.7f},  {0.9f, 0.6f, 1.0f}, {1.0f, 1.0f, 0.8f}};
    std::array<Lamp, kLampCount> lamps;
    for (int i = 0; i < kLampCount; ++i) {
        const double speed = (0.25 + 0.12 * i) * (i % 2 ? -1.0 : 1.0); // radians a second, both ways round
        const double angle = 2.0 * 3.14159265358979 * i / kLampCount + speed * seconds;
        const double reach = 2.6 + 0.8 * i, height = 1.3 + 0.65 * ((i * 2) % kLampCount) + 0.2 * (i % 2);
        lamps[static_cast<size_t>(i)] = {{static_cast<float>(reach * std::cos(angle)), static_cast<float>(height),
                                          static_cast<float>(reach * std::sin(angle))},
                                         kColours[i],
                                         14.0f};
    }
    return lamps;
}
} // namespace stranger
