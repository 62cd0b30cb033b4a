#pragma once
// Counts what gnomon draws from index lists, which only volumes are: triangles, and samples that pass the depth test,
// in queries around every such draw.
#include <cstdint>

#include "device/fixture.hpp"

namespace gnomon::test {

struct DrawCount {
    uint64_t draws = 0;
    uint64_t triangles = 0; ///< Assembled: those of draws with no instance are none.
    uint64_t samples = 0;   ///< Passing the depth test: what z-pass counts.
};

/// One at a time. Contexts made with options() are counted while it lives.
class DrawCounter {
public:
    DrawCounter();
    ~DrawCounter();
    DrawCounter(const DrawCounter&) = delete;
    DrawCounter& operator=(const DrawCounter&) = delete;

    /// Whether the device can count at all. Where it can, the host has to have asked for it, or validation complains.
    static bool possible();
    HostOptions options(HostOptions base = {}) const;
    /// Draws one frame of a host made with options(); waits for it.
    DrawCount count(Host& host, const FrameOptions& frame);
};

} // namespace gnomon::test
