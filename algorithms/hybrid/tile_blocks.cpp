#include "algorithms/hybrid/tile_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#if GNOMON_SIMD_X86
#include <cpuid.h>
#endif

#include "algorithms/shared/receivers.hpp"
#include "runtime/base/instruction_set.hpp"

namespace gnomon {

using namespace simd;

#if GNOMON_SIMD_X86
namespace {

/// No feature string of clang 14's __builtin_cpu_supports().
bool hasF16c()
{
    unsigned a = 0, b = 0, c = 0, d = 0;
    return __get_cpuid(1, &a, &b, &c, &d) != 0 && (c & bit_F16C) != 0;
}

} // namespace
#endif

std::span<const Kernels* const> kernelsHere()
{
    static constexpr const Kernels* kAll[] = {
        &kBaseline,
#if GNOMON_SIMD_X86
        &kAvx2,
#endif
    };
    std::size_t count = 1;
#if GNOMON_SIMD_X86
    if (isSupported(InstructionSet::Avx2) && hasF16c()) count = 2;
#endif
    return std::span(kAll).first(count);
}

const Kernels& widestKernels()
{
    return *kernelsHere().back();
}

float leastCoordinate(const CameraView& view, const LightView& light)
{
    float largest = view.constants.corners;
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return largest;
    for (int i = 0; i < 3; ++i) {
        const float at = light.constants.positionWs[i];
        largest = std::max({largest, std::abs(at - view.constants.eyeWs[i]), std::abs(at)});
    }
    return largest;
}

BlockReader::BlockReader(const Kernels& kernels, const CameraView& view, const LightView& light,
                         std::span<const float> depth, std::span<const std::byte> normals)
    : kernels_(kernels), area_(view.area), width_(view.extent.width), depth_(depth), normals_(normals),
      halfNormals_(view.normalFormat == VK_FORMAT_R16G16B16A16_SFLOAT)
{
    const gpu::ViewConstants& v = view.constants;
    for (int i = 0; i < 3; ++i) {
        constants_.eye[i] = v.eyeWs[i];
        constants_.rayCorner[i] = v.rayCornerWs[i];
        constants_.rayDx[i] = v.rayDxWs[i];
        constants_.rayDy[i] = v.rayDyWs[i];
        constants_.rayDepth[i] = v.rayDepthWs[i];
    }
    constants_.beyond = v.rayDepthWs.w;
    constants_.depthStep = v.eyeWs.w;
    constants_.depthScale = v.depthScale;
    constants_.depthMul = v.depthMul;
    constants_.depthAdd = v.depthAdd;
    constants_.skyDepth = v.skyDepth;
    constants_.offsetFactor = v.offsetFactor;
    constants_.pixelSize = v.pixelSize;
    constants_.hasNormals = !normals.empty();
    const gpu::LightConstants& l = light.constants;
    for (int i = 0; i < 3; ++i) {
        constants_.lightPosition[i] = l.positionWs[i];
        constants_.lightDirection[i] = l.directionWs[i];
    }
    constants_.cone = l.directionWs.w * std::abs(l.directionWs.w);
    constants_.rangeSquared = l.range * l.range;
    constants_.directional = l.type == gpu::LIGHT_DIRECTIONAL;
    constants_.leastCoordinate = leastCoordinate(view, light);
}

void BlockReader::normal(const std::byte* texel, Texels& texels, std::uint32_t lane) const
{
    float values[3];
    if (halfNormals_) {
        std::uint16_t halves[3];
        std::memcpy(halves, texel, sizeof halves);
        for (int i = 0; i < 3; ++i)
            values[i] = fromHalf(halves[i]);
    } else {
        std::memcpy(values, texel, sizeof values);
    }
    for (int i = 0; i < 3; ++i)
        texels.normal[i][lane] = values[i];
}

/// Rows of four, one after the other.
void BlockReader::whole(std::size_t pixel, Texels& texels) const
{
    for (std::uint32_t row = 0; row < kBlockSide; ++row)
        std::memcpy(texels.depth + row * kBlockSide, depth_.data() + pixel + row * std::size_t(width_),
                    kBlockSide * sizeof(float));
    if (normals_.empty()) {
        std::memset(texels.normal, 0, sizeof texels.normal);
        return;
    }
    if (halfNormals_) {
        std::uint16_t halves[4 * kLanes];
        for (std::uint32_t row = 0; row < kBlockSide; ++row)
            std::memcpy(halves + row * 4 * kBlockSide, normals_.data() + (pixel + row * std::size_t(width_)) * 8,
                        kBlockSide * 8);
        kernels_.fromHalf(halves, texels.normal);
        return;
    }
    for (std::uint32_t i = 0; i < kLanes; ++i)
        normal(normals_.data() + (pixel + i / kBlockSide * std::size_t(width_) + i % kBlockSide) * 16, texels, i);
}

/// Pixels beyond the area are sky.
void BlockReader::part(std::uint32_t x, std::uint32_t y, Texels& texels) const
{
    for (std::uint32_t i = 0; i < kLanes; ++i) {
        const std::uint32_t column = x + i % kBlockSide, row = y + i / kBlockSide;
        texels.depth[i] = constants_.skyDepth;
        texels.normal[0][i] = texels.normal[1][i] = texels.normal[2][i] = 0.0f;
        if (column >= area_.extent.width || row >= area_.extent.height) continue;
        const std::size_t pixel = std::size_t(static_cast<std::uint32_t>(area_.offset.y) + row) * width_ +
                                  static_cast<std::uint32_t>(area_.offset.x) + column;
        texels.depth[i] = depth_[pixel];
        if (!normals_.empty()) normal(normals_.data() + pixel * (halfNormals_ ? 8 : 16), texels, i);
    }
}

void BlockReader::prefetch(std::uint32_t x, std::uint32_t y) const
{
    if (x + kBlockSide > area_.extent.width || y + kBlockSide > area_.extent.height) return;
    std::size_t pixel = std::size_t(static_cast<std::uint32_t>(area_.offset.y) + y) * width_ +
                        static_cast<std::uint32_t>(area_.offset.x) + x;
    for (std::uint32_t row = 0; row < kBlockSide; ++row, pixel += width_) {
        prefetchRead(depth_.data() + pixel);
        if (!normals_.empty()) prefetchRead(normals_.data() + pixel * (halfNormals_ ? 8 : 16));
    }
}

void BlockReader::texels(std::uint32_t x, std::uint32_t y, Texels& texels) const
{
    const std::uint32_t left = static_cast<std::uint32_t>(area_.offset.x) + x;
    const std::uint32_t top = static_cast<std::uint32_t>(area_.offset.y) + y;
    texels.left = static_cast<float>(left) + 0.5f;
    texels.top = static_cast<float>(top) + 0.5f;
    if (x + kBlockSide <= area_.extent.width && y + kBlockSide <= area_.extent.height)
        whole(std::size_t(top) * width_ + left, texels);
    else
        part(x, y, texels);
    if (normals_.empty()) beside(left, top, texels);
}

/// What is beside the pixels of a block, by image coordinates.
void BlockReader::beside(std::uint32_t left, std::uint32_t top, Texels& texels) const
{
    const auto areaLeft = static_cast<std::uint32_t>(area_.offset.x),
               areaTop = static_cast<std::uint32_t>(area_.offset.y);
    const std::uint32_t right = areaLeft + area_.extent.width, bottom = areaTop + area_.extent.height;
    if (left > areaLeft && top > areaTop && left + kBlockSide < right && top + kBlockSide < bottom) {
        const std::size_t pixel = std::size_t(top) * width_ + left;
        const std::size_t from[4] = {pixel - 1, pixel + 1, pixel - width_, pixel + width_};
        for (std::uint32_t side = 0; side < 4; ++side)
            for (std::uint32_t row = 0; row < kBlockSide; ++row)
                std::memcpy(texels.beside[side] + row * kBlockSide,
                            depth_.data() + from[side] + row * std::size_t(width_), kBlockSide * sizeof(float));
        return;
    }
    for (std::uint32_t i = 0; i < kLanes; ++i) {
        const std::uint32_t x = left + i % kBlockSide, y = top + i / kBlockSide;
        NeighbourDepths found{}; // a lane beyond the area is sky itself, and asks nothing
        if (x < right && y < bottom) found = neighbourDepths(depth_, width_, area_, x, y);
        texels.beside[0][i] = found.left;
        texels.beside[1][i] = found.right;
        texels.beside[2][i] = found.above;
        texels.beside[3][i] = found.below;
    }
}

void BlockReader::read(std::uint32_t x, std::uint32_t y, Block& block) const
{
    Texels read;
    texels(x, y, read);
    kernels_.receivers(constants_, read, block);
}

void BlockReader::readSummed(std::uint32_t x, std::uint32_t y, Block& block) const
{
    Texels read;
    texels(x, y, read);
    kernels_.summedReceivers(constants_, read, block);
}

void BlockReader::place(std::uint32_t x, std::uint32_t y, const MapLookup& map, MapPlaces& places) const
{
    Texels read;
    texels(x, y, read);
    kernels_.place(constants_, read, map, places);
}

} // namespace gnomon
