#pragma once
// F. Morais, "Rasterization + Ray Tracing: Rendering of Hard Shadows", Universidade do Minho, 2015: the counts his
// tables print for a picture of 1024 x 1024 pixels.

#include <span>

#include "demo/theses/map_census.hpp"

namespace gnomon::demo {

/// One view. What is called certain and correct in his tables 14, 15 and 59 to 66 is all that is certain: only their
/// totals have the wrong ones taken off.
struct PrintedMapView {
    const char* scene;
    Look look;            ///< Sponza has one view, written as `side`.
    uint32_t table;       ///< Of `certain`.
    uint32_t facing;      ///< Tables 5, 6, 27 to 34.
    uint32_t plain[4][2]; ///< Wrongly lit and dark by the plain map, by kCensusMaps (tables 11, 12, 37 to 58).
    /// PCF, CRSM, CRSMA at 1024 texels: lit, traced to lit, wrongly lit; dark, traced to dark, wrongly dark.
    uint32_t certain[3][6];
    /// The same by kCensusMaps: traced, wrong (tables 17, 18, 75 to 82).
    uint32_t sweep[3][4][2];
};
std::span<const PrintedMapView> printedMapViews();

} // namespace gnomon::demo
