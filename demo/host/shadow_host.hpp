#pragma once
// gnomon embedded: the scene's meshes, instances, lights and views registered once, kept up to date every frame.

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "demo/host/caster_drawer.hpp"
#include "demo/host/device.hpp"
#include "demo/host/geometry.hpp"

namespace gnomon::demo {

struct ShadowHostOptions {
    uint32_t framesInFlight = 2;
    uint32_t viewCount = 1;
    uint32_t maxLights = 16;
    GnContextCreateFlags flags = 0;
    VkDeviceSize memoryLimit = 0;     ///< As GnContextCreateInfo's.
    bool pinnedThreads = false;       ///< gnomon's workers stay on the second processor, the third, ...
    std::vector<std::string> plugins; ///< Paths, for gnLoadPlugin().
};

class ShadowHost {
public:
    ShadowHost(const Device& device, const Scene& scene, const SceneGeometry& geometry,
               const ShadowHostOptions& options);
    ~ShadowHost();
    ShadowHost(const ShadowHost&) = delete;
    ShadowHost& operator=(const ShadowHost&) = delete;

    GnContext context() const noexcept { return context_; }
    GnView view(uint32_t index) const { return views_.at(index); }
    GnLight light(uint32_t index) const { return lights_.at(index); }

    /// Moves what moved since the last call.
    void update(const SceneState& state);

    /// The lights of a state in the order of their layers.
    std::vector<GnLight> present(const SceneState& state) const;

    /// All methods are ready afterwards.
    Status warmUp();
    /// The method is ready afterwards; empty: all are.
    Status warmUp(const std::string& method);

    /// A text or a preset with errors leaves the last good ones in force. \param preset of the text; empty: none.
    Status loadRules(const std::string& text, const std::string& fileName, const std::string& preset = {});
    Status loadKnowledge(const std::string& text, const std::string& fileName) const;
    /// Empty hands the light back to the rules.
    Status pin(uint32_t light, const std::string& method);
    /// Every light that the method serves; the others stay with the rules and are named in `refused`, with the reason.
    /// Fails where it serves none.
    Status pinAll(const std::string& method, std::vector<std::string>* refused = nullptr);
    Status set(const std::string& method, const std::string& setting, double value);

    std::vector<GnMethodInfo> methods() const;
    GnFrameStats stats() const;
    /// Why the light's method in the first view was not this one. \param frame of gnomon's; 0: the newest
    std::string whyNot(uint32_t light, const std::string& method, uint64_t frame = 0) const;

    /// Warnings and errors since the last call.
    std::vector<std::string> takeMessages();

private:
    struct Rules {
        std::string text, fileName, preset;
    };
    static void GN_CALL onMessage(const GnMessage* message, void* user);
    Status statusOf(GnResult result) const;
    std::string faults(); ///< What the last call, which failed, has said.
    void createInstances(const SceneGeometry& geometry);
    void createLights();

    const Scene& scene_;
    CasterDrawer casterDrawer_;
    std::mutex mutex_;
    std::vector<std::string> messages_;
    Rules rules_;                            ///< In force; empty: none.
    std::vector<HostDrawnCaster> hostDrawn_; ///< One per instance; stable addresses for the callbacks.
    GnContext context_ = VK_NULL_HANDLE;
    std::vector<GnMesh> meshes_;
    std::vector<GnInstance> instances_;
    std::vector<GnLight> lights_;
    std::vector<GnView> views_;
    std::vector<GnTransform> lastTransforms_;
    std::vector<LightState> lastLights_;
};

GnTransform toGnTransform(const Transform& transform);
GnLightInfo toGnLight(const Light& light, const LightState& state);

} // namespace gnomon::demo
