// Tables of warps as the device makes them, against sums in double precision that are written down as the theses have
// them: from random importance, and from what breaks tables.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <glm/vec2.hpp>

#include "device/warp_tables.hpp"

namespace gnomon::test {
namespace {

constexpr uint32_t kBins = gpu::WARP_BINS;
constexpr uint32_t kProbes = 100'000;

// --- what is asked ---

struct Case {
    const char* name;
    std::function<uint32_t(uint32_t x, uint32_t y, uint32_t cells, std::mt19937& random)> count;
};

const Case kCases[] = {
    {"nothing", [](uint32_t, uint32_t, uint32_t, std::mt19937&) { return 0u; }},
    {"one receiver",
     [](uint32_t x, uint32_t y, uint32_t cells, std::mt19937&) { return x == cells / 2 + 13 && y == 3 ? 1u : 0u; }},
    {"all in one cell",
     [](uint32_t x, uint32_t y, uint32_t cells, std::mt19937&) { return x == 0 && y == cells - 1 ? 33'177'600u : 0u; }},
    {"even", [](uint32_t, uint32_t, uint32_t, std::mt19937&) { return 50u; }},
    {"random",
     [](uint32_t, uint32_t, uint32_t, std::mt19937& random) { return static_cast<uint32_t>(random() % 100); }},
    {"sparse",
     [](uint32_t, uint32_t, uint32_t, std::mt19937& random) { return random() % 50 == 0 ? random() % 5000 : 0u; }},
    {"a diagonal", [](uint32_t x, uint32_t y, uint32_t cells,
                      std::mt19937& random) { return x + y == cells ? random() % 1000 : 0u; }},
};

/// Running sums: what lies before each edge, of all that lies there, with a share spread evenly.
std::vector<double> edgesOf(const std::vector<double>& importance, double even)
{
    const auto n = importance.size();
    double total = 0.0;
    for (const double value : importance)
        total += value;
    std::vector<double> edges(n + 1);
    for (size_t k = 0; k <= n; ++k) {
        double before = 0.0;
        for (size_t i = 0; i < k; ++i)
            before += importance[i];
        const double flat = double(k) / double(n);
        edges[k] = total > 0.0 ? (before / total + even * flat) / (1.0 + even) : flat;
    }
    return edges;
}

double tentOf(int distance, int radius)
{
    return std::max(0, radius + 1 - std::abs(distance));
}

Grid functionsOf(const Grid& counts, double even, int radius)
{
    Grid edges;
    std::vector<double> weights;
    for (const std::vector<double>& row : counts) {
        edges.push_back(edgesOf(row, even));
        double sum = 0.0;
        for (const double value : row)
            sum += value;
        weights.push_back(sum);
    }
    const auto cells = int(counts.size());
    Grid smooth(counts.size(), std::vector<double>(counts.size() + 1));
    for (int row = 0; row < cells; ++row) {
        for (size_t k = 0; k <= counts.size(); ++k) {
            double sum = 0.0, weight = 0.0;
            for (int other = 0; other < cells; ++other) {
                const double w = tentOf(other - row, radius) * weights[size_t(other)];
                sum += w * edges[size_t(other)][k];
                weight += w;
            }
            smooth[size_t(row)][k] = weight > 0.0 ? sum / weight : double(k) / cells;
        }
    }
    return smooth;
}

/// Cells spread over the columns they come to lie in, by the overlap of every cell with every column.
Grid recounted(const Grid& counts, const Grid& rows)
{
    const size_t cells = counts.size();
    Grid result(cells, std::vector<double>(cells));
    for (size_t row = 0; row < cells; ++row)
        for (size_t cell = 0; cell < cells; ++cell) {
            const double begin = rows[row][cell], end = rows[row][cell + 1];
            for (size_t column = 0; column < cells; ++column) {
                const double overlap = std::min(end, (double(column) + 1.0) / double(cells)) -
                                       std::max(begin, double(column) / double(cells));
                if (overlap > 0.0) result[column][row] += counts[row][cell] * overlap / (end - begin);
            }
        }
    return result;
}

/// Where functions, and what lies between them, have the middles of texels.
class Places {
public:
    Places(Grid functions, double side) : functions_(std::move(functions)), side_(side) {}

    /// \param across 0..1, the middle of a function is whole
    double at(double across, double texel) const
    {
        const double last = double(functions_.size()) - 1.0;
        const double q = std::clamp(across * double(functions_.size()) - 0.5, 0.0, last);
        const double before = std::floor(q), after = std::min(before + 1.0, last);
        return std::lerp(inverse(size_t(before), texel), inverse(size_t(after), texel), q - before);
    }
    /// How far a place lies beside all that is between the middles of a texel's neighbours.
    double beside(double across, double place, double texel) const
    {
        const double before = texel > 0.0 ? at(across, texel - 1.0) : 0.0;
        const double after = texel < side_ - 1.0 ? at(across, texel + 1.0) : 1.0;
        return std::max({before - place, place - after, 0.0});
    }

private:
    double inverse(size_t function, double texel) const
    {
        const std::vector<double>& edges = functions_[function];
        const double wanted = (texel + 0.5) / side_;
        size_t k = 0;
        while (k + 2 < edges.size() && edges[k + 1] <= wanted)
            ++k;
        return (double(k) + (wanted - edges[k]) / (edges[k + 1] - edges[k])) / double(functions_.size());
    }
    Grid functions_;
    double side_;
};

std::vector<glm::vec2> probes(std::mt19937& random)
{
    std::uniform_real_distribution<float> place(0.0f, 1.0f);
    std::vector<glm::vec2> all;
    for (uint32_t i = 0; i < kProbes; ++i)
        all.emplace_back(place(random), place(random));
    all[0] = {0.0f, 0.0f};
    all[1] = {1.0f, 1.0f};
    all[2] = {0.0f, 1.0f};
    return all;
}

bool rises(std::span<const float> edges)
{
    for (size_t i = 1; i < edges.size(); ++i)
        if (!(edges[i] > edges[i - 1])) return false;
    return std::fabs(edges.front()) <= 1e-6f && std::fabs(edges.back() - 1.0f) <= 1e-6f;
}

/// Texels and places between functions, as the device has them, against its own functions.
void checkPlaces(const NonorthogonalTables& made, const std::vector<glm::vec2>& asked, double side,
                 const std::string& name, double most)
{
    const Places rows(made.functions(0), side), columns(made.functions(1), side);
    double placeError = 0.0, beside = 0.0, farthest = 0.0;
    uint32_t others = 0; // texels whose own place is said to be another's
    for (uint32_t i = 0; i < kProbes; ++i) {
        const glm::dvec2 at(asked[i]),
            texel(glm::min(glm::floor(asked[i] * float(side)), glm::vec2(float(side) - 1.0f)));
        const glm::vec4 first = made.answers[2 * i], second = made.answers[2 * i + 1];
        const glm::dvec2 from(first.x, first.y), nearest(first.z, first.w);
        const double y = columns.at((texel.x + 0.5) / side, texel.y), x = rows.at(y, texel.x);
        placeError = std::max(placeError, glm::length(from - glm::dvec2(x, y)));
        beside = std::max(
            {beside, rows.beside(at.y, at.x, nearest.x), columns.beside((nearest.x + 0.5) / side, at.y, nearest.y)});
        others += glm::dvec2(second.x, second.y) != texel;
        farthest = std::max(farthest, glm::length(from - (texel + 0.5) / side));
    }
    CHECK(placeError <= most);
    CHECK(beside <= 1e-6);
    CHECK(others == 0);
    if (name == "even")
        CHECK(farthest <= 1e-5);
    else if (name == "all in one cell")
        CHECK(farthest > 0.3);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "tables of non-orthogonal warps are those of double precision, rise, and have an inverse")
{
    std::mt19937 random(7);
    const std::vector<glm::vec2> asked = probes(random);
    uint32_t map = 0;
    for (const Case& wanted : kCases) {
        for (const auto& [even, radius, side] : {std::tuple{0.25f, 8.0f, 512.0f}, std::tuple{0.06f, 0.0f, 300.0f},
                                                 std::tuple{1.0f, 32.0f, 1000.0f}, std::tuple{0.1f, 3.0f, 128.0f}}) {
            const std::string what =
                std::string(wanted.name) + ", " + std::to_string(side); // clang 14 captures no binding
            CAPTURE(what);
            const uint32_t cells = gpu::warpCells(side);
            std::vector<uint32_t> counts(cells * cells);
            Grid grid(cells, std::vector<double>(cells));
            for (uint32_t y = 0; y < cells; ++y)
                for (uint32_t x = 0; x < cells; ++x)
                    grid[y][x] = counts[y * cells + x] = wanted.count(x, y, cells, random);
            const NonorthogonalTables made = nonorthogonalOf(
                {.map = map++ % gpu::WARP_MAPS, .side = side, .blur = radius, .even = even}, counts, asked);
            const bool any = std::ranges::any_of(counts, [](uint32_t count) { return count > 0; });
            CHECK(made.tables[made.is.seen] == (any ? 1.0f : 0.0f));
            const Grid rows = functionsOf(grid, even, int(radius));
            const Grid columns = functionsOf(recounted(grid, rows), even, int(radius));
            double tableError = 0.0;
            uint32_t falling = 0;
            for (uint32_t kind = 0; any && kind < 2; ++kind)
                for (uint32_t f = 0; f < cells; ++f) {
                    const std::span<const float> edges = made.function(kind, f);
                    falling += !rises(edges);
                    const std::vector<double>& wantedEdges = (kind == 0 ? rows : columns)[f];
                    for (uint32_t k = 0; k < made.is.edges; ++k)
                        tableError = std::max(tableError, std::fabs(double(edges[k]) - wantedEdges[k]));
                }
            CHECK(falling == 0);
            // Without smoothing functions are up to a hundred times as steep as they are flat elsewhere.
            const double most = radius == 0.0f ? 5e-5 : 1e-5;
            CHECK(tableError <= most);
            if (any) checkPlaces(made, asked, double(side), wanted.name, 10.0 * most);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "bounds of blocks of 2, 4, ... functions are the least and the greatest of theirs")
{
    std::mt19937 random(3);
    for (const float side : {128.0f, 512.0f}) {
        const uint32_t cells = gpu::warpCells(side);
        std::vector<uint32_t> counts(size_t{cells} * cells);
        for (uint32_t& count : counts)
            count = random() % 9 == 0 ? static_cast<uint32_t>(random() % 999) : 0u;
        const NonorthogonalTables made =
            nonorthogonalOf({.map = 2, .side = side, .blur = 2.0f, .even = 0.25f}, counts, probes(random));
        uint32_t block = 0; // of all sizes, the smallest first
        for (uint32_t size = 2; size < cells; size *= 2)
            for (uint32_t first = 0; first < cells; first += size, ++block)
                for (uint32_t kind = 0; kind < 2; ++kind)
                    for (uint32_t k = 0; k < made.is.edges; ++k) {
                        float least = 2.0f, greatest = -1.0f;
                        for (uint32_t f = first; f < first + size; ++f) {
                            least = std::min(least, made.function(kind, f)[k]);
                            greatest = std::max(greatest, made.function(kind, f)[k]);
                        }
                        const uint32_t at = made.is.bounds + (2 * kind * made.is.blocks + block) * made.is.edges + k;
                        REQUIRE(made.tables[at] == least);
                        REQUIRE(made.tables[at + made.is.blocks * made.is.edges] == greatest);
                    }
        CHECK(block == made.is.blocks);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "tables of rectilinear warps are those of double precision, rise, and have an inverse")
{
    std::mt19937 random(11);
    const std::vector<glm::vec2> asked = probes(random);
    constexpr float kNot = std::numeric_limits<float>::quiet_NaN();
    const std::pair<const char*, std::function<float(uint32_t)>> cases[] = {
        {"nothing", [](uint32_t) { return 0.0f; }},
        {"one", [](uint32_t bin) { return bin == 511 ? 1e-3f : 0.0f; }},
        {"even", [](uint32_t) { return 0.25f; }},
        {"random", [&](uint32_t) { return float(random() % 1000) / 100.0f; }},
        {"far and near", [&](uint32_t bin) { return bin % 7 ? 0.0f : std::pow(10.0f, float(random() % 8) - 4.0f); }},
        {"what is no number", [&](uint32_t bin) { return bin % 5   ? float(bin)
                                                         : bin % 2 ? kNot
                                                                   : HUGE_VALF; }},
    };
    uint32_t next = 0;
    for (const auto& [name, value] : cases) {
        for (const auto& [sums, power] : {std::pair{false, 1.0f}, {true, 0.5f}, {true, 0.0f}}) {
            for (const auto& [even, radius, side] :
                 {std::tuple{0.05f, 2.0f, 512.0f}, std::tuple{0.001f, 0.0f, 64.0f}, std::tuple{1.0f, 64.0f, 1000.0f}}) {
                const std::string what = std::string(name) + ", " + std::to_string(side);
                CAPTURE(what);
                std::vector<uint32_t> importance;
                Grid numbers(2);
                for (uint32_t i = 0; i < 2 * kBins; ++i) {
                    const float is = value(i % kBins);
                    const double counts = is > 0.0f && is < 1e30f ? double(is) : 0.0;
                    const auto sum = static_cast<uint32_t>(1000.0 * counts);
                    importance.push_back(sums ? sum : std::bit_cast<uint32_t>(is));
                    const double number = sums ? double(sum) : counts;
                    numbers[i / kBins].push_back(number > 0.0 ? std::pow(number, double(power)) : 0.0);
                }
                const auto [table, answers] = rectilinearOf({.map = next++ % gpu::WARP_MAPS,
                                                             .side = side,
                                                             .blur = radius,
                                                             .even = even,
                                                             .power = power,
                                                             .mostWeight = sums},
                                                            importance, asked);
                double counted = 0.0;
                for (const double number : numbers[0])
                    counted += number;
                CHECK(table[gpu::rectilinearSeen(side)] == (counted > 0.0 ? 1.0f : 0.0f));
                std::vector<double> truth[2];
                for (int axis = 0; axis < 2; ++axis) {
                    std::vector<double> blurred(kBins);
                    for (int bin = 0; bin < int(kBins); ++bin)
                        for (int other = 0; other < int(kBins); ++other)
                            blurred[size_t(bin)] +=
                                tentOf(other - bin, int(radius)) * numbers[size_t(axis)][size_t(other)];
                    truth[axis] = edgesOf(blurred, even);
                    const std::span<const float> edges(&table[size_t(axis) * gpu::WARP_BIN_EDGES], gpu::WARP_BIN_EDGES);
                    CHECK(rises(edges));
                    double error = 0.0;
                    for (size_t k = 0; k <= kBins; ++k)
                        error = std::max(error, std::fabs(double(edges[k]) - truth[axis][k]));
                    CHECK(error <= 1e-5);
                }
                const auto warped = [&](int axis, double at) {
                    const double k = at * kBins;
                    const auto edge = std::min(static_cast<size_t>(k), size_t(kBins) - 1);
                    return truth[axis][edge] + (truth[axis][edge + 1] - truth[axis][edge]) * (k - double(edge));
                };
                double placeError = 0.0, inverseError = 0.0;
                for (uint32_t i = 0; i < kProbes; ++i) {
                    const glm::dvec4 answer(answers[i]);
                    for (int axis = 0; axis < 2; ++axis) {
                        placeError =
                            std::max(placeError, std::fabs(answer[axis] - warped(axis, double(asked[i][axis]))));
                        const double texel = std::min(std::floor(double(asked[i][axis] * side)), double(side) - 1.0);
                        inverseError = std::max(
                            inverseError, std::fabs(warped(axis, answer[axis + 2]) - (texel + 0.5) / double(side)));
                    }
                }
                CHECK(placeError <= 1e-5);
                CHECK(inverseError <= 1e-4);
            }
        }
    }
}

} // namespace gnomon::test
