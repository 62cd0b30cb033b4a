#pragma once
// Passes over a frame's picture that show what is behind it: errors of visibility, widths of texels.

#include "demo/host/renderer.hpp"

namespace gnomon::demo {

/// A fullscreen pass over a picture that is in TRANSFER_SRC_OPTIMAL before and after, with sets of renderers and behind
/// them one of its own that has one storage buffer.
class PicturePass {
public:
    struct Description {
        std::span<const uint32_t> fragment;
        uint32_t imageSets = 1; ///< Of renderers, behind a frame set.
        VkDeviceSize bufferSize = 0;
        uint32_t pushBytes = 0; ///< To the fragment shader.
    };
    PicturePass(const Device& device, const Renderer& renderer, const Description& description);

    /// \param sets the frame set and the image sets.
    /// \param left column of the picture where the pass begins, below its width.
    void draw(VkCommandBuffer cmd, const Image& picture, std::span<const VkDescriptorSet> sets, uint32_t left,
              const void* push = nullptr) const;
    const Buffer& buffer() const noexcept { return buffer_; }

private:
    uint32_t pushBytes_;
    Buffer buffer_;
    UniqueSetLayout setLayout_;
    UniquePipelineLayout layout_;
    UniquePipeline pipeline_;
    UniqueDescriptorPool descriptors_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

/// A frame's visibility against that of another renderer, the truth: the truth's picture in grey, and over it what is
/// lit by mistake in kFalseLit, dark by mistake in kFalseShadow, as strongly as the light differs that differs most.
/// Pixels count for a light as in countedPixels().
class ErrorView {
public:
    /// Throws HostError where the device cannot count in fragment shaders.
    ErrorView(const Device& device, const Renderer& renderer);

    /// Within a frame of `judged`, behind the newest one of `truth` with the same size, time and camera. What `truth`
    /// draws next waits until the device is through with this frame.
    void record(VkCommandBuffer cmd, const Renderer& judged, const Renderer& truth, uint32_t left) const;

    struct Counts {
        uint64_t counted = 0, wrong = 0; ///< Pairs of a pixel and a light.
    };
    /// Of what was recorded last, right of `left`. \pre that frame has been waited for
    Counts counts() const;

private:
    PicturePass pass_;
};

/// The measure of aliasing (aliasing.hpp) of one light's map in the colours of pictureOf(), grey where no map is looked
/// up.
class TexelView {
public:
    TexelView(const Device& device, const Renderer& renderer);

    /// Within a frame of `renderer`. \param layer of the light among those that are there.
    void record(VkCommandBuffer cmd, const Renderer& renderer, const GnLightMap& map, uint32_t layer) const;

private:
    PicturePass pass_;
};

} // namespace gnomon::demo
