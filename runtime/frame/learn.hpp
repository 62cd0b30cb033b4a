#pragma once
// What frames leave behind: records of their decisions, and, once they are completed, what they took.
#include "runtime/frame/choose.hpp"

namespace gnomon {

/// After a frame's lights are settled and declared.
void recordDecisions(const Frame& frame, const ChooseParts& parts);

/// What learning takes.
struct LearnParts {
    const FrameTimings *newest, *newestTimed; ///< Of the executor; null: none yet.
    bool hasClock;                            ///< Of the queue. Without, the part that the GPU takes is not known.
    FramePlan& plan;
    FrameHistory& history;
    std::uint32_t methods = 0; ///< How many there are.
};

/// Sixth stage: timings that came in with the frame's slot are published, charged to lights and learned from.
void learn(Frame& frame, const LearnParts& parts);

} // namespace gnomon
