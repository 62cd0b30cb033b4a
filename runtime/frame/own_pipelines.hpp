#pragma once
// The pipelines of the runtime's own passes: the depth grid, and the mix of two methods of a fading light.
#include <string>

#include "runtime/base/messages.hpp"
#include "runtime/vk/pipeline_store.hpp"

namespace gnomon {

struct OwnPipelines {
    PipelineId grid, mix;
    bool ready = false;  ///< They have run once.
    bool failed = false; ///< They never will.

    /// Describes both; their owner has been set.
    void describe(PipelineLibrary& library);
    /// Makes them. @return whether they are made, and still to be run for the first time
    bool create(PipelineStore& store, const Messages& messages);
    void fail(const std::string& why, const Messages& messages);
};

} // namespace gnomon
