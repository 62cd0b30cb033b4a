#pragma once
// What whole frames took, and what no light of them is charged with.
#include <cstdint>
#include <span>

#include "runtime/frame/past_frames.hpp"
#include "runtime/frame/timed_frames.hpp"
#include "runtime/passes/pass_executor.hpp"
#include "runtime/select/shared_parts.hpp"

namespace gnomon {

/// The newest frame whose total is known, and how much the barriers of a timed frame slow it down.
class FrameTotals {
public:
    /// @param whole, timed what the executor knows last; null: nothing
    void note(const FrameTimings* whole, const FrameTimings* timed, const PastFrames& past);
    /// Compares a timed frame with the newest untimed one. The middle of five such pairs, since either frame may have
    /// been disturbed; by weight, since barriers are a third of a millisecond of copies and next to nothing of twenty
    /// of drawing.
    void noteScale(const FrameTimings& timed, const PastFrames& past);

    bool known() const { return gpuMs_ > 0.0f; }
    std::uint64_t frame() const { return frame_; }
    float gpuMs() const { return gpuMs_; }
    float cpuMs() const { return cpuMs_; }
    /// Of all shadow passes, GPU and host; < 0: not known.
    double ms() const { return known() ? double{gpuMs_} + double{cpuMs_} : -1.0; }
    /// From what a pass takes in a timed frame to its share of an untimed one.
    float scale() const { return scale_; }

private:
    void take(std::uint64_t frame, float gpuMs, const PastFrames& past);

    std::uint64_t frame_ = 0;
    float gpuMs_ = 0.0f, cpuMs_ = 0.0f;
    WeightedMedianOfFive ratios_;
    float scale_ = 1.0f;
};

/// What lights share, or nobody asked for, in frames timed unasked: one in four or more brings a depth grid.
class SharedCosts {
public:
    /// The depth grid and moved instances are there whatever the methods, so that lights may spend what they leave of a
    /// budget; copies for the CPU and whatever else methods share within a view, with the first of them. What a method
    /// makes once for a mesh is its first frame's. Of frames that the host has timed seven in eight bring no grid.
    /// @param then what is known of the frame
    void note(const FrameTimings& timings, const PastFrame& then, float scale);
    /// What showing two methods takes beside them: a pass that neither of them is charged with.
    void noteMixes(const FrameTimings& timings, float scale);

    /// What a knowledge base says that methods share (SharedParts::teach()).
    void teach(std::span<const cost::KnowledgePart> parts, std::span<const std::string_view> algorithms) noexcept
    {
        parts_.teach(parts, algorithms);
    }

    float ms() const { return all_.get(); }
    float unaskedMs() const { return unasked_.get(); } ///< Of that, what no method asked for.
    float mixMs() const { return mix_.get(); }         ///< Of a light's mix pass.
    std::span<const plan::SharedPart> parts(double pixels) { return parts_.parts(pixels); } ///< The rest.

private:
    SecondOfEight all_, unasked_;
    SharedParts parts_;
    MedianOfFive mix_;
};

/// All that earlier frames have told.
struct FrameHistory {
    PastFrames past;
    FrameIntervals intervals;
    FrameTotals totals;
    SharedCosts shared;
    TimedFrames timed;
    std::uint64_t learnedFrom = 0; ///< The newest timed frame that lights were charged with.
    double predictedMs = 0.0;      ///< Of the methods of the newest frame.
};

} // namespace gnomon
