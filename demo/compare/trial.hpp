#pragma once
// Each method in a few frames, for the lights that it serves: what it takes and how wrong it is, by kind of light.
#include <string>
#include <vector>

#include "demo/compare/stage.hpp"

namespace gnomon::demo {

struct TriedMethod {
    std::string name;
    GnTraits traits = 0;
    uint32_t roundTrips = 0;
};

/// \param notes takes a line for each method that could not be tried
std::vector<MethodTrial> tryMethods(const Stage& stage, const Truths& truths, const EqualQuality& quality,
                                    const std::vector<TriedMethod>& methods, std::vector<std::string>& notes);

} // namespace gnomon::demo
