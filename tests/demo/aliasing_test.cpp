// The measure of aliasing, against texels whose corners are projected onto a surface and from there to the picture.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "demo/program/aliasing.hpp"

using namespace gnomon::demo;

namespace {

constexpr double kWidth = 640.0, kHeight = 360.0, kSide = 1024.0;

glm::dmat4 looking(const glm::dvec3& from, const glm::dvec3& to, const glm::dmat4& projection)
{
    return projection * glm::lookAtRH(from, to, glm::dvec3(0.1, 1.0, 0.2));
}

/// Where the ray of a sample meets the plane through `at`.
glm::dvec3 onPlane(const glm::dmat4& worldFromSamples, const glm::dvec2& sample, const glm::dvec3& at,
                   const glm::dvec3& normal)
{
    const auto point = [&](double z) {
        const glm::dvec4 p = worldFromSamples * glm::dvec4(sample, z, 1.0);
        return glm::dvec3(p) / p.w;
    };
    const glm::dvec3 from = point(0.3), way = point(0.7) - from;
    return from + way * (glm::dot(at - from, normal) / glm::dot(way, normal));
}

glm::dvec2 projected(const glm::dmat4& samplesFromWorld, const glm::dvec3& at)
{
    const glm::dvec4 clip = samplesFromWorld * glm::dvec4(at, 1.0);
    return glm::dvec2(clip) / clip.w;
}

/// The root of how many pixels the texel around `at` covers.
double footprint(const glm::dmat4& texels, const glm::dmat4& pixels, const glm::dvec3& at, const glm::dvec3& normal)
{
    const glm::dvec2 middle = projected(texels, at);
    const glm::dmat4 back = glm::inverse(texels);
    std::array<glm::dvec2, 4> corners;
    const glm::dvec2 around[4] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    for (size_t i = 0; i < 4; ++i)
        corners[i] = projected(pixels, onPlane(back, middle + around[i], at, normal));
    double area = 0.0;
    for (size_t i = 0; i < 4; ++i) {
        const glm::dvec2 a = corners[i] - corners[0], b = corners[(i + 1) % 4] - corners[0];
        area += 0.5 * (a.x * b.y - a.y * b.x);
    }
    return std::sqrt(std::fabs(area));
}

} // namespace

TEST_CASE("predicted widths of texels are those of their footprints on the screen within 5 %")
{
    const glm::dvec3 eye(0.0, 2.0, 8.0);
    const glm::dmat4 pixels = samplesFromClip(kWidth, kHeight) *
                              looking(eye, glm::dvec3(0.0), glm::perspectiveRH_ZO(0.8, kWidth / kHeight, 0.1, 100.0));
    const glm::dmat4 spot = looking({4.0, 7.0, 3.0}, glm::dvec3(0.0), glm::perspectiveRH_ZO(1.2, 1.0, 0.5, 40.0));
    const glm::dmat4 sun = looking({5.0, 9.0, 2.0}, glm::dvec3(0.0), glm::orthoRH_ZO(-9.0, 9.0, -9.0, 9.0, 0.1, 40.0));
    glm::dmat4 trapezoid(1.0); // clip w goes with y: texels are dense at one side
    trapezoid[1][3] = 0.6;
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const auto& [name, clip] :
         {std::pair{"spot", spot}, {"sun", sun}, {"warped sun", trapezoid * sun}, {"warped spot", trapezoid * spot}}) {
        const std::string what = name; // clang 14 captures no binding
        CAPTURE(what);
        const glm::dmat4 texels = samplesFromClip(kSide, kSide) * clip;
        double worst = 0.0, least = 1e9, most = 0.0;
        uint32_t asked = 0;
        for (int i = 0; i < 5'000; ++i) {
            const glm::dvec3 at = 3.0 * glm::dvec3(unit(random), unit(random), unit(random));
            const glm::dvec3 normal = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)));
            const glm::dvec3 light = beamAt(texels, at), view = beamAt(pixels, at);
            // Grazing, a texel reaches so far that its footprint is no parallelogram.
            if (std::fabs(glm::dot(normal, glm::normalize(light))) < 0.1) continue;
            if (std::fabs(glm::dot(normal, glm::normalize(view))) < 0.1) continue;
            const double predicted = aliasingOf(light, view, normal), measured = footprint(texels, pixels, at, normal);
            worst = std::max(worst, std::fabs(predicted / measured - 1.0));
            least = std::min(least, measured);
            most = std::max(most, measured);
            ++asked;
        }
        MESSAGE(what << ": " << asked << " places, texels from " << least << " to " << most
                     << " pixels, off by at most " << 100.0 * worst << " %");
        CHECK(asked > 2'000);
        CHECK(most > 2.0 * least);
        CHECK(worst <= 0.05);
    }
}
