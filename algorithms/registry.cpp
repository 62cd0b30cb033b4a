#include "algorithms/registry.hpp"

#include <array>

#include "algorithms/maps/shadow_map.hpp"
#include "algorithms/omni/cube_map.hpp"
#include "algorithms/omni/dual_paraboloid.hpp"

namespace gnomon {

namespace {

constexpr std::array kAlgorithms = {
    &kShadowMap,
    &kCubeMap,
    &kDualParaboloid,
};

} // namespace

std::span<const AlgorithmEntry* const> builtinAlgorithms()
{
    return kAlgorithms;
}

} // namespace gnomon
