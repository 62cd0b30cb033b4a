#pragma once
#include <span>

#include "runtime/algorithm.hpp"
#include "runtime/registry.hpp"

namespace gnomon {

/// Every algorithm of this build, in the order that breaks ties.
std::span<const AlgorithmEntry* const> builtinAlgorithms();

} // namespace gnomon
