#include "algorithms/hybrid/float4.hpp"
#include "algorithms/hybrid/lanes.hpp"

namespace gnomon::lanes {
#include "algorithms/hybrid/lanes_wide.inc"

#include "algorithms/hybrid/lanes_kernel.inc" // of sixteens

#include "algorithms/hybrid/lanes_volumes.inc" // of both

#include "algorithms/hybrid/lanes_map.inc" // of both

#include "algorithms/hybrid/lanes_witness.inc" // of the kernel

#include "algorithms/hybrid/lanes_conservative.inc" // and of all

constinit const Kernels kBaseline = kKernels;

} // namespace gnomon::lanes
