#pragma once
// What the host hands over, checked and brought into one form. No state; every error names the value at fault.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "gnomon/gnomon.h"
#include "runtime/base/result.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Largest coordinate, length or factor taken, metres: beyond it squared distances leave the range of float (3.4e38).
inline constexpr double kLargestMagnitude = 1e18;

/// How messages call an object: "mesh 'rock'", or "a mesh without a name". Text is made where something is wrong only.
std::string named(const char* kind, const char* name);
struct Subject {
    const char* kind;
    const char* name; ///< Null and "": none.
    std::string text() const { return named(kind, name); }
};

/// Corners or vertices of a mesh as the host gave them.
struct MeshInput {
    std::string name;
    bool turned = false;                ///< MeshView::turned; `indices` are counter-clockwise then.
    std::vector<glm::vec3> positions;   ///< Followed by kPositionPadding unused ones.
    std::vector<std::uint32_t> indices; ///< In range; zero-area triangles are still there.
};

/// Positions kept past the last one, so that 16-byte loads of any position stay inside the array (Embree).
inline constexpr std::size_t kPositionPadding = 2;

/// What a device takes of a mesh; more is GN_ERROR_TOO_MANY.
struct MeshLimits {
    std::uint64_t bufferBytes; ///< Of one storage buffer.
    std::uint32_t index;       ///< The largest in an indexed draw.
};

/// Finite and at most kLargestMagnitude. @param name as in gnomon.h, "translation[2]"
Result<void> checkNumber(Subject what, double value, const char* name);
/// How many corners of triangles there are, not 0 and a multiple of 3.
Result<std::uint32_t> readIndexCount(Subject what, const GnMeshCreateInfo& info, bool hasIndices);
/// Not more than the device takes. @param bytes of the larger one of its buffers
Result<void> checkMeshSize(Subject what, std::uint32_t positionCount, std::uint64_t bytes, const MeshLimits& limits);
/// Whether fronts are clockwise.
Result<bool> readFrontFace(Subject what, VkFrontFace frontFace);
Result<MeshInput> readMesh(const GnMeshCreateInfo& info, const MeshLimits& limits);
/// Finite positions, packed and padded.
Result<std::vector<glm::vec3>> readPositions(Subject what, const float* positions, std::uint32_t count,
                                             std::uint32_t stride);
/// Triangles that have an area.
struct KeptTriangles {
    std::vector<std::uint32_t> indices;
    std::vector<std::uint32_t> numbers; ///< Of each one in the list it was taken from; empty where all are kept.
};
/// An area counts as zero if no component of its vector is representable as float.
KeptTriangles withoutZeroArea(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

/// The transform with an all-zero basis replaced by the identity.
Result<GnTransform> readTransform(Subject what, const GnTransform& transform);
bool sameTransform(const GnTransform& a, const GnTransform& b) noexcept;

/// Of a host-drawn instance, in its own space.
Result<Aabb> readBounds(Subject what, const float (&lower)[3], const float (&upper)[3]);

/// Everything about an instance but its mesh.
Result<GnInstanceCreateInfo> readInstance(const GnInstanceCreateInfo& info);

/// A light with defaults filled in. Members that its type does not use are zero, so that equal lights compare equal.
struct LightDescription {
    GnLightType type = GN_LIGHT_TYPE_DIRECTIONAL;
    bool isStatic = false;
    bool sampled = false;
    std::array<double, 3> position{};
    std::array<float, 3> direction{}; ///< Unit length.
    float range = 0.0f;               ///< kUnlimitedRange where the host gave 0, and for directional lights.
    float coneAngle = 0.0f;
    float sourceRadius = 0.0f;                 ///< Of a rectangle: of the disc that has its area.
    std::array<float, 3> sourceX{}, sourceY{}; ///< LightView's.
    GnSourceShape sourceShape = GN_SOURCE_SHAPE_SPHERE;
    float importance = 1.0f;
    std::uint32_t mask = kAllMasks;

    bool samePose(const LightDescription& other) const noexcept;  ///< Where it is and what it reaches.
    bool sameLight(const LightDescription& other) const noexcept; ///< Pose, radius, mask: all that shadows depend on.
};
Result<LightDescription> readLight(Subject what, const GnLightInfo& info);

} // namespace gnomon
