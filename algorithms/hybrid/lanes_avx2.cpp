#include <immintrin.h>

#include "algorithms/hybrid/lanes.hpp"

namespace gnomon::lanes {
#include "algorithms/hybrid/lanes_kernel.inc"
#include "algorithms/hybrid/lanes_map.inc"
#include "algorithms/hybrid/lanes_conservative.inc"

constinit const Kernels kAvx2{.fromHalf = fromHalf,
                              .receivers = receivers,
                              .summedReceivers = summedReceivers,
                              .square = square,
                              .place = place,
                              .vote = vote,
                              .nearest = nearest,
                              .placeStarts = placeStarts,
                              .conserve = conserve,
                              .pack = pack,
                              .bound = bound,
                              .classify = classify};

} // namespace gnomon::lanes
