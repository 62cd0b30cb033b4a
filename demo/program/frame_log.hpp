#pragma once
// frames.csv, lights.csv and the summary of a run.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "demo/host/shadow_host.hpp"
#include "demo/io/csv.hpp"
#include "demo/program/shadow_times.hpp"

namespace gnomon::demo {

inline constexpr const char* kNoMethod = "none"; ///< In tables and logs: no method serves the light.

class FrameLog {
public:
    explicit FrameLog(const Scene& scene);

    /// After a frame was submitted: what was decided, and what gnomon says it cost.
    void add(uint32_t frame, double timeSeconds, const SceneState& state, const ShadowHost& shadows);
    /// Once for every frame, in their order. \param frameMs Wall time since it was called for the frame before.
    void finish(double frameMs);

    struct LightLine {
        std::string light, method;
        float suitability = 0.0f;
        bool switched = false;
    };
    /// Decisions of the newest frame, in layer order.
    const std::vector<LightLine>& newest() const noexcept { return newest_; }
    bool newestSwitched() const noexcept { return newestSwitched_; }

    /// Writes both tables into `folder`.
    void save(const std::filesystem::path& folder) const;

    struct Summary {
        uint32_t frames = 0;
        double averageFps = 0.0;
        double onePercentLowFps = 0.0; ///< Of the slowest hundredth of the frames, at least one.
        double shadowGpuMs = 0.0;      ///< Mean of the frames whose time is known; NaN where none is.
        double shadowCpuMs = 0.0;      ///< Mean per frame.
        uint64_t switches = 0;
        uint32_t overBudget = 0;
        uint64_t pagesEvicted = 0, pagesWithoutRoom = 0;
        std::map<std::string, uint64_t> lightFrames; ///< By method.
    };
    Summary summary() const;
    std::string summaryText() const;

private:
    struct FrameRow {
        uint32_t frame;
        double timeSeconds;
        size_t lights;
        GnFrameStats stats;
    };
    bool overBudget(const FrameRow& row) const;
    CsvWriter framesTable() const;
    double meanGpuMs() const;

    const Scene& scene_;
    std::vector<FrameRow> rows_;
    ShadowTimes shadowTimes_;
    std::vector<double> frameMs_; ///< Of the first rows; grows by finish().
    CsvWriter lights_;
    std::vector<LightLine> newest_;
    bool newestSwitched_ = false;
    bool budgetSet_ = false; ///< By the host or the rules, in any frame.
    std::map<std::string, uint64_t> lightFrames_;
};

const char* nameOf(GnReason reason) noexcept;

} // namespace gnomon::demo
