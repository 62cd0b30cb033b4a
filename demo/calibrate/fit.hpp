#pragma once
// A knowledge base from samples: milliseconds per term, algorithm by algorithm.
#include "demo/calibrate/samples.hpp"
#include "runtime/cost/knowledge_base.hpp"

namespace gnomon::demo {

/// Numbers >= 0 per term whose sums are nearest to the samples' fastest times by ratio (the mean of |log2|, so that a
/// bad sample does not bend the rest). @param kind of the device: "software", "integrated" or "discrete"
cost::DeviceKnowledge fitKnowledge(const Samples& samples, const std::string& kind);

} // namespace gnomon::demo
