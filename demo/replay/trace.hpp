#pragma once

/// A trace: what every method would have cost and shown for every light in every frame. Replaying one turns the
/// evaluation of a policy into a deterministic computation without a device.
///
/// File, little-endian, no padding:
///
///     "GNTRACE3"                                            version in the last byte
///     u32 frames, lights, methods, facts; f32 frameSeconds
///     methods x { u8 length, name, f32 mapTexels, u8 flags (1: draws volumes, 2: traces pixels) }
///
///     facts x { u8 length, name }
///
///     frames x { f32 budgetMs; u8 flags (1: cut); lights x u8 present }
///
///     and after each frame's head, for each light present:
///         f32 importance, minimumQuality
///         u8 flags (1: near floor, 2: still, 4: new light in this slot, 8: directional, 16: point)
///         f32 pixels, casterTriangles, drawnTriangles, casters, drawnPixels, viewPixels, shadowPixels, treeLevels,
///         sharing
///         facts x f32
///         methods x { u16 updateGpu, updateCpu, resolveGpu, resolveCpu, u16 error, u8 spread, u16 quality,
///                     i16 suitability }
///     u64 FNV-1a of everything before
///
/// Times are the minimum over at least five separate sweeps: u16 = 1 + (log2 ms + 20) * 2048, 0 for none; a step is
/// 0.034 %. spread = 32 * log2(slowest sweep / fastest), so that raw times can be drawn again. error = 65535 * share of
/// wrong pixels in that frame. quality = 65535 * the share of the truth that the plan counts the method as keeping;
/// what it goes by, however wrong this one frame is. suitability is in steps of 1/4096, -1 without opinion, -2 unable,
/// -3 vetoed, as the rules in force saw it; a replay may ask other rules, from the facts. What casters fill and touch
/// of maps (cost::Workload::mapFilled, mapTouched) is not recorded: a replay takes maps for full.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "demo/io/outcome.hpp"

namespace gnomon::demo {

inline constexpr uint32_t kTraceMostFrames = 1u << 16;
inline constexpr uint32_t kTraceMostLights = 256;
inline constexpr uint32_t kTraceMostMethods = 32;
inline constexpr uint32_t kTraceMostFacts = 32;

enum : int16_t { kTraceNoOpinion = -1, kTraceUnable = -2, kTraceVetoed = -3 };

struct TraceMethod {
    float updateGpuMs = 0.0f, updateCpuMs = 0.0f; ///< Minimum over sweeps; 0: nothing to do.
    float resolveGpuMs = 0.0f, resolveCpuMs = 0.0f;
    float error = 0.0f;   ///< [0, 1]
    float spread = 1.0f;  ///< Slowest sweep over fastest, >= 1.
    float quality = 1.0f; ///< [0, 1]
    int16_t suitability = kTraceUnable;

    /// Both processors together: on a device that shares the CPU's cores they add up.
    double ms() const noexcept
    {
        return double{updateGpuMs} + double{updateCpuMs} + double{resolveGpuMs} + double{resolveCpuMs};
    }
};

struct TraceLight {
    bool present = false;
    bool fresh = false; ///< Another light than in the frame before.
    bool floor = false; ///< Near: minimumQuality holds.
    bool still = false;
    bool directional = false, point = false;
    float importance = 1.0f, minimumQuality = 0.0f;
    float pixels = 0.0f, casterTriangles = 0.0f; ///< And all that follow: as the cost model's Workload.
    float drawnTriangles = 0.0f, casters = 0.0f;
    float drawnPixels = 0.0f, viewPixels = 0.0f, shadowPixels = 0.0f, treeLevels = 0.0f;
    float sharing = 1.0f;
};

struct Trace {
    uint32_t frames = 0, lights = 0; ///< Slots; a light keeps its slot while it lives.
    float frameSeconds = 1.0f / 60.0f;
    std::vector<std::string> methods, facts;
    std::vector<float> mapTexels;        ///< Per method.
    std::vector<uint8_t> drawsVolumes;   ///< Per method.
    std::vector<uint8_t> tracesPixels;   ///< Likewise: a ray for every pixel.
    std::vector<float> budgetsMs;        ///< Per frame.
    std::vector<uint8_t> cuts;           ///< Per frame.
    std::vector<TraceLight> lightStates; ///< frames x lights
    std::vector<float> factValues;       ///< frames x lights x facts
    std::vector<TraceMethod> measures;   ///< frames x lights x methods

    /// Sizes all arrays for the numbers of frames, lights, methods and facts.
    void allocate();
    size_t cell(uint32_t frame, uint32_t light) const noexcept { return size_t{frame} * lights + light; }
    const TraceMethod& measure(uint32_t frame, uint32_t light, uint32_t method) const noexcept
    {
        return measures[cell(frame, light) * methods.size() + method];
    }
    TraceMethod& measure(uint32_t frame, uint32_t light, uint32_t method) noexcept
    {
        return measures[cell(frame, light) * methods.size() + method];
    }
};

/// Whether readTrace() takes as much.
bool fitsTrace(uint32_t frames, uint32_t lights, size_t methods, size_t facts) noexcept;

std::string writeTrace(const Trace& trace);
/// Any bytes may come in: what is no trace, was cut short or damaged is an error that names the place.
Outcome<Trace> readTrace(std::string_view bytes);

} // namespace gnomon::demo
