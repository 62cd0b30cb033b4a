#pragma once
// The zero of a frame's coordinates, which are floats.
#include <array>
#include <cstdint>
#include <span>

#include "gnomon/gnomon.h"

namespace gnomon {

/// Follows the first view's eye in steps of kStep.
class WorldOrigin {
public:
    /// Metres. At most three quarters of a step from the eye a float resolves 0.015 mm; with steps of 1024 m, rays left
    /// from one or two metres before the eye hit the surface they came from. Every step moves all that is kept, so
    /// smaller ones are not free either.
    static constexpr double kStep = 256.0;

    /// @return whether it moved: all revisions are others then, though nothing else has moved
    bool follow(std::span<const GnViewFrame> views, std::uint64_t frame);
    const std::array<double, 3>& at() const { return at_; }
    std::uint64_t movedIn() const { return movedIn_; } ///< Frame; 0: it has not.

private:
    std::array<double, 3> at_{};
    bool set_ = false;
    std::uint64_t movedIn_ = 0;
};

} // namespace gnomon
