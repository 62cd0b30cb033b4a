#pragma once
// The kernels of findFacing(), one file per instruction set. Nothing inline here: see face_block.hpp.
#include <stddef.h>
#include <stdint.h>

#include "runtime/scene/face_block.hpp"

namespace gnomon::facing {

/// Writes kBlockFaces answers, 0 or 1, per block. @param light four floats.
using Kernel = void (*)(const FaceBlock* blocks, size_t count, const float* light, uint8_t* facing);

void runScalar(const FaceBlock* blocks, size_t count, const float* light, uint8_t* facing);
#if GNOMON_FACING_X86
void runSse2(const FaceBlock* blocks, size_t count, const float* light, uint8_t* facing);
void runAvx2(const FaceBlock* blocks, size_t count, const float* light, uint8_t* facing);
#endif

} // namespace gnomon::facing
