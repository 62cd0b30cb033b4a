#include "exactness/soft_reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <glm/geometric.hpp>

namespace gnomon::exact {
namespace {

constexpr uint32_t kStrata = 16; // a side: 256 rays

/// A number in [0, 1) of its own for every pixel, stratum and axis.
double jitter(uint32_t pixel, uint32_t stratum, uint32_t axis)
{
    uint64_t h = (uint64_t(pixel) << 32 | stratum << 1 | axis) + 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebull;
    return double((h ^ (h >> 31)) >> 11) * 0x1p-53;
}

/// From the unit square to the unit disc, equal areas to equal areas.
glm::dvec2 onDisc(double u, double v)
{
    const double radius = std::sqrt(u), angle = 2.0 * std::numbers::pi * v;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Half axes of what shines; the square from -1 to 1 of them, or the disc in that.
struct Source {
    glm::dvec3 x, y;
    bool square = false;
};

Source sourceOf(const demo::Light& light, const glm::dvec3& towards)
{
    if (light.rectangle.x > 0.0f) {
        const RectangleAxes axes = rectangleAxes(light);
        return {axes.x, axes.y, true};
    }
    const auto size = static_cast<double>(light.radius);
    const glm::dvec3 looksTo = light.disc ? light.direction : towards;
    const double radius = light.kind == demo::LightKind::Directional ? std::tan(size) : size; // its radius is an angle
    const glm::dvec3 axis = glm::normalize(looksTo);
    const glm::dvec3 helper = std::abs(axis.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, axis));
    return {radius * x, radius * glm::cross(axis, x)};
}

/// \param towards The source's centre from the origin; \param end of the rays, in parts of them.
double shareSeen(const brute::Scene& casters, const glm::dvec3& origin, const glm::dvec3& towards, const Source& source,
                 double end, uint32_t pixel)
{
    uint32_t seen = 0;
    for (uint32_t i = 0; i < kStrata * kStrata; ++i) {
        const glm::dvec2 unit((i % kStrata + jitter(pixel, i, 0)) / kStrata,
                              (i / kStrata + jitter(pixel, i, 1)) / kStrata);
        const glm::dvec2 at = source.square ? 2.0 * unit - 1.0 : onDisc(unit.x, unit.y);
        seen += !casters.blocked(origin, towards + at.x * source.x + at.y * source.y, end);
    }
    return double(seen) / (kStrata * kStrata);
}

} // namespace

RectangleAxes rectangleAxes(const demo::Light& light)
{
    const glm::dvec3 across = light.rectangleAxis - light.direction * glm::dot(light.rectangleAxis, light.direction);
    const glm::dvec3 x = glm::normalize(across);
    return {double(light.rectangle.x) * x, double(light.rectangle.y) * glm::cross(x, light.direction)};
}

SoftTruth softTruth(const Stage& stage, size_t layer, const brute::Scene& casters)
{
    const brute::View view = bruteView(stage);
    const brute::Light light = bruteLight(stage, layer);
    const bool sun = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const double end = sun ? HUGE_VAL : 1.0;
    const demo::Light& described = stage.scene().lights[stage.present[layer]];
    SoftTruth truth;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const auto px = static_cast<uint32_t>(x), py = static_cast<uint32_t>(y);
            const glm::dvec3 normal = drawnNormal(stage, px, py);
            const brute::Answer answer =
                brute::answerAt(view, light, casters, x, y, *stage.surfaces.depth.at(px, py), normal);
            const bool asked = answer.state == brute::State::asked;
            const glm::dvec3 origin = answer.receiver + normal * (answer.offset / glm::length(normal));
            truth.asked.push_back(asked && !answer.grazing);
            const glm::dvec3 towards = sun ? -glm::normalize(light.direction) : light.position - origin;
            truth.visibility.push_back(asked ? shareSeen(casters, origin, towards, sourceOf(described, towards), end,
                                                         static_cast<uint32_t>(y * view.width + x))
                                             : double(answer.lit));
        }
    }
    return truth;
}

std::vector<SoftTruth> softTruths(const Stage& stage)
{
    const brute::Scene casters(bruteTriangles(stage));
    std::vector<SoftTruth> truths;
    for (size_t layer = 0; layer < stage.present.size(); ++layer)
        truths.push_back(softTruth(stage, layer, casters));
    return truths;
}

std::vector<SoftTruth> tracedSoftTruths(Stage& stage, uint32_t samples, uint32_t seed, const std::string& method)
{
    const Pictures pictures = stage.draw(method, {{"samples", double(samples)}, {"seed", double(seed)}});
    std::vector<SoftTruth> truths(pictures.size());
    for (size_t layer = 0; layer < pictures.size(); ++layer) {
        for (size_t i = 0; i < pictures[layer].texels.size(); ++i) {
            truths[layer].visibility.push_back(pictures[layer].texels[i] / 255.0);
            truths[layer].asked.push_back(stage.counted[layer][i] == 1);
        }
    }
    return truths;
}

SoftError& SoftError::operator+=(const SoftError& other)
{
    demo::SoftError::operator+=(other);
    notAskedOff += other.notAskedOff;
    return *this;
}

SoftError compareSoft(const Image8& picture, const SoftTruth& truth)
{
    SoftError error;
    REQUIRE(picture.texels.size() == truth.visibility.size());
    for (size_t i = 0; i < truth.visibility.size(); ++i) {
        const double visibility = picture.texels[i] / 255.0, wanted = truth.visibility[i];
        if (truth.asked[i])
            error.add(visibility, wanted);
        else
            error.notAskedOff += std::abs(visibility - wanted) > 1.5 / 255.0 && (wanted == 0.0 || wanted == 1.0);
    }
    return error;
}

SoftError compareSoft(const Pictures& pictures, const std::vector<SoftTruth>& truths)
{
    SoftError sum;
    for (size_t layer = 0; layer < pictures.size(); ++layer)
        sum += compareSoft(pictures[layer], truths[layer]);
    return sum;
}

std::string inWords(const SoftError& error)
{
    char text[160];
    std::snprintf(text, sizeof text, "%.4f over %llu (worst %.2f), outside %.5f over %llu, wrong %llu", error.mean(),
                  static_cast<unsigned long long>(error.penumbra.pixels), error.penumbra.worst, error.outside.mean(),
                  static_cast<unsigned long long>(error.outside.pixels), static_cast<unsigned long long>(error.wrong));
    return text;
}

} // namespace gnomon::exact
