#pragma once
// What the methods that send many rays a pixel to a light's source are told, and how its points lie.
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "runtime/algorithm.hpp"
#include "shaders/hybrid/ray_samples.h"

namespace gnomon {

/// Most rays a pixel.
inline constexpr std::uint32_t kMaxSourceSamples = gpu::MOST_SAMPLES;

inline constexpr SettingSpec kSamplesSetting = {
    "samples", "Rays a pixel to points of a light with a radius; 1: one ray to its centre, a hard shadow.", 1,
    kMaxSourceSamples, 1};
inline constexpr SettingSpec kSeedSetting = {"seed", "Another number takes other points.", 0, 65535, 0};

/// Points lie in so many rows, each as high as the points that it holds.
inline std::uint32_t sampleRows(std::size_t count)
{
    return static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
}

} // namespace gnomon
