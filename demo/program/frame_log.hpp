#pragma once
// frames.csv, lights.csv and the summary of a run.

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "demo/host/shadow_host.hpp"
#include "demo/io/csv.hpp"

namespace gnomon::demo {

class FrameLog {
public:
    FrameLog(const Scene& scene, float budgetMs);

    /// After a frame. \param frameMs Wall time from the start of this frame to the start of the next.
    void add(uint32_t frame, double timeSeconds, double frameMs, const SceneState& state, const ShadowHost& shadows);

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
        double onePercentLowFps = 0.0;               ///< Of the slowest hundredth of the frames, at least one.
        double shadowGpuMs = 0.0, shadowCpuMs = 0.0; ///< Mean per frame.
        uint64_t switches = 0;
        uint32_t overBudget = 0;
        std::map<std::string, uint64_t> lightFrames; ///< By method.
    };
    Summary summary() const;
    std::string summaryText() const;

private:
    const Scene& scene_;
    float budgetMs_;
    CsvWriter frames_, lights_;
    std::vector<double> frameMs_;
    std::vector<LightLine> newest_;
    bool newestSwitched_ = false;
    double gpuMs_ = 0.0, cpuMs_ = 0.0;
    uint64_t switches_ = 0;
    uint32_t overBudget_ = 0;
    std::map<std::string, uint64_t> lightFrames_;
};

const char* nameOf(GnReason reason) noexcept;

} // namespace gnomon::demo
