#pragma once
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

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

/// Whether they have a point in common; sides count.
inline bool overlap(const Aabb& a, const Aabb& b)
{
    return glm::all(glm::lessThanEqual(a.lower, b.upper)) && glm::all(glm::lessThanEqual(b.lower, a.upper));
}

} // namespace gnomon
