#pragma once
// How much of the picture the sides of a light's shadow volumes touch: what volumes cost depends on it.
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Pixels that the sides of the shadow volumes cover, from the casters to the end of all their bounds, by the number
/// and length of sides that each mesh has on average. What a rasteriser pays on top for slivers is counted in pixels,
/// too. What overlaps counts each time. An estimate for the cost model, no bound. Takes time in proportion to the
/// casters.
double shadowPixels(const LightView& light, const LightCasters& casters, const CameraView& view);

/// Of a caster as a light sees it, on average over directions.
struct Outline {
    float length = 0.0f; ///< Metres.
    float area = 0.0f;   ///< Square metres of the faces; what others of them hide counts, too.
};
Outline outlineOf(const Caster& caster);

} // namespace gnomon
