#pragma once
// How much of the picture the sides of a light's shadow volumes touch: what volumes cost depends on it.
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Pixels that the sides of the shadow volumes touch, from the casters' bounds to the end of all bounds: those inside
/// the outlines, and the blocks along every side, by the number of sides that meshes of so many triangles have. What
/// overlaps counts each time. An estimate for the cost model, no bound. Takes time in
/// proportion to the casters.
double shadowPixels(const LightView& light, const LightCasters& casters, const CameraView& view);

} // namespace gnomon
