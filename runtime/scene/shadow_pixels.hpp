#pragma once
// How much of the picture the sides of a light's shadow volumes touch: what volumes cost depends on it.
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Pixels that the sides of the shadow volumes touch, from the casters to the end of all their bounds: the blocks along
/// every side, by the number of sides that the mesh has on average, and a share of those inside the outlines. What
/// overlaps counts each time. An estimate for the cost model, no bound. Takes time in proportion to the casters.
double shadowPixels(const LightView& light, const LightCasters& casters, const CameraView& view);

} // namespace gnomon
