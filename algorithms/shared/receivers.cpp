#include "algorithms/shared/receivers.hpp"

#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "runtime/scene/light_pixels.hpp"

namespace gnomon {

float fromHalf(std::uint16_t bits)
{
    // The exponent moves from bias 15 to 127; multiplying by 2^112 also makes numbers of subnormal halves.
    const std::uint32_t sign = (bits & 0x8000u) << 16;
    const std::uint32_t magnitude = (bits & 0x7fffu) << 13;
    const bool special = (bits & 0x7c00u) == 0x7c00u; // infinity and NaN keep the full exponent
    const float value = std::bit_cast<float>(magnitude) * 0x1p112f;
    return std::bit_cast<float>((special ? magnitude | 0x7f800000u : std::bit_cast<std::uint32_t>(value)) | sign);
}

NeighbourDepths neighbourDepths(std::span<const float> depth, std::uint32_t width, const VkRect2D& area,
                                std::uint32_t x, std::uint32_t y)
{
    const float* at = depth.data() + static_cast<std::size_t>(y) * width + x;
    // @param step from the pixel to the next one, @param before @param after whether those are drawn
    const auto beside = [&](std::ptrdiff_t step, bool before, bool after) {
        const float back = before ? at[-step] : after ? 2.0f * *at - at[step] : *at;
        const float on = after ? at[step] : before ? 2.0f * *at - at[-step] : *at;
        return std::pair(back, on);
    };
    const auto left = static_cast<std::uint32_t>(area.offset.x), top = static_cast<std::uint32_t>(area.offset.y);
    const auto [back, on] = beside(1, x > left, x + 1 < left + area.extent.width);
    const auto [above, below] = beside(static_cast<std::ptrdiff_t>(width), y > top, y + 1 < top + area.extent.height);
    return {back, on, above, below};
}

Receivers::Receivers(const CameraView& view, const LightView& light, std::span<const float> depth,
                     std::span<const std::byte> normals)
    : view_(view.constants), light_(light.constants), area_(view.area), width_(view.extent.width), depth_(depth),
      normals_(normals), halfNormals_(view.normalFormat == VK_FORMAT_R16G16B16A16_SFLOAT)
{
}

glm::vec3 Receivers::normalAt(std::size_t pixel) const
{
    glm::vec3 normal;
    if (halfNormals_) {
        std::uint16_t texel[4];
        std::memcpy(texel, normals_.data() + pixel * sizeof texel, sizeof texel);
        normal = {fromHalf(texel[0]), fromHalf(texel[1]), fromHalf(texel[2])};
    } else {
        float texel[4];
        std::memcpy(texel, normals_.data() + pixel * sizeof texel, sizeof texel);
        normal = {texel[0], texel[1], texel[2]};
    }
    return normal * (1.0f / gpu::max(gpu::length(normal), 1e-20f)); // halves are unit length to 1e-3 only
}

/// As shaders have it (shaders/shared/seen_normal.glsl).
glm::vec3 Receivers::seenNormalAt(std::uint32_t x, std::uint32_t y, const glm::vec3& viewRay) const
{
    const float depth = depth_[static_cast<std::size_t>(y) * width_ + x];
    const NeighbourDepths beside = neighbourDepths(depth_, width_, area_, x, y);
    const glm::vec2 centre(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    return gpu::seenNormalWs(gpu::seenStepWs(view_, centre, {1.0f, 0.0f}, beside.left, beside.right, depth, viewRay),
                             gpu::seenStepWs(view_, centre, {0.0f, 1.0f}, beside.above, beside.below, depth, viewRay),
                             gpu::lookingWs(view_, viewRay));
}

void Receivers::prefetch(std::uint32_t x, std::uint32_t y) const
{
    const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
    prefetchRead(depth_.data() + pixel);
    if (!normals_.empty()) prefetchRead(normals_.data() + pixel * (halfNormals_ ? 8 : 16));
}

Asked Receivers::at(std::uint32_t x, std::uint32_t y, ShadowRay& ray, Receiver& surface) const
{
    const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
    const float depth = depth_[pixel];
    if (depth == view_.skyDepth) return Asked::lit;

    const glm::vec2 centre(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    const glm::vec3 viewRay = gpu::receiverRayWs(view_, gpu::viewRayWs(view_, centre), depth);
    surface.viewRay = viewRay;
    surface.w = gpu::linearDepth(view_, depth);
    const glm::vec3 receiver = glm::vec3(view_.eyeWs) + surface.w * viewRay;
    if (!gpu::lightReaches(light_, receiver)) return Asked::lit;

    const glm::vec3 toLight = gpu::towardsLightWs(light_, receiver);
    const glm::vec3 looking = gpu::lookingWs(view_, viewRay);
    glm::vec3 normal = looking / gpu::length(looking), away; // without normals: the longest offset there is
    if (normals_.empty()) {
        away = gpu::startDirectionWs(seenNormalAt(x, y, viewRay), normal);
    } else {
        normal = away = normalAt(pixel);
        if (!(gpu::dot(normal, toLight) > 0.0f)) return Asked::dark;
    }
    surface.normal = normal;
    const float offset = gpu::receiverOffset(view_, light_, depth, viewRay, receiver, normal);
    const gpu::LightRay way = gpu::lightRay(light_, receiver, away, offset, std::numeric_limits<float>::infinity());
    ray = {.origin = way.start, .tfar = way.end, .direction = way.along};
    return Asked::ray;
}

AskedPixels askedPixels(const CameraView& view, const LightView& light, std::uint32_t tileSide)
{
    const VkRect2D pixels = lightPixels(light, view);
    const auto left = static_cast<std::uint32_t>(pixels.offset.x - view.area.offset.x);
    const auto top = static_cast<std::uint32_t>(pixels.offset.y - view.area.offset.y);
    return {.left = left / tileSide * tileSide,
            .top = top / tileSide * tileSide,
            .right = left + pixels.extent.width,
            .bottom = top + pixels.extent.height};
}

} // namespace gnomon
