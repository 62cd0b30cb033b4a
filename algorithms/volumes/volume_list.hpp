#pragma once
// The index lists of one light in a buffer, and when they are built: on the CPU, or by the device (mesh_volumes.hpp).
//
// The buffer starts with one VkDrawIndexedIndirectCommand per piece; indices follow, every piece with room for the most
// it can need. Counts therefore live and stay with the buffer: a kept list is drawn without the CPU knowing its length.
// Pieces start at multiples of six indices: side i of the buffer is indices 6 i to 6 i + 5.
#include <cstdint>
#include <span>

#include "algorithms/shared/caster_lists.hpp"
#include "runtime/algorithm.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon {

/// Edges and faces of a mesh that has a topology, or connectivity.
inline const Topology& topologyOf(const MeshView& mesh)
{
    return mesh.topology ? *mesh.topology : *mesh.connectivity;
}

/// What has a volume of its own: a cluster of a caster's mesh, or the whole.
struct VolumeSource {
    static constexpr std::uint32_t kWhole = UINT32_MAX;

    const Caster* caster = nullptr;
    std::uint32_t cluster = 0;
    bool bothSides = false; ///< z-fail counts all faces of a closed cluster, as it does those of an open one.

    const Topology& topology() const { return topologyOf(*caster->mesh); }
    const Topology::Cluster& shape() const
    {
        return cluster == kWhole ? topology().whole : topology().clusters[cluster];
    }
    /// A solid whose faces cast with both sides, as those of the rest of its mesh.
    bool closedInOpenMesh() const { return shape().closed && !topology().closed; }
    Aabb bounds() const; ///< World.
    /// Faces that the picture does not show may lie before what it shows. A host that draws one side of all leaves
    /// those out which look away from the eye: near ones, where a solid is inside out.
    bool mayBeUnseen() const { return shape().insideOut || (caster->singleSided && !shape().closed); }
    bool operator==(const VolumeSource&) const = default;
};

/// The volumes of these casters in their order, and in that of their clusters. Meshes are cut into at most 1 024
/// clusters together, those that the light is within before others and large ones before small: of a forest no tree
/// gains by it what hundreds of draws cost.
std::span<const VolumeSource> volumesOf(FrameArena& arena, std::span<const Caster* const> casters,
                                        const LightView& light);
/// At least as many as volumesOf() of all parts of these casters has together.
std::size_t mostVolumes(std::span<const Caster* const> casters);

enum class ListKind : std::uint8_t { sides, caps };

/// A range of a cluster's edges (sides) or faces (caps), small enough to share the work among threads.
struct VolumePiece {
    VolumeSource source;
    std::uint32_t first = 0, count = 0; ///< Edges, or places of faces.
    std::uint32_t firstIndex = 0;       ///< In the buffer, in units of indices.
    std::uint32_t facingOffset = 0;     ///< Of the caster's faces in the builder's scratch.
};

struct VolumeList {
    BufferId buffer;                     ///< Null id: no pieces.
    std::span<const VolumePiece> pieces; ///< In the order of the volumes; piece i has the i-th command.
};

/// Bytes of a list that holds the sides, or the caps, of these casters, before it grows to a power of two.
/// @param listed whether it holds a caster
VkDeviceSize sidesBytes(std::span<const Caster* const> casters, bool (*listed)(const Caster&) = castsVolume);
VkDeviceSize capsBytes(std::span<const Caster* const> casters, bool (*listed)(const Caster&) = castsVolume);

struct MeshVolumePipelines; // mesh_volumes.hpp

/// The sides of the static (or else the moving) casters of the light: once per light, whatever the views. Built if the
/// light or one of these casters changed, else kept; moving ones that cast no volume may change.
/// @param device null: on the CPU
VolumeList declareSides(PassBuilder& passes, const ShadowTask& task, bool statics,
                        const MeshVolumePipelines* device = nullptr);

/// Of lists of casters whose positions the GPU alone knows; 0 and 1 are those of all static and all moving ones.
inline constexpr std::uint32_t kMeshVariant = 2;

/// The sides of the light's casters whose positions the GPU alone knows. Each is one volume, since bounds of clusters
/// are of another pose.
VolumeList declareMeshSides(PassBuilder& passes, const ShadowTask& task, const MeshVolumePipelines& device);

/// What a method draws of a light's static casters whatever the view: sides, or caps, of the volumes it has chosen once
/// for this light and these casters. Once per light and choice; built if `stamp` or the light changed, else kept.
struct VolumeChoice {
    std::span<const VolumeSource> volumes;
    std::uint64_t stamp = 0;   ///< Of everything the choice depends on besides the light.
    std::uint32_t variant = 0; ///< Distinguishes choices.
};
VolumeList declareChosenSides(PassBuilder& passes, const ShadowTask& task, const VolumeChoice& choice);
VolumeList declareChosenCaps(PassBuilder& passes, const ShadowTask& task, const VolumeChoice& choice);

/// The caps of the given volumes, which depend on the view by their choice only.
/// @param device of declareMeshSides()
VolumeList declareCaps(PassBuilder& passes, const ShadowTask& task, std::span<const VolumeSource> volumes,
                       std::uint32_t variant, const MeshVolumePipelines* device = nullptr);

} // namespace gnomon
