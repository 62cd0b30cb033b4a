#include "algorithms/registry.hpp"

#include <array>

#include "algorithms/maps/shadow_map.hpp"
#include "algorithms/omni/cube_map.hpp"
#include "algorithms/omni/dual_paraboloid.hpp"
#ifdef GNOMON_WITH_OPENMESH
#include "algorithms/volumes/stencil_volume.hpp"
#endif

namespace gnomon {

namespace {

constexpr std::array kAlgorithms = {
    &kShadowMap,
    &kCubeMap,
    &kDualParaboloid,
#ifdef GNOMON_WITH_OPENMESH
    &kStencilVolume,
#endif
};

} // namespace

std::span<const AlgorithmEntry* const> builtinAlgorithms()
{
    return kAlgorithms;
}

} // namespace gnomon
