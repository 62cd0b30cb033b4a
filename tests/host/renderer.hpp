// A small deferred renderer: G-buffer, gnomon's shadows, one lighting pass over the whole picture. Two frames are in
// flight, and timestamps of its own say what the shadows took.
#ifndef GNOMON_TESTS_HOST_RENDERER_HPP
#define GNOMON_TESTS_HOST_RENDERER_HPP

#include <array>
#include <chrono>
#include <vector>

#include "shadows.hpp"

namespace stranger {

/// What a frame took, in milliseconds, and what was chosen in it.
struct FrameReport {
    double shadowMs = 0.0;    ///< On the device from the end of the G-buffer to the lighting pass, round trips and
                              ///< their waits included; beside it the call, where it only records.
    double gnomonMs = 0.0;    ///< As gnomon says, and holds a budget against; 0: not known.
    double predictedMs = 0.0; ///< By gnomon.
    double callMs = 0.0;      ///< The call of gnomon, from outside.
    double wallMs = 0.0;      ///< From the beginning of this frame to that of the next one.
    GnResult result = GN_SUCCESS;
    std::array<Choice, kLampCount> choices;
};

/// The newest frame's answer, layer by layer, and what the pixels show.
struct Answer {
    std::vector<uint8_t> visibility; ///< kLampCount layers of width x height.
    std::vector<uint8_t> pixels;     ///< RGBA.
    std::vector<float> depth;
    std::vector<uint16_t> normals; ///< Four half floats a pixel.
    FrameData data;
    VkExtent2D size;
};

class Renderer {
public:
    Renderer(const Device& device, const Options& options);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    Shadows& shadows() noexcept { return shadows_; }
    const Shadows& shadows() const noexcept { return shadows_; }
    /// \param seconds Of the animation.
    void renderFrame(double seconds);
    /// Waits for all frames; their reports are complete then.
    void finish();
    const std::vector<FrameReport>& reports() const noexcept { return reports_; }
    /// Of the newest frame, after finish().
    Answer read();

private:
    using Clock = std::chrono::steady_clock;
    struct Slot {                                  ///< What a frame in flight has for itself.
        std::array<VkCommandBuffer, 2> commands{}; ///< G-buffer (recorded: all), lighting.
        Buffer frameData;
        std::array<VkDescriptorSet, 2> sets{}; ///< Frame data; images of the lighting pass.
        uint64_t revision = 0;                 ///< Of the visibility that the second set names.
        uint64_t frame = 0;                    ///< Under way; 0: none.
    };

    void createGeometry();
    void createImages();
    void createSets();
    void createSlots();
    void writeImage(VkDescriptorSet set, uint32_t binding, VkImageView view) const;
    void drawSurfaces(VkCommandBuffer commands, const Slot& slot) const;
    void drawLighting(VkCommandBuffer commands, const Slot& slot) const;
    void nameVisibility(Slot& slot) const;
    void submit(VkCommandBuffer commands, uint64_t signalled) const;
    /// Waits for the slot's frame and completes its report.
    void collect(Slot& slot);
    void closeWall();

    const Device& device_;
    Options options_;
    Shadows shadows_;
    Image albedo_, normals_, depth_, picture_;
    Buffer vertices_;
    uint32_t vertexCount_ = 0;
    VkSampler sampler_ = VK_NULL_HANDLE;
    std::array<VkDescriptorSetLayout, 2> setLayouts_{};
    VkDescriptorPool setPool_ = VK_NULL_HANDLE;
    VkPipelineLayout pipelineLayout_ = VK_NULL_HANDLE;
    VkPipeline surfacePipeline_ = VK_NULL_HANDLE, lightingPipeline_ = VK_NULL_HANDLE;
    VkCommandPool commandPool_ = VK_NULL_HANDLE;
    VkQueryPool queries_ = VK_NULL_HANDLE;
    VkSemaphore timeline_ = VK_NULL_HANDLE;
    std::array<Slot, Shadows::kFramesInFlight> slots_;
    uint64_t completed_ = 0; ///< Newest frame that the device is done with.
    FrameData data_{};
    bool wallOpen_ = false;
    Clock::time_point wallStart_;
    std::vector<FrameReport> reports_;
};
} // namespace stranger
#endif
