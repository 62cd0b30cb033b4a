// What the program and the test compute from frames: medians, and how wrong an answer is.
#ifndef GNOMON_TESTS_HOST_MEASURE_HPP
#define GNOMON_TESTS_HOST_MEASURE_HPP

#include <string>
#include <vector>

#include "renderer.hpp"

namespace stranger {

struct Summary {
    double mean = 0.0, median = 0.0, max = 0.0;
};
/// All zero of no values.
Summary summarise(std::vector<double> values);

/// Among pairs of a pixel and a lamp that shines on it, the share in per cent whose visibility differs by more than
/// half from that of a reference of the same moment. The surface has to face the lamp by more than 0.03: at grazing
/// angles rounding decides.
double wrongPercent(const Answer& answer, const Answer& reference);

/// Of all lamps: "4 x ray_traced (price), 2 x cube_map (rules)".
std::string listChoices(const std::array<Choice, kLampCount>& choices);

/// Writes the picture as PNG.
void writePicture(const Answer& answer, const std::string& path);

} // namespace stranger
#endif
