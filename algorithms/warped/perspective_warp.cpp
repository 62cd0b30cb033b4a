// Perspective shadow map and light-space perspective shadow map: the light's map is drawn through a perspective that
// follows the view's, so that its texels grow with distance from the eye as pixels do.
// Source:    M. Stamminger, G. Drettakis, "Perspective shadow maps", SIGGRAPH 2002; M. Wimmer, D. Scherzer,
//            W. Purgathofer, "Light space perspective shadow maps", EGSR 2004.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: views across the light over a long way.
// Weak at:   views along the light; cameras that move, since texels move with them.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/warped/warped_map.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kForm, kFit, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map.", 64, 8192, 1024, true},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
    {"form", "0: PSM, the perspective of the view; 1: LiSPSM, a weaker one across the light.", 0, 1, 1},
    {"fit", "1: the smallest rectangle around what is seen serves where it is finer.", 0, 1, 0},
    kContactSetting,
};

constexpr ViewMapNames kNames{
    "perspective_warp.depth",
    "perspective_warp.statics",
    "perspective_warp.stamp",
    {"perspective_warp.casters", "perspective_warp.statics", "perspective_warp.copy_statics"}};

double lengthAlong(const SeenPart& part)
{
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const glm::dvec2 p : part.hull.points()) {
        low = std::min(low, glm::dot(p, part.away));
        high = std::max(high, glm::dot(p, part.away));
    }
    return high - low;
}

/// Wimmer et al. 2004: the warp's centre lies (z_n + sqrt(z_n z_f)) / sin g before the near end of what is seen, g the
/// angle between view and light.
Warp lightSpaceWarp(const SeenPart& part)
{
    if (part.hull.count == 0 || part.sine == 0.0) return {};
    const double near = nearestReceiver(part), far = std::max(part.farthest, near);
    const double length = part.metres * lengthAlong(part);
    return {part.away, part.sine * length / (near + std::sqrt(near * far))};
}

/// The view's perspective, of linear depths near to far: what is seen becomes [-1, 1], [-1, 1], [0, 1].
glm::dmat4 viewPerspective(const CameraView& view, double near, double far)
{
    const glm::vec2 low(static_cast<float>(view.area.offset.x), static_cast<float>(view.area.offset.y));
    const glm::vec2 size(static_cast<float>(view.area.extent.width), static_cast<float>(view.area.extent.height));
    const glm::dvec3 middle(gpu::viewRayWs(view.constants, low + 0.5f * size)), axis(view.frustum[4].normal);
    const glm::dvec3 sides[2] = {glm::dvec3(view.constants.rayDxWs) * (0.5 * static_cast<double>(size.x)),
                                 glm::dvec3(view.constants.rayDyWs) * (0.5 * static_cast<double>(size.y))};
    const glm::dvec3 eye(view.eye);
    glm::dmat4 rows(0.0);
    for (int i = 0; i < 2; ++i) {
        const glm::dvec3 side = sides[i] / glm::dot(sides[i], sides[i]);
        const glm::dvec3 row = side - glm::dot(side, middle) * axis; // beside the middle's ray, of linear depth 1
        rows[i] = glm::dvec4(row, -glm::dot(row, eye));
    }
    rows[3] = glm::dvec4(axis, -glm::dot(axis, eye));
    rows[2] = rows[3] * (far / (far - near));
    rows[2].w -= near * far / (far - near);
    return glm::transpose(rows);
}

/// Stamminger and Drettakis 2002: the map is drawn after the view's perspective, from where that puts the light,
/// towards the middle of what the view sees. What is w there is linear over the light's plain map, too: along a ray of
/// the light all of it grows alike. So the warp is one of the plain map, casters behind the eye lie where what they
/// shade does, and depths keep their order wherever the light appears.
Warp viewWarp(const ShadowTask& task, const WarpSource& source)
{
    const SeenPart& part = source.part;
    if (part.hull.count == 0 || part.sine == 0.0) return {};
    const double near = nearestReceiver(part), far = std::max(part.farthest, 1.001 * near);
    const glm::dmat4 perspective = viewPerspective(*task.view, near, far);
    const bool directional = task.light->type == GN_LIGHT_TYPE_DIRECTIONAL;
    const glm::dvec4 light = perspective * (directional ? glm::dvec4(glm::dvec3(task.light->direction()), 0.0)
                                                        : glm::dvec4(glm::dvec3(task.light->position()), 1.0));
    // w as a function of the perspective's space: the distance along the light's camera, which looks at the middle.
    glm::dvec4 depth(0.0, 0.0, 0.0, 1.0);
    if (std::abs(light.w) > 1e-6 * glm::length(glm::dvec3(light))) {
        const glm::dvec3 at = glm::dvec3(light) / light.w;
        const glm::dvec3 way = glm::normalize(glm::dvec3(0.0, 0.0, 0.5) - at);
        depth = glm::dvec4(way, -glm::dot(way, at));
    }
    const glm::dvec4 world = glm::transpose(perspective) * depth;
    // The same of the plane's x, y and w: world = x rows[0] + y rows[1] + w rows[2].
    const MapPlane plane(*source.plain);
    glm::dmat3 gram(0.0);
    glm::dvec3 right(0.0);
    for (int i = 0; i < 3; ++i) {
        right[i] = glm::dot(plane.rows[i], world);
        for (int j = 0; j < 3; ++j)
            gram[i][j] = glm::dot(plane.rows[i], plane.rows[j]);
    }
    const glm::dvec3 w = glm::inverse(gram) * right;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const glm::dvec2 p : part.hull.points()) {
        const double value = glm::dot(w, glm::dvec3(p, 1.0));
        least = std::min(least, value);
        most = std::max(most, value);
    }
    const double slope = glm::length(glm::dvec2(w));
    if (most < 0.0) { // the light appears behind the view
        std::swap(least, most);
        least = -least;
        most = -most;
    }
    if (!(slope > 0.0) || !(least > 0.0)) return {}; // the light is within what is seen: it has no such camera
    const glm::dvec2 away = glm::dvec2(w) / (glm::dot(w, glm::dvec3(part.hull.corners[0], 1.0)) < 0.0 ? -slope : slope);
    return {away, most / least - 1.0};
}

class PerspectiveWarp final : public ShadowAlgorithm {
public:
    explicit PerspectiveWarp(const AlgorithmServices& services) : map_(services, "perspective_warp.resolve", kNames) {}

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const WarpSource source = map_.source(passes, task, resolution);
        const bool ofView = task.settings[kForm] < 0.5;
        const Warp warp = ofView ? viewWarp(task, source) : lightSpaceWarp(source.part);
        map_.declare(passes, task, source, warp,
                     {resolution, task.settings[kFilter], task.settings[kFit] >= 0.5, task.settings[kContact],
                      ofView ? 1.0 : 4.0});
    }

    const Map* lightMap() const override { return map_.lightMap(); }

private:
    WarpedMap map_;
};

} // namespace

constinit const AlgorithmEntry kPerspectiveWarp{
    .name = "perspective_warp",
    .source = "Stamminger and Drettakis 2002; Wimmer, Scherzer and Purgathofer 2004",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT |
              GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight = lightMapMemory,
    .create = makeAlgorithm<PerspectiveWarp>,
    .typicalWrongPercent = 0.54f,
    .followsView = true,
};

} // namespace gnomon
