#include "algorithms/shared/source_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "algorithms/shared/source_size.hpp"

namespace gnomon {

namespace {

/// Multiples of these are spread evenly between whole numbers: of the golden ratio best of all; of the other, 1 / g^3
/// with g^4 = g + 1, in three dimensions beside others (M. Roberts, "The Unreasonable Effectiveness of Quasirandom
/// Sequences", 2018).
constexpr double kGolden = 0.6180339887498949, kBesideGolden = 0.5497004779019703;

float multipleOf(double of, std::uint32_t i)
{
    const double value = of * (i + 0.5);
    return static_cast<float>(value - std::floor(value));
}

} // namespace

glm::vec3 axisAcross(glm::vec3 direction)
{
    const glm::vec3 size = glm::abs(direction);
    if (size.x <= size.y && size.x <= size.z) return {1.0f, 0.0f, 0.0f};
    return size.y <= size.z ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(0.0f, 0.0f, 1.0f);
}

glm::vec2 discOfSquare(glm::vec2 square)
{
    if (square.x == 0.0f && square.y == 0.0f) return square;
    constexpr float eighth = std::numbers::pi_v<float> / 4.0f; // of a turn: from a side's middle to its corner
    const bool wide = std::fabs(square.x) > std::fabs(square.y);
    const float radius = wide ? square.x : square.y;
    const float angle = wide ? eighth * square.y / square.x : eighth * (2.0f - square.x / square.y);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

glm::vec2 spreadPoint(std::uint32_t i, std::uint32_t side)
{
    const auto n = static_cast<float>(side);
    const glm::vec2 cell(static_cast<float>(i % side), static_cast<float>(i / side));
    return 2.0f * (cell + (glm::vec2(cell.y, cell.x) + 0.5f) / n) / n - 1.0f;
}

glm::vec2 sunflowerPoint(std::uint32_t i, std::uint32_t count)
{
    const float radius = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
    const float angle = 2.0f * std::numbers::pi_v<float> * multipleOf(kGolden, i);
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

SourcePoint spreadOver(const LightView& light, std::uint32_t i, std::uint32_t side)
{
    if (light.rectangular()) return {.at = spreadPoint(i, side)};
    return {.at = sunflowerPoint(i, side * side), .height = multipleOf(kBesideGolden, i)};
}

SourcePoint pointAt(const LightView& light, glm::vec2 square, std::uint32_t i)
{
    if (light.rectangular()) return {.at = square};
    return {.at = discOfSquare(square), .height = multipleOf(kGolden, i)};
}

namespace {

/// From the light's centre. Spheres: a body of density 1 / sqrt(R^2 - r^2) covers the same disc evenly from all sides,
/// since its integral along any line through the sphere is pi. Along the line it is spread as the cosine of an angle.
glm::vec3 offsetOf(const LightView& light, SourcePoint place)
{
    if (light.flat()) return place.at.x * light.sourceX + place.at.y * light.sourceY;
    const bool point = light.type == GN_LIGHT_TYPE_POINT; // shines all ways
    const glm::vec3 along = point ? glm::vec3(0.0f, -1.0f, 0.0f) : light.direction();
    const glm::vec3 x = glm::normalize(glm::cross(along, axisAcross(along)));
    const glm::vec3 across = place.at.x * x + place.at.y * glm::cross(along, x);
    const float half = std::sqrt(std::max(1.0f - glm::dot(place.at, place.at), 0.0f));
    const bool sun = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const float height = sun ? 0.0f : half * std::cos(std::numbers::pi_v<float> * place.height);
    return discRadius(light) * (across + height * along);
}

} // namespace

LightView lightAt(const LightView& light, SourcePoint point, float nearest)
{
    LightView result = light;
    result.constants.sourceRadius = 0.0f;
    result.sourceX = result.sourceY = glm::vec3(0.0f);
    const glm::vec3 offset = offsetOf(light, point);
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        result.constants.directionWs =
            glm::vec4(glm::normalize(light.direction() - offset), light.constants.directionWs.w);
        return result;
    }
    result.constants.positionWs += glm::vec4(offset, 0.0f);
    if (!light.unlimited()) result.constants.range += glm::length(offset);
    if (light.type != GN_LIGHT_TYPE_SPOT) return result;
    // The rim of the cone at the nearest caster; closer than two radii a source has no shadows worth the texels.
    const float from = std::max(nearest * std::cos(light.coneAngle), 2.0f * light.sourceReach());
    const float along = glm::dot(offset, light.direction()), across = glm::length(offset - along * light.direction());
    result.coneAngle = std::atan((from * std::tan(light.coneAngle) + across) / (from - along));
    result.constants.directionWs.w = std::cos(result.coneAngle);
    return result;
}

} // namespace gnomon
