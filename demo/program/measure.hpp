#pragma once
// Frames of one method beside the same frames without shadows, and the same scene as the truth sees it. Shared by
// `bench` and `contact`.

#include <memory>
#include <optional>

#include "demo/program/commands.hpp"
#include "demo/program/error_count.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

inline constexpr const char* kNoneMethod = "none";
inline constexpr const char* kBareMethod = "bare_shadow_map";
inline constexpr const char* kTruthMethod = "ray_traced";
inline constexpr const char* kSamplesSetting = "samples"; ///< Of the truth: rays a pixel to a light with a radius.
inline constexpr uint32_t kTruthSamples = 1024;
inline constexpr const char* kResolutionSetting = "resolution";
inline constexpr const char* kRowsSetting = "rows"; ///< Of a table: what a map's side is to a map.

/// Frames before the first measured pair: pipelines and their shaders, pools and lists reach their final size.
inline constexpr uint32_t kWarmFrames = 3;

/// Whether a method with these traits serves any of the lights.
bool servesOne(const Scene& scene, GnTraits traits);

/// The scene with only those lights that a method with these traits serves.
Scene onlyServed(const Scene& scene, GnTraits traits);

/// Gives the lights these radii instead of their own.
void setSourceSizes(Scene& scene, const SourceSizes& sizes);

/// One of the lights in use has the name; else throws HostError.
void requireLight(const Scene& scene, const std::string& name);

/// Names of the lights that are not there at the time, with commas between them.
std::string absentLights(const Scene& scene, double time);

/// Leaves the scene the lights of these names alone, in its own order. requireLight() each.
void keepLights(Scene& scene, const std::vector<std::string>& names);

/// What the truth says about the present lights of a scene at one time.
struct Truth {
    FrameSurfaces surfaces;
    CameraMatrices camera;
    SceneState state;
    std::vector<std::string> lights; ///< Names, in layer order.
    std::vector<Image8> visibility;  ///< Hard, whatever the lights' radii.
    std::vector<Image8> soft;        ///< Of lights with a radius; of others, an empty picture.
    std::vector<std::vector<uint8_t>> counted;

    const Image8* find(const std::string& light, const std::vector<uint8_t>** countedPixels) const;
};

/// Empty where this build has no ray tracing.
std::optional<Truth> measureTruth(Device& device, const Scene& scene, VkExtent2D size, double time);

/// One frame of the first view, and a wait for it.
void drawOnce(Session& session, double time, bool recorded);

/// Draws until `method`, which all lights are pinned to, serves them (warm-up of that method alone, workers), then
/// leaves the newest frame at `time`. Throws HostError with gnomon's explanation where it does not come to serve them,
/// for want of memory for instance.
void settle(Session& session, const std::string& method, double time, bool recorded);

/// One method must not end a long measurement: what it failed with goes to the standard error output.
void noteLeftOut(const std::string& scene, const std::string& method, const HostError& error);

struct PairTimes {
    std::vector<double> withMs, withoutMs;           ///< Wall time of each frame of the interleaved pairs.
    std::vector<double> gpuMs, cpuMs;                ///< As gnomon reports them.
    std::vector<double> raysMs;                      ///< Inside the ray tracer, all threads.
    uint64_t pagesEvicted = 0, pagesWithoutRoom = 0; ///< Of all frames.
    uint32_t unpinned = 0;      ///< Frames in which a light was served by another method than its own.
    uint32_t unpinnedLight = 0; ///< One of them, in the newest such frame.
    uint64_t unpinnedFrame = 0;
};

/// Alternates frames without and with shadows; both of a pair show the same time. \param shadows false: `other`
/// instead.
PairTimes timePairs(Session& session, uint32_t pairs, bool recorded, OtherShadows* other);

struct PassTime {
    std::string name;
    uint32_t count = 0; ///< In one frame, all lights together.
    double gpuMs = 0.0; ///< Fastest frame's sum.
    double cpuMs = 0.0;
};
/// What each pass of a method takes, from timed frames: full barriers around every pass, so the sum is more than the
/// frame without them.
std::vector<PassTime> timePasses(Session& session, uint32_t frames);

double minimum(const std::vector<double>& values);
double median(std::vector<double> values);
/// The value that a share of them is at most. \pre there are some
double quantile(std::vector<double> values, double share);

} // namespace gnomon::demo
