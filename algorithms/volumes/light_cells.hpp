#pragma once
// Where in a light's map, cut into coarse cells, the shadow of a caster can fall; plain CPU code without Vulkan.
#include <cstdint>
#include <span>

#include "runtime/scene/light_fit.hpp"
#include "shaders/volumes/chan_durand.h"

namespace gnomon {

/// The cells of every fit (layer) behind the box as the light sees it. Every receiver that the box can shadow, and that
/// the shader finds in this map, lies in one of them, no nearer to the light than `nearestKey`.
/// @param fits DepthKind::clip, at most six, of `light`. @param resolution texels per side. @return footprints written.
std::uint32_t cellFootprints(std::span<const LightFit> fits, const LightView& light, std::uint32_t resolution,
                             const Aabb& box, gpu::CellFootprint (&out)[gpu::MAX_LAYERS]);

} // namespace gnomon
