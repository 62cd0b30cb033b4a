#pragma once
// A depth map as a surface, the parts known before it is drawn: where it lies, how its cells are filled with triangles,
// and where the near rectangle meets it. Plain CPU code without Vulkan.
#include <array>

#include "runtime/scene/light_fit.hpp"
#include "shaders/volumes/mccool.h"

namespace gnomon {

/// TEMPLATES times TEMPLATE_TRIANGLES triangles, those that are not needed 0 (shaders/volumes/mccool.h says what is in
/// one). Seen from the light the triangles of a template cover the cell once; those that stand on edge are its walls:
///
///   no jump     two triangles; drawn by nobody
///   one         a fan: the wall ends within the cell
///   two         a wall from jump to jump, the parts on either side filled
///   three       the same for two of them, the third ends within the cell; variant: which one, counted among the jumps
///   four        two walls that part corners 1 and 3 from the rest, or, variant 1, corners 2 and 0
std::array<std::uint32_t, gpu::TEMPLATES * gpu::TEMPLATE_TRIANGLES> cellTemplates();

/// The surface of a map; capacities are left 0.
gpu::DepthSurface depthSurface(const LightFit& fit, const LightView& light, glm::vec3 eye, std::uint32_t resolution);

/// The texels that decide whether a point of the near rectangle can lie behind the surface.
struct NearTexels {
    glm::vec4 texels{0.0f, 0.0f, -1.0f, -1.0f}; ///< x and y of the first, x and y of the last; none: first > last.
    float depth = 0.0f;                         ///< Greatest map depth on the rectangle.
    bool always = false;                        ///< Too many to ask, or the light's plane cuts the rectangle.
};
NearTexels nearTexels(const LightFit& fit, const std::array<glm::vec3, 4>& nearCorners, std::uint32_t resolution);

} // namespace gnomon
