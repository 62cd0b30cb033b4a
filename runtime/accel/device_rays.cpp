#include "runtime/accel/device_rays.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/matrix.hpp>

#include "runtime/base/hash.hpp"
#include "runtime/passes/pass_context.hpp"
#include "runtime/scene/long_edges.hpp"
#include "runtime/vk/structures.hpp"
#include "shaders/shared/device_rays.h"

namespace gnomon {
namespace {

// Refits until a structure is built again: boxes of what has moved apart grow with every one. An estimate: half a
// second at 60 Hz.
constexpr std::uint64_t kRefits = 32;
// Frames after which what is known of a mesh is forgotten that nobody traces: the pool has given its structure back
// long before (passes/resources.cpp).
constexpr std::uint64_t kKnown = 600;

/// Whether rays meet a caster: as a volume it is empty where its basis has no inverse.
bool castsDeviceRays(const Caster& caster)
{
    return caster.mesh && std::isfinite(1.0f / glm::determinant(caster.basis));
}

VkAccelerationStructureGeometryKHR trianglesOf(const MeshView& mesh)
{
    VkAccelerationStructureGeometryKHR geometry{};
    geometry.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR;
    geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
    VkAccelerationStructureGeometryTrianglesDataKHR& triangles = geometry.geometry.triangles;
    triangles.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
    triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    triangles.vertexData.deviceAddress = mesh.vertexAddress;
    triangles.vertexStride = sizeof(glm::vec3);
    triangles.maxVertex = mesh.positionCount() - 1;
    triangles.indexType = VK_INDEX_TYPE_UINT32;
    triangles.indexData.deviceAddress = mesh.indexAddress;
    return geometry;
}

VkAccelerationStructureBuildGeometryInfoKHR meshBuild(const VkAccelerationStructureGeometryKHR& geometry, bool deforms)
{
    VkAccelerationStructureBuildGeometryInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR;
    info.type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
    info.flags = deforms ? VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR |
                               VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_BUILD_BIT_KHR
                         : VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR |
                               VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
    info.geometryCount = 1;
    info.pGeometries = &geometry;
    return info;
}

VkAccelerationStructureBuildGeometryInfoKHR topBuild(const VkAccelerationStructureGeometryKHR& geometry)
{
    VkAccelerationStructureBuildGeometryInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR;
    info.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
    info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
    info.geometryCount = 1;
    info.pGeometries = &geometry;
    return info;
}

VkAccelerationStructureBuildSizesInfoKHR
sizesOf(const DeviceTable& vk, const VkAccelerationStructureBuildGeometryInfoKHR& info, std::uint32_t count)
{
    VkAccelerationStructureBuildSizesInfoKHR sizes{};
    sizes.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR;
    vk.vkGetAccelerationStructureBuildSizesKHR(vk.device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info,
                                               &count, &sizes);
    return sizes;
}

/// A caster and where the structure of its mesh is.
struct PlacedCaster {
    const Caster* caster;
    VkDeviceAddress mesh;
};

gpu::uvec2 wordsOf(VkDeviceAddress address)
{
    return {static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(address >> 32)};
}

gpu::TracedCaster tracedCaster(const Caster& caster)
{
    return {.positions = wordsOf(caster.mesh->vertexAddress),
            .indices = wordsOf(caster.mesh->indexAddress),
            .mask = caster.mask,
            .isLong = isLong(caster, caster.mesh->longest) ? 1u : 0u};
}

/// @param number of its TracedCaster
VkAccelerationStructureInstanceKHR instanceOf(const PlacedCaster& placed, std::uint32_t number)
{
    const Caster& caster = *placed.caster;
    const gpu::TracedCaster traced = tracedCaster(caster);
    const bool asks = traced.mask != kAllMasks || traced.isLong != 0;
    VkAccelerationStructureInstanceKHR instance{};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            instance.transform.matrix[row][column] = caster.basis[column][row];
        instance.transform.matrix[row][3] = caster.translation[row];
    }
    instance.instanceCustomIndex = number & 0xffffffu;
    instance.mask = gpu::foldedMask(caster.mask) & 0xffu;
    instance.flags = static_cast<std::uint8_t>(
        VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR |
        (asks ? VK_GEOMETRY_INSTANCE_FORCE_NO_OPAQUE_BIT_KHR : VK_GEOMETRY_INSTANCE_FORCE_OPAQUE_BIT_KHR));
    instance.accelerationStructureReference = placed.mesh;
    return instance;
}

} // namespace

void DeviceRays::begin()
{
    sizes_.begin();
    if (meshes_.size() >= forgetAt_) forgetUnused();
    ++turn_;
    needed_.clear();
    wanted_.clear();
    promised_ = building_ = 0;
    declared_ = tried_ = false;
}

/// Meshes that are gone.
void DeviceRays::forgetUnused()
{
    std::erase_if(meshes_, [this](const auto& entry) { return entry.second.used + kKnown < turn_; });
    forgetAt_ = 64 + 2 * meshes_.size();
}

std::uint64_t DeviceRays::contentOf(const MeshView& mesh)
{
    return mixed(mixed(kEmptyHash, mesh.revision), mesh.faces) | 1; // 0 is no stamp
}

/// The pool has the structure. That of a mesh that deforms counts, whatever its pose: the frame refits it.
bool DeviceRays::isBuilt(const PassBuilder& passes, const Caster& caster) const
{
    const MeshView& mesh = *caster.mesh;
    const auto found = meshes_.find(mesh.id);
    if (found == meshes_.end()) return false;
    const MeshStructure& structure = found->second;
    if (structure.deforms) return passes.parts(structure.whole(mesh.id)).base == mesh.faces;
    const std::uint64_t content = contentOf(mesh);
    return passes.holds(structure.whole(mesh.id), content) ||
           (structure.compactStamp == content && passes.holds(structure.compact(mesh.id), content));
}

/// Lights share casters: each is looked up once a turn.
bool DeviceRays::isMissing(const PassBuilder& passes, const Caster& caster)
{
    if (caster.index >= checked_.size()) checked_.resize(std::bit_ceil(std::size_t{caster.index} + 1));
    Checked& known = checked_[caster.index];
    if (known.turn != turn_) known = {turn_, castsDeviceRays(caster) && !isBuilt(passes, caster)};
    return known.missing;
}

UnbuiltCasters::Part DeviceRays::count(const PassBuilder& passes, std::span<const Caster* const> casters,
                                       std::uint64_t stamp)
{
    UnbuiltCasters::Part part{.stamp = stamp};
    for (const Caster* caster : casters) {
        if (!isMissing(passes, *caster)) continue;
        ++part.casters;
        part.triangles += caster->mesh->triangleCount();
    }
    return part;
}

std::uint32_t DeviceRays::unbuilt(const PassBuilder& passes, const LightCasters& casters, UnbuiltCasters& known)
{
    if (inFrame_) return 0;
    if (known.turn == turn_) return known.answer; // in another view
    const std::uint64_t asOf = mixed(mixed(kEmptyHash, builtAnew_), passes.structureLosses());
    const bool same = known.asOf == asOf;
    known.asOf = asOf;
    known.turn = turn_;
    if (!same || known.statics.stamp != casters.staticStamp)
        known.statics = count(passes, casters.statics, casters.staticStamp);
    if (!same || known.dynamics.stamp != casters.dynamicStamp)
        known.dynamics = count(passes, casters.dynamics, casters.dynamicStamp);
    const std::uint64_t triangles = known.statics.triangles + known.dynamics.triangles;
    const bool fits = promised_ + triangles <= kBuiltPerFrame;
    if (fits) promised_ += triangles;
    return known.answer = fits ? 0 : known.statics.casters + known.dynamics.casters;
}

bool DeviceRays::isNeeded(const Caster& caster) const
{
    return caster.index < neededIn_.size() && neededIn_[caster.index] == turn_;
}

void DeviceRays::need(const LightCasters& casters)
{
    if (tried_) return; // passes of the scene are declared once, for what was needed then
    for (const Caster* caster : casters.all) {
        if (!castsDeviceRays(*caster) || isNeeded(*caster)) continue;
        if (caster->index >= neededIn_.size()) neededIn_.resize(std::bit_ceil(std::size_t{caster->index} + 1));
        neededIn_[caster->index] = turn_;
        needed_.push_back(caster);
    }
}

void DeviceRays::want(const LightCasters& casters)
{
    for (const Caster* caster : casters.all)
        if (castsDeviceRays(*caster)) wanted_.push_back(caster); // what is built stays so meanwhile
}

const TracedScene* DeviceRays::declare(PassBuilder& passes, const LightCasters& casters)
{
    tried_ = true;
    if (!declared_) declared_ = declareScene(passes);
    if (!declared_) { // its task fails, and another may declare all of it once more
        forgetTurn();
        return nullptr;
    }
    const bool holdsAll = std::ranges::all_of(
        casters.all, [this](const Caster* caster) { return !castsDeviceRays(*caster) || isNeeded(*caster); });
    return holdsAll ? &scene_ : nullptr;
}

/// What this turn declared will not be built.
void DeviceRays::forgetTurn()
{
    for (auto& [id, structure] : meshes_)
        if (structure.used == turn_) structure.used = 0;
}

bool DeviceRays::declareScene(PassBuilder& passes)
{
    builds_.clear();
    compactions_.clear();
    asked_.clear();
    for (const Caster* caster : needed_)
        if (!declareMesh(passes, *caster->mesh)) return false;
    scene_.order = passes.persistent(BufferInfo{.name = "rays.order", .scope = Scope::scene});
    if (!scene_.order || !declareBuilds(passes, 0)) return false;
    declareSizes(passes, 0);
    declareCompactions(passes, 0);
    return declareTopLevel(passes);
}

void DeviceRays::declareWanted(PassBuilder& passes)
{
    builds_.clear();
    compactions_.clear();
    asked_.clear();
    scene_.order = passes.persistent(BufferInfo{.name = "rays.order", .scope = Scope::scene});
    for (const Caster* caster : wanted_) {
        const bool fits = building_ == 0 || building_ + caster->mesh->triangleCount() <= kBuiltPerFrame;
        if (!fits && !isBuilt(passes, *caster)) continue;
        if (!declareMesh(passes, *caster->mesh)) return forgetTurn();
    }
    if (!declareBuilds(passes, 1)) return forgetTurn();
    declareSizes(passes, 1);
    declareCompactions(passes, 1);
}

void DeviceRays::findSizes(MeshStructure& structure, const MeshView& mesh) const
{
    const VkAccelerationStructureGeometryKHR geometry = trianglesOf(mesh);
    const VkAccelerationStructureBuildSizesInfoKHR sizes =
        sizesOf(vk_, meshBuild(geometry, structure.deforms), mesh.triangleCount());
    structure.size = sizes.accelerationStructureSize;
    structure.buildScratch = sizes.buildScratchSize;
    structure.updateScratch = sizes.updateScratchSize;
    structure.faces = mesh.faces;
}

/// The structure as of the frame's positions. @return false where it could not be made
bool DeviceRays::declareMesh(PassBuilder& passes, const MeshView& mesh)
{
    MeshStructure& structure = meshes_[mesh.id];
    if (structure.used == turn_ && structure.address) return true;
    const bool begins = structure.positions != 0 && structure.positions != mesh.revision && !structure.deforms;
    structure.deforms |= begins;
    if (begins || structure.faces != mesh.faces) findSizes(structure, mesh);
    structure.used = turn_;
    structure.positions = mesh.revision;
    if (declareCompact(passes, mesh, structure)) return true;
    const BufferId id = passes.persistent(structure.whole(mesh.id));
    structure.address = passes.address(id);
    if (!id) return false;
    if (!passes.stale(id, contentOf(mesh))) return true;
    const KeptParts before = passes.partsBefore(id); // the triangles it was built of; refits since, or its size's query
    const bool refit = structure.deforms && before.base == mesh.faces && before.covered < kRefits;
    const std::uint64_t query = structure.deforms ? 0 : sizes_.take(passes.frame());
    passes.keepParts(id, {.base = mesh.faces, .covered = refit ? before.covered + 1 : query});
    structure.compactStamp = structure.compactSize = 0; // of another build
    builds_.push_back({.triangles = trianglesOf(mesh),
                       .count = mesh.triangleCount(),
                       .structure = id,
                       .deforms = structure.deforms,
                       .refit = refit,
                       .scratch = refit ? structure.updateScratch : structure.buildScratch,
                       .sizeQuery = query});
    ++builtEver_;
    builtAnew_ += !refit;
    if (!refit) building_ += mesh.triangleCount();
    return true;
}

/// One pass for all of builds_.
bool DeviceRays::declareBuilds(PassBuilder& passes, std::uint32_t variant)
{
    if (builds_.empty()) return true;
    VkDeviceSize bytes = vk_.scratchAlignment;
    for (const Build& build : builds_)
        bytes += alignedUp(build.scratch, vk_.scratchAlignment);
    const BufferId scratch = passes.transient(BufferInfo{.name = "rays.mesh_scratch",
                                                         .scope = Scope::scene,
                                                         .size = bytes,
                                                         .place = BufferPlace::buildScratch,
                                                         .variant = variant});
    if (!scratch) return false;
    const std::span<const Build> builds = passes.arena().copy(std::span<const Build>(builds_));
    const auto infos = passes.arena().array<VkAccelerationStructureBuildGeometryInfoKHR>(builds.size());
    const auto ranges = passes.arena().array<VkAccelerationStructureBuildRangeInfoKHR>(builds.size());
    const auto rangesOf = passes.arena().array<const VkAccelerationStructureBuildRangeInfoKHR*>(builds.size());
    PassRef pass = passes.compute("rays.meshes", Scope::scene, variant);
    pass.builds(scene_.order).builds(scratch);
    for (const Build& build : builds)
        pass.builds(build.structure);
    const VkDeviceAddress work = passes.address(scratch);
    pass.record([=](PassContext& gpu) {
        VkDeviceAddress at = alignedUp(work, gpu.vk->scratchAlignment);
        for (std::size_t i = 0; i < builds.size(); ++i) {
            const Build& build = builds[i];
            infos[i] = meshBuild(build.triangles, build.deforms);
            infos[i].mode = build.refit ? VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR
                                        : VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
            infos[i].dstAccelerationStructure = gpu.structure(build.structure);
            if (build.refit) infos[i].srcAccelerationStructure = infos[i].dstAccelerationStructure;
            infos[i].scratchData.deviceAddress = at;
            ranges[i] = {.primitiveCount = build.count, .primitiveOffset = 0, .firstVertex = 0, .transformOffset = 0};
            rangesOf[i] = &ranges[i];
            at += alignedUp(build.scratch, gpu.vk->scratchAlignment);
        }
        gpu.vk->vkCmdBuildAccelerationStructuresKHR(gpu.cmd, static_cast<std::uint32_t>(infos.size()), infos.data(),
                                                    rangesOf.data());
    });
    for (const Build& build : builds_)
        if (build.sizeQuery != 0) asked_.push_back({build.structure, build.sizeQuery});
    return true;
}

void DeviceRays::findTopSizes(std::uint32_t instances)
{
    if (instances <= topInstances_) return;
    topInstances_ = std::bit_ceil(std::max(instances, 16u));
    const VkAccelerationStructureGeometryKHR geometry = instancesAt(0);
    const VkAccelerationStructureBuildSizesInfoKHR sizes = sizesOf(vk_, topBuild(geometry), topInstances_);
    topSize_ = sizes.accelerationStructureSize;
    topScratch_ = sizes.buildScratchSize;
}

/// The top level and the table beside it. @return false where a buffer could not be made
bool DeviceRays::declareTopLevel(PassBuilder& passes)
{
    const std::span<PlacedCaster> placed = passes.arena().array<PlacedCaster>(needed_.size());
    std::uint64_t stamp = mixed(kEmptyHash, builtEver_);
    for (std::size_t i = 0; i < placed.size(); ++i) {
        placed[i] = {needed_[i], meshes_[needed_[i]->mesh->id].address};
        stamp = mixed(mixed(mixed(stamp, needed_[i]->id), needed_[i]->revision), placed[i].mesh);
    }
    stamp |= 1; // 0 is no stamp
    const auto count = static_cast<std::uint32_t>(placed.size());
    findTopSizes(std::max(count, 1u)); // without casters the structure is empty, but it is one
    scene_.topLevel = passes.persistent(
        BufferInfo{.name = "rays.top_level", .scope = Scope::scene, .size = topSize_, .place = BufferPlace::topLevel});
    scene_.casters = passes.persistent(BufferInfo{.name = "rays.casters",
                                                  .scope = Scope::scene,
                                                  .size = count * sizeof(gpu::TracedCaster),
                                                  .place = BufferPlace::upload});
    const bool topDue = passes.stale(scene_.topLevel, stamp), tableDue = passes.stale(scene_.casters, stamp);
    if (!scene_.topLevel || !scene_.casters) return false;
    if (tableDue)
        passes.prepare("rays.casters", Scope::scene)
            .writes(scene_.casters)
            .run([placed, table = scene_.casters](HostContext& host) {
                std::ranges::transform(placed, host.write<gpu::TracedCaster>(table).begin(),
                                       [](const PlacedCaster& each) { return tracedCaster(*each.caster); });
            });
    if (!topDue) return true;
    const BufferId instances = passes.transient(BufferInfo{.name = "rays.instances",
                                                           .scope = Scope::scene,
                                                           .size = count * sizeof(VkAccelerationStructureInstanceKHR),
                                                           .place = BufferPlace::buildInput});
    const BufferId scratch = passes.transient(BufferInfo{.name = "rays.top_scratch",
                                                         .scope = Scope::scene,
                                                         .size = topScratch_ + vk_.scratchAlignment,
                                                         .place = BufferPlace::buildScratch});
    if (!instances || !scratch) return false;
    passes.prepare("rays.instances", Scope::scene).writes(instances).run([=](HostContext& host) {
        const std::span<VkAccelerationStructureInstanceKHR> out =
            host.write<VkAccelerationStructureInstanceKHR>(instances);
        for (std::uint32_t i = 0; i < count; ++i)
            out[i] = instanceOf(placed[i], i);
    });
    const VkDeviceAddress input = passes.address(instances), work = passes.address(scratch);
    passes.compute("rays.top_level", Scope::scene)
        .builds(scene_.order)
        .builds(scene_.topLevel)
        .builds(scratch)
        .buildsFrom(instances)
        .record([=, top = scene_.topLevel](PassContext& gpu) {
            const VkAccelerationStructureGeometryKHR geometry = instancesAt(input);
            VkAccelerationStructureBuildGeometryInfoKHR info = topBuild(geometry);
            info.dstAccelerationStructure = gpu.structure(top);
            info.scratchData.deviceAddress = alignedUp(work, gpu.vk->scratchAlignment);
            const VkAccelerationStructureBuildRangeInfoKHR range{
                .primitiveCount = count, .primitiveOffset = 0, .firstVertex = 0, .transformOffset = 0};
            const VkAccelerationStructureBuildRangeInfoKHR* const ranges = &range;
            gpu.vk->vkCmdBuildAccelerationStructuresKHR(gpu.cmd, 1, &info, &ranges);
        });
    return true;
}

} // namespace gnomon
