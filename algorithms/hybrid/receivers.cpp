#include "algorithms/hybrid/receivers.hpp"

#include <bit>
#include <cstring>
#include <limits>

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

Receivers::Receivers(const CameraView& view, const LightView& light, std::span<const float> depth,
                     std::span<const std::byte> normals)
    : view_(view.constants), light_(light.constants), width_(view.extent.width), depth_(depth), normals_(normals),
      halfNormals_(view.normalFormat == VK_FORMAT_R16G16B16A16_SFLOAT)
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
    return normal / gpu::max(gpu::length(normal), 1e-20f); // halves are unit length to 1e-3 only
}

Asked Receivers::at(std::uint32_t x, std::uint32_t y, ShadowRay& ray) const
{
    const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
    const float depth = depth_[pixel];
    if (depth == view_.skyDepth) return Asked::lit;

    const glm::vec2 centre(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    const glm::vec3 viewRay = gpu::viewRayWs(view_, centre);
    const glm::vec3 receiver = glm::vec3(view_.eyeWs) + gpu::linearDepth(view_, depth) * viewRay;
    if (!gpu::lightReaches(light_, receiver)) return Asked::lit;

    const glm::vec3 toLight = gpu::towardsLightWs(light_, receiver);
    glm::vec3 normal = viewRay / gpu::length(viewRay), away = toLight; // without normals: the longest offset there is
    if (!normals_.empty()) {
        normal = normalAt(pixel);
        if (!(gpu::dot(normal, toLight) > 0.0f)) return Asked::dark;
        away = normal;
    }
    const float offset = gpu::receiverOffset(view_, light_, depth, viewRay, receiver, normal);
    ray.origin = receiver + offset * away;
    if (light_.type == gpu::LIGHT_DIRECTIONAL) {
        ray.direction = toLight;
        ray.tfar = std::numeric_limits<float>::infinity();
    } else {
        ray.direction = glm::vec3(light_.positionWs) - ray.origin;
        // Less than zero where the receiver is closer to the light than the offset: nothing fits between them.
        ray.tfar = 1.0f - offset / gpu::max(gpu::length(ray.direction), 1e-20f);
    }
    return Asked::ray;
}

} // namespace gnomon
