#pragma once
// Single pixels of a light's layer given another value: what a host pass found out about them.
#include <cstdint>
#include <span>

#include "runtime/algorithm.hpp"

namespace gnomon {

/// Pixels of one value: a part of a list of packed pixels (shaders/hybrid/ray_list.h).
struct MarkRange {
    std::uint32_t first = 0, count = 0;
    float value = 0.0f;
};

class PointMarks {
public:
    /// @param name of the pass that draws them, "algorithm.umbra".
    PointMarks(const AlgorithmServices& services, const char* name);

    /// Declares the points. The list and the ranges, which live as long as the frame, are read when they are drawn.
    void declare(PassBuilder& passes, const ShadowTask& task, BufferId pixels, std::span<const MarkRange> ranges) const;

private:
    const char* name_;
    PipelineId points_;
};

} // namespace gnomon
