#pragma once
// What a light with a surface shows: 256 rays a pixel to the disc that its sphere turns towards the receiver, or to the
// sun's, traced by the brute force. And the soft error, as the definitions have it.
#include <cstdint>
#include <vector>

#include "exactness/brute_stage.hpp"

namespace gnomon::exact {

/// Of one light, row by row.
struct SoftTruth {
    std::vector<double> visibility; ///< Share of the disc that the pixel sees; of those that are not asked 1 or 0.
    std::vector<uint8_t> asked;     ///< 1: light-facing, within range and cone, not grazing.
};

/// \param casters Made of the stage's bruteTriangles().
SoftTruth softTruth(const Stage& stage, size_t layer, const brute::Scene& casters);
/// Of all lights.
std::vector<SoftTruth> softTruths(const Stage& stage);

struct SoftError {
    uint64_t penumbra = 0;    ///< Asked pixels of which the truth lies in (0.02, 0.98).
    double sum = 0.0;         ///< Of absolute errors there.
    double worst = 0.0;       ///< There.
    uint64_t outside = 0;     ///< Asked pixels that are lit or in the umbra.
    uint64_t wrong = 0;       ///< Of these, by half a light or more.
    double outsideSum = 0.0;  ///< Of absolute errors there.
    uint64_t notAskedOff = 0; ///< Of the others, by more than a 255th.

    double mean() const { return penumbra ? sum / double(penumbra) : 0.0; }
    SoftError& operator+=(const SoftError& other);
};
SoftError compareSoft(const Image8& picture, const SoftTruth& truth);
SoftError compareSoft(const Pictures& pictures, const std::vector<SoftTruth>& truths);

/// "0.0123 over 4567 (worst 0.1), outside 0.0001 over 8910, wrong 2".
std::string inWords(const SoftError& error);

} // namespace gnomon::exact
