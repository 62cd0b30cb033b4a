#pragma once
// How much of a light's maps its casters fill: what drawing a map takes depends on it.
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Shares of all that a light's maps show: the square around a cone, six faces around a point, the bounds of all
/// casters seen along a direction.
struct MapCover {
    double filled = 0.0;  ///< By the boxes around the casters. What overlaps counts each time: it may exceed 1.
    double touched = 0.0; ///< Point lights: faces of the cube that a caster touches, of six. Else 1, or 0 without any.
};

/// Of the casters `drawn`, some of the light's. An estimate for the cost model, no bound. Takes time in proportion to
/// the casters.
MapCover mapCover(const LightView& light, const LightCasters& casters, std::span<const Caster* const> drawn);

} // namespace gnomon
