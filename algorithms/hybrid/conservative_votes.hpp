#pragma once
// The two layers of a conservative map asked on the CPU, in copies of them: the starts of sixteen rays at a time, and
// rays at once where neither knows.
#include "algorithms/hybrid/map_votes.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "shaders/hybrid/conservative_lookup.h"

namespace gnomon {

/// Both layers on the CPU.
struct ConservativeCopies {
    HostMapCopy nearest, covered;
};

/// Declares the passes that answer all pixels of the task. @param constants kept for the frame
/// @param doubt a byte that is not believed where receivers may lie inside of casters
void declareConservativeVotes(PassBuilder& passes, const ShadowTask& task, const VoteNames& names,
                              const ConservativeCopies& copies, const gpu::ConservativeConstants& constants,
                              const Doubt& doubt);

} // namespace gnomon
