#pragma once

/// How long a method will take for a light, learned from timings.
///
/// Per method and *track* (update or resolve, GPU or CPU) the logarithm of the time is linear in the features:
///
///     log2 ms = theta . f + device + residual(light, method)
///
/// f holds 1, log2 of pixels, triangles, instances and texels, flags for the kind of light, and two or three
/// products of these: real times are sums (an overhead, a part per triangle, a part per texel), and the logarithm of a
/// sum of powers is a bent surface. On such truths the bend takes the median error from 26 to 8 %.
/// theta comes from calibration and is refined by recursive least squares; `device` is one number of each processor,
/// common to all methods, so that a new GPU is known after a few frames, and a step of which is believed where passes
/// that take most of the time show it, of lights whose time was known or of several methods; the residual is what this
/// light differs by, and of a light that the method has not served what its other lights differ by: a scene has its own
/// ways. Steps of the world (a clock that drops, a scene that doubles) show in several frames in a row and are taken
/// over at once; a spike shows in one and is not.
///
/// Only + - * / and square roots on doubles, in fixed order: the same observations give the same bits everywhere.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/cost/weighted_median.hpp"

namespace gnomon::cost {

enum class Pass : uint8_t { update, resolve }; ///< What a cache can skip; what every pixel pays.
enum class Processor : uint8_t { gpu, cpu };   ///< On a software device both are the same cores.

inline constexpr uint32_t kTracks = 4; ///< Pass x Processor.
constexpr uint32_t trackOf(Pass pass, Processor processor)
{
    return static_cast<uint32_t>(pass) * 2 + static_cast<uint32_t>(processor);
}

/// What the time depends on.
struct Workload {
    double pixels = 0.0;                     ///< Reached by the light.
    double casterTriangles = 0.0;            ///< In range of the light.
    double mapTexels = 0.0;                  ///< Of the method's maps for this light; 0: none.
    double sharing = 1.0;                    ///< Lights of the frame.
    bool still = false;                      ///< Light and casters stand still: the update may be skipped.
    double drawnTriangles = 0.0;             ///< Of the casters', those an update draws; 0: all of them.
    double casters = 0.0;                    ///< Instances in range.
    bool directional = false, point = false; ///< Kind of light; neither: a spot light.
    double drawnPixels = 0.0;                ///< Of the screen rectangle around the light; 0: `pixels`.
    double viewPixels = 0.0;                 ///< Of the view; 0: `pixels`.
    double shadowPixels = 0.0;               ///< Covered by the sides of shadow volumes; 0 for methods that draw none.
    double mapFilled = 1.0;  ///< Of the map's texels, by the casters that an update draws; each counts. May exceed 1.
    double mapTouched = 1.0; ///< Share of the maps (one, or six faces) that these casters touch.
    double treeLevels = 0.0; ///< On the way of a reached pixel's ray; 0 for methods that trace few.

    bool operator==(const Workload&) const = default;
};

inline constexpr uint32_t kFeatures = 10;
using Features =
    std::array<double, kFeatures>; ///< 1, then the workload in logarithms less a reference size, then curvature.
Features featuresOf(const Workload& workload, Pass pass) noexcept;

/// What is timed in the first frames after a switch is passed over: caches, allocation, clocks.
inline constexpr uint32_t kSettleFrames = 3;
/// Timings alike that replace what was thought of a light. So many frames are timed once it has settled.
inline constexpr uint32_t kPersistentTimings = 4;
/// From a switch on, until its timings are taken.
inline constexpr uint32_t kLearnFrames = kSettleFrames + kPersistentTimings;

/// One timing.
struct Observation {
    uint32_t light = 0; ///< Slot below the lights of resize().
    uint32_t method = 0;
    Pass pass = Pass::resolve;
    Processor processor = Processor::gpu;
    Workload workload;
    double ms = 0.0;
    uint64_t framesSinceSwitch = 1u << 30; ///< Frames since the light's method changed.
    bool disturbed = false; ///< Pipeline compilation, resize, capture, first use: not the method's doing.
};

struct Prediction {
    double ms = 0.0;
    double sigmaMs = 0.0;      ///< One standard error.
    double sigmaOctaves = 0.0; ///< The same, relative: of log2 ms.
    bool calibrated = false;   ///< False: a guess from the prior.
};

/// What stays when the program ends is the knowledge base's (knowledge_base.hpp); this is the learner.
class CostModel {
public:
    /// Sets the numbers of methods and light slots; keeps what is known of those that stay. Allocates.
    void resize(uint32_t methods, uint32_t lights);

    /// On a device whose "GPU" runs on the CPU's cores both are one device, with one factor. Before the first timing.
    void setSharedCores(bool shared) noexcept { sharedCores_ = shared; }
    bool sharedCores() const noexcept { return sharedCores_; }

    /// Least squares over one measurement of a calibration run: no forgetting, no clipping. Calibrations of another
    /// device are fine: the device factor is learned on top.
    void calibrate(uint32_t method, Pass pass, Processor processor, const Workload& workload, double ms) noexcept;
    /// True if the timings of calibrate() came from this device: its factor starts as known.
    void finishCalibration(bool sameDevice) noexcept;

    /// Timings are collected between these two, one frame at a time, in any number. No allocation.
    void observe(const Observation& observation) noexcept;
    void endFrame() noexcept;

    /// A light is gone, and its slot free. What is known of the scene stays until a timing says more, for which the
    /// light no longer counts.
    void forgetLight(uint32_t light) noexcept;

    /// GPU and CPU milliseconds together, as budgets and measured times are given.
    /// Not for two threads at a time. Cheapest light by light, pass by pass: a workload's logarithms are taken once.
    Prediction predict(uint32_t light, uint32_t method, Pass pass, const Workload& workload) const noexcept;
    /// Update and resolve; `updateSkipped` when what the update would make is still valid.
    Prediction predict(uint32_t light, uint32_t method, const Workload& workload, bool updateSkipped) const noexcept;

    /// The device's factor, by Processor.
    std::array<double, 2> deviceOctaves() const noexcept { return {deviceOf(0).octaves, deviceOf(1).octaves}; }
    uint64_t samples() const noexcept { return samples_; }

private:
    using Matrix = std::array<double, kFeatures * kFeatures>;
    struct Track {
        Features theta{};
        Matrix covariance{};
        double noise = 0.0;  ///< Variance of one timing, octaves squared.
        double lights = 0.0; ///< Variance among lights, octaves squared.
        double scene = 0.0;  ///< What lights that were timed differ by on average: expected of the others. Octaves.
        uint32_t samples = 0;
        bool seen = false;  ///< Any timing at all: a track never seen predicts nothing.
        bool timed = false; ///< In the current frame.
    };
    struct Residual {
        double octaves = 0.0;
        double samples = 0.0; ///< Effective; fades with the distance of the features.
        std::array<double, kPersistentTimings> recent{};
        Features at{};
        uint8_t recentCount = 0, recentNext = 0;
    };
    /// What all methods have in common on one processor, and what the current frame's timings say of it.
    struct Device {
        double octaves = 0.0;
        double variance = 0.0;
        uint32_t frames = UINT32_MAX; ///< That it was learned from; a fresh model is at home.
        std::vector<Weighted> votes;  ///< Fixed size, more are not collected.
        uint32_t voteCount = 0;
        uint32_t settled = 0;          ///< Of these, by lights whose time was known: the first ones.
        uint32_t method = 0;           ///< The newest one's;
        bool mixed = false;            ///< whether there were others.
        std::array<double, 5> steps{}; ///< Medians of the newest frames.
        uint32_t stepNext = 0;
    };
    struct Octaves {
        double mean = 0.0, variance = 0.0;
        bool calibrated = false;
    };

    Track& track(uint32_t method, uint32_t t) noexcept { return tracks_[method * kTracks + t]; }
    const Track& track(uint32_t method, uint32_t t) const noexcept { return tracks_[method * kTracks + t]; }
    Residual& residual(uint32_t light, uint32_t method, uint32_t t) noexcept
    {
        return residuals_[(size_t{light} * methods_ + method) * kTracks + t];
    }
    static void reset(Track& track, uint32_t t) noexcept;
    static double fit(Track& track, const Features& f, double error, double forgetting) noexcept;
    void learn(Residual& residual, const Features& f, double error) noexcept;
    static double effectiveSamples(const Residual& own, const Features& f) noexcept;
    double trust(const Track& track, double samples) const noexcept;
    void noteScene(uint32_t method, uint32_t t) noexcept;
    const Features& recall(const Workload& workload, Pass pass) const noexcept;
    Octaves octaves(uint32_t light, uint32_t method, uint32_t t, const Features& f) const noexcept;
    static Prediction sumOf(const Prediction& gpu, const Prediction& cpu) noexcept;
    static bool isSettled(const Residual& own, const Features& f) noexcept;
    Device& deviceOf(uint32_t t) noexcept { return devices_[sharedCores_ ? 0 : t % 2]; }
    const Device& deviceOf(uint32_t t) const noexcept { return devices_[sharedCores_ ? 0 : t % 2]; }
    static void noteVote(Device& device, const Weighted& vote, uint32_t method, bool settled) noexcept;
    static uint32_t votesThatCount(const Device& device) noexcept;
    void noteStep(Device& device, double frameMedian) noexcept;

    uint32_t methods_ = 0, lights_ = 0;
    bool sharedCores_ = false;
    std::vector<Track> tracks_;
    std::vector<Residual> residuals_;
    std::array<Device, 2> devices_; ///< By Processor.
    /// Methods of one light ask with the same workload one after another; its logarithms are taken once.
    struct Recalled {
        Workload workload;
        Features features{};
        bool valid = false;
    };
    struct Recall {
        std::array<Recalled, 4> newest{}; ///< Methods of a light differ in texels alone: none, a map's, six maps'.
        uint32_t next = 0;
    };
    mutable std::array<Recall, 2> recalled_{}; ///< By pass.
    uint64_t samples_ = 0;
};

} // namespace gnomon::cost
