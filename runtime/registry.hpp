#pragma once
#include <span>

#include "runtime/algorithm.hpp"

namespace gnomon {

/// An algorithm of this build.
struct BuiltinAlgorithm {
    const AlgorithmEntry* entry = nullptr;
    const char* family = nullptr; ///< "maps": its folder below algorithms/.
};

/// One that is known but left out of this build.
struct AbsentAlgorithm {
    const char* name = nullptr;
    const char* needs = nullptr; ///< "GNOMON_WITH_EMBREE and GNOMON_WITH_OPENMESH": what is off.
};

/// The algorithms a build offers. The runtime names none; the build makes this function of what the modules say of
/// themselves (cmake/GnomonAlgorithm.cmake).
struct AlgorithmRegistry {
    std::span<const BuiltinAlgorithm> algorithms; ///< In the order that breaks ties.
    std::span<const AbsentAlgorithm> absent;      ///< Rules may still name them.
};
AlgorithmRegistry builtinRegistry();

} // namespace gnomon
