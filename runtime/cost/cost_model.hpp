#pragma once

/// How long a method will take for a light: milliseconds per term from a knowledge base, corrected by timings.
///
///     log2 ms = log2(sum over processors of 2^device * (ms per term . terms)) + method + own
///
/// Three corrections, in octaves, each with its variance. `device`, one of each processor, is common to all methods: a
/// device that nobody has measured. `method` is common to all lights of a method and pass: a scene has its own ways,
/// and what one light has shown of a method is at once expected of the others. `own` is what one light differs by.
/// A timing's error is shared out in this order, each taking the part that its variance is of the whole, as in a Kalman
/// filter (R. E. Kalman, "A new approach to linear filtering and prediction problems", 1960). Steps of the world (a
/// clock that drops) show in several frames in a row; a spike shows in one and is not believed.
///
/// An unmeasured light's variance is what its class has shown, so `sureMs` of what nobody has measured is far above
/// `ms`, and choices ask for `sureMs`: unknown is never cheap. What one light differs by evens out over those that
/// share a view; what a whole method may be off by does not.
///
/// Only + - * / and square roots on doubles, in fixed order: the same observations give the same bits everywhere.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/cost/knowledge_base.hpp"
#include "runtime/cost/weighted_median.hpp"
#include "runtime/cost/workload.hpp"

namespace gnomon::cost {

/// What is timed in the first frame after a switch is passed over: allocation, maps of what stands still.
inline constexpr uint32_t kSettleFrames = 1;
/// So many frames are timed once it has settled: the middle of three is believed.
inline constexpr uint32_t kPersistentTimings = 3;
/// From a switch on, until its timings are taken.
inline constexpr uint32_t kLearnFrames = kSettleFrames + kPersistentTimings;

/// One timing of one pass of a light, both processors.
struct Observation {
    uint32_t light = 0; ///< Slot below the lights of resize().
    uint32_t method = 0;
    Pass pass = Pass::resolve;
    Workload workload;
    double gpuMs = 0.0, cpuMs = 0.0;
    uint64_t framesSinceSwitch = 1u << 30; ///< Frames since the light's method changed.
    bool disturbed = false; ///< Pipeline compilation, resize, capture, first use: not the method's doing.
};

struct Prediction {
    double ms = 0.0;
    double sigmaMs = 0.0;      ///< One standard error in a sum over the lights of a view, whose differences even out.
    double sigmaOctaves = 0.0; ///< The same, relative: of log2 ms.
    double ownOctaves = 0.0;   ///< Of this light by itself.
    bool measured = false;     ///< On this light; else it is the class that speaks,
    bool familiar = false;     ///< or other lights of this scene.

    /// What it will hardly exceed: ms, kSure standard errors higher.
    double sureMs() const noexcept;
    /// What this light may take if the prediction is too high by so many standard errors.
    double luckyMs(double sigmas) const noexcept;
};

/// Standard errors that a choice adds to what it does not know. With one, five in six times are below it.
inline constexpr double kSure = 1.0;

/// Whose numbers were taught. A device of the same name may have another clock, other cores (a software device) or
/// other work to do.
enum class Kinship : uint8_t { same, alike, foreign };

/// What stays when the program ends is the knowledge base's; this is the learner.
class CostModel {
public:
    /// Sets the numbers of methods and light slots; keeps what is known of those that stay. Allocates.
    void resize(uint32_t methods, uint32_t lights);

    /// On a device whose "GPU" runs on the CPU's cores both are one device, with one factor. Before the first timing.
    void setSharedCores(bool shared) noexcept { sharedCores_ = shared; }
    bool sharedCores() const noexcept { return sharedCores_; }

    /// Where predictions of a method start. @param doubt octaves by which its class may be off beside each track's own;
    /// 0: these numbers are the method's
    void teach(uint32_t method, const std::array<TrackCost, kTracks>& tracks, double doubt) noexcept;
    /// How much the numbers taught say about this device. Forgets the device factor.
    void setKinship(Kinship kinship) noexcept;

    /// Timings are collected between these two, one frame at a time, in any number. No allocation.
    void observe(const Observation& observation) noexcept;
    void endFrame() noexcept;

    /// A light is gone, and its slot free. What is known of the scene stays.
    void forgetLight(uint32_t light) noexcept;

    /// GPU and CPU milliseconds together, as budgets and measured times are given. A light beyond those of resize() is
    /// one that no method has served.
    Prediction predict(uint32_t light, uint32_t method, Pass pass, const Workload& workload) const noexcept;
    /// Update and resolve of a mean frame; `updateSkipped` when what the update would make is still valid.
    Prediction predict(uint32_t light, uint32_t method, const Workload& workload, bool updateSkipped) const noexcept;

    /// The device's factor, by Processor.
    std::array<double, 2> deviceOctaves() const noexcept { return {devices_[0].octaves, devices_[at(1)].octaves}; }
    uint64_t samples() const noexcept { return samples_; }
    /// Grows when what is expected of lights that were not timed has changed: predictions are out of date.
    uint64_t revision() const noexcept { return revision_; }

private:
    /// A correction.
    struct Belief {
        double octaves = 0.0;
        double variance = 0.0;
        double factor = 1.0; ///< 2^octaves.

        void shift(double by) noexcept;
        double take(double error, double otherVariance) noexcept;
    };
    struct Method {
        std::array<TrackCost, kTracks> tracks;
        std::array<Belief, 2> scene;   ///< By Pass.
        std::array<double, 2> prior{}; ///< Variance of `scene` before anything is timed.
        std::array<double, 2> among{}; ///< Variance among lights, by Pass.
        bool timed = false;            ///< With any light.
    };
    /// What one light differs by, of one method and pass.
    struct Own {
        double octaves = 0.0;
        std::array<double, 3> recent{}; ///< Errors less everything but `octaves`.
        double logBase = 0.0;           ///< log2 of the knowledge base's milliseconds at the newest timing.
        uint32_t count = 0;
        bool onGpu = true; ///< Where most of the time goes.
    };
    /// What timings of the current frame are off by.
    struct Surprise {
        uint32_t light, method;
        Pass pass;
        double octaves; ///< Less all that was known.
        double ms;      ///< Predicted.
        double base;    ///< log2 of the base's milliseconds.
        bool settled;   ///< The light's own correction was known.
        bool onGpu;     ///< Where most of the time is predicted.
    };
    struct Base {
        double ms = 0.0, gpuMs = 0.0;
    };

    size_t at(size_t processor) const noexcept { return sharedCores_ ? 0 : processor; }
    Base baseOf(const Method& method, Pass pass, const Workload& workload) const noexcept;
    Own& own(uint32_t light, uint32_t method, Pass pass) noexcept
    {
        return own_[(size_t{light} * methods_.size() + method) * 2 + static_cast<size_t>(pass)];
    }
    const Own* find(uint32_t light, uint32_t method, Pass pass) const noexcept;
    void learnDevice(size_t processor) noexcept;
    double medianOf(size_t processor, bool settled, uint32_t& methods, double& doubt) noexcept;
    void shiftKnown(size_t processor, double octaves) noexcept;
    void learnMethods() noexcept;
    void learnLight(const Surprise& surprise) noexcept;

    std::vector<Method> methods_;
    std::vector<Own> own_;
    uint32_t lights_ = 0;
    bool sharedCores_ = false;
    std::array<Belief, 2> devices_{Belief{0.0, 9.0}, Belief{0.0, 9.0}}; ///< By Processor; kForeign.
    struct Steps {
        std::array<double, 5> medians{}; ///< Of the newest frames.
        uint32_t next = 0;
    };
    std::array<Steps, 2> steps_;      ///< By Processor.
    std::vector<Surprise> surprises_; ///< Fixed size, more are not collected.
    std::vector<Weighted> votes_;     ///< Scratch, of the same size.
    uint32_t surpriseCount_ = 0;
    uint64_t samples_ = 0, revision_ = 0;
};

} // namespace gnomon::cost
