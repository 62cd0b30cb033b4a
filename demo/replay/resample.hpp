#pragma once

/// A trace at the rate at which a runtime would decide.

#include "demo/replay/trace.hpp"

namespace gnomon::demo {

/// A trace is recorded every tenth of a second or so, because every method is measured in every frame; what decides
/// does so sixty times a second, and counts in frames. Between two recorded frames this puts as many as bring the rate
/// nearest to `framesPerSecond`: times and sizes go over in octaves, facts, errors and suitability in a straight line.
/// What jumps keeps its recorded value up to the frame it jumps in: budgets, flags, a light that is not in both frames,
/// whatever lies on both sides of a camera cut, a method with nothing to measure in one of them.
///
/// Never fewer frames than recorded; the frames recorded are among those of the result, unchanged.
Trace resample(const Trace& recorded, double framesPerSecond);

} // namespace gnomon::demo
