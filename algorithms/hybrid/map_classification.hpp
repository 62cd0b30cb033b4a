#pragma once
// A light's map asked for all pixels on the CPU, in a copy of it: by its own texel each, or by the four around it,
// where rays follow at once if they differ.
#include "algorithms/hybrid/bit_rows.hpp"
#include "algorithms/hybrid/host_blocks.hpp"
#include "algorithms/hybrid/host_map.hpp"

namespace gnomon {

/// The bytes of visibility itself.
inline constexpr simd::MapBytes kVisibility{.outside = 255, .backfacing = 0, .lit = 255, .dark = 0, .unsure = 255};

/// A map as a host pass asks it. The view's normals must be there.
struct MapQuestion {
    const CameraView* view;
    const LightView* light;
    const gpu::MapConstants* constants; ///< Of declareLightMap() or addLightProjection(); kept for the frame.
    HostMapCopy map;
    BufferId depth, normals; ///< Of the view, read back.

    void uses(PassRef& host) const; ///< What the pass reads.
};

/// What passes and buffers are called, "algorithm.what".
struct ClassificationNames {
    const char *visibility, *pass, *copy;
};

/// pcf_hybrid's verdict: declares the passes that answer all pixels of the task.
/// @param reasons codes of shaders/hybrid/reasons.h in place of visibility
void declareMapClassification(PassBuilder& passes, const ShadowTask& task, const ClassificationNames& names,
                              const HostMapCopy& map, const gpu::MapConstants& constants, bool reasons);

// What the passes do. In a host pass; the area's bytes, row by row.

/// What the four texels around every pixel say, and what rays say where they differ.
void classifiedPixels(const MapQuestion& question, bool reasons, const HostContext& host,
                      std::span<std::uint8_t> bytes);
/// When the four texels around a pixel are believed without a further question.
enum class Believed : std::uint8_t {
    never,
    agreeing,   ///< They say the same as the own one.
    clearlyLit, ///< They say lit by more than depths may be off.
};

/// What every pixel's own texel says.
/// @param settled of the area's size: set where nothing is left to ask, at pixels that do not ask the map and at those
/// of which the four texels around are believed
void nearestPixels(const MapQuestion& question, const simd::MapBytes& told, const HostContext& host,
                   std::span<std::uint8_t> bytes, const BitRows& settled, Believed believed);

} // namespace gnomon
