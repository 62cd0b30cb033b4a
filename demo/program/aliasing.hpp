#pragma once
// How many pixels wide a texel of a light's map is where it is looked up (Navratil 2015, 3.1): above 1, edges of
// shadows show texels; below, texels are finer than pixels.
//
// The thesis's m = (w_l cos t_i) / (w_i cos t_l) is for beams that are seen from their side: w are the widths of a
// texel's and a pixel's where they meet the surface, t their angles to its normal. Beams have two sides, and a surface
// stretches one of them: widths are roots of areas here, and so are the cosines.

#include <optional>

#include "demo/program/error_count.hpp"
#include "gnomon/gnomon.h"

namespace gnomon::demo {

/// What a map or a picture has where a beam meets a surface. Its direction is the beam's, its length the samples in a
/// square metre across it: 1 / w^2.
glm::dvec3 beamAt(const glm::dmat4& samplesFromWorld, const glm::dvec3& at);

/// m, from both beams and the surface's normal (any length); infinite where the light grazes it.
double aliasingOf(const glm::dvec3& texels, const glm::dvec3& pixels, const glm::dvec3& normal);

/// Clip space to samples, counted from the corner.
glm::dmat4 samplesFromClip(double width, double height);

/// Clip space of each layer that can be looked up, in that order, from world axes about the eye; six at most.
std::vector<glm::dmat4> layersOf(const GnLightMap& map, const glm::dvec3& eye);

/// Of a light's map in one frame: m per pixel, 0 where no map is looked up.
/// \param counted countedPixels() of the light. Empty where no layer has a matrix.
std::optional<ImageF> measureAliasing(const GnLightMap& map, LightKind kind, const CameraMatrices& camera,
                                      const FrameSurfaces& surfaces, const std::vector<uint8_t>& counted);

/// For people: white where m is 1, red where texels are wider than pixels, blue where they are narrower, both full at a
/// factor of eight; black where no map is looked up.
Image8 pictureOf(const ImageF& aliasing);

} // namespace gnomon::demo
