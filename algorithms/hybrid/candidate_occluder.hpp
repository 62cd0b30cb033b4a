#pragma once
// Whether one triangle that a map names blocks one ray: what a single candidate occluder proves. A hit proves shadow, a
// miss nothing. Source: Moderno, 3.2.
#include <cstdint>
#include <optional>
#include <span>

#include <glm/mat3x3.hpp>

#include "algorithms/hybrid/triangle_rings.hpp"
#include "runtime/base/arena.hpp"
#include "runtime/rays/ray_scene.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// What a texel holds where no triangle was drawn.
inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// A triangle in the world, as something to ask rays against.
struct CandidateOccluder {
    glm::dvec3 a, b, c, normal;
    double lengths[3]; ///< Of the edges ab, bc, ca, as sums of coordinates: bounds that cost no root.
    double size;       ///< Of the coordinates that the tracer rounds.
    double stretch;    ///< Of its rounding, by the transform.
};
CandidateOccluder candidateOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Whether the triangle blocks the ray, well inside its edges and between the ray's ends. "True" is what the tracer
/// says too; "false" says nothing.
bool blocks(const CandidateOccluder& candidate, const ShadowRay& ray);

/// The triangles of a light's casters, numbered one caster after the other.
class NumberedTriangles {
public:
    /// Rings come from the cache, built or still to be built; null leaves them out. Memory from the arena.
    NumberedTriangles(std::span<const Caster* const> casters, RingsCache* cache, FrameArena& arena);

    struct Entry {
        const Caster* caster;
        RingsCache::Entry* rings; ///< May be null.
        std::uint32_t first;      ///< Number of its first triangle.
        /// Stretch of the transform: the tracer moves the ray into the object, and its rounding there grows by this.
        float stretch;
        bool testifies; ///< The tracer sees it as it is drawn: opaque, with a tree, not flattened.
    };
    std::span<const Entry> entries() const { return entries_; }
    /// Changes when the numbers do.
    std::uint64_t stamp() const { return stamp_; }

    const Entry& of(std::uint32_t number) const;
    /// The triangle's three, in its mesh.
    const std::uint32_t* corners(std::uint32_t number) const;
    /// Where the triangle is; nothing if it does not testify.
    std::optional<CandidateOccluder> candidate(std::uint32_t number) const;

private:
    std::span<Entry> entries_;
    std::uint64_t stamp_ = 0;
};

/// Triangles by number, remembered for the next ray: neighbouring pixels ask the same ones. Of one thread.
class CandidateOccluders {
public:
    explicit CandidateOccluders(const NumberedTriangles& triangles) : triangles_(triangles)
    {
        for (Kept& kept : kept_)
            kept.number = kNoTriangle;
    }
    const NumberedTriangles& triangles() const { return triangles_; }
    bool blocks(std::uint32_t number, const ShadowRay& ray);

private:
    struct Kept {
        std::uint32_t number;
        std::optional<CandidateOccluder> candidate;
    };

    const NumberedTriangles& triangles_;
    // What four rows of pixels meet: a few dozen triangles at a time. 37 kB.
    static constexpr std::uint32_t kPlaces = 256;
    Kept kept_[kPlaces];
};

} // namespace gnomon
