#include "algorithms/revectorized/line_map.hpp"

#include <algorithm>

#include "shaders/revectorized_lines_cube_frag.h"
#include "shaders/revectorized_lines_frag.h"

namespace gnomon {

std::uint32_t lineBorder(const LightView& light, std::uint32_t resolution, const Lines& lines)
{
    if (light.type != GN_LIGHT_TYPE_POINT) return kernelBorder(lines.filterSide);
    const std::uint32_t reach = lines.longest + (lines.filterSide + 1) / 2 + 1;
    return std::clamp(reach, kMapBorderTexels, resolution / 4);
}

LineMap::LineMap(const AlgorithmServices& services, const char* name)
    : casters_(makeDepthMapPipelines(services)),
      resolve_(services, {.name = name, .fragment = k_revectorized_lines_frag, .cube = k_revectorized_lines_cube_frag})
{
}

ShadowAlgorithm::Map LineMap::declare(PassBuilder& passes, const ShadowTask& task, std::uint32_t resolution,
                                      const Lines& lines) const
{
    gpu::LineConstants constants{};
    constants.base = mapConstants(task, resolution, lines.filterSide);
    constants.mode = lines.mode;
    constants.longest = lines.longest;
    const LightMap map =
        declareLightMap(passes, casters_, task, resolution, constants.base, lineBorder(*task.light, resolution, lines));
    resolve_.declare(passes, task, map.image, constants, {.filtered = lines.mode == gpu::REVECTORIZE_KERNEL});
    return handedOut(map.image, map.fits, map.needed, constants.base);
}

} // namespace gnomon
