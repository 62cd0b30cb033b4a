#pragma once
// What `gnomon compare --csv` and `gnomon bench --csv` have measured.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "demo/io/outcome.hpp"

namespace gnomon::demo {

struct Compared {
    /// One contestant in one scene. Milliseconds are of one frame: the median over the alternations of its mean.
    struct Run {
        std::string scene, name, pass;
        bool adaptive = false, equalQuality = false;
        double frameMs = 0.0, shadowMs = 0.0;   ///< NaN: not known.
        double nearWrong = 0.0, farWrong = 0.0; ///< Per cent.
    };
    std::vector<Run> runs;
    std::vector<std::string> notes;
};
Outcome<Compared> readCompared(const std::filesystem::path& file);

struct Benched {
    /// A method in a scene.
    struct Row {
        std::string scene, method, map, device;
        double ms = 0.0; ///< More than a frame without shadows takes.
        double error =
            0.0; ///< Wrong pixels, per cent; in a scene with soft lights the RMSE of visibility in penumbrae.
        double memoryMib = std::nan(""); ///< NaN: not known.
        bool soft = false;
    };
    std::vector<Row> rows; ///< With both numbers.
    std::vector<std::string> notes;
};
Outcome<Benched> readBenched(const std::filesystem::path& file);

/// Of points (ms, error) those that none is better than in one and as good in the other, by ms.
std::vector<size_t> paretoFront(const std::vector<Benched::Row>& rows);

} // namespace gnomon::demo
