#pragma once
// Many rays a pixel to points of the light's source: the truth that soft methods are held against. ray_query takes the
// same points (shaders/hybrid/ray_samples.frag).
#include "algorithms/hybrid/sample_settings.hpp"
#include "algorithms/hybrid/traced_pixels.hpp"

namespace gnomon {

/// The points of a light's disc that a pixel asks. The disc is cut into `count` parts of equal area, and one point is
/// taken somewhere in each: where, differs from pixel to pixel, and is the same in every frame.
struct SourceSamples {
    std::uint32_t count = 1; ///< 1 to kMaxSourceSamples.
    std::uint32_t seed = 0;  ///< Another one gives other points.
};

/// Declares the passes that write the task's layer: the share of the points that each pixel sees. The light has a
/// radius that refusesDisc() does not object to.
void declareSampledPixels(PassBuilder& passes, const ShadowTask& task, const TracedNames& names,
                          const SourceSamples& samples);

} // namespace gnomon
