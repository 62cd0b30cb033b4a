#pragma once
// The host's side of host-drawn and alpha-tested casters: draws them into a shadow map when gnomon asks, and answers
// how opaque a hit of a ray is.

#include <map>

#include "demo/host/device.hpp"
#include "demo/host/geometry.hpp"

namespace gnomon::demo {

class CasterDrawer;

/// What one instance needs when gnomon calls back.
struct HostDrawnCaster {
    CasterDrawer* drawer = nullptr;
    const Mesh* mesh = nullptr;
    MeshRange range;
    bool alphaTested = false;
    Transform transform; ///< Of this frame; written before the frame's shadow call.
};

class CasterDrawer {
public:
    CasterDrawer(const Device& device, const SceneGeometry& geometry);

    /// PFN_gnDrawCasters; the user data is a HostDrawnCaster.
    static void GN_CALL draw(VkCommandBuffer cmd, const GnCasterProjection* projection, void* user);
    /// PFN_gnOpacity; from worker threads.
    static float GN_CALL opacity(uint32_t triangle, float u, float v, void* user);

private:
    VkPipeline pipeline(VkFormat depthFormat, bool alphaTested);

    const Device& device_;
    const SceneGeometry& geometry_;
    UniquePipelineLayout layout_;
    std::map<std::pair<VkFormat, bool>, UniquePipeline> pipelines_; ///< Made when a pass first wants them.
};

} // namespace gnomon::demo
