#pragma once
// Face planes as the kernels read them (algorithms/volumes/facing_kernel.hpp). These are compiled once per instruction
// set, so nothing here may have inline functions: the linker would keep one copy of each, and a processor without AVX
// might meet the AVX one.
#include <stdint.h>

namespace gnomon {

inline constexpr uint32_t kBlockFaces = 16; ///< The floats of a cache line, and of the widest register.

/// Planes of that many faces, a cache line per component: one stream to read, and no line is touched in vain.
struct alignas(64) FaceBlock {
    float x[kBlockFaces], y[kBlockFaces], z[kBlockFaces], w[kBlockFaces];
};

} // namespace gnomon
