#pragma once
// How much of the picture the shadow volumes of a light's casters cover: what volumes cost depends on it.
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Pixels inside the outlines of the shadow volumes, from the casters' bounds to the end of all bounds, summed over
/// casters: what overlaps counts each time. An estimate for the cost model, no bound. About 40 ns a caster.
double shadowPixels(const LightView& light, const LightCasters& casters, const CameraView& view);

} // namespace gnomon
