// Spelling shared by C++, GLSL and HLSL (GNOMON_HLSL): vector types, layout asserts, shared functions.
#ifndef GNOMON_SHARED_TYPES_H
#define GNOMON_SHARED_TYPES_H

#ifdef __cplusplus

#include <bit>
#include <cstddef>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#define GN_SHARED_BEGIN namespace gnomon::gpu {
#define GN_SHARED_END }
#define GN_SHARED_FN inline
#define GN_SHARED_CONST inline constexpr
#define GN_XYZ(v) vec3(v)
#define GN_MUL(matrix, vector) ((matrix) * (vector))
#define GN_PRECISE // a variable computed as written, without contraction: C++ is compiled so altogether
#define GN_SHARED_OFFSET(type, member, bytes) static_assert(offsetof(type, member) == (bytes));
#define GN_SHARED_SIZE(type, bytes) static_assert(sizeof(type) == (bytes));

GN_SHARED_BEGIN
using glm::mat4;
using glm::uvec2;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
using glm::abs;
using glm::atan;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::floor;
using glm::length;
using glm::max;
using glm::min;
using glm::sqrt;
inline uint floatBitsToUint(float value) { return std::bit_cast<uint>(value); }
inline float uintBitsToFloat(uint bits) { return std::bit_cast<float>(bits); }
GN_SHARED_END

#else

#define GN_SHARED_BEGIN
#define GN_SHARED_END
#define GN_SHARED_FN
#define GN_XYZ(v) (v).xyz
#define GN_PRECISE precise
#define GN_SHARED_OFFSET(type, member, bytes)
#define GN_SHARED_SIZE(type, bytes)

#ifdef GNOMON_HLSL
#define GN_SHARED_CONST static const
#define vec2 float2
#define vec3 float3
#define vec4 float4
// Columns: a float4x4's place in memory depends on compiler and options.
struct GnColumns {
    float4 x, y, z, w;
};
#define mat4 GnColumns
float4 gnTimes(GnColumns m, float4 v) { return m.x * v.x + m.y * v.y + m.z * v.z + m.w * v.w; }
#define GN_MUL(matrix, vector) gnTimes(matrix, vector)
#else
#define GN_SHARED_CONST const
#define GN_MUL(matrix, vector) ((matrix) * (vector))
#endif

#endif
#endif
