// Compiled without vectorisation on processors that have kernels of their own (algorithms/CMakeLists.txt).
#include "algorithms/volumes/facing_kernel.hpp"

namespace gnomon::facing {

void runScalar(const FaceBlock* blocks, size_t count, const float* light, uint8_t* facing)
{
    const float lightX = light[0], lightY = light[1], lightZ = light[2], lightW = light[3];
    for (; count != 0; --count, ++blocks, facing += kBlockFaces) {
        for (uint32_t i = 0; i < kBlockFaces; ++i) {
            const float sum =
                blocks->x[i] * lightX + blocks->y[i] * lightY + blocks->z[i] * lightZ + blocks->w[i] * lightW;
            facing[i] = sum > 0.0f;
        }
    }
}

} // namespace gnomon::facing
