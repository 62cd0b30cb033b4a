#include "algorithms/volumes/facing_kernel.hpp"

#include <emmintrin.h>

namespace gnomon::facing {

void runSse2(const FaceBlock* blocks, size_t count, const float* light, uint8_t* facing)
{
    const __m128 lightX = _mm_set1_ps(light[0]), lightY = _mm_set1_ps(light[1]);
    const __m128 lightZ = _mm_set1_ps(light[2]), lightW = _mm_set1_ps(light[3]);
    for (; count != 0; --count, ++blocks, facing += kBlockFaces) {
        __m128i towards[4]; // -1 where a face looks towards the light
        for (uint32_t i = 0; i < 4; ++i) {
            const __m128 xy = _mm_add_ps(_mm_mul_ps(_mm_load_ps(blocks->x + 4 * i), lightX),
                                         _mm_mul_ps(_mm_load_ps(blocks->y + 4 * i), lightY));
            const __m128 xyz = _mm_add_ps(xy, _mm_mul_ps(_mm_load_ps(blocks->z + 4 * i), lightZ));
            const __m128 sum = _mm_add_ps(xyz, _mm_mul_ps(_mm_load_ps(blocks->w + 4 * i), lightW));
            towards[i] = _mm_castps_si128(_mm_cmpgt_ps(sum, _mm_setzero_ps()));
        }
        const __m128i low = _mm_packs_epi32(towards[0], towards[1]), high = _mm_packs_epi32(towards[2], towards[3]);
        const __m128i bytes = _mm_and_si128(_mm_packs_epi16(low, high), _mm_set1_epi8(1));
        _mm_storeu_si128(reinterpret_cast<__m128i*>(facing), bytes);
    }
}

} // namespace gnomon::facing
