#pragma once

/// The knowledge base: what a calibration found methods to take, as a CSV that people can read and programs can merge.
///
///     # gnomon knowledge 7
///     device,driver,kind,algorithm,pass,processor,samples,octaves,fixed_ms,ms_per_mtriangle,...
///
/// The first line names the version. Columns are found by name, in any order; unknown ones are passed over; an empty
/// cell is 0. What a row says depends on its `pass`:
///
/// | pass | says |
/// | --- | --- |
/// | `update`, `resolve` | milliseconds per term (workload.hpp) on `processor`, `gpu` or `cpu`, and by how many
/// `octaves` (root mean square) measurements differ from that | | `method` | `wrong_percent` at map side 1024, the mean
/// of `samples` measurements, and `first_frame_ms`, the median by which the first frame takes longer | | `view:NAME` |
/// milliseconds of a pass that the view's lights share, per million pixels |
///
/// A row that cannot be used, an unknown version, a missing column or a file that is no table is an error and leaves
/// nothing: the first such row says that others may be wrong without showing it.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/cost/workload.hpp"

namespace gnomon::cost {

inline constexpr uint32_t kKnowledgeVersion = 7;
inline constexpr size_t kMaxKnowledgeBytes = size_t{1} << 20; ///< The file is untrusted; a device takes 15 kB.
inline constexpr size_t kMaxKnowledgeRows = 8192;

/// What a pass of a method takes on one processor.
struct TrackCost {
    Terms ms{};           ///< Per term, >= 0.
    double octaves = 0.0; ///< Root mean square of log2(measured / predicted).
    uint32_t samples = 0; ///< 0: the pass does not run there.
};

/// A device's numbers of one algorithm.
struct AlgorithmCost {
    std::string algorithm;
    std::array<TrackCost, kTracks> tracks; ///< By trackOf().
    double wrongPercent = 0.0;             ///< Of the light-facing pixels, against ray tracing, at map side 1024.
    uint32_t wrongSamples = 0;             ///< 0: not measured.
    double firstFrameMs = 0.0;             ///< By which the first frame after a switch takes longer.

    bool isTimed() const noexcept; ///< Any pass was.
};

/// A pass for all lights of a view (a copy of its depth, say) that an algorithm needs.
struct KnowledgePart {
    std::string algorithm;
    std::string pass;
    double msPerPixel = 0.0; ///< GPU and CPU together, > 0.
};

/// What was measured on one device.
struct DeviceKnowledge {
    std::string device, driver;
    std::string kind; ///< "software", "integrated" or "discrete"
    std::vector<AlgorithmCost> algorithms;
    std::vector<KnowledgePart> parts;

    const AlgorithmCost* find(std::string_view algorithm) const noexcept; ///< Null: not measured.
};

struct KnowledgeBase {
    std::vector<DeviceKnowledge> devices;

    /// That of the device of this name; else of the first of its kind; else, for a GPU, of the first GPU; else the
    /// first. Null: there is none.
    const DeviceKnowledge* nearestTo(std::string_view device, std::string_view kind) const noexcept;
};

struct KnowledgeResult {
    std::optional<KnowledgeBase> base;
    std::string error; ///< Why there is none: "line 7: fixed_ms 'nan' is no measurement".
};

/// The largest number that any row can hold: eleven days in milliseconds. A larger one is no measurement.
inline constexpr double kMostKnowledge = 1e9;

struct KnowledgeColumn {
    std::string_view name;
    bool isNumber = false;   ///< From 0 to kMostKnowledge; an empty cell is 0.
    bool isRequired = false; ///< A row needs it.
};
/// All that a table needs, in the order in which it is written.
std::vector<KnowledgeColumn> knowledgeColumns();

KnowledgeResult parseKnowledge(std::string_view text);
std::string writeKnowledge(std::span<const DeviceKnowledge> devices);

/// What comes with the library: the devices of rules/knowledge/*.csv.
const KnowledgeBase& shippedKnowledge();

} // namespace gnomon::cost
