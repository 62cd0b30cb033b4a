#pragma once

/// The knowledge base: what calibration measured, as a CSV that people can read and programs can merge.
///
///     # gnomon knowledge 4
///     device,driver,algorithm,pass,pixels,caster_triangles,map_texels,sharing,still,samples,gpu_ms_p50,gpu_ms_p95,...
///
/// The first line names the version. Columns are found by name, in any order; unknown ones are passed over. A row that
/// cannot be used is left out and reported; an unknown version, a missing column or a file that is no table is an error
/// and leaves nothing. An empty base is valid: the cost model starts from its prior.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/cost/cost_model.hpp"

namespace gnomon::cost {

inline constexpr uint32_t kKnowledgeVersion = 4;
inline constexpr size_t kMaxKnowledgeBytes = size_t{4} << 20; ///< The file is untrusted; 12 methods take 60 kB.
inline constexpr size_t kMaxKnowledgeRows = 65536;

inline constexpr double kNotMeasured = -1.0;

/// One measured workload. Times of 0 were not measured: the pass does not run on that processor.
struct KnowledgeRow {
    std::string device, driver;
    std::string algorithm;
    Pass pass = Pass::resolve;
    Workload workload;
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
struct KnowledgePart {
    std::string device, driver;
    std::string algorithm;
    std::string pass;
    double viewPixels = 0.0; ///< > 0; the time grows with them.
    uint32_t samples = 0;
    double gpuMs = 0.0, cpuMs = 0.0; ///< One is > 0.
    std::string date;
};

struct KnowledgeBase {
    std::vector<KnowledgeRow> rows;
    std::vector<KnowledgePart> parts;
    std::vector<std::string> findings; ///< "line 7: gpu_ms_p50 is not a number"; at most kMaxFindings.
    uint32_t rejected = 0;             ///< Rows left out.
};
inline constexpr uint32_t kMaxFindings = 32;

struct KnowledgeResult {
    std::optional<KnowledgeBase> base;
    std::string error; ///< Why there is none.
};

KnowledgeResult parseKnowledge(std::string_view text);
std::string writeKnowledge(std::span<const KnowledgeRow> rows, std::span<const KnowledgePart> parts = {});

/// Feeds every row of `base` to all methods of its algorithm (`algorithms[i]` is method i's) and finishes the
/// calibration. Rows of `device` are used if there are any; otherwise those of the device with most rows, as foreign.
/// With `firstMethod` only methods from it on learn, and the device factor stays: they were added later.
struct Learned {
    uint32_t rows = 0;
    bool sameDevice = false;
    std::string device; ///< Whose rows were used.
};
Learned learn(CostModel& model, const KnowledgeBase& base, std::span<const std::string> algorithms,
              std::string_view device, uint32_t firstMethod = 0);

} // namespace gnomon::cost
