#pragma once
// What tile_shafts does to every pixel, sixteen at a time: one file per instruction set, made of one source
// (simd_kernel.inc). Nothing inline and nothing of glm's here, for the reason that runtime/rays/ray_packet.hpp gives.
#include <stddef.h>
#include <stdint.h>

#include "runtime/rays/ray_packet.hpp"

namespace gnomon::simd {

inline constexpr uint32_t kBlockSide = 4; ///< Pixels.
inline constexpr uint32_t kLanes = 16;    ///< The pixels of a block, row by row.

/// gpu::ViewConstants and gpu::LightConstants, as far as receivers need them.
struct Constants {
    float eye[3], rayCorner[3], rayDx[3], rayDy[3], rayDepth[3];
    float beyond;    ///< ViewConstants::rayDepthWs.w
    float depthStep; ///< ViewConstants::eyeWs.w
    float depthScale, depthMul, depthAdd, skyDepth, offsetFactor, pixelSize;
    float lightPosition[3], lightDirection[3];
    float cone; ///< Cosine of the cone's half angle times its absolute value.
    float rangeSquared;
    float leastCoordinate; ///< c in receiverOffset(), but for what the receiver adds.
    uint32_t directional, hasNormals;
};

/// A block as it was read back.
struct Texels {
    float left, top; ///< Centre of the first pixel, image coordinates.
    float depth[kLanes];
    float normal[3][kLanes]; ///< As stored: not unit length.
    float beside[4][kLanes]; ///< Without normals: NeighbourDepths, left, right, above and below.
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

/// A light's map and how receivers are found in it: gpu::MapLookup, as far as that takes.
struct MapLookup {
    float clipOfEye[4], clipFromRay[3][4]; ///< Columns; of one map.
    float texelDx[3], texelDy[3], axis[3];
    float eyeFromLight[3], offset[3];
    float depthConstant, depthScale, positional;
    float inverseSlope, perTexel; ///< Of six maps: 1 / slope and 2 slope / side.
    uint32_t side, cube;
    const float* depth[6]; ///< Of one map or six, row by row. Null: no receiver should lie there.
};

/// Sixteen receivers in a map. Words of bits have one of every lane.
struct alignas(64) MapPlaces {
    float x[kLanes], y[kLanes];             ///< Texels, at most four beyond the map.
    float left[kLanes], top[kLanes];        ///< The first of the four around: whole numbers.
    int32_t texel[kLanes];                  ///< Place of that one in the layer, where `together` is set.
    float depth[kLanes];                    ///< Of the receiver's plane at x, y, ...
    float depthDx[kLanes], depthDy[kLanes]; ///< ... how it changes a texel, ...
    float slack[kLanes];                    ///< ... and what it is already nearer by.
    uint32_t layer[kLanes];
    uint32_t asks;      ///< Lanes that ask the map, ...
    uint32_t facesAway; ///< ... and of the others those that are dark.
    uint32_t turned;    ///< Lanes that face away from the light by the map's rounding.
    uint32_t together;  ///< Not 0: the four texels around all lanes that ask lie in one layer that is there.
};

/// The bytes of a map's answers.
struct MapBytes {
    uint32_t outside, backfacing; ///< Of lanes that ask nothing.
    uint32_t lit, dark;
    uint32_t unsure; ///< Of nearest(): lit, but for what lies at or before the map's near end.
};

/// How a light sees a tile: around `centre`, the last axis leads to the light. Whatever lies on one ray to the light
/// has the same first two coordinates, those of where the ray crosses the plane through the centre.
struct LightFrame {
    float centre[3];
    float axis[3][3]; ///< Orthonormal.
    float distance;   ///< From the centre to the light; directional lights: not used.
    uint32_t directional;
};

/// There: across the light's rays, and towards it.
struct FrameBounds {
    float lower[3], upper[3];
};

/// A tile as the triangles of one caster meet it; positions relative to its frame's centre (lookOf() of shaft.hpp).
struct TriangleLookup {
    LightFrame frame;
    double basis[3][3]; ///< Columns.
    double translation[3];
    float light[3];    ///< The light, or the direction towards it.
    float axis[3][3];  ///< The hull's, as long as half of it.
    float extent[3];   ///< Of the hull, along the axes of the world.
    float rounding[3]; ///< Of coordinates, by the ray tracer.
    float unsure;      ///< The same wherever the shaft meets the caster, all coordinates together.
    float relative;    ///< The tracer's and our roundings of distances.
    float farthest;    ///< Receiver from the light.
    float nearOffset;  ///< Closer to the light than that nothing is certain.
    uint32_t opaque;
};

/// Corners of sixteen triangles in mesh space.
struct alignas(64) Corners {
    float at[3][3][kLanes]; ///< Corner, axis.
};

/// The volumes in which sixteen triangles shadow: inside four planes each, n.p + f >= 0 with p relative to the frame's
/// centre. Within `margin` of a plane the answer is the ray tracer's.
struct alignas(64) ShadowVolumes {
    float x[4][kLanes], y[4][kLanes], z[4][kLanes], f[4][kLanes], margin[4][kLanes];
    float lower[2][kLanes], upper[3][kLanes]; ///< FrameBounds; nothing is shadowed above the last.
    uint32_t certain;                         ///< Bits; of the others, being inside proves nothing.
};

/// Some of sixteen volumes.
struct VolumeBits {
    uint16_t block, bits;
};

/// Which lanes ask a map, and what the four texels around them say, bits; the latter of lanes that ask.
struct MapLanes {
    uint32_t asks;
    uint32_t agree;      ///< All four the same: MapTexels::agree().
    uint32_t clearlyLit; ///< MapTexels::clearlyLit().
};

/// What is known of a block's lanes, bits.
struct LaneStates {
    uint32_t inside = 0; ///< Of a volume that is certain.
    uint32_t unsure = 0; ///< Of the others: too close to a border.
};

/// Functions of one instruction set.
struct Kernels {
    void (*fromHalf)(const uint16_t* texels, float (*normal)[kLanes]); ///< 16 texels of four halves.
    void (*receivers)(const Constants& constants, const Texels& texels, Block& block);
    void (*summedReceivers)(const Constants& constants, const Texels& texels, Block& block);
    void (*square)(const SquareTexels& texels, Square& square);
    /// Finds receivers in a map and calls for the texels that classifyTexels() will read; there are normals.
    void (*place)(const Constants& constants, const Texels& texels, const MapLookup& map, MapPlaces& places);
    /// What the four texels around each receiver say (shaders/shared/verdict.glsl).
    /// @return bit i: lane i wants a ray, and its byte is undefined
    uint32_t (*classifyTexels)(const MapLookup& map, const MapPlaces& places, const MapBytes& bytes, uint8_t* answers);
    /// What each receiver's own texel says (nearestVisibility() of shaders/shared/filter.glsl).
    MapLanes (*nearest)(const MapLookup& map, const MapPlaces& places, const MapBytes& bytes, uint8_t* answers);
    /// The rays of the lanes that ask, but for those that end before they start: nothing blocks them.
    void (*pack)(const Constants& constants, const Block& block, RayPacket& packet);
    /// Widens [lower, upper] along three axes by what the blocks' rays start from, relative to `centre`.
    void (*bound)(const Block* blocks, uint32_t count, const float* centre, const float (*axes)[3], float* lower,
                  float* upper);
    /// The volumes of triangles as one tile meets them. @param lanes bits of the corners that count
    /// @return bits of the volumes that meet the tile's hull; `covering`: of those that hold all of it
    uint32_t (*volumes)(const TriangleLookup& look, const Corners& corners, uint32_t lanes, ShadowVolumes& volumes,
                        uint32_t& covering);
    /// Bounds of the starts of a block's rays; all lanes ask, or they are summed.
    void (*spanned)(const LightFrame& frame, const Block& block, FrameBounds& bounds);
    /// The volumes of a list that may shadow something within bounds. @return how many entries `to` has then
    uint32_t (*meeting)(const ShadowVolumes* volumes, const VolumeBits* from, uint32_t count, const FrameBounds& bounds,
                        VolumeBits* to);
    /// What the volumes of a list say of the lanes of a block that ask.
    LaneStates (*classify)(const LightFrame& frame, const Block& block, const ShadowVolumes* volumes,
                           const VolumeBits* list, uint32_t count);
};

extern const Kernels kBaseline;
#if GNOMON_SIMD_X86
extern const Kernels kAvx2;
#endif

} // namespace gnomon::simd
