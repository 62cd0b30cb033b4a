#pragma once
// What a calibration measured, row by row, as a CSV. A knowledge base is fitted to it (fit.hpp).
//
//     # gnomon samples 4
//     device,driver,algorithm,pass,pixels,caster_triangles,map_texels,sharing,still,...
//
// Columns are found by name, in any order; unknown ones are passed over. A row that cannot be used is left out and
// reported; an unknown version, a missing column or a file that is no table is an error.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "demo/io/outcome.hpp"
#include "runtime/cost/workload.hpp"

namespace gnomon::demo {

inline constexpr uint32_t kSamplesVersion = 5;
inline constexpr size_t kMaxSampleBytes = size_t{16} << 20;
inline constexpr size_t kMaxSamples = 65536;
inline constexpr uint32_t kMaxFindings = 32;
inline constexpr double kNotMeasured = -1.0;

/// One measured workload. Times of 0 were not measured: the pass does not run on that processor.
struct Sample {
    std::string device, driver;
    std::string algorithm;
    cost::Pass pass = cost::Pass::resolve;
    cost::Workload workload;
    uint32_t samples = 0;
    double gpuMsMin = 0.0, gpuMsP50 = 0.0, gpuMsP95 = 0.0;
    double cpuMsMin = 0.0, cpuMsP50 = 0.0;
    double firstFrameMs = 0.0;          ///< By which the first frame after a switch takes longer.
    double wrongPercent = kNotMeasured; ///< Of the light-facing pixels, against ray tracing.
    double clockMhz = 0.0;
    std::string date;
};

/// What a pass for all lights of a view takes (a copy of its depth, say) that an algorithm needs. In the file its
/// `pass` is `view:` and the pass's name; view_pixels, samples and the times are set, and every number else is 0.
struct SharedSample {
    std::string device, driver;
    std::string algorithm;
    std::string pass;
    double viewPixels = 0.0; ///< > 0; the time grows with them.
    uint32_t samples = 0;
    double gpuMs = 0.0, cpuMs = 0.0; ///< One is > 0.
    std::string date;
};

struct Samples {
    std::vector<Sample> rows;
    std::vector<SharedSample> parts;
    std::vector<std::string> findings; ///< "line 7: gpu_ms_p50 is not a measurement"; at most kMaxFindings.
    uint32_t rejected = 0;             ///< Rows left out.
};

Outcome<Samples> parseSamples(std::string_view text);
std::string writeSamples(std::span<const Sample> rows, std::span<const SharedSample> parts = {});

} // namespace gnomon::demo
