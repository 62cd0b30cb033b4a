#pragma once
// `budget: auto`: a budget for hosts that name none, from what the cheapest acceptable plan takes here.
#include <array>
#include <cstdint>

namespace gnomon {

/// 1.3 times the cheapest plan that keeps the near floor, measured in the first second, in which that plan runs; again,
/// in a part of a second, after a camera cut and once an eighth of the lights have come or gone to stay: that plan is
/// another one. Lights that flicker, views that take turns and cuts in every frame do not keep it measuring. In between
/// it follows what the cheapest plan is predicted to take in each frame, times what such plans took lately over what
/// had been predicted of them: while the plan in force is about as cheap, every frame tells. A camera that walks up to
/// what is lit, and lights that come one by one, would else leave a budget behind that no plan keeps.
class AutoBudget {
public:
    /// Room for one step up where every light has the cheapest method.
    static constexpr double kFactor = 1.3;
    /// The first second, in frames at 60 Hz; where frames are slower, one second of time, but two timed frames (one in
    /// eight) on either side of the half that counts.
    static constexpr std::uint32_t kMostFrames = 60;
    static constexpr std::uint32_t kFewestFrames = 32;
    /// What is known of the methods by then need not be learned again: one timed frame on either side.
    static constexpr std::uint32_t kFewestAgain = 16;
    /// Other lights that stay so many frames, half a second at 60 Hz, are there to stay; and between two cuts that
    /// count lies as much.
    static constexpr std::uint32_t kSettled = 30;
    /// Frames of whose median the budget follows: a quarter second at 60 Hz. Spikes do not move it, and what comes up
    /// within eight frames finds room in kFactor.
    static constexpr std::uint32_t kFollowed = 16;
    /// Plans this much costlier than the cheapest one, as predicted, still measure it: an incumbent stays for less
    /// (plan::kChangeMargin).
    static constexpr double kAsCheap = 1.1;

    /// Measures again.
    void restart() { *this = {}; }
    /// Each frame, before note(). @param lights of all views
    void look(std::uint32_t lights, bool cut);
    bool measuring() const { return ms_ == 0.0; }
    /// One frame of the cheapest plan. @return true if this frame made the budget known.
    /// @param tookMs     Of all shadow passes, > 0.
    /// @param intervalMs Since the frame before.
    bool note(double tookMs, double intervalMs);
    /// One frame of any plan.
    /// @param tookMs     Of all shadow passes.
    /// @param plannedMs  What the plan in force was predicted to take,
    /// @param cheapestMs and the cheapest one.
    void follow(double tookMs, double plannedMs, double cheapestMs);
    /// As it was measured, first and then by the median of the newest plans as cheap; 0 while measuring.
    double ms() const { return ms_; }
    /// The budget over what the cheapest plan is predicted to take, near ms() (plan::kLeash); 0 while measuring, and
    /// while too little is known.
    double perCheapest() const { return measuring() ? 0.0 : kFactor * ratio_; }

private:
    std::array<double, kMostFrames> tookMs_{};    ///< Those that measured.
    std::uint32_t frames_ = 0;                    ///< In tookMs_.
    std::array<double, kFollowed> cheapTookMs_{}; ///< As the cheapest plan would have; a ring.
    std::array<double, kFollowed> ratios_{};      ///< Took over predicted; a ring.
    std::uint32_t followed_ = 0;
    double ratio_ = 0.0;       ///< Their median, once the ring is full.
    std::uint32_t lights_ = 0; ///< That it is, or was, measured with.
    std::uint32_t known_ = 0;  ///< Frames since it was measured, ...
    std::uint32_t other_ = 0;  ///< ... of these the newest ones with other lights, in a row.
    bool again_ = false;
    double elapsedMs_ = 0.0;
    double ms_ = 0.0;
};

} // namespace gnomon
