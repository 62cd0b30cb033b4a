// Receivers that a warp counts in a light's map: none is lost or counted twice, and each is in its cell.
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "algorithms/maps_fixture.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "device/warp_tables.hpp"
#include "shaders/warped_importance_comp.h"

namespace gnomon::test {
namespace {

constexpr uint32_t kWidth = 203, kHeight = 117; // no multiples of what an invocation and a workgroup look at
constexpr uint32_t kSide = 300;                 // texels: 64 cells

/// What a view sees: hills, sky behind them, and surfaces turned this way and that.
struct Seen {
    std::vector<float> depth;
    std::vector<glm::vec4> normals;
};

Seen seenBy(Random& random)
{
    Seen seen;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const float linear = 6.0f + 4.0f * std::sin(0.05f * float(x)) + 0.03f * float(kHeight - y);
            seen.depth.push_back(y < 20 ? 0.0f : 0.1f / linear); // reversed, near plane at 0.1 m; 0: sky
            seen.normals.emplace_back(random.unit(), 0.0f);
        }
    return seen;
}

/// Cells by the light's matrix in double precision.
std::vector<uint32_t> countsOf(const Seen& seen, const CameraView& view, const LightView& light, const LightFit& fit,
                               uint32_t cells)
{
    std::vector<uint32_t> counts(size_t{cells} * cells);
    const glm::dmat4 clipFromWorld(fit.clipFromWorld);
    for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
        if (seen.depth[i] == 0.0f) continue;
        const gpu::ViewConstants& c = view.constants;
        const glm::dvec3 ray = glm::dvec3(c.rayCornerWs) + (i % kWidth + 0.5) * glm::dvec3(c.rayDxWs) +
                               (i / kWidth + 0.5) * glm::dvec3(c.rayDyWs);
        const glm::dvec3 at = glm::dvec3(view.eye) + 0.1 / double(seen.depth[i]) * ray;
        const bool sun = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
        const glm::dvec3 away = sun ? glm::dvec3(light.direction()) : at - glm::dvec3(light.position());
        if (!(glm::dot(glm::dvec3(seen.normals[i]), away) < 0.0)) continue;
        if (!sun && (glm::length(away) > double(light.constants.range) ||
                     glm::dot(glm::normalize(away), glm::dvec3(light.direction())) < std::cos(double(light.coneAngle))))
            continue;
        const glm::dvec4 clip = clipFromWorld * glm::dvec4(at, 1.0);
        const glm::dvec2 place = 0.5 + 0.5 * glm::dvec2(clip) / clip.w;
        if (!(clip.w > 0.0 && place.x >= 0.0 && place.x < 1.0 && place.y >= 0.0 && place.y < 1.0)) continue;
        ++counts[static_cast<size_t>(place.y * cells) * cells + static_cast<size_t>(place.x * cells)];
    }
    return counts;
}

std::vector<uint32_t> countedOnDevice(const Seen& seen, const gpu::MapConstants& map, uint32_t cells)
{
    demo::Buffer constants =
        demo::makeBuffer(device(), sizeof(gpu::WarpConstants), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, true);
    gpu::WarpConstants& warp = constants.as<gpu::WarpConstants>()[0];
    warp = {};
    warp.base = map;
    warp.pixels = {0, 0, kWidth, kHeight};
    warp.maps = 1;
    const demo::Buffer counts = bufferOf(std::vector<uint32_t>(size_t{cells} * cells)), depth = bufferOf(seen.depth),
                       normals = bufferOf(seen.normals);
    run({{.code = k_warped_importance_comp,
          .buffers = {{0, &constants}, {1, &counts}},
          .x = (kWidth + 31) / 32,
          .y = (kHeight + 31) / 32,
          .images = {{2, VK_FORMAT_R32_SFLOAT, {kWidth, kHeight}, &depth},
                     {3, VK_FORMAT_R32G32B32A32_SFLOAT, {kWidth, kHeight}, &normals}}}});
    const std::span<const uint32_t> all = counts.as<uint32_t>();
    return {all.begin(), all.end()};
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "every receiver that the light reaches and that faces it is counted once, in its cell")
{
    Random random;
    const CameraView view =
        camera({0.0f, 2.0f, 0.0f}, glm::normalize(glm::vec3(0.1f, -0.1f, -1.0f)), 0.5f, kWidth, kHeight);
    const Seen seen = seenBy(random);
    const uint32_t cells = gpu::warpCells(kSide);
    for (const bool spot : {false, true}) {
        CAPTURE(spot);
        const LightView lamp = light(spot ? GN_LIGHT_TYPE_SPOT : GN_LIGHT_TYPE_DIRECTIONAL, {2.0f, 7.0f, 1.0f},
                                     glm::normalize(glm::vec3(-0.3f, -0.6f, -0.9f)), spot ? 14.0f : 1e30f, 0.5f);
        const Aabb casters{{-4.0f, 0.0f, -9.0f}, {4.0f, 3.0f, -4.0f}}; // a sun's map ends where they do
        const LightFit fit = spot ? fitSpot(lamp, casters, kSide, 4.0f) : fitDirectional(lamp, casters);
        const LightCasters none{};
        ShadowTask task;
        task.view = &view;
        task.light = &lamp;
        task.casters = &none;
        gpu::MapConstants constants = mapConstants(task, kSide, 1);
        addProjection(constants, fit, task);
        const std::vector<uint32_t> is = countedOnDevice(seen, constants, cells);
        const std::vector<uint32_t> wanted = countsOf(seen, view, lamp, fit, cells);
        const auto sum = [](const std::vector<uint32_t>& counts) {
            return std::accumulate(counts.begin(), counts.end(), int64_t{0});
        };
        int64_t apart = 0; // those that rounding takes to the cell beside
        for (size_t i = 0; i < is.size(); ++i)
            apart += std::abs(int64_t{is[i]} - int64_t{wanted[i]});
        MESSAGE(sum(is) << " receivers counted, " << sum(wanted) << " wanted, cells apart by " << apart);
        CHECK(sum(wanted) > 2000);
        CHECK(std::abs(sum(is) - sum(wanted)) <= 2); // at the border of a cone or a map
        CHECK(apart <= 20);
    }
}

} // namespace gnomon::test
