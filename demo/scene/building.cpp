#include "demo/scene/primitives.hpp"

#include <array>

namespace gnomon::demo {
namespace {

// Of a bay and of a floor: the share that its window takes, and the sill's height.
constexpr float kWindowWidth = 0.55f, kWindowHeight = 0.5f, kSill = 0.28f;
constexpr float kParapetHeight = 0.9f;

/// Lines of the lattice along one axis. Cell i lies between lines i and i + 1.
using Lines = std::vector<float>;

/// From -half to half: the thickness of the wall, then piers and windows by turns, and the other wall. Cells of windows
/// are 2, 4, 6 and so on.
Lines bayLines(float half, float recess, uint32_t bays)
{
    Lines lines = {-half, -half + recess};
    const float bay = 2.0f * (half - recess) / float(bays), side = 0.5f * (1.0f - kWindowWidth) * bay;
    for (uint32_t i = 0; i < bays; ++i) {
        const float start = -half + recess + bay * float(i);
        lines.insert(lines.end(), {start + side, start + bay - side});
    }
    lines.insert(lines.end(), {half - recess, half});
    return lines;
}

/// From the ground up: sill and head of every floor's windows, roof and parapet. Cells of windows are 1, 3, 5 and so
/// on.
Lines floorLines(float storey, uint32_t floors)
{
    Lines lines = {0.0f};
    for (uint32_t i = 0; i < floors; ++i)
        lines.insert(lines.end(), {storey * (float(i) + kSill), storey * (float(i) + kSill + kWindowHeight)});
    const float roof = storey * float(floors);
    lines.insert(lines.end(), {roof, roof + kParapetHeight});
    return lines;
}

/// The boxes of a lattice that are full. Vertices are shared, so that the whole is closed.
class Blocks {
public:
    explicit Blocks(const BuildingShape& shape)
        : lines_{bayLines(0.5f * shape.width, shape.recess, shape.bays), floorLines(shape.storey, shape.floors),
                 bayLines(0.5f * shape.depth, shape.recess, shape.sideBays)}
    {
        for (size_t axis = 0; axis < 3; ++axis)
            cells_[axis] = static_cast<int>(lines_[axis].size()) - 1;
    }

    /// Calls for every side of a full cell whose neighbour is empty: the cell, the axis, and whether it is the upper
    /// side.
    template <typename Side>
    void forEachSide(Side side) const
    {
        for (int z = 0; z < cells_[2]; ++z)
            for (int y = 0; y < cells_[1]; ++y)
                for (int x = 0; x < cells_[0]; ++x)
                    for (int axis = 0; axis < 3; ++axis)
                        for (const bool upper : {false, true}) {
                            const Cell cell = {x, y, z};
                            Cell next = cell;
                            next[axis] += upper ? 1 : -1;
                            if (full(cell) && !full(next)) side(cell, axis, upper);
                        }
    }

    Mesh mesh() const
    {
        Mesh mesh;
        std::vector<uint32_t> numbers((cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1), UINT32_MAX);
        const auto vertex = [&](const Cell& at) {
            uint32_t& number = numbers[(at[2] * (cells_[1] + 1) + at[1]) * (cells_[0] + 1) + at[0]];
            if (number == UINT32_MAX) {
                number = static_cast<uint32_t>(mesh.positions.size());
                mesh.positions.emplace_back(lines_[0][at[0]], lines_[1][at[1]], lines_[2][at[2]]);
            }
            return number;
        };
        forEachSide([&](const Cell& cell, int axis, bool upper) {
            // Counter-clockwise round the axis, so seen from its positive end.
            const int first = (axis + 1) % 3, second = (axis + 2) % 3;
            std::array<Cell, 4> at = {cell, cell, cell, cell};
            for (Cell& corner : at)
                corner[axis] += upper ? 1 : 0;
            at[1][first] += 1;
            at[2][first] += 1;
            at[2][second] += 1;
            at[3][second] += 1;
            const uint32_t a = vertex(at[0]), b = vertex(at[upper ? 1 : 3]), c = vertex(at[2]),
                           d = vertex(at[upper ? 3 : 1]);
            mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
        });
        return mesh;
    }

private:
    using Cell = std::array<int, 3>;

    bool full(const Cell& cell) const
    {
        for (size_t axis = 0; axis < 3; ++axis)
            if (cell[axis] < 0 || cell[axis] >= cells_[axis]) return false;
        const auto [x, y, z] = cell;
        const bool outX = x == 0 || x == cells_[0] - 1, outZ = z == 0 || z == cells_[2] - 1;
        if (y == cells_[1] - 1) return outX || outZ; // the parapet
        const bool windowX = x >= 2 && x < cells_[0] - 2 && x % 2 == 0,
                   windowZ = z >= 2 && z < cells_[2] - 2 && z % 2 == 0;
        return y % 2 == 0 || !((outX && windowZ) || (outZ && windowX));
    }

    std::array<Lines, 3> lines_;
    std::array<int, 3> cells_{};
};

} // namespace

Mesh makeBuilding(const BuildingShape& shape)
{
    return Blocks(shape).mesh();
}

uint64_t triangleCount(const BuildingShape& shape)
{
    // Sides of cells, front by front: those of a plain block, four more for each window, the parapet's inner walls.
    const uint64_t x = 2ull * shape.bays + 3, y = 2ull * shape.floors + 2, z = 2ull * shape.sideBays + 3;
    const uint64_t windows = 2ull * shape.floors * (shape.bays + shape.sideBays);
    const uint64_t inner = 2 * (x - 2 + z - 2);
    return 2 * (2 * (x * y + y * z + x * z) + 4 * windows + inner);
}

} // namespace gnomon::demo
