#include "algorithms/volumes/facing.hpp"

#include <algorithm>

namespace gnomon {

namespace {

/// Writes kBlockFaces answers. Compilers make vectors of it, since the answers alias nothing until they are copied.
void faceBlock(const FaceBlock& block, const glm::vec4& light, std::uint8_t* facing)
{
    std::uint8_t answers[kBlockFaces];
    for (std::uint32_t i = 0; i < kBlockFaces; ++i) {
        const float sum = block.x[i] * light.x + block.y[i] * light.y + block.z[i] * light.z + block.w[i] * light.w;
        answers[i] = sum > 0.0f ? 1 : 0;
    }
    std::copy_n(answers, kBlockFaces, facing);
}

} // namespace

void findFacing(const FacePlanes& planes, const glm::vec4& light, std::uint32_t first, std::span<std::uint8_t> facing)
{
    const FaceBlock* block = planes.blocks() + first / kBlockFaces;
    // A block that the range cuts is looked at as a whole; what lies outside of the range is not written.
    const auto cut = [&](std::size_t skipped) {
        std::uint8_t whole[kBlockFaces];
        faceBlock(*block++, light, whole);
        const std::size_t count = std::min(facing.size(), kBlockFaces - skipped);
        std::copy_n(whole + skipped, count, facing.data());
        facing = facing.subspan(count);
    };
    if (first % kBlockFaces != 0 && !facing.empty()) cut(first % kBlockFaces);
    for (; facing.size() >= kBlockFaces; facing = facing.subspan(kBlockFaces))
        faceBlock(*block++, light, facing.data());
    if (!facing.empty()) cut(0);
}

} // namespace gnomon
