#pragma once
#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace gnomon {

/// A box along the axes, metres.
struct Aabb {
    glm::vec3 lower{0.0f}, upper{0.0f};
    glm::vec3 center() const { return 0.5f * (lower + upper); }
    glm::vec3 halfExtent() const { return 0.5f * (upper - lower); }
};

/// The least box around both.
inline Aabb unionOf(const Aabb& a, const Aabb& b)
{
    return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

} // namespace gnomon
