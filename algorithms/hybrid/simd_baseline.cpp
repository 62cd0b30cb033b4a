#include "algorithms/hybrid/float4.hpp"
#include "algorithms/hybrid/simd_kernels.hpp"

namespace gnomon::simd {
#include "algorithms/hybrid/simd_kernels.inc"

constinit const Kernels kBaseline = kKernels;

} // namespace gnomon::simd
