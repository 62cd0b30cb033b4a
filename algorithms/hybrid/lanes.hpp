#pragma once
// What tile_shafts does to every pixel, sixteen at a time: one file per instruction set, made of one source
// (lanes_kernel.inc). Nothing inline and nothing of glm's here, for the reason that runtime/scene/face_block.hpp gives.
#include <stddef.h>
#include <stdint.h>

#include "runtime/rays/ray_packet.hpp"

namespace gnomon::lanes {

inline constexpr uint32_t kBlockSide = 4; ///< Pixels.
inline constexpr uint32_t kLanes = 16;    ///< The pixels of a block, row by row.

/// gpu::ViewConstants and gpu::LightConstants, as far as receivers need them.
struct Constants {
    float eye[3], rayCorner[3], rayDx[3], rayDy[3];
    float depthScale, depthMul, depthAdd, skyDepth, offsetFactor, pixelSize;
    float lightPosition[3], lightDirection[3];
    float cone; ///< Cosine of the cone's half angle times its absolute value.
    float rangeSquared;
    float lightLargest; ///< The light's largest coordinate in receiverOffset(); 0 for directional lights.
    uint32_t directional, hasNormals;
};

/// A block as it was read back.
struct Texels {
    float left, top; ///< Centre of the first pixel, image coordinates.
    float depth[kLanes];
    float normal[3][kLanes]; ///< As stored: not unit length.
};

/// Asked (receivers.hpp) as a word.
inline constexpr uint32_t kLit = 0, kDark = 1, kRay = 2;

/// The receivers of a block. Where they are summed, lanes that need no ray repeat one that does, so that bounds need no
/// masks.
struct alignas(64) Block {
    float origin[3][kLanes]; ///< Of the rays.
    float tfar[kLanes];      ///< ShadowRay::tfar
    uint32_t asked[kLanes];
    uint32_t rays; ///< Lanes that ask.
    // Where they are summed, of the lanes that ask; where none does, undefined.
    float normalSum[3];
    float largestOffset;
    uint32_t finite; ///< All origins are numbers.
};

inline constexpr uint32_t kSquareSide = 8; ///< Pixels.

/// A square where it was read back.
struct SquareTexels {
    const float* depth;  ///< Of the first pixel.
    const void* normals; ///< Four numbers a pixel.
    size_t width;        ///< Pixels from one row to the next.
    float skyDepth;
    uint32_t halfNormals; ///< 0: in single precision.
};

/// Depth values near a plane of image space: that of pixel (i, j) is depth + i dx + j dy + d, below <= d <= above.
struct DepthPlane {
    float depth;        ///< Of the first pixel.
    float dx, dy;       ///< Change a pixel to the right and down.
    float below, above; ///< Not above and not below 0.
};

/// What a square shows.
struct Square {
    DepthPlane plane;
    float normalLower[3], normalUpper[3]; ///< As stored.
    uint32_t receivers;                   ///< Pixels that are not sky; in the rest of the bounds, sky counts as well.
    uint32_t finite;                      ///< All depths and normals are numbers whose squares are.
};

/// The volume in which a triangle shadows: inside four planes, n.p + f >= 0 with p relative to the list's centre.
/// Within `margin` of a plane the answer is the ray tracer's.
struct alignas(16) ShadowPlanes {
    float x[4], y[4], z[4], f[4], margin[4];
    uint32_t certain; ///< 0: being inside proves nothing.
    uint32_t padding[3];
};

/// What is known of a lane after classify().
inline constexpr uint32_t kMissed = 0, kUnsure = 1, kInside = 2;

/// Functions of one instruction set.
struct Kernels {
    void (*fromHalf)(const uint16_t* texels, float (*normal)[kLanes]); ///< 16 texels of four halves.
    void (*receivers)(const Constants& constants, const Texels& texels, Block& block);
    void (*summedReceivers)(const Constants& constants, const Texels& texels, Block& block);
    void (*square)(const SquareTexels& texels, Square& square);
    /// The rays of the lanes that ask, but for those that end before they start: nothing blocks them.
    void (*pack)(const Constants& constants, const Block& block, RayPacket& packet);
    /// Widens [lower, upper] along three axes by what the blocks' rays start from, relative to `centre`.
    void (*bound)(const Block* blocks, uint32_t count, const float* centre, const float (*axes)[3], float* lower,
                  float* upper);
    /// state[i] = the largest of what the volumes say about lane i, kInside over kUnsure over kMissed.
    void (*classify)(const Block& block, const float* centre, const ShadowPlanes* const* volumes, uint32_t count,
                     uint32_t* state);
};

extern const Kernels kBaseline;
#if GNOMON_LANES_X86
extern const Kernels kAvx2;
extern const Kernels kAvx512;
#endif

} // namespace gnomon::lanes
