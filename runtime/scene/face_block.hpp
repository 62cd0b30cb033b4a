#pragma once
// Face planes as the facing test (algorithms/volumes/facing.hpp) reads them:
// in blocks of a structure of arrays, of which compilers make vectors. What includes this has no need
// of the whole topology.
#include <stdint.h>

namespace gnomon {

inline constexpr uint32_t kBlockFaces = 16; ///< The floats of a cache line.

/// Planes of that many faces, a cache line per component: one stream to read, and no line is touched in vain.
struct alignas(64) FaceBlock {
    float x[kBlockFaces], y[kBlockFaces], z[kBlockFaces], w[kBlockFaces];
};

} // namespace gnomon
