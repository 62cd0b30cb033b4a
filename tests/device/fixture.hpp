#pragma once
// A device test's world: one device with core and synchronization validation for the whole program, a headless host
// that draws depth and normals and then asks gnomon for shadows, and the books it keeps of what gnomon calls.
#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "demo/host/caster_drawer.hpp"
#include "demo/host/device.hpp"
#include "demo/host/geometry.hpp"
#include "demo/host/readback.hpp"
#include "demo/host/shadow_host.hpp"
#include "demo/scene/primitives.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::test {

using demo::Image8;
using demo::Scene;

/// Made when first asked for.
demo::Device& device();
/// Before that: for what validation would disturb, such as counting allocations, which it makes as well.
void withoutValidation();
/// At the end of main(): the layer's own statics are gone before ours.
void releaseDevice();

/// Calls gnomon made through the function table it was handed; the host's own are not among them.
struct VulkanCalls {
    std::atomic<uint32_t> deviceWaitIdle{0}, queueWaitIdle{0}, submits{0};
};
VulkanCalls& vulkanCalls();

/// Fails the test if validation said anything since it began.
class DeviceTest {
public:
    DeviceTest() : before_(device().validation.count()) {}
    ~DeviceTest();

private:
    size_t before_;
};

/// What the host draws into.
struct Target {
    VkFormat depth = VK_FORMAT_D32_SFLOAT, normals = VK_FORMAT_R16G16B16A16_SFLOAT;
    GnNormalEncoding encoding = GN_NORMAL_SIGNED;
    uint32_t samples = 1;
    bool layered = false; ///< All views draw into one image, each into its layer; there is one layer more.
};

struct HostOptions {
    VkExtent2D extent{320, 180};
    Target target;
    VkRect2D area{}; ///< The cameras' part of their images; of no extent: all of them.
    uint32_t framesInFlight = 2;
    uint32_t viewCount = 1;
    uint32_t maxLights = 16;
    bool packed = false; ///< GN_VIEW_PACKED_BIT.
    GnContextCreateFlags flags = GN_CONTEXT_NO_BACKGROUND_BIT;
    bool warmUp = true; ///< What is asked for by pin() and warm(); before a frame that rules choose for, five methods.
    bool warmAll = false; ///< Before such a frame all, which takes seconds.
    /// For Host::fixMapSides(), so that what is drawn depends on nothing that was measured; 0: maps follow coverage.
    double mapSide = 256.0;
    std::function<void(GnContextCreateInfo&)> context; ///< Last word on the create-info.
};

enum class Call { submit, record, begin };

struct FrameOptions {
    Call call = Call::submit;
    double time = 0.0;
    const std::vector<demo::CameraState>* cameras = nullptr; ///< One per view; null: the scene's.
    const std::vector<GnLight>* lights = nullptr;            ///< Null: those present.
    bool drop = false;                                       ///< Recorded only: withdrawn, never submitted.
    std::optional<float> outside; ///< Depth value beside the area; what lies there has no normal that is a number.
    std::optional<std::pair<VkRect2D, float>>
        normals;                                     ///< Pixels, and what all components of their normals are instead.
    std::function<void(demo::CameraMatrices&)> lens; ///< Before they are drawn with.
    std::function<void(GnFrameInfo&, std::vector<GnViewFrame>&)> adjust; ///< Before the call.
    std::function<void(VkCommandBuffer, bool begins)> around; ///< Recorded only: before and after gnomon's commands.
    size_t (*counter)() noexcept = nullptr;                   ///< Read before and after the call; see Host::counted.
};

/// A scene registered with gnomon. The members may be used and changed by tests; draw() passes on what moved.
class Host {
public:
    explicit Host(Scene scene, const HostOptions& options = {});
    ~Host();
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;

    /// One frame. On an error nothing of it counts: the next call has the same frame number.
    GnResult draw(const FrameOptions& options = {});
    /// Ends a frame drawn with Call::begin. An error takes the frame back, as draw()'s.
    GnResult finish(uint64_t timeoutNs);
    void draw(uint32_t frames, const FrameOptions& options);
    void resize(VkExtent2D extent);
    /// From the next frame on cameras draw this part of their images.
    void limit(const VkRect2D& area) { area_ = area; }
    /// The camera does not see it; it casts all the same.
    void hide(size_t instance) { hidden_[instance] = true; }

    void pin(size_t light, const char* method); ///< Null: the rules decide.
    void pinAll(const char* method);
    /// Makes a method ready. From then on lights that are not pinned may have those that were named here or pinned,
    /// and no frame waits for others.
    void warm(const char* method);
    /// Maps that would follow screen coverage get fixed sides, of at most so many texels. 256 do for pictures of
    /// 320x180: with them device_recorded_tests takes 129 s of processor time, with 1024 it takes 266.
    void fixMapSides(double most = HostOptions{}.mapSide);
    /// New ones in place of all lights, pinned to nothing: what is kept for a light starts again.
    void renewLights();
    /// The scene, which has the same things in other places, and new lights with that method: as a new host, without
    /// the half second in which a context makes its pipelines.
    void beginAnew(const Scene& from, const char* method);
    void require(GnResult result) const;

    /// Of the newest frame, one layer per light; waits for it.
    std::vector<Image8> pictures(uint32_t view = 0);
    /// The view's depth image, found in the layout that the contract promises.
    std::vector<std::byte> depthTexels(uint32_t view = 0);
    GnFrameStats stats() const;
    std::vector<GnPassTiming> passes() const;
    uint32_t passCount(const std::string& name) const;
    GnDecision decision(size_t light, uint32_t view = 0) const;
    std::string explanation(size_t light, uint32_t view = 0) const;
    std::string lastError() const { return gnGetLastError(context); }
    std::vector<std::string> takeMessages();
    uint64_t frame() const noexcept { return frame_; }
    VkExtent2D extent() const noexcept { return extent_; }

    Scene scene;
    GnContext context = VK_NULL_HANDLE;
    std::vector<GnMesh> meshes;
    std::vector<GnInstance> instances;
    std::vector<GnLight> lights;
    std::vector<GnView> views;
    size_t counted = 0; ///< By how much the counter of the newest draw() grew inside the call.

private:
    struct Surface { ///< What one view's camera sees.
        demo::Image depth, normals;
        demo::UniqueImageView depthTarget, normalTarget; ///< Of the view's layer.
    };
    struct Slot {
        demo::UniqueCommandPool pool;
        VkCommandBuffer before = VK_NULL_HANDLE, after = VK_NULL_HANDLE;
    };
    struct Retired {
        uint64_t submission;
        std::vector<Surface> surfaces;
    };

    void createContext(const HostOptions& options);
    void createScene();
    void createSurfaces();
    void update(const demo::SceneState& state);
    void drawSurface(VkCommandBuffer cmd, uint32_t view, const demo::CameraMatrices& camera,
                     const demo::SceneState& state, const FrameOptions& options);
    const Surface& imagesOf(uint32_t view) const { return surfaces_[target_.layered ? 0 : view]; }
    void warmUpFor(const std::vector<GnLight>& lit);
    GnViewFrame viewFrame(uint32_t view, const demo::CameraMatrices& camera, const std::vector<GnLight>& lit) const;
    void submit(VkCommandBuffer cmd, bool last);
    void wait(uint64_t submission);
    void retire();
    Slot& takeSlot();
    static void GN_CALL onMessage(const GnMessage* message, void* user);

    demo::SceneGeometry geometry_;
    demo::CasterDrawer casterDrawer_;
    std::vector<demo::HostDrawnCaster> hostDrawn_;
    demo::UniquePipelineLayout layout_;
    demo::UniquePipeline pipeline_;
    demo::UniqueSemaphore timeline_; ///< Counts the host's frames, failed and dropped ones included.
    demo::Readback readback_;
    VkExtent2D extent_;
    VkRect2D area_;
    const Target target_;
    std::vector<Surface> surfaces_;
    std::vector<Slot> slots_;
    std::deque<Retired> retired_;
    std::deque<std::pair<uint64_t, uint64_t>> unfinished_; ///< (submission, gnomon's frame), oldest first.
    std::vector<bool> hidden_;
    const bool warmUp_, warmAll_;
    bool warmForRules_ = false, warmsByName_ = false;
    std::set<std::string> warm_;
    std::set<GnLight> pinned_;
    std::vector<GnTransform> lastTransforms_;
    std::vector<demo::LightState> lastLights_;
    uint64_t submission_ = 0, waited_ = 0, frame_ = 0, completed_ = 0;
    uint32_t layers_ = 0;
    std::mutex messageMutex_;
    std::vector<std::string> messages_;
};

/// A floor, a ball and a box over it, seen from above; one static spot light. Everything static unless a test says.
Scene smallScene();
demo::Light spotLight(const char* name, const glm::dvec3& position, const glm::dvec3& target, bool isStatic);
demo::Light pointLight(const char* name, const glm::dvec3& position, bool isStatic);

/// A host-drawn caster that draws nothing: what counts is that nobody else can see it.
/// @param draws counts how often it was asked to
GnInstance addHostDrawn(Host& host, GnInstanceFlags extra, double x, uint32_t mask, uint32_t* draws = nullptr);

size_t differences(const Image8& a, const Image8& b);
size_t differences(const std::vector<Image8>& a, const std::vector<Image8>& b);
/// Pixels that are fully dark or fully lit: a picture with shadows has many of both.
size_t dark(const Image8& picture);
size_t lit(const Image8& picture);
/// Methods this build and device can run, in registry order.
std::vector<GnMethodInfo> availableMethods(GnContext context);
/// Whether methods trace on the device. Fails the test where one cannot although the driver lists what they need: tests
/// that end early on devices without ray queries would not notice that they are gone.
bool tracesRays(GnContext context);
std::string shippedRules(const char* name);
bool serves(const GnMethodInfo& method, demo::LightKind kind);
/// Has a map whose side is a setting.
bool hasMap(const GnMethodInfo& method);
/// A kind of light that the method serves: a spot light if it can.
demo::LightKind servedKind(const GnMethodInfo& method);

} // namespace gnomon::test
