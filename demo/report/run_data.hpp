#pragma once
// What a folder of `gnomon run` says about the run.
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "demo/io/outcome.hpp"

namespace gnomon::demo {

/// A light from one frame on, as long as nothing but numbers changed.
struct Stretch {
    uint32_t first = 0, last = 0;         ///< Frames, both included.
    size_t method = 0;                    ///< RunData::methods.
    std::string reason;                   ///< Of its first frame.
    double nearest = 0.0, farthest = 0.0; ///< Metres from the eye; NaN: not known.
    double measuredMs = 0.0;              ///< Sum over `timed` rows.
    uint32_t timed = 0;
};

struct LightTrack {
    std::string name;
    double distanceSum = 0.0;
    uint32_t distances = 0;
    std::vector<Stretch> stretches;
};

struct FrameRow {
    uint32_t frame = 0;
    double frameMs = 0.0, gpuMs = 0.0, cpuMs = 0.0, budgetMs = 0.0;
    uint32_t lights = 0, switches = 0;
    bool overBudget = false;
};

/// Bands of distance from the eye to a light's nearest receiver: each twice as wide as the one before.
inline constexpr double kBands[] = {2.5, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0};

struct MethodUse {
    uint64_t rows = 0;
    double nearest = 0.0, farthest = 0.0, measuredMs = 0.0;
    uint64_t timed = 0;
    uint64_t inBand[std::size(kBands) + 1] = {}; ///< The last: farther than all.
};

struct RunData {
    std::filesystem::path folder;
    std::vector<std::pair<std::string, std::string>> facts; ///< run.csv: what ran where.
    std::vector<FrameRow> frames;
    std::vector<LightTrack> lights;
    std::vector<std::string> methods;
    std::vector<MethodUse> uses;    ///< As `methods`.
    std::string log;                ///< decisions.gnlog; empty: none.
    std::vector<uint32_t> pictures; ///< Frames with both pictures.
    std::vector<std::string> notes;

    std::string fact(std::string_view name) const; ///< Empty: not known.
};

/// "frame_00012": what `gnomon run` calls its picture of a frame, without the ending.
std::string pictureName(uint32_t frame);

/// Needs frames.csv and lights.csv; everything else may be missing.
Outcome<RunData> readRun(const std::filesystem::path& folder);

} // namespace gnomon::demo
