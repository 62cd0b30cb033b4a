// The default choice against pinned methods in one run, in turns, so that a machine that slows down does so for all.
#ifndef GNOMON_TESTS_HOST_CONTEST_HPP
#define GNOMON_TESTS_HOST_CONTEST_HPP

#include <memory>
#include <string>
#include <vector>

#include "turns.hpp"

namespace stranger {

/// What a pinned method took and showed.
struct Rival {
    std::string name;
    std::unique_ptr<Renderer> renderer;
    double lookMs = 0.0;         ///< Median of some of its first frames.
    double wrongPercent = 0.0;   ///< Largest of the moments looked at.
    std::vector<double> turnsMs; ///< Medians, one of each turn it had against the default.
};

struct Contest {
    std::vector<Rival> rivals; ///< That serve and are not hopelessly slow, cheapest first look first.
    std::vector<double> defaultTurnsMs;
    double firstFrameMs = 0.0;                   ///< Of the default, after gnWarmUp().
    double defaultWrongPercent = 0.0;            ///< Largest of the moments looked at, after its first second.
    double allowedWrongPercent = 0.0;            ///< Up to this a rival's quality equals the default's.
    std::string choices;                         ///< Of the default in its last frame.
    uint32_t framesOver = 0, framesBudgeted = 0; ///< After the first second with a budget.
    double budgetMs = 0.0;
    std::string choicesBudgeted; ///< In the last of these frames.

    double defaultMs() const;
    /// Of those that had turns; null: there is none of equal quality.
    const Rival* best() const;
};

/// Runs all of it for an entry point and prints the figures.
Contest holdContest(const Device& device, bool recorded);

} // namespace stranger
#endif
