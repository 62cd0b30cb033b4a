#pragma once
// The main tables of Morais's thesis with our numbers beside the printed ones.

#include <span>

#include "demo/theses/map_census.hpp"
#include "demo/theses/pair_table.hpp"

namespace gnomon::demo {

/// Percent of the light-facing pixels.
inline double tracedPercent(const MapView& view, MapMethod method)
{
    return percentOf(view.of(method).traced(), view.facing);
}
/// One of ours; the views must hold it.
const MapView& viewOf(std::span<const MapView> views, const char* scene, Look look, uint32_t map);

std::vector<PairTable> moraisTables(std::span<const MapView> ours);

} // namespace gnomon::demo
