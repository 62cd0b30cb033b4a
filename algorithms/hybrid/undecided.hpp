#pragma once
// From the pixels that a map could not answer to what their rays say: the second half of every map-and-rays hybrid. The
// deciding pass writes UNDECIDED (shaders/hybrid/reasons.h) where it cannot tell; the picture goes through the host,
// which finds those bytes, answers them and hands the picture back. Only the pixels that the light reaches travel, a
// byte each.
//
// A list that fragments append to would be shorter, but its counter lies in the host's memory, every device orders it
// differently, and a device that is the CPU asks each fragment whether it appends.
#include <cstdint>
#include <span>

#include "algorithms/hybrid/host_blocks.hpp"
#include "algorithms/hybrid/near_clip.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon {

/// The setting that turns visibility into reason codes (REASON_*, shaders/hybrid/reasons.h), for overlays.
inline constexpr SettingSpec kReasonsSetting = {
    "reasons", "1: the byte in visibility is why a pixel is lit or dark: a REASON of shaders/hybrid/reasons.h.", 0, 1,
    0};

/// What passes and buffers are called, "algorithm.what".
struct UndecidedNames {
    const char *status, *readback, *visibility, *trace, *copy;
    const char *list = nullptr, *clear = nullptr; ///< Where the device traces (undecided_on_device.hpp).
};

/// What pixels are answered from.
struct UndecidedSource {
    const CameraView& view;
    const LightView& light;
    const HostContext& host;
    const Receivers& receivers;
    const BlockReader& blocks;
};

/// Answers pixels of a light: bytes[i] is what pixels[i] shows. Several threads at once.
/// @param pixels packed by packPixel(), image coordinates, one 4x4 tile of the view's area after the other
using AnswerPixels = void (*)(const UndecidedSource& source, std::span<const std::uint32_t> pixels,
                              std::span<std::uint8_t> bytes);

/// One ray a pixel.
void traceHard(const UndecidedSource& source, std::span<const std::uint32_t> pixels, std::span<std::uint8_t> bytes);
/// The same, REASON_RT_LIT and REASON_RT_SHADOW in place of 255 and 0.
void traceReasons(const UndecidedSource& source, std::span<const std::uint32_t> pixels, std::span<std::uint8_t> bytes);

/// A byte of the deciding pass that is taken for UNDECIDED where receivers may lie inside of casters.
struct Doubt {
    std::uint8_t byte = gpu::UNDECIDED;
    NearClipRegion where;
};

/// Declares what comes after the pass that wrote the task's visibility with UNDECIDED bytes in it.
void declareUndecided(PassBuilder& passes, const ShadowTask& task, const UndecidedNames& names, AnswerPixels answer,
                      const Doubt& doubt = {});

/// Device bytes for a view: the picture both ways.
inline VkDeviceSize undecidedMemory(VkExtent2D extent)
{
    return 2 * hostVisibilityMemory(extent);
}

/// The UNDECIDED pixels of some rows of a picture, packed by packPixel(), 4x4 tile by tile.
/// @param bytes the rows, `width` each; @param x, y of the first pixel; @param list at least as long as they are many
/// @return how many
std::size_t findUndecided(std::span<const std::uint8_t> bytes, std::uint32_t width, std::uint32_t x, std::uint32_t y,
                          std::span<std::uint32_t> list);

} // namespace gnomon
