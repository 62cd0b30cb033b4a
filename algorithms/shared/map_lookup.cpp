#include "algorithms/shared/map_lookup.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace gnomon {

namespace {

bool positional(const LightView& light)
{
    return light.type != GN_LIGHT_TYPE_DIRECTIONAL;
}

// raiseNearEnd(): the slack at the farthest caster, in texels there. A map does not know what lies within half a texel
// of its own edges; an eighth along the ray adds little to that: 0.0534 % wrong, where an end at 1/128 gives 0.0532
// (room, point lights, 4096 texels).
constexpr double kSlackTexels = 0.125;
// And the end in parts of the distance of the farthest caster: what maps of thousands of texels or of narrow cones
// would need is not worth the casters that would be clamped.
constexpr double kMostNearPerEnd = 1.0 / 128.0;
// Nor does it leave the lamp: a caster a kilometre away would clear metres around it of shadows. What that costs are
// texels of slack at casters so far away that a texel is metres wide.
constexpr double kMostNearWs = 0.1;

float largest(glm::vec3 v)
{
    const glm::vec3 size = glm::abs(v);
    return std::fmax(size.x, std::fmax(size.y, size.z));
}

/// Of the pixels drawn. Off the centre, one corner's is longer than the others'.
float longestViewRay(const CameraView& view)
{
    float longest = 0.0f;
    for (const std::uint32_t column : {0u, view.area.extent.width})
        for (const std::uint32_t row : {0u, view.area.extent.height}) {
            const glm::vec2 pixel(view.area.offset.x + static_cast<int>(column),
                                  view.area.offset.y + static_cast<int>(row));
            longest = std::fmax(longest, glm::length(gpu::viewRayWs(view.constants, pixel)));
        }
    return longest;
}

// Offset of receivers along their normal, an upper bound of receiverOffset() (shaders/shared/receiver.h) as a
// polynomial of the linear depth w: x + w (y + w z). Coordinates count from the frame's origin, where casters are
// drawn. A map does not tell a receiver's own triangle from others, as rays do: edges of any length count.
glm::vec4 receiverOffset(const ShadowTask& task)
{
    const CameraView& view = *task.view;
    const LightView& light = *task.light;
    const gpu::ViewConstants& c = view.constants;
    float edge = 0.0f;
    if (task.casters)
        for (const Caster* caster : task.casters->all)
            edge = std::fmax(edge, caster->longestEdge);
    const float ray = longestViewRay(view) + glm::length(glm::vec3(c.rayDepthWs));
    const float lamp = positional(light) ? largest(light.position()) : 0.0f;
    const float where = std::fmax(std::fmax(largest(view.eye), lamp), std::fmax(c.corners, 0.25f * edge));
    const float coordinate = 0x1p-21f;
    // One unit in the last place of a depth: reversed, a constant share of w; standard, w^2 of the unit near 1. Of
    // integers it is the same everywhere; without a perspective it is what they span.
    const float farthest = ray * std::fabs(c.depthMul / c.depthScale);
    const float spanned = glm::length(glm::vec3(c.rayDepthWs)) * (0x1p-24f + c.eyeWs.w);
    const float ulp = spanned + (view.reversed() ? ray * 0x1p-23f : 0.0f);
    const float ulpFar = farthest * (c.eyeWs.w + (view.reversed() ? 0.0f : 0x1p-24f));
    return c.offsetFactor * glm::vec4(coordinate * where, c.pixelSize / 256.0f + coordinate * ray + ulp, ulpFar, 0.0f);
}

} // namespace

MapProjection mapProjection(const LightFit& fit, const LightView& light)
{
    MapProjection result;
    result.clipFromZero = fit.clipFromWorld;
    if (!positional(light)) return result;
    // The light is the eye of a perspective: there clip x, y and w vanish, and what remains of z is depthScale.
    result.depthConstant = 1.0f;
    result.depthScale = -fit.nearWs;
    result.zeroWs = light.position();
    result.clipFromZero[3] = glm::vec4(0.0f, 0.0f, result.depthScale, 0.0f);
    return result;
}

void raiseNearEnd(LightFit& fit, std::uint32_t resolution, float limit)
{
    // Clip w grows along the axis from 0 at the light: the near side opens to all that lies before the light.
    glm::dmat4 rows = glm::transpose(glm::dmat4(fit.clipFromWorld));
    const glm::dvec4 before = rows[3] / glm::length(glm::dvec3(rows[3]));
    fit.volume[4] = {glm::vec3(before), static_cast<float>(before.w)};

    const double texels = static_cast<double>(fit.texelAtOne) / resolution; // width of a texel at 1 m
    const double needed = std::fmin(gpu::DEPTH_ROUNDING / (kSlackTexels * texels), kMostNearPerEnd);
    const double n = std::min({needed * static_cast<double>(fit.endWs), static_cast<double>(limit), kMostNearWs});
    if (!(n > static_cast<double>(fit.nearWs))) return;
    rows[2] = rows[3]; // clip z is linear in clip w
    rows[2].w -= n;
    fit.clipFromWorld = glm::mat4(glm::transpose(rows));
    fit.nearWs = static_cast<float>(n);
}

gpu::MapConstants mapConstants(const ShadowTask& task, std::uint32_t resolution, std::uint32_t filterSide)
{
    const VkRect2D& area = task.view->area;
    gpu::MapConstants constants{};
    constants.view = task.view->constants;
    const gpu::LightConstants& light = task.light->constants;
    const float cosine = light.directionWs.w;
    constants.map.eyeFromLight = glm::vec4(task.view->eye - task.light->position(), light.range * light.range);
    constants.map.cone = glm::vec4(task.light->direction(), cosine * std::fabs(cosine));
    constants.map.offset = receiverOffset(task);
    constants.map.area = {static_cast<float>(area.offset.x), static_cast<float>(area.offset.y),
                          static_cast<float>(area.extent.width), static_cast<float>(area.extent.height)};
    constants.map.positional = positional(*task.light) ? 1.0f : 0.0f;
    constants.map.side = static_cast<float>(resolution);
    constants.map.filterSide = static_cast<float>(filterSide);
    return constants;
}

void addProjection(gpu::MapConstants& constants, const LightFit& fit, const ShadowTask& task)
{
    gpu::MapLookup& look = constants.map;
    const MapProjection projection = mapProjection(fit, *task.light);
    look.depthConstant = projection.depthConstant;
    look.depthScale = projection.depthScale;
    look.farWs = std::fmax(fit.endWs, 2.0f * fit.nearWs);

    // Rows of the map's clip space, x and y in texels.
    glm::dmat4 rows = glm::transpose(glm::dmat4(projection.clipFromZero));
    rows[0] = 0.5 * static_cast<double>(look.side) * (rows[0] + rows[3]);
    rows[1] = 0.5 * static_cast<double>(look.side) * (rows[1] + rows[3]);
    const glm::dmat4 clipFromZero = glm::transpose(rows);
    const glm::dvec3 eye = glm::dvec3(task.view->eye) - glm::dvec3(projection.zeroWs);
    look.clipOfEye = glm::vec4(clipFromZero * glm::dvec4(eye, 1.0));
    look.clipFromRay = glm::mat4(clipFromZero);
    look.clipFromRay[3] = glm::vec4(0.0f);
    look.clipOfDepth = look.clipFromRay * glm::vec4(glm::vec3(task.view->constants.rayDepthWs), 0.0f);

    // Perspective: the texel's ray is the vector whose clip x, y and w are the texel and 1. Directional: its origin and
    // its axis are the points whose clip x, y and z are.
    const glm::dvec4 last = look.positional != 0.0f ? rows[3] : rows[2];
    const glm::dmat3 clip = glm::transpose(glm::dmat3(glm::dvec3(rows[0]), glm::dvec3(rows[1]), glm::dvec3(last)));
    const glm::dmat3 fromClip = glm::inverse(clip);
    look.texelDx = glm::vec4(glm::vec3(fromClip[0]), 0.0f);
    look.texelDy = glm::vec4(glm::vec3(fromClip[1]), 0.0f);
    if (look.positional == 0.0f) look.axisWs = glm::vec4(glm::vec3(fromClip[2]), 0.0f);
}

void addLightProjection(gpu::MapConstants& constants, std::span<const LightFit> fits, const ShadowTask& task)
{
    if (fits.size() == 1) {
        addProjection(constants, fits.front(), task);
        return;
    }
    const MapProjection face = mapProjection(fits.front(), *task.light); // all six differ in their axes only
    constants.map.depthConstant = face.depthConstant;
    constants.map.depthScale = face.depthScale;
    constants.map.farWs = std::fmax(fits.front().endWs, 2.0f * fits.front().nearWs);
    constants.map.slope = 0.5f * fits.front().texelAtOne;
}

gpu::ShadowSample sampleOf(const gpu::MapLookup& look, std::uint32_t kind)
{
    gpu::ShadowSample sample{};
    sample.map = look;
    sample.kind = kind;
    return sample;
}

} // namespace gnomon
