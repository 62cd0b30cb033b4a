#pragma once
// Each method in a few frames, for the lights that it serves: what it takes and how wrong it is, by kind of light.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "demo/compare/stage.hpp"

namespace gnomon::demo {

struct TriedMethod {
    std::string name, algorithm;
    GnTraits traits = 0;
    uint32_t roundTrips = 0;
    std::optional<GnSettingInfo> resolution; ///< Empty: it has no such setting.
    uint32_t side = 0; ///< Of the maps of a variant, which the host has to add; 0: this is the library's own.
};

/// Each method, and behind it a variant for each side that its maps can have and do not have by themselves:
/// "shadow_map_512".
std::vector<TriedMethod> withSides(const std::vector<TriedMethod>& methods, std::span<const uint32_t> sides);

/// Whether the sides of its maps follow from screen coverage, frame by frame.
bool followsCoverage(const TriedMethod& method);

/// Makes the method ready in the session's context, which it is added to if it is a variant. Throws HostError.
void prepareMethod(Session& session, const Stage& stage, const TriedMethod& method);

/// \param notes takes a line for each method that could not be tried
std::vector<MethodTrial> tryMethods(const Stage& stage, const Truths& truths, const EqualQuality& quality,
                                    const std::vector<TriedMethod>& methods, std::vector<std::string>& notes);

} // namespace gnomon::demo
