#pragma once
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Casters as spans of angle, row by row round the light; receivers look theirs up on the CPU. No map, no volume, and
/// no ray but where an open mesh may shade itself. Source:    Thakur et al., in Rautenbach 2008, 3.3.3 and 4.3.5.
/// Reads:     topology and positions of the casters, receiver depth and normals (read back). Writes: visibility.
/// Strong at: standing lights and casters: tables are kept, a receiver costs a search; no GPU work but two copies.
/// Weak at:   edges are stepped by the height of a row; large casters have large rows; one round trip.
extern const AlgorithmEntry kAngularSpans;

} // namespace gnomon
