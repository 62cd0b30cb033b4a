#pragma once
// Maps for tests of conservative rasterisation, and what the rays through them meet: in double precision and without
// any formula of shaders/hybrid/conservative.h.
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "shaders/hybrid/conservative.h"

namespace gnomon::test {

/// Corners given in texels and depth, as a directional light sees them; depth 0 near, 1 far.
inline gpu::ConservativePush straightDown(float side, float texelError, std::uint32_t flags = 0)
{
    gpu::ConservativePush push{};
    push.texelFromObject = glm::mat4(1.0f);
    push.texelFromObject[3] = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
    push.side = side;
    push.depthConstant = 0.0f;
    push.depthScale = -1.0f;
    push.texelError = texelError;
    push.depthError = 1e-6f;
    push.flags = flags;
    return push;
}

inline constexpr float kLampNear = 0.25f, kLampFar = 32.0f; ///< Metres.

/// Corners in metres about a light that looks along z through a map of 90 degrees.
inline gpu::ConservativePush lamp(float side)
{
    gpu::ConservativePush push = straightDown(side, 1e-5f * 4.0f * side, gpu::CASTER_PERSPECTIVE);
    const float half = 0.5f * side;
    push.texelFromObject = glm::mat4(half, 0, 0, 0, 0, half, 0, 0, half, half, 0, 1, 0, 0, 0, 0);
    push.depthConstant = kLampFar / (kLampFar - kLampNear);
    push.depthScale = -kLampFar * kLampNear / (kLampFar - kLampNear);
    push.wError = 1e-5f;
    push.depthErrorSquare = 1e-5f / -push.depthScale;
    return push;
}

/// A triangle as the rays through a map see it.
class SeenTriangle {
public:
    SeenTriangle(const gpu::ConservativePush& push, const std::array<glm::vec3, 3>& corners)
        : perspective_((push.flags & gpu::CASTER_PERSPECTIVE) != 0), constant_(static_cast<double>(push.depthConstant)),
          scale_(static_cast<double>(push.depthScale))
    {
        glm::dmat3 columns;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec4 q =
                glm::dmat4(push.texelFromObject) * glm::dvec4(glm::dvec3(corners[std::size_t(i)]), 1.0);
            columns[i] = {q.x, q.y, q.w};
            depths_[i] = q.z;
        }
        flat_ = glm::determinant(columns) == 0.0;
        if (!flat_) weightsAt_ = glm::inverse(columns);
    }

    /// Depth where the ray through a place in the map, in texels, meets the triangle; before the near end below 0.
    /// \param slack How far outside it may pass, as a share of the triangle: rays along an edge that two share meet
    /// one.
    std::optional<double> depthAt(glm::dvec2 at, double slack = 0.0) const
    {
        if (flat_) return {};
        const glm::dvec3 weights = weightsAt_ * glm::dvec3(at, 1.0);
        const double sum = weights.x + weights.y + weights.z, least = -slack * std::abs(sum);
        if (weights.x < least || weights.y < least || weights.z < least) return {};
        return perspective_ ? constant_ + scale_ * sum : glm::dot(weights, depths_);
    }

private:
    glm::dmat3 weightsAt_{1.0};
    glm::dvec3 depths_{0.0};
    bool flat_ = false, perspective_;
    double constant_, scale_;
};

} // namespace gnomon::test
