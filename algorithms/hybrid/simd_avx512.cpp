#include <immintrin.h>

#include "algorithms/hybrid/simd_kernels.hpp"

namespace gnomon::simd {
#include "algorithms/hybrid/simd_wide.inc"

#include "algorithms/hybrid/simd_kernel.inc" // of sixteens

#include "algorithms/hybrid/simd_volumes.inc" // of both

#include "algorithms/hybrid/simd_map.inc" // of both

#include "algorithms/hybrid/simd_candidate.inc" // of the kernel

#include "algorithms/hybrid/simd_conservative.inc" // and of all

constinit const Kernels kAvx512 = kKernels;

} // namespace gnomon::simd
