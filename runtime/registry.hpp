#pragma once
#include <span>

#include "runtime/algorithm.hpp"

namespace gnomon {

/// The algorithms a build offers. The runtime names none; the library that links it together provides this function
/// (algorithms/registry.cpp).
struct AlgorithmRegistry {
    std::span<const AlgorithmEntry* const> entries; ///< In the order that breaks ties.
    std::span<const char* const> absent;            ///< Known names left out of this build: rules may still say them.
};
AlgorithmRegistry builtinRegistry();

} // namespace gnomon
