#pragma once
// Four floats in a register, for compilers that know gcc's vector types; one instruction each on every processor.
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace gnomon {

using Float4 [[gnu::vector_size(16)]] = float;
using Int4 [[gnu::vector_size(16)]] = std::int32_t;

inline Float4 load(const float* values)
{
    Float4 result;
    __builtin_memcpy(&result, values, sizeof result);
    return result;
}

inline void store(float* values, Float4 from)
{
    __builtin_memcpy(values, &from, sizeof from);
}

inline Float4 allFour(float value)
{
    return Float4{value, value, value, value};
}

inline Float4 absolute(Float4 v)
{
    return reinterpret_cast<Float4>(reinterpret_cast<Int4>(v) & 0x7fffffff);
}

/// Bit i: comparison i holds.
inline std::uint32_t bitsOf(Int4 comparison)
{
#if defined(__SSE2__)
    return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(comparison)));
#else
    return static_cast<std::uint32_t>((comparison[0] & 1) | (comparison[1] & 2) | (comparison[2] & 4) |
                                      (comparison[3] & 8));
#endif
}

} // namespace gnomon
