#include "algorithms/volumes/facing.hpp"

#include <algorithm>

#include "algorithms/volumes/facing_kernel.hpp"
#include "runtime/base/instruction_set.hpp"

namespace gnomon {

namespace {

facing::Kernel kernelOf(FacingWidth width) noexcept
{
    switch (width) {
#if GNOMON_FACING_X86
    case FacingWidth::sse2:
        return &facing::runSse2;
    case FacingWidth::avx2:
        return &facing::runAvx2;
#endif
    default:
        return &facing::runScalar;
    }
}

} // namespace

const char* nameOf(FacingWidth width) noexcept
{
    constexpr const char* kNames[] = {"scalar", "sse2", "avx2"};
    return kNames[static_cast<std::size_t>(width)];
}

bool runsHere(FacingWidth width) noexcept
{
    switch (width) {
    case FacingWidth::scalar:
        return true;
#if GNOMON_FACING_X86
    case FacingWidth::sse2:
        return true;
    case FacingWidth::avx2:
        return isSupported(InstructionSet::Avx2);
#endif
    default:
        return false;
    }
}

FacingWidth widestFacing() noexcept
{
    FacingWidth widest = FacingWidth::scalar;
    for (const FacingWidth width : kFacingWidths)
        if (runsHere(width)) widest = width;
    return widest;
}

void findFacing(FacingWidth width, const FacePlanes& planes, const glm::vec4& light, std::uint32_t first,
                std::span<std::uint8_t> facing)
{
    const facing::Kernel kernel = kernelOf(width);
    const float components[4] = {light.x, light.y, light.z, light.w};
    const FaceBlock* block = planes.blocks() + first / kBlockFaces;
    // A block that the range cuts is looked at as a whole; what lies outside of the range is not written.
    const auto cut = [&](std::size_t skipped) {
        std::uint8_t whole[kBlockFaces];
        kernel(block++, 1, components, whole);
        const std::size_t count = std::min(facing.size(), kBlockFaces - skipped);
        std::copy_n(whole + skipped, count, facing.data());
        facing = facing.subspan(count);
    };
    if (first % kBlockFaces != 0 && !facing.empty()) cut(first % kBlockFaces);
    const std::size_t blocks = facing.size() / kBlockFaces;
    kernel(block, blocks, components, facing.data());
    block += blocks;
    facing = facing.subspan(blocks * kBlockFaces);
    if (!facing.empty()) cut(0);
}

} // namespace gnomon
