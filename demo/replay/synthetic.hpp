#pragma once

/// Invented traces: worlds whose times are sums of powers, which the cost model does not fit exactly, with a factor of
/// its own for every light and method. They rank policies; they predict no device. The seed settles every number.

#include <cstdint>

#include "demo/replay/trace.hpp"

namespace gnomon::demo {

enum class SyntheticKind : uint8_t {
    still,    ///< Nothing moves.
    slowWalk, ///< Facts drift over tens of seconds.
    stress, ///< Faster drift, a cut every 8 s, lights that come and go, all times doubled from 60 to 80 % of the trace.
    budgetStep, ///< A slow walk whose budget falls by a third, and comes back.
};

struct SyntheticOptions {
    SyntheticKind kind = SyntheticKind::still;
    uint32_t frames = 1800; ///< 30 s at 60 Hz.
    uint32_t lights = 16;
    uint64_t seed = 1;
    /// Budget over the cheapest plan that keeps the floor, median over the frames.
    double budgetOverCheapest = 2.0;
};

Trace syntheticTrace(const SyntheticOptions& options);

} // namespace gnomon::demo
