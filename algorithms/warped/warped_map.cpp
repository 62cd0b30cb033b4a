#include "algorithms/warped/warped_map.hpp"

#include <algorithm>
#include <array>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "shaders/warped_warped_map_frag.h"

namespace gnomon {

namespace {

/// A map's widest texel over its narrowest: beyond, coordinates of casters that reach past the map are rounded by more
/// than the look-up allows for. A light that nearly appears in view asks PSM for any number.
constexpr double kMostStrength = 256.0;

} // namespace

WarpedMap::WarpedMap(const AlgorithmServices& services, const char* resolveName, const ViewMapNames& names)
    : casters_(makeDepthMapPipelines(services)),
      resolve_(services, {.name = resolveName, .fragment = k_warped_warped_map_frag}), contact_(services), names_(names)
{
}

WarpSource WarpedMap::source(PassBuilder& passes, const ShadowTask& task, std::uint32_t resolution) const
{
    const LightFit* plain = fitDepthMap(casters_.clamped, task, resolution, passes.arena());
    return {plain, seenPart(task, *plain)};
}

void WarpedMap::declare(PassBuilder& passes, const ShadowTask& task, const WarpSource& source, const Warp& warp,
                        const WarpSettings& settings)
{
    std::array<Warp, 8> warps;
    std::size_t count = 0;
    const double strength = std::min(warp.strength, kMostStrength / settings.most);
    for (double share = std::min(settings.most, 8.0); share >= 0.25; share *= 0.5)
        warps[count++] = {warp.away, share * strength};
    warps[count++] = {warp.away, 0.0};
    if (settings.minimal && source.part.hull.count > 0)
        warps[count++] = {smallestRectangle(source.part.hull.points()), 0.0};
    const LightFit* fit = passes.arena().make(fitWarped(*source.plain, source.part, {warps.data(), count},
                                                        settings.resolution, static_cast<float>(kMapBorderTexels)));
    const DepthMap map = declareViewMap(passes, casters_, task, settings.resolution, fit, names_);
    gpu::MapConstants constants = mapConstants(task, settings.resolution, filterSide(settings.filter));
    addWarpedProjection(constants, *fit, task);
    resolve_.declare(passes, task, map.image, constants);
    contact_.declare(passes, task, settings.contact);
    map_ = {.image = map.image, .clipFromWorld = {fit->clipFromWorld}};
}

void addWarpedProjection(gpu::MapConstants& constants, const LightFit& fit, const ShadowTask& task)
{
    addProjection(constants, fit, task);
    gpu::MapLookup& look = constants.map;
    if (look.positional != 0.0f) return;
    // Rows of the map's clip space about the eye, x and y in texels. A column of the inverse is the homogeneous place
    // that one more unit of x, y or z adds.
    glm::dmat4 rows = glm::transpose(glm::dmat4(fit.clipFromWorld));
    for (int row = 0; row < 4; ++row)
        rows[row].w += glm::dot(glm::dvec3(rows[row]), glm::dvec3(task.view->eye));
    rows[0] = 0.5 * static_cast<double>(look.side) * (rows[0] + rows[3]);
    rows[1] = 0.5 * static_cast<double>(look.side) * (rows[1] + rows[3]);
    const glm::dmat4 fromClip = glm::inverse(glm::transpose(rows));
    look.texelDx = glm::vec4(fromClip[0]);
    look.texelDy = glm::vec4(fromClip[1]);
    look.axisWs = glm::vec4(glm::vec3(fromClip[2]), 0.0f); // along the light: w stays
}

} // namespace gnomon
