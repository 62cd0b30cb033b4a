#pragma once
// The hull of a tile's receivers, the shaft between it and the light, and how the light sees both: what tile_shafts
// proves things with. Set up in double precision, asked in single, with margins for what the ray tracer rounds (the
// page tile_shafts derives them).
#include <cstdint>

#include <glm/ext/vector_double3.hpp>
#include <glm/mat3x3.hpp>

#include "algorithms/hybrid/float4.hpp"
#include "algorithms/hybrid/simd_kernels.hpp"
#include "algorithms/hybrid/spread.hpp"
#include "runtime/rays/ray_scene.hpp"
#include "runtime/rays/triangle_tree.hpp"

namespace gnomon {

/// A light as shafts see it.
struct ShaftLight {
    bool directional = false;
    glm::dvec3 position{0.0}; ///< Spot and point lights.
    glm::dvec3 toLight{0.0};  ///< Directional lights; unit length.

    explicit ShaftLight(const LightView& light);
    glm::dvec3 largest() const { return directional ? glm::dvec3(0.0) : glm::abs(position); } ///< By amount.
};

/// A box with any orientation around where a tile's rays start.
struct Hull {
    glm::dvec3 centre{0.0};
    glm::dvec3 axis[3]; ///< Orthonormal; the last is across the receivers, along which they are thinnest.
    double half[3]{};
    double largestOffset = 0.0;

    double radius(glm::dvec3 direction) const
    {
        return glm::abs(glm::dot(direction, axis[0])) * half[0] + glm::abs(glm::dot(direction, axis[1])) * half[1] +
               glm::abs(glm::dot(direction, axis[2])) * half[2];
    }
    glm::dvec3 extent() const;  ///< From the centre to the faces of the world box around it.
    glm::dvec3 largest() const; ///< Coordinates, by amount.
    /// Sets the axes. @param normals the receivers' sum @param row direction of pixel rows
    void turn(glm::dvec3 normals, glm::dvec3 row);
};

/// The hull of the blocks' rays; false where none asks or one is not a number. @param row direction of pixel rows
bool hullOf(const simd::Kernels& kernels, const simd::Block* blocks, std::uint32_t count, glm::vec3 row, Hull& hull);

/// Everything between a hull and the light lies inside of all planes.
struct Shaft {
    static constexpr int kSides = 4;  ///< Through the light.
    static constexpr int kPlanes = 6; ///< The receivers' own after them, and one across the light's direction.
    glm::dvec3 normal[kPlanes];
    double distance[kPlanes];
    glm::dvec3 largest; ///< Coordinates of hull and light, by amount.
};
Shaft shaftOf(const ShaftLight& light, const Hull& hull);

/// How far from the origin a caster lies: what roundings are measured by.
struct CasterReach {
    glm::dvec3 translation{0.0};
    glm::dmat3 spread{0.0}; ///< Of spreadOf().
    glm::dvec3 reach{0.0};  ///< Largest coordinates of its bounds, by amount.

    /// What the ray tracer may be wrong by in each coordinate where rays start at such coordinates.
    glm::dvec3 rounding(glm::dvec3 largestCoordinates) const;
};

/// A caster as shafts meet it.
struct ShaftCaster : CasterReach {
    const MeshView* mesh = nullptr;
    const TriangleTree* tree = nullptr; ///< Null: only its bounds are known, and all they touch is traced.
    glm::dmat3 basis{1.0};
    glm::vec3 meshReach{0.0f};
    bool opaque = true;

    explicit ShaftCaster(const Caster& caster);

    /// How much a mesh's space enlarges relative errors: 1 where axes stay axes.
    double skew() const { return skewOf(spread); }
};

/// A shaft's planes in a mesh's space, each moved outward by all that is rounded on either side.
struct MeshShaft {
    Float4 normal[Shaft::kPlanes][3]; ///< Each number four times.
    Float4 distance[Shaft::kPlanes];
    std::uint8_t outer[Shaft::kPlanes][3]; ///< Rows of a node's boxes that are farthest along the normal, see rowOf().

    /// With `caster` null in world space, for points no farther than `reach`.
    MeshShaft(const Shaft& shaft, const ShaftCaster* caster, glm::dvec3 rounding, glm::vec3 reach);

    /// Bit i: box i of the node may touch the shaft.
    std::uint32_t touches(const TriangleTree::Node& node) const;
    /// Bit i: box i of the node reaches across all four sides, as it must to hold what hides the light from all of the
    /// hull.
    std::uint32_t spannedBy(const TriangleTree::Node& node) const;
};

/// How the light sees a hull; false where the light is within it, or beside.
bool frameOf(const ShaftLight& light, const Hull& hull, simd::LightFrame& frame);
/// A hull's bounds in a frame of its light.
simd::FrameBounds boundsIn(const simd::LightFrame& frame, const Hull& hull);

/// What the triangles of one caster are to a tile.
simd::TriangleLookup lookOf(const ShaftLight& light, const Hull& hull, const simd::LightFrame& frame,
                            const ShaftCaster& caster);

} // namespace gnomon
