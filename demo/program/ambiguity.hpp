#pragma once
// Which pixels have no clear answer: the truth changes when the receiver moves by 1/128 pixel on its own plane, or when
// the offset of its ray is halved or doubled.
//
// The rays are traced in single precision against one flattened mesh relative to the eye, robustly; the brute force of
// the tests, which is in double precision, finds the same share on small scenes.

#include "demo/program/error_count.hpp"

namespace gnomon::demo {

/// Per pixel 1 where ambiguous, for the pixels counted; empty where this build has no ray tracing.
std::vector<uint8_t> ambiguousPixels(const Scene& scene, const SceneState& state, const CameraMatrices& camera,
                                     const FrameSurfaces& surfaces, const Light& light, const LightState& lightState,
                                     const std::vector<uint8_t>& counted);

} // namespace gnomon::demo
