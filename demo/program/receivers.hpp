#pragma once
// The shared definition of a receiver (shaders/shared/receiver.h), filled from what the host knows. All relative to the
// eye, hence with ViewConstants::eyeWs zero.

#include "demo/host/geometry.hpp"
#include "shaders/shared/receiver.h"

namespace gnomon::demo {

gpu::ViewConstants viewConstants(const Scene& scene, const CameraMatrices& camera, VkExtent2D extent);
gpu::LightConstants lightConstants(const Light& light, const LightState& state, const glm::dvec3& eye);

} // namespace gnomon::demo
