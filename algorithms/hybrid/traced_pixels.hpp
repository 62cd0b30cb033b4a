#pragma once
// One ray a pixel towards the light's centre: all of ray_traced, and what soft methods are for a light without a
// radius.
#include "runtime/algorithm.hpp"

namespace gnomon {

/// What the rows, the host pass and the copy are called, "algorithm.what".
struct TracedNames {
    const char *visibility, *trace, *copy;
};

/// Declares the passes that write the task's layer. @param reasons codes instead of visibility
/// (shaders/hybrid/reasons.h).
void declareTracedPixels(PassBuilder& passes, const ShadowTask& task, const TracedNames& names, bool reasons = false);

} // namespace gnomon
