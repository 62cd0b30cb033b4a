// The default choice against pinned methods in one run, in turns, so that a machine that slows down does so for all.
#ifndef GNOMON_TESTS_HOST_COMPARISON_HPP
#define GNOMON_TESTS_HOST_COMPARISON_HPP

#include <memory>
#include <string>
#include <vector>

#include "runs.hpp"

namespace stranger {

/// Wrong share that the near floor of the shipped rules allows: minimumQuality 0.875 = 1 / (1 + 0.143 %).
constexpr double kFloorWrongPercent = 0.143;

/// What a pinned method took and showed.
struct PinnedMethod {
    std::string name;
    std::unique_ptr<Renderer> renderer;
    double lookMs = 0.0;           ///< Median of some of its first frames.
    double wrongPercent = 0.0;     ///< Largest of the moments looked at.
    std::vector<double> mediansMs; ///< One of each alternation with the default; empty: it had none.
};

/// Frames of the default with a budget, after its first second, and as many of the best pinned method in between. The
/// budget that they are held against grows where that method has become slower; where its frames are over it all the
/// same, other work on the machine is the cause.
struct BudgetRun {
    double budgetMs = 0.0;
    double medianMs = 0.0, bestMedianMs = 0.0;
    double timesBest = 0.0; ///< Median of the ratios of alternations.
    uint32_t frames = 0, framesOver = 0, bestFramesOver = 0;
    std::string choices; ///< Of the default in its last frame.
};

struct Comparison {
    std::vector<PinnedMethod> pinned; ///< Some of those that can serve, cheapest first.
    std::vector<double> defaultMediansMs;
    double firstFrameMs = 0.0;  ///< Of the default, after gnWarmUp(): its shadows, or the call if that took longer.
    double steadyFrameMs = 0.0; ///< The same of its last frames.
    double defaultWrongPercent = 0.0; ///< Largest of the moments looked at, after its first second.
    double allowedWrongPercent = 0.0; ///< Up to this a pinned method is of equal quality.
    std::string choices;              ///< Of the default in its last frame.
    BudgetRun kept;                   ///< With a budget of 1.5 times the best pinned method.
    BudgetRun tooTight;               ///< With half of that method, which nothing of equal quality can keep.

    double defaultMs() const;
    /// What the default takes of a method's time: the median of the ratios of alternations.
    double timesMethod(const PinnedMethod& method) const;
    /// The cheapest in the alternations; null: none is of equal quality.
    const PinnedMethod* best() const;
};

/// Runs all of it for an entry point and prints the figures. Of equal quality is a pinned method whose wrong share is
/// at most the greater of the default's own and the near floor's. The three cheapest of them alternate with the
/// default.
Comparison compareEntry(const Device& device, bool recorded);

} // namespace stranger
#endif
