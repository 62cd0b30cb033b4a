#pragma once
// A tile of receivers in blocks of 4x4 pixels, read from what was read back.
#include <cstddef>
#include <span>

#include "algorithms/hybrid/simd_kernels.hpp"
#include "runtime/rays/ray_scene.hpp"

namespace gnomon {

/// The widest that this build has and this processor runs.
const simd::Kernels& widestKernels();
std::span<const simd::Kernels* const> kernelsHere(); ///< All that run here, narrowest first.

/// The ray of Receivers::at() of a lane that asks.
inline ShadowRay rayOf(const simd::Block& block, std::uint32_t lane, const LightView& light)
{
    const glm::vec3 origin(block.origin[0][lane], block.origin[1][lane], block.origin[2][lane]);
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    return {origin, block.tfar[lane], directional ? -light.direction() : light.position() - origin};
}

/// What c of receiverOffset() (shaders/shared/receiver.h) is at least, wherever the receiver is.
float leastCoordinate(const CameraView& view, const LightView& light);

/// Reads blocks of a view for one light.
class BlockReader {
public:
    /// Arguments as for Receivers.
    BlockReader(const simd::Kernels& kernels, const CameraView& view, const LightView& light,
                std::span<const float> depth, std::span<const std::byte> normals);

    /// The block whose first pixel is at (x, y) of the view's area. Lanes beyond the area ask nothing.
    void read(std::uint32_t x, std::uint32_t y, simd::Block& block) const;
    void readSummed(std::uint32_t x, std::uint32_t y, simd::Block& block) const;
    /// Where the receivers there lie in a map; there are normals.
    void place(std::uint32_t x, std::uint32_t y, const simd::MapLookup& map, simd::MapPlaces& places) const;
    /// The rays of a block that was read: rayOf() of the lanes that ask.
    void pack(const simd::Block& block, RayPacket& packet) const { kernels_.pack(constants_, block, packet); }
    const simd::Kernels& kernels() const { return kernels_; }
    /// Calls for what read() will read there, which may be beyond the area.
    void prefetch(std::uint32_t x, std::uint32_t y) const;

private:
    void texels(std::uint32_t x, std::uint32_t y, simd::Texels& texels) const;
    void whole(std::size_t pixel, simd::Texels& texels) const;
    void part(std::uint32_t x, std::uint32_t y, simd::Texels& texels) const;
    void normal(const std::byte* texel, simd::Texels& texels, std::uint32_t lane) const;
    void beside(std::uint32_t left, std::uint32_t top, simd::Texels& texels) const;

    const simd::Kernels& kernels_;
    simd::Constants constants_{};
    VkRect2D area_;
    std::uint32_t width_;
    std::span<const float> depth_;
    std::span<const std::byte> normals_;
    bool halfNormals_;
};

} // namespace gnomon
