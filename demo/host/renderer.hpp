#pragma once
// A small deferred renderer, the kind of host gnomon is made for: depth and geometric normals first, then shadows (by
// gnomon, by a baseline, or none), then one lighting pass. It never waits idle; a frame waits only for the frame whose
// slot it takes.

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "demo/host/geometry.hpp"
#include "demo/host/readback.hpp"
#include "demo/host/shadow_host.hpp"
#include "demo/io/image.hpp"

namespace gnomon::demo {

struct RendererOptions {
    uint32_t framesInFlight = 2; ///< [1, 8].
    uint32_t viewCount = 1;
    uint32_t maxLights = 16; ///< At most gpu::MAX_DEMO_LIGHTS.
    VkExtent2D extent{};
};

/// What a pass recorded between depth and lighting may use (bench_bare.hpp).
struct ViewInputs {
    VkDescriptorSet frameSet = VK_NULL_HANDLE; ///< Set 0, shaders/demo/frame.glsl.
    VkImageView depthView = VK_NULL_HANDLE;
    VkExtent2D extent{};
    const CameraMatrices* camera = nullptr;
    const SceneState* state = nullptr;
};

/// Shadows by something else than gnomon.
class OtherShadows {
public:
    virtual ~OtherShadows() = default;
    /// Records after depth is readable; on return the visibility image is readable by fragment shaders.
    virtual void record(VkCommandBuffer cmd, const ViewInputs& inputs) = 0;
    virtual VkImageView visibility() const = 0; ///< A 2D array, layer 0 for the first light.
};

/// Where a finished picture goes besides memory.
struct PresentTarget {
    VkImage image = VK_NULL_HANDLE;
    VkExtent2D extent{};
    VkSemaphore acquired = VK_NULL_HANDLE; ///< Binary.
    VkSemaphore drawn = VK_NULL_HANDLE;    ///< Binary.
};

struct FrameRequest {
    double time = 0.0;
    std::span<const CameraState> cameras; ///< One per view.
    ShadowHost* shadows = nullptr;        ///< Null: `other`, or no shadows at all (visibility is constant 1).
    OtherShadows* other = nullptr;        ///< First view only.
    bool recorded = false;                ///< gnCmdRenderShadows into our command buffer, else gnSubmitShadows.
    float budgetMs = 0.0f;
    GnFrameFlags flags = 0;
    bool cameraCut = false;
    std::span<const glm::vec3> lightColours; ///< One per light of the scene, linear RGB; empty: the scene's.
    const PresentTarget* present = nullptr;
    /// Draws over the first view's picture, which is in TRANSFER_SRC_OPTIMAL before and after; empty: nothing does.
    std::function<void(VkCommandBuffer cmd, const Image& picture)> overlay;
};

class Renderer {
public:
    static constexpr VkFormat kColourFormat = VK_FORMAT_R8G8B8A8_UNORM; ///< Of the picture.

    Renderer(const Device& device, const Scene& scene, const SceneGeometry& geometry, const RendererOptions& options);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// Takes effect with the next frame; images of frames in flight live on until those are done.
    void resize(VkExtent2D extent);
    VkExtent2D extent() const noexcept { return extent_; }

    void draw(const FrameRequest& request);
    /// Until the newest frame is finished on the device, or an older one.
    void waitForFrame() { waitForFrame(frame_); }
    void waitForFrame(uint64_t frame);
    uint64_t frame() const noexcept { return frame_; }

    // Of the newest frame; these wait for it. Row 0 is the top row.
    ImageF readDepth(uint32_t view = 0);
    ImageF readNormals(uint32_t view = 0);
    Image8 readColour(uint32_t view = 0);
    /// One gray image per present light, through gnomon/visibility.glsl.
    std::vector<Image8> readVisibility(uint32_t view = 0);

    const CameraMatrices& camera(uint32_t view = 0) const { return views_[view].camera; }
    const SceneState& state() const noexcept { return state_; }
    /// The newest frame's picture, in TRANSFER_SRC_OPTIMAL behind its commands; until the next resize() took effect.
    const Image& colour(uint32_t view = 0) const { return views_[view].images.colour; }
    VkDescriptorSetLayout frameSetLayout() const noexcept { return frameLayout_.get(); }
    VkDescriptorSetLayout imageSetLayout() const noexcept { return imageLayout_.get(); }
    struct NewestSets {
        VkDescriptorSet frame;  ///< Set 0, shaders/demo/frame.glsl.
        VkDescriptorSet images; ///< Depth, normals, visibility.
    };
    /// Of the newest frame's lighting; until the next draw() begins.
    NewestSets newestSets(uint32_t view = 0) const
    {
        const SlotOfView& slot = views_[view].slots[frame_ % options_.framesInFlight];
        return {slot.frameSet, slot.imageSet};
    }

private:
    struct SlotOfView { ///< One frame in flight of one view.
        Buffer view, instances;
        VkDescriptorSet frameSet = VK_NULL_HANDLE;
        VkDescriptorSet imageSet = VK_NULL_HANDLE;
        std::array<VkImageView, 3> bound{}; ///< In imageSet.
    };
    struct ViewImages {
        Image depth, normals, colour;
    };
    struct View {
        ViewImages images;
        CameraMatrices camera;
        VkImageView visibility = VK_NULL_HANDLE; ///< What the newest frame was lit with.
        uint32_t layers = 0;
        std::vector<SlotOfView> slots;
    };
    struct Slot {
        UniqueCommandPool pool;
        VkCommandBuffer before = VK_NULL_HANDLE, after = VK_NULL_HANDLE;
    };
    struct Retired {
        uint64_t frame;
        std::vector<ViewImages> images;
        Image ones;
    };

    void createPipelines();
    void createSets();
    void createImages();
    void retire();
    uint64_t completed() const;

    void writeFrameData(uint32_t view, const FrameRequest& request);
    void recordPrepass(VkCommandBuffer cmd, uint32_t view);
    void drawInstances(VkCommandBuffer cmd, const View& view);
    void recordLighting(VkCommandBuffer cmd, uint32_t view, VkImageView visibility);
    void recordPresent(VkCommandBuffer cmd, const PresentTarget& target);
    void clearOnes(VkCommandBuffer cmd);
    void submit(VkCommandBuffer cmd, const PresentTarget* present, bool last);
    void callGnomon(const FrameRequest& request, VkCommandBuffer cmd);

    const Device& device_;
    const Scene& scene_;
    const SceneGeometry& geometry_;
    RendererOptions options_;
    VkExtent2D extent_{};

    UniqueSetLayout frameLayout_, imageLayout_;
    UniquePipelineLayout prepassLayout_, lightingLayout_;
    std::array<UniquePipeline, 4> prepass_; ///< Bit 0: open casters too, bit 1: alpha-tested.
    UniquePipeline lighting_;
    UniqueSampler sampler_;
    UniqueDescriptorPool descriptors_;
    UniqueSemaphore timeline_; ///< Counts finished frames.
    Image ones_;               ///< Visibility where no shadows are asked for.
    bool onesCleared_ = false;
    std::vector<View> views_;
    std::vector<Slot> slots_;
    std::deque<Retired> retired_;
    Readback readback_;

    SceneState state_;
    uint64_t frame_ = 0;
    uint64_t submitted_ = 0; ///< Equals frame_ unless a frame was given up by an exception.
    uint64_t gnomonFrame_ = 0;
    std::deque<std::pair<uint64_t, uint64_t>> gnomonFrames_; ///< (our frame, gnomon's), oldest first, unfinished.
    uint64_t gnomonCompleted_ = 0;
};

} // namespace gnomon::demo
