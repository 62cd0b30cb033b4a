#pragma once
// Receivers on the CPU: the same formulas as the shaders' (shaders/shared/receiver.h), from depth and normals that were
// read back; and the shadow rays they ask for.
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/passes/pass_context.hpp"
#include "runtime/rays/ray_scene.hpp"

namespace gnomon {

/// Has memory brought near that will be read soon, where the compiler knows how.
inline void prefetchRead([[maybe_unused]] const void* memory)
{
#if defined(__GNUC__)
    __builtin_prefetch(memory);
#endif
}

/// What a pixel wants to know.
enum class Asked : std::uint8_t {
    lit,  ///< Nothing: sky, or the light does not reach it.
    dark, ///< Nothing: its surface faces away from the light.
    ray,  ///< Whether anything blocks the ray.
};

/// The surface behind a pixel that asks.
struct Receiver {
    glm::vec3 viewRay; ///< World: receiverRayWs() of receiver.h.
    float w;           ///< Linear depth.
    glm::vec3 normal;  ///< Unit; without normals from the host, the direction of the view ray.
};

/// Depth values beside a pixel. Beyond what the view draws the plane goes on (shaders/shared/seen_normal.glsl).
struct NeighbourDepths {
    float left, right, above, below;
};
/// Of the pixel at image coordinates within `area`. @param depth row by row, `width` to a row
NeighbourDepths neighbourDepths(std::span<const float> depth, std::uint32_t width, const VkRect2D& area,
                                std::uint32_t x, std::uint32_t y);

/// A view's receivers for one light.
class Receivers {
public:
    /// @param depth row by row over the image's extent. @param normals raw texels in view.normalFormat, or empty: every
    /// reached pixel asks, because facing from depth would be wrong on 0.3 to 1.7 % of the pixels.
    Receivers(const CameraView& view, const LightView& light, std::span<const float> depth,
              std::span<const std::byte> normals);

    /// The ray of the pixel at image coordinates, or why it needs none.
    Asked at(std::uint32_t x, std::uint32_t y, ShadowRay& ray) const
    {
        Receiver receiver;
        return at(x, y, ray, receiver);
    }
    Asked at(std::uint32_t x, std::uint32_t y, ShadowRay& ray, Receiver& receiver) const;
    /// Calls for what at() will read.
    void prefetch(std::uint32_t x, std::uint32_t y) const;
    bool hasNormals() const { return !normals_.empty(); }

private:
    glm::vec3 normalAt(std::size_t pixel) const;
    glm::vec3 seenNormalAt(std::uint32_t x, std::uint32_t y, const glm::vec3& viewRay) const;

    gpu::ViewConstants view_;
    gpu::LightConstants light_;
    VkRect2D area_;
    std::uint32_t width_;
    std::span<const float> depth_;
    std::span<const std::byte> normals_;
    bool halfNormals_;
};

/// The pixels of the view's area that the light may reach, from its first one, to whole tiles: nothing else asks.
struct AskedPixels {
    std::uint32_t left = 0, top = 0;     ///< Multiples of the tile's side.
    std::uint32_t right = 0, bottom = 0; ///< One past the last ones, within the area.

    bool holdsRow(std::uint32_t y) const { return top <= y && y < bottom; }
};
AskedPixels askedPixels(const CameraView& view, const LightView& light, std::uint32_t tileSide);

/// IEEE 754 binary16, all values.
float fromHalf(std::uint16_t bits);

/// Shadow rays of pixels, answered in batches: add pixels, then take the answers.
template <std::size_t Capacity>
struct RayBatch {
    std::size_t count = 0;
    ShadowRay rays[Capacity];
    std::uint32_t tags[Capacity]; ///< The caller's name for a ray.
    std::uint8_t occluded[Capacity];

    bool full() const { return count == Capacity; }
    /// Answers what is there and calls `answer(tag, occluded)`; the batch is empty afterwards.
    template <typename Answer>
    void flush(const HostContext& host, std::uint32_t lightMask, Answer&& answer)
    {
        if (count == 0) return;
        host.rays->occluded(std::span<const ShadowRay>(rays, count), lightMask,
                            std::span<std::uint8_t>(occluded, count));
        host.countRays(count);
        for (std::size_t i = 0; i < count; ++i)
            answer(tags[i], occluded[i] != 0);
        count = 0;
    }
};

} // namespace gnomon
