#pragma once
// Where the maps of a directional light lie that is asked near the eye more finely than far away.
#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"

namespace gnomon {

/// One map: about a slice of the view, or of all that casts.
struct Cascade {
    LightFit fit;
    glm::dvec2 middle{}, half{}; ///< Of its sides, metres from the origin along them.
    std::uint32_t layer = 0;
};

struct CascadeSplit {
    std::uint32_t count = 4; ///< Of maps, the one of all casters included; at least 1.
    double blend = 1.0;      ///< 0 even slices, 1 slices whose ends grow by a factor.
    std::uint32_t resolution = 1;
    float borderTexels = 0.0f; ///< Receivers of a slice lie that far inside of its map.
};

/// End of the slices' first `share`, linear depth: the practical split of Zhang, Sun, Xu and Lun 2006, Eq 4.
double splitDepth(double near, double far, double share, double blend);

/// The maps of a task, finest first; the last one covers all casters and does not depend on the view. Slices that need
/// all of its width and height have none.
///
/// A slice's map is a square about a sphere that holds it, so that its size does not change when the camera turns; the
/// size is rounded up to a 32nd to a 64th, the place to an eighth of the side: what stands still in it is drawn again
/// only when the camera has left that eighth, and then on the same grid of texels. Both, and the border, are in the
/// size. Along a side where that is more than the last map's, it is the last map's.
/// All have one range of depths, that of all casters, so that no caster between slice and light is missed.
std::span<Cascade> fitCascades(const ShadowTask& task, const CascadeSplit& split, FrameArena& arena);

/// Where a texel of `finest` lies in another map: xy times it, plus zw.
glm::vec4 cascadePart(const Cascade& finest, const Cascade& of, std::uint32_t resolution);

} // namespace gnomon
