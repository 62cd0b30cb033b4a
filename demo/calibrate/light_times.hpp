#pragma once
// What the lights of a scene cost by one method, as the cost model is told: update and resolve, GPU and CPU apart.

#include <limits>
#include <string>
#include <vector>

#include "demo/calibrate/samples.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

/// Of sessions that measure: a frame is waited for before the next one anyway, and its timings are known one frame
/// sooner.
inline constexpr uint32_t kCalibrationFramesInFlight = 1;

/// Timings of one light in consecutive timed frames, beside the workload they were for.
struct LightTimes {
    uint32_t light = 0; ///< Index in the scene.
    cost::Workload workload;
    std::vector<double> updateGpuMs, updateCpuMs, resolveGpuMs, resolveCpuMs; ///< Updates: of frames that had one.
};

struct MomentTimes {
    std::vector<LightTimes> lights;   ///< Those that the method served, in layer order.
    std::vector<SharedSample> shared; ///< For all of them; names and times alone, the fastest of each.
    double firstFrameMs = 0.0;        ///< By which the first frame took longer than the median of the others.
    double lastTime = 0.0;            ///< Seconds, of the last frame drawn.
};

struct Moment {
    double time = 0.0; ///< Seconds.
    double step = 0.0; ///< Between frames; 0: nothing moves.
    uint32_t samples = 3;
    /// Where it would take longer: fewer samples, at least one.
    double seconds = std::numeric_limits<double>::infinity();
};

/// Makes the rules name one method for every light that it serves; unlike a pin this leaves the runtime measuring how
/// much of the picture a light reaches.
void useMethod(ShadowHost& shadows, const std::string& method);

/// Draws the moment's frames, timed and untimed ones in turn; the first ones only warm caches up.
MomentTimes measureMoment(Session& session, const std::string& method, const Moment& moment);

/// Adds what was measured at one more point: sums of pixels, times and points, by pass.
void addShared(std::vector<SharedSample>& sums, const MomentTimes& times);
/// Means of such sums, with the names of what was measured.
std::vector<SharedSample> meansOf(std::vector<SharedSample> sums, const std::string& algorithm, const Device& device);

/// Rows of a knowledge base, one per light and pass.
std::vector<Sample> rowsOf(const MomentTimes& times, const std::string& algorithm, const Device& device);

} // namespace gnomon::demo
