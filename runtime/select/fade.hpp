#pragma once
// The cross-fade of a light whose method changes: which two pictures are mixed, by how much, and what that may cost.
// Knows no device.
#include <cstdint>
#include <span>

namespace gnomon {

/// Of one light in one view. While a fade runs, the light's visibility is outgoing * (1 - share) + incoming * share,
/// and share grows by 1 / (n + 1) in each of n frames.
class Fade {
public:
    static constexpr std::uint32_t kNone = UINT32_MAX;

    struct Step {
        std::uint32_t outgoing = kNone; ///< Runs beside the light's method; kNone: there is no fade.
        float share = 1.0f;             ///< Of the light's method, (0, 1].
        bool begun = false;             ///< An earlier frame showed this fade already.
    };

    /// The next frame, in which the light has `method`; call it once a frame.
    /// Back to the outgoing method, the fade turns round. A third method starts a fade of its own from whichever of the
    /// two is the more visible.
    /// @param length n of the fades that begin; 0 ends those that run.
    /// @param jump   The picture before is of no use, or nobody wants to see it: `method` shows at once.
    Step advance(std::uint64_t frame, std::uint32_t method, std::uint32_t length, bool jump);
    bool running() const { return now_.outgoing != kNone; }
    /// True for the methods, one or two, behind the newest picture: what they need is in use already.
    bool shows(std::uint32_t method) const { return method == now_.shown || method == now_.outgoing; }
    /// The mix that advance() asked for is not shown, the light's method is.
    void skip() { now_ = {.shown = now_.shown}; }
    /// The frame showed nothing of this light.
    void lose() { now_ = {}; }
    /// The frame is withdrawn: the next one shows what it would have shown.
    void withdraw(std::uint64_t frame);

private:
    struct State {
        std::uint32_t outgoing = kNone;
        std::uint32_t shown = kNone; ///< The method whose picture it is, or will be.
        std::uint32_t step = 0;      ///< Frames of the fade so far.
        std::uint32_t length = 0;
    };
    State now_, before_;
    std::uint64_t frame_ = 0; ///< Of `now_`; 0: none.
};

/// A fade that waits for the plan's word.
struct FadeRequest {
    double outgoingMs = 0.0; ///< Predicted.
    bool begun = false;
    bool admitted = false;
};

/// Admits what fits: fades that run before those that would begin, then in order.
/// @param plannedMs What the plan's methods take.
/// @param usableMs  Limit of all; infinite: there is none.
/// @return plannedMs and the outgoing methods of the admitted fades.
double admitFades(std::span<FadeRequest> requests, double plannedMs, double usableMs);

} // namespace gnomon
