#pragma once
// What could be had of several methods frame by frame, from runs that were repeated in turns.
#include <span>
#include <vector>

namespace gnomon::demo {

/// Milliseconds of each frame of each run, [run][frame]. Runs of the same number were made one after the other.
using RunTimes = std::vector<std::vector<double>>;

/// Of each frame, over the runs.
std::vector<double> fastestFrames(const RunTimes& runs);

/// Of each frame, the fastest of the methods. Where several take as long, this is below each of them: of numbers that
/// scatter, the least is taken.
/// \param methods at least one, of as many frames each
std::vector<double> envelopeOf(std::span<const RunTimes* const> methods);

/// What runs took over what they would have, had every frame been drawn by the method that was fastest in it in the
/// other runs: of what is chosen, no number is used that it was chosen by, so methods that take as long give 1.
/// \param runs and methods: as many runs and frames each
/// \return NaN where there are fewer than two runs
double overChosenElsewhere(const RunTimes& runs, std::span<const RunTimes* const> methods);

} // namespace gnomon::demo
