#pragma once
// What algorithms see of the scene in one frame: plain structs, relative to the frame's origin, immutable while the
// frame is declared, prepared, recorded and traced.
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "gnomon/gnomon.h"
#include "runtime/scene/aabb.hpp"
#include "shaders/shared/receiver.h"

namespace gnomon {

/// LightConstants::range of a light without one. Finite, and far enough from the largest float to be added to.
inline constexpr float kUnlimitedRange = std::numeric_limits<float>::max() / 4.0f;

struct Topology;
class MeshRays; // runtime/rays: the tree of one mesh

/// A mesh as the frame sees it. Alive while any frame that saw it is in flight.
struct MeshView {
    const char* name = "";
    std::uint32_t id = 0;                        ///< Stable identity over revisions, from 1; never another mesh's.
    std::span<const glm::vec3> positions;        ///< Empty while the buffers alone have them.
    std::span<const std::uint32_t> indices;      ///< Likewise. Three per triangle, zero-area triangles removed.
    std::span<const std::uint32_t> givenNumbers; ///< The host's number of each triangle; empty: none was removed.
    Aabb bounds;                                 ///< Object space.
    std::span<const Aabb> chunks;           ///< Of every kChunkFaces triangles (mesh_chunks.hpp); empty: not known.
    VkBuffer vertexBuffer = VK_NULL_HANDLE; ///< Positions, 12 bytes each. Also a storage buffer.
    VkBuffer indexBuffer = VK_NULL_HANDLE;  ///< uint32. Also a storage buffer.
    const Topology* topology = nullptr;     ///< Null until a worker has built it, or without OpenMesh.
    const Topology* connectivity = nullptr; ///< Edges and faces while the GPU alone knows where the vertices are:
                                            ///< planes, lengths and bounds are those of another pose. Null: not known.
    std::uint64_t connectivityRevision = 0; ///< As `revision`, which no mesh has; 0: no connectivity.
    const MeshRays* rays = nullptr;         ///< Null until a worker has built it, or without Embree.
    std::uint64_t revision = 0;             ///< Unique over all meshes; changes with the positions.
    bool closed = false;                    ///< Known from the topology; false until it is there.
    bool insideOut = false;                 ///< Likewise: some watertight shell is.
    bool turned = false;                    ///< The host's fronts are clockwise: its second corner is our third.
    bool noCpuCopy = false;                 ///< Positions and indices will never be known to the CPU.
    std::uint32_t gpuTriangles = 0;         ///< While the buffers alone have them: how many; zero-area ones count.
    std::uint32_t gpuPositions = 0;         ///< Likewise.

    std::uint64_t faces = 0; ///< Unique over all meshes; changes with the triangles.
    /// longestOf() (long_edges.hpp); infinite until a worker has measured it, or where nobody needs it.
    float longest = std::numeric_limits<float>::infinity();
    VkDeviceAddress vertexAddress = 0, indexAddress = 0; ///< Of the buffers; 0 without DeviceTable::rayQuery().

    glm::vec3 edgeSpan{0.0f}; ///< The most that an edge goes along each axis, object space.

    std::uint32_t positionCount() const
    {
        return positions.empty() ? gpuPositions : static_cast<std::uint32_t>(positions.size());
    }
    bool onGpuOnly() const { return indices.empty() && gpuTriangles > 0; }
    std::uint32_t triangleCount() const
    {
        return indices.empty() ? gpuTriangles : static_cast<std::uint32_t>(indices.size() / 3);
    }
};

constexpr std::uint32_t kAllMasks = 0xffffffffu; ///< What 0 means in the API.

/// One instance as a caster.
struct Caster {
    std::uint32_t index = 0;        ///< Into the frame's table of transforms: firstInstance of its draws.
    std::uint32_t id = 0;           ///< Stable identity of the instance over frames: small, from 1; a destroyed one's
                                    ///< id may come back, then with another revision.
    const MeshView* mesh = nullptr; ///< Null for host-drawn casters.
    glm::mat3 basis{1.0f};          ///< world = basis * object + translation
    glm::vec3 translation{0.0f};    ///< Relative to the frame's origin, metres.
    Aabb bounds;                    ///< World, relative to the origin.
    std::uint64_t revision = 0; ///< Unique over all instances; changes when transform, mesh, mask or positions do, that
                                ///< of a host-drawn one that is not static in every frame.
    std::uint32_t mask = kAllMasks;
    float longestEdge = 0.0f; ///< At most: of its triangles in the world, metres; 0 where the host draws it.
    float meshReach = 0.0f;   ///< Largest coordinate of its triangles from the zero of their mesh, metres; 0 likewise.
    bool isStatic = false;
    bool mirrored = false; ///< The basis has a negative determinant: winding is reversed.
    bool closed = false;   ///< mesh->closed; open casters are drawn from both sides with a bias.
    bool alphaTested = false;
    bool hostDrawn = false;
    bool gpuPlaced = false; ///< The table of transforms alone says where it is: bounds and `mirrored` are the host's,
                            ///< and the basis is zero, so that rays do not meet it.
    bool mayBeMissed = false;
    bool singleSided = false; ///< The host draws the front of its triangles only.
    PFN_gnDrawCasters drawCasters = nullptr;
    PFN_gnOpacity opacity = nullptr;
    void* userData = nullptr;
    const char* name = "";
};

/// A light as the frame sees it.
struct LightView {
    std::uint32_t id = 0; ///< Stable identity over frames, from 1; never another light's.
    GnLight handle = VK_NULL_HANDLE;
    GnLightType type = GN_LIGHT_TYPE_DIRECTIONAL;
    GnSourceShape sourceShape = GN_SOURCE_SHAPE_SPHERE;
    const char* name = "";
    gpu::LightConstants constants{}; ///< Position relative to the origin.
    float coneAngle = 0.0f;          ///< Spot: half angle, radians.
    /// Half axes of a flat source, a rectangle or a disc, metres. Zero: a sphere, or the sun. constants.sourceRadius is
    /// that of sphere, sun or disc, or of a disc that has the rectangle's area.
    glm::vec3 sourceX{0.0f}, sourceY{0.0f};
    std::uint32_t mask = kAllMasks;
    std::uint64_t revision = 0; ///< Unique over all lights; changes when the description or the origin does.
    bool isStatic = false;      ///< Static flag set and never moved.
    bool sampled = false;       ///< GN_LIGHT_SAMPLED_BIT. Changing it alone is no new revision either.
    float importance = 1.0f;    ///< Weight in the plan. Changing it alone is no new revision: no map depends on it.

    bool unlimited() const { return constants.range >= kUnlimitedRange; }
    bool flat() const { return sourceX != glm::vec3(0.0f); }
    bool rectangular() const { return flat() && sourceShape == GN_SOURCE_SHAPE_RECTANGLE; }
    /// Metres from its position to the farthest point of its source.
    float sourceReach() const { return rectangular() ? glm::length(sourceX + sourceY) : constants.sourceRadius; }
    glm::vec3 position() const { return glm::vec3(constants.positionWs); }
    glm::vec3 direction() const { return glm::vec3(constants.directionWs); }
};

/// The casters a light can see: those with a matching mask that touch its range and cone.
struct LightCasters {
    std::span<const Caster* const> statics; ///< Static flag set and never moved.
    std::span<const Caster* const> dynamics;
    std::span<const Caster* const> all; ///< statics, then dynamics.
    std::uint64_t staticStamp = 0;      ///< Changes when the set or any member of `statics` does. Never 0.
    std::uint64_t dynamicStamp = 0;     ///< The same for `dynamics`; 0 when there are none.
    std::uint32_t triangles = 0;
    std::uint32_t hostDrawn = 0; ///< Host-drawn casters in range that may not be missed.
    std::uint32_t gpuPlaced = 0; ///< Casters in range whose transforms the GPU alone knows.
    std::uint32_t missable = 0;  ///< Casters in range that some methods draw and others leave out.
    std::uint32_t opacities = 0; ///< Casters in range that ask the host whether a ray stops (Caster::opacity).
};

/// A plane with dot(normal, p) + distance >= 0 inside.
struct Plane {
    glm::vec3 normal{0.0f};
    float distance = 0.0f;
};

/// Where in the host's images a view's pixels are.
struct ImageSource {
    std::uint32_t samples = 1; ///< A pixel; `sample` is judged.
    std::uint32_t sample = 0;
    bool layered = false; ///< Image views are of arrays, and `layer` is the view's.
    std::uint32_t layer = 0;
    GnNormalEncoding encoding = GN_NORMAL_SIGNED;
    glm::vec4 straight{0.0f}; ///< CameraView::oblique: depth becomes w (depth - x - y column - z row).
    float skyDepth = 0.0f;    ///< And this one 0.
};

/// A camera as the frame sees it.
struct CameraView {
    gpu::ViewConstants constants{};
    glm::mat3 viewFromWorld{1.0f}; ///< Rotation.
    glm::mat4 projection{1.0f};    ///< clipFromView as given; through the judged sample, without an oblique near plane.
    glm::vec3 eye{0.0f};           ///< Relative to the origin.
    std::array<Plane, 6> frustum{};         ///< World, inward; the far one is (0, 0, 0), 1 for infinite projections.
    std::array<glm::vec3, 4> nearCorners{}; ///< World corners of the near rectangle of the render area, in ring order.
    GnDepthConvention convention = GN_DEPTH_REVERSED_INFINITE;
    VkFormat depthFormat = VK_FORMAT_D32_SFLOAT; ///< Of the host's image.
    VkFormat normalFormat = VK_FORMAT_UNDEFINED; ///< Undefined: no normals.
    VkExtent2D extent{};                         ///< Of the images.
    VkRect2D area{};                             ///< Pixels drawn.
    double origin[3]{};                          ///< World position of the zero of all coordinates here.
    glm::vec3 motionScale{0.0f};                 ///< Of motion vectors, as GnViewFrame::motionScale; x and y not 0.
    ImageSource source;
    std::uint32_t id = 0;
    bool cut = false;
    bool oblique = false; ///< The host's near plane cuts across the view: before it anything may be.

    bool reversed() const { return convention != GN_DEPTH_STANDARD; }
    /// Sign of the view's z axis along which it looks.
    float ahead() const
    {
        if (!gpu::isOrthographic(constants)) return projection[2][3] < 0.0f ? -1.0f : 1.0f; // clip w is the depth
        return (projection[2][2] > 0.0f) != reversed() ? 1.0f : -1.0f;
    }
};

/// ViewConstants::corners: what receivers on any of the casters are rounded by, beside their own coordinates, as a
/// share of 2^-21 (largestCoordinate(), shaders/shared/receiver.h). Metres.
///
/// A quarter of the longest edge, 64 m at most (long_edges.hpp): depths are those of triangles whose corners were
/// rounded where they are. Receivers on grounds of two triangles lay deeper by up to 2^-24.2 of it (4 km, lavapipe).
///
/// Half of how far the eye is from the zero of a mesh that goes as far: rays meet triangles in mesh space, and a
/// building in world coordinates has its zero kilometres away. There a ray's start is rounded by 2^-24 of each
/// coordinate, three times where the mesh is turned. What receivers are farther away than the eye is in their own
/// coordinates.
float cornersOf(std::span<const Caster> casters, const glm::vec3& eye);

// --- culling helpers, conservative: "true" may be wrong, "false" never is ---

bool touches(const Aabb& box, std::span<const Plane> volume);
/// Whether all of the box lies in the volume; here "false" may be wrong.
bool holds(std::span<const Plane> volume, const Aabb& box);
/// Box against sphere.
bool touches(const Aabb& box, glm::vec3 center, float radius);
/// Whether anything of the box can lie between the light, source radius included, and what it reaches.
bool reaches(const LightView& light, const Aabb& box);

/// Whether a light with a position lies within the box.
bool holdsLight(const Aabb& box, const LightView& light);
/// World bounds of an object-space box.
Aabb transformed(const Aabb& box, const glm::mat3& basis, glm::vec3 translation);

} // namespace gnomon
