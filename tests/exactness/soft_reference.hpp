#pragma once
// What a light with a surface shows: 256 rays a pixel to the disc that its sphere turns towards the receiver, or to the
// sun's, or to a rectangle, traced by the brute force. And the soft error, as the definitions have it.
#include <cstdint>
#include <vector>

#include "demo/program/soft_error.hpp"
#include "exactness/brute_stage.hpp"

namespace gnomon::exact {

/// Of one light, row by row.
struct SoftTruth {
    std::vector<double> visibility; ///< Share of the disc that the pixel sees; of those that are not asked 1 or 0.
    std::vector<uint8_t> asked;     ///< 1: light-facing, within range and cone, not grazing.
};

/// Of a light with a rectangle: half its width and half its height, metres.
struct RectangleAxes {
    glm::dvec3 x, y;
};
RectangleAxes rectangleAxes(const demo::Light& light);

/// \param casters Made of the stage's bruteTriangles().
SoftTruth softTruth(const Stage& stage, size_t layer, const brute::Scene& casters);
/// Of all lights.
std::vector<SoftTruth> softTruths(const Stage& stage);
/// The same by `ray_traced`, of which soft_truth_test.cpp says how good it is: much sooner. Grazing pixels and those
/// out of the light are not asked.
std::vector<SoftTruth> tracedSoftTruths(Stage& stage, uint32_t samples = 1024, uint32_t seed = 0,
                                        const std::string& method = "ray_traced");

struct SoftError : demo::SoftError {
    uint64_t notAskedOff = 0; ///< Of pixels that are not asked: those that are off by more than a 255th.

    double mean() const { return penumbra.mean(); }
    SoftError& operator+=(const SoftError& other);
};
SoftError compareSoft(const Image8& picture, const SoftTruth& truth);
SoftError compareSoft(const Pictures& pictures, const std::vector<SoftTruth>& truths);

/// "0.0123 over 4567 (worst 0.1), outside 0.0001 over 8910, wrong 2".
std::string inWords(const SoftError& error);

} // namespace gnomon::exact
