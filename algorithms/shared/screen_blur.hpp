#pragma once
// Averages a picture of visibility over an ellipse on each receiver's plane, in two passes
// (shaders/shared/screen_blur.frag).
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/shared/screen_penumbra.h"

namespace gnomon {

class ScreenBlur {
public:
    /// @param rows, columns passes and pipelines
    ScreenBlur(const AlgorithmServices& services, const char* rows, const char* columns);

    /// The picture: x visibility, or that less NOT_ASKED; y half the ellipse's width, metres; z what the result is
    /// multiplied with.
    static constexpr VkFormat kSeenFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
    /// What it holds where nothing is drawn: light, and no part of what others average.
    static constexpr VkClearValue kNotAsked{.color = {.float32 = {1.0f - gpu::NOT_ASKED, 0.0f, 1.0f, 0.0f}}};

    static ImageId declareSeen(PassBuilder& passes, const ShadowTask& task);

    /// Writes the task's layer of visibility. @param constants live until the frame is recorded
    void declare(PassBuilder& passes, const ShadowTask& task, ImageId seen,
                 const gpu::ScreenPenumbraConstants& constants) const;

    /// Device bytes of both images.
    static VkDeviceSize memory(VkExtent2D extent);

private:
    const char *rows_, *columns_;
    PipelineId pipelines_[2][2]; ///< [has normals][is last]
};

} // namespace gnomon
