#include "algorithms/volumes/facing_kernel.hpp"

#include <immintrin.h>

namespace gnomon::facing {

void runAvx512(const FaceBlock* blocks, size_t count, const float* light, uint8_t* facing)
{
    const __m512 lightX = _mm512_set1_ps(light[0]), lightY = _mm512_set1_ps(light[1]);
    const __m512 lightZ = _mm512_set1_ps(light[2]), lightW = _mm512_set1_ps(light[3]);
    const __m512i ones = _mm512_set1_epi32(1);
    for (; count != 0; --count, ++blocks, facing += kBlockFaces) {
        const __m512 xy = _mm512_add_ps(_mm512_mul_ps(_mm512_load_ps(blocks->x), lightX),
                                        _mm512_mul_ps(_mm512_load_ps(blocks->y), lightY));
        const __m512 xyz = _mm512_add_ps(xy, _mm512_mul_ps(_mm512_load_ps(blocks->z), lightZ));
        const __m512 sum = _mm512_add_ps(xyz, _mm512_mul_ps(_mm512_load_ps(blocks->w), lightW));
        const __mmask16 towards = _mm512_cmp_ps_mask(sum, _mm512_setzero_ps(), _CMP_GT_OQ);
        _mm_storeu_si128(reinterpret_cast<__m128i*>(facing), _mm512_maskz_cvtepi32_epi8(towards, ones));
    }
}

} // namespace gnomon::facing
