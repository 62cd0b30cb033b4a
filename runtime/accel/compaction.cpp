// Copies of structures without the room that their builds left unused.
#include <algorithm>

#include "runtime/accel/device_rays.hpp"
#include "runtime/passes/pass_context.hpp"

namespace gnomon {

BufferInfo DeviceRays::MeshStructure::whole(std::uint32_t mesh) const
{
    return {.name = deforms ? "rays.deforming_mesh" : "rays.mesh",
            .scope = Scope::scene,
            .size = size,
            .place = BufferPlace::bottomLevel,
            .variant = mesh};
}

BufferInfo DeviceRays::MeshStructure::compact(std::uint32_t mesh) const
{
    return {.name = "rays.compact_mesh",
            .scope = Scope::scene,
            .size = compactSize,
            .place = BufferPlace::bottomLevel,
            .variant = mesh};
}

/// The copy without unused room, once its size is known. The whole one is not used from then on, and goes with time.
/// @return false where there is none: the whole one serves
bool DeviceRays::declareCompact(PassBuilder& passes, const MeshView& mesh, MeshStructure& structure)
{
    if (structure.deforms) return false;
    const std::uint64_t content = contentOf(mesh);
    const bool hasWhole = passes.holds(structure.whole(mesh.id), content);
    if (hasWhole && structure.compactStamp != content) {
        const KeptParts parts = passes.parts(structure.whole(mesh.id));
        if (parts.covered == 0) return askSize(passes, mesh, structure, parts), false;
        const VkDeviceSize size = sizes_.read(parts.covered, passes.completedFrame());
        if (size == 0 || size >= structure.size) return false;
        structure.compactSize = size;
        structure.compactStamp = content;
    }
    if (structure.compactStamp != content) return false;
    if (!hasWhole && !passes.holds(structure.compact(mesh.id), content)) return false;
    // Memory is saved at nobody's cost: maps of other lights do not make way for the copy.
    if (!passes.holds(structure.compact(mesh.id), content) && !passes.hasRoomFor(structure.compactSize)) return false;
    const BufferId copy = passes.persistentIfPossible(structure.compact(mesh.id));
    if (!copy) {
        structure.compactStamp = 0; // and it stays so until the mesh is built again
        return false;
    }
    structure.address = passes.address(copy);
    if (!passes.stale(copy, content)) return true;
    compactions_.push_back({.from = passes.persistent(structure.whole(mesh.id)), .to = copy});
    ++builtEver_;
    return true;
}

/// All queries were taken when it was built.
void DeviceRays::askSize(PassBuilder& passes, const MeshView& mesh, const MeshStructure& structure, KeptParts parts)
{
    parts.covered = sizes_.take(passes.frame());
    if (parts.covered == 0) return;
    const BufferId whole = passes.persistent(structure.whole(mesh.id));
    if (!whole) return;
    passes.keepParts(whole, parts);
    asked_.push_back({whole, parts.covered});
}

/// One pass for all of compactions_.
void DeviceRays::declareCompactions(PassBuilder& passes, std::uint32_t variant)
{
    if (compactions_.empty()) return;
    const std::span<const Compaction> compactions = passes.arena().copy(std::span<const Compaction>(compactions_));
    PassRef pass = passes.compute("rays.compact", Scope::scene, variant);
    pass.builds(scene_.order); // after their builds; what is copied is not changed
    for (const Compaction& compaction : compactions)
        pass.builds(compaction.to);
    pass.record([=](PassContext& gpu) {
        for (const Compaction& compaction : compactions) {
            const VkCopyAccelerationStructureInfoKHR info{.sType =
                                                              VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR,
                                                          .src = gpu.structure(compaction.from),
                                                          .dst = gpu.structure(compaction.to),
                                                          .mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR};
            gpu.vk->vkCmdCopyAccelerationStructureKHR(gpu.cmd, &info);
        }
    });
}

/// Asks the device how large copies of what was built would be.
void DeviceRays::declareSizes(PassBuilder& passes, std::uint32_t variant)
{
    if (asked_.empty()) return;
    const std::span<const SizeAsked> asked = passes.arena().copy(std::span<const SizeAsked>(asked_));
    asked_.clear();
    passes.compute("rays.sizes", Scope::scene, variant)
        .builds(scene_.order)
        .record([=, pool = sizes_.pool()](PassContext& gpu) {
            for (const auto& [buffer, number] : asked) {
                const std::uint32_t query = CompactedSizes::indexOf(number);
                const VkAccelerationStructureKHR structure = gpu.structure(buffer);
                gpu.vk->vkCmdResetQueryPool(gpu.cmd, pool, query, 1);
                gpu.vk->vkCmdWriteAccelerationStructuresPropertiesKHR(
                    gpu.cmd, 1, &structure, VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR, pool, query);
            }
        });
}

} // namespace gnomon
