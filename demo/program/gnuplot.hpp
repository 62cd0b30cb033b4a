#pragma once
// Plots by the program `gnuplot`, where it is installed.

#include <string>
#include <string_view>
#include <vector>

#include "demo/program/pictures.hpp"

namespace gnomon::demo {

struct PlotCurve {
    std::string title, style; ///< As gnuplot takes it: "lines lw 2 lc rgb '#...'".
    std::vector<std::pair<double, double>> points;
};

/// In quotes, whatever the text holds but line breaks.
std::string gnuplotText(std::string_view text);

/// "#rrggbb"
std::string hexOf(const Rgb8& colour);

/// Draws the curves into a PNG file. \param settings gnuplot's lines before `plot`. Throws HostError.
void plotCurves(const std::string& settings, const std::vector<PlotCurve>& curves, const std::string& out);

} // namespace gnomon::demo
