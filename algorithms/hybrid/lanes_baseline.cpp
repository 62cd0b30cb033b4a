#include "algorithms/hybrid/lanes.hpp"

namespace gnomon::lanes {
#include "algorithms/hybrid/lanes_kernel.inc"

constinit const Kernels kBaseline{.fromHalf = fromHalf,
                                  .receivers = receivers,
                                  .summedReceivers = summedReceivers,
                                  .square = square,
                                  .pack = pack,
                                  .bound = bound,
                                  .classify = classify};

} // namespace gnomon::lanes
