// The scene that calibration measures: a method that is exact must be able to be exact in it.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "demo/calibrate/sweep_scene.hpp"
#include "tests/demo/scene_analysis.hpp"

using namespace gnomon::demo;

namespace {

/// How often the surface goes around a point, counter-clockwise as seen from outside: its solid angle over 4 pi.
/// Source: A. van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng., 1983.
double windingNumber(const Mesh& mesh, const glm::dvec3& point)
{
    double angle = 0.0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto corner = [&](size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]) - point; };
        const glm::dvec3 a = corner(0), b = corner(1), c = corner(2);
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        angle += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                                  la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
    }
    return angle / (4.0 * 3.14159265358979323846);
}

} // namespace

TEST_CASE("casters of the calibration are closed, and nowhere inside out")
{
    // Where a surface is inside out, the host draws its far side, and a ray from there is blocked by what is not drawn:
    // volumes are counted wrong that are not.
    const Sweep sweep = makeSweep(1);
    std::mt19937 random(1);
    for (const Mesh& mesh : sweep.scene.meshes) {
        CAPTURE(mesh.name);
        CHECK(countEdges(mesh).closed());
        glm::vec3 lower(1e9f), upper(-1e9f);
        for (const glm::vec3& position : mesh.positions) {
            lower = glm::min(lower, position);
            upper = glm::max(upper, position);
        }
        const auto points = std::clamp<size_t>(size_t{4000000} / mesh.indices.size(), 100, 10000);
        double least = 0.0, most = 0.0;
        std::uniform_real_distribution<float> share(0.0f, 1.0f);
        for (size_t i = 0; i < points; ++i) {
            const glm::vec3 t(share(random), share(random), share(random));
            const double winding = windingNumber(mesh, lower + t * (upper - lower));
            least = std::min(least, winding);
            most = std::max(most, winding);
        }
        CHECK(least > -0.5);
        CHECK(most > 0.5);
    }
}
