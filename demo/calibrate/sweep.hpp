#pragma once
// Measuring: every method on the generated sweep, or on the lights of a scene.

#include "demo/calibrate/light_times.hpp"
#include "demo/calibrate/sweep_scene.hpp"

namespace gnomon::demo {

/// A method with what matters here.
struct SweepMethod {
    std::string name, algorithm;
    GnTraits traits = 0;
    bool hasMap = false;
};

/// Methods of this build that the device can run; fails naming one that is wanted and unknown.
Outcome<std::vector<SweepMethod>> sweepMethods(Device& device, const std::vector<std::string>& wanted);

/// What a method's sweep has measured so far.
struct SweepRun {
    std::vector<Sample> rows;
    std::vector<SharedSample> shared; ///< Sums (addShared()).
    uint32_t points = 0;
    size_t next = 0;      ///< Point of the sweep.
    double seconds = 0.0; ///< Spent.
};

/// To learn from: as many as a fit has coefficients.
constexpr uint32_t kLeastPoints = cost::kTerms;

class Sweeper {
public:
    explicit Sweeper(Device& device);
    /// The method's next points, as many as fit until `seconds` are spent in all, but until there are so many.
    void proceed(SweepRun& run, const SweepMethod& method, double seconds, uint32_t leastPoints);

private:
    bool measureErrors(std::vector<Sample>& rows, const MomentTimes& times);

    Device& device_;
    Sweep sweep_;
    Session session_;
};

/// The lights of a scene at a few moments, each moving on for some frames. Only lights that the method serves. In the
/// order of moments and lights, the same at every call.
std::vector<Sample> measureScene(Device& device, const Scene& scene, const SweepMethod& method, VkExtent2D size,
                                 uint32_t moments);

} // namespace gnomon::demo
