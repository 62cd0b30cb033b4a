#pragma once
// What the shadows of each frame of a run took. The GPU's part is known two frames late and must not be added to
// another frame's host part.
#include <cstdint>
#include <vector>

#include "demo/host/shadow_host.hpp"

namespace gnomon::demo {

class ShadowTimes {
public:
    /// After every frame.
    void note(const ShadowHost& shadows);
    /// GPU and host passes of a frame, ms. Of a timed frame, whose passes run one by one, their sum.
    /// \return NaN where it is not known, as of the newest frames.
    double ms(uint64_t frame) const;

private:
    void take(uint64_t frame, double ms);

    uint64_t first_ = 0; ///< Frame of ms_[0].
    std::vector<double> ms_;
    std::vector<GnPassTiming> passes_;
};

} // namespace gnomon::demo
