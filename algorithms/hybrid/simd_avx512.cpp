#include <immintrin.h>

#include "algorithms/hybrid/simd_kernels.hpp"

namespace gnomon::simd {
#include "algorithms/hybrid/simd_kernels.inc"

constinit const Kernels kAvx512 = kKernels;

} // namespace gnomon::simd
