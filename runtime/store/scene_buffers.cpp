// Meshes in the host's buffers, from the call to the GPU's copy and, where the host allows it, to the CPU's.
#include <algorithm>
#include <cstring>
#include <iterator>

#include "runtime/store/scene_registry_impl.hpp"

namespace gnomon {
namespace {

// What the host wrote on this queue comes before, and so does every read of the copies as they were.
constexpr VkMemoryBarrier2 kConversionsAfterAll{
    .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
    .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
    .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
    .dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT,
    .dstAccessMask = VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                     VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
// Before every read of vertices and indices. Compute and copies come after for another reason as well: the host may
// write its buffers again by them, without a barrier of its own.
VkMemoryBarrier2 conversionsBeforeReads(const DeviceTable& vk)
{
    VkMemoryBarrier2 barrier = beforeMeshReads(vk);
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    barrier.dstStageMask |= VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_HOST_BIT;
    barrier.dstAccessMask |= VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_HOST_READ_BIT;
    return barrier;
}
constexpr VkMemoryBarrier2 kCopiesBeforeHost{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                             .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                             .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                             .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                             .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};

// Frames without a rewrite after which a mesh that was copied before is copied again: one that is skinned in every
// second to fourth frame does not rest in between.
constexpr std::uint32_t kRestFrames = 8;

bool onGpuOnly(const MeshRevision& revision)
{
    return revision.positions.empty();
}

} // namespace

// --- what the host asks for ---

void SceneRegistry::readBuffersBy(PipelineStore& pipelines, std::uint32_t owner)
{
    impl_->converter = std::make_unique<MeshConverter>(impl_->vk, pipelines, owner);
}

Result<GnMesh> SceneRegistry::createMeshInBuffers(const GnMeshCreateInfo& info)
{
    Result<BufferMeshInput> input = readMeshInBuffers(info, impl_->builder.limits());
    if (!input) return input.error();
    if (Result<void> ready = impl_->converter->prepare(); !ready) return ready.error();
    Impl::Conversion conversion{.revision = {}, .positions = input->positions, .indices = input->indices};
    const bool copied = !input->layout.noCpuCopy;
    Result<RevisionPtr> revision = impl_->builder.createInBuffers(std::move(*input));
    if (!revision) return revision.error();
    conversion.revision = *revision;

    const std::lock_guard lock(impl_->mutex);
    makeRoom(impl_->requested);
    makeRoom(impl_->copiesWanted);
    const std::uint64_t handle = impl_->meshes.insert(*revision);
    if (!handle) return tooMany("mesh");
    impl_->requested.push_back(std::move(conversion)); // the first of this mesh
    if (copied) impl_->wantCopy(handle);
    impl_->meshesChanged = true;
    return handleFromBits<GnMesh>(handle);
}

namespace {

/// New ones, or those from before.
Result<Aabb> boundsOf(Subject what, const float* lower, const float* upper, const Aabb& before)
{
    if (!lower && !upper) return before;
    if (!lower || !upper)
        return Error{GN_ERROR_NULL_ARGUMENT, "BoundsHalf", what.text() + ": boundsMin and boundsMax go together"};
    return readBounds(what, {lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]});
}

} // namespace

Result<void> SceneRegistry::updateMeshFromBuffer(GnMesh mesh, const VkDescriptorBufferInfo& positions,
                                                 const float* lower, const float* upper)
{
    std::vector<RevisionPtr> released;
    {
        const std::lock_guard lock(impl_->mutex);
        RevisionPtr* current = impl_->findMesh(mesh);
        if (!current) return invalidHandle("mesh");
        const std::shared_ptr<BufferMesh> inBuffers = (*current)->inBuffers;
        const MeshIdentity& identity = *(*current)->identity;
        if (!inBuffers)
            return Error{GN_ERROR_INVALID_HANDLE, "MeshOfArrays",
                         identity.what() + " is not in buffers: gnUpdateMeshPositions replaces its positions"};
        const Subject what{"mesh", identity.name.c_str()};
        const Result<VkDescriptorBufferInfo> range =
            readPositionRange(what, inBuffers->layout, positions, impl_->builder.limits());
        if (!range) return range.error();
        const Result<Aabb> bounds = boundsOf(what, lower, upper, inBuffers->bounds);
        if (!bounds) return bounds.error();
        RevisionPtr revision = impl_->builder.rewriteInBuffers(inBuffers, *bounds);
        makeRoom(released);
        makeRoom(impl_->graves);
        makeRoom(impl_->requested);
        makeRoom(impl_->copiesWanted);
        inBuffers->bounds = *bounds;
        Impl::request({.revision = revision, .positions = *range, .indices = {}}, impl_->requested);
        if (!inBuffers->layout.noCpuCopy) impl_->wantCopy(bitsOf(mesh));
        impl_->release(std::exchange(*current, std::move(revision)), released);
    }
    return {};
}

/// Of one mesh the newest counts, but indices are given once.
void SceneRegistry::Impl::request(Conversion conversion, std::vector<Conversion>& list)
{
    const auto same = std::find_if(list.begin(), list.end(), [&](const Conversion& other) {
        return other.revision->inBuffers == conversion.revision->inBuffers;
    });
    if (same == list.end()) {
        list.push_back(std::move(conversion));
        return;
    }
    if (!conversion.indices) conversion.indices = same->indices;
    *same = std::move(conversion);
}

void SceneRegistry::Impl::wantCopy(std::uint64_t mesh)
{
    if (std::find(copiesWanted.begin(), copiesWanted.end(), mesh) == copiesWanted.end()) copiesWanted.push_back(mesh);
}

// --- what a frame does of it ---

/// What was asked for until now; what comes later has not been written by the host yet.
void SceneRegistry::Impl::takeConversions()
{
    const auto isGone = [](const Conversion& conversion) { return conversion.revision->inBuffers->destroyed; };
    std::erase_if(due, isGone);
    std::erase_if(requested, isGone);
    std::erase_if(copies, [](const CopyPtr& copy) { return copy->frame == 0 && copy->of->inBuffers->destroyed; });
    if (due.empty()) due.swap(requested); // nearly always: else a frame was dropped, or failed
    makeRoom(due, requested.size());
    for (Conversion& conversion : requested)
        request(std::move(conversion), due);
    requested.clear();
    std::erase_if(copiesWanted, [this](std::uint64_t mesh) { return beginCopy(mesh); });
}

/// @return whether the mesh waits no longer.
bool SceneRegistry::Impl::beginCopy(std::uint64_t mesh)
{
    const RevisionPtr* revision = meshes.find(mesh);
    if (!revision || !onGpuOnly(**revision)) return true;
    BufferMesh& inBuffers = *(*revision)->inBuffers;
    const bool rewritten = std::any_of(due.begin(), due.end(), [&](const Conversion& conversion) {
        return conversion.revision->inBuffers.get() == &inBuffers;
    });
    inBuffers.rests = rewritten ? 0 : inBuffers.rests + 1;
    // The first is made whatever the pose, for the connectivity, and so is the one that corrects it.
    const bool atOnce = !inBuffers.tried || (inBuffers.cameApart && !inBuffers.mendFailed);
    if ((!atOnce && inBuffers.rests < kRestFrames) || inBuffers.copying) return false;
    const VkDeviceSize size = inBuffers.vertices.get().size + inBuffers.indices.get().size;
    Result<OwnedBuffer> content = builder.readback(size, inBuffers.identity->name);
    if (!content) {
        copyWaits = true;
        return false;
    }
    const auto copy = std::make_shared<MeshCopy>();
    copy->content = std::move(*content);
    copy->of = *revision;
    copy->mesh = mesh;
    copy->registry = this;
    copy->connects = !inBuffers.connectivity || inBuffers.cameApart;
    copies.push_back(copy);
    inBuffers.copying = true;
    return true;
}

void SceneRegistry::Impl::reportWaitingCopies()
{
    if (!copyWaits || std::exchange(copyWaitReported, true)) return;
    messages.warn("MeshCopyWaits", "no memory for copies of meshes in buffers; methods that need them wait");
}

bool SceneRegistry::conversionsPending() const
{
    const std::lock_guard lock(impl_->mutex);
    return !impl_->due.empty() || !impl_->placements.empty() ||
           std::any_of(impl_->copies.begin(), impl_->copies.end(), [](const auto& copy) { return copy->frame == 0; });
}

Result<void> SceneRegistry::recordConversions(VkCommandBuffer cmd, std::uint64_t frame, DescriptorRing& descriptors,
                                              VkBuffer table)
{
    Impl& self = *impl_;
    const std::lock_guard lock(self.mutex);
    makeRoom(self.converted, self.due.size());
    orderMemory(self.vk, cmd, kConversionsAfterAll);
    for (const Impl::Conversion& conversion : self.due) {
        const BufferMesh& mesh = *conversion.revision->inBuffers;
        const MeshConnectivity* connectivity = conversion.revision->connectivity.get();
        if (auto ok = self.converter->positions(cmd, descriptors, mesh, connectivity, conversion.positions); !ok)
            return ok;
        if (!conversion.indices) continue;
        if (auto ok = self.converter->indices(cmd, descriptors, mesh, *conversion.indices); !ok) return ok;
    }
    for (const PlacementRun& run : self.placements)
        if (auto ok = self.converter->transforms(cmd, descriptors, run, table); !ok) return ok;
    orderMemory(self.vk, cmd, conversionsBeforeReads(self.vk));
    self.recordCopies(cmd, frame);
    for (Impl::Conversion& conversion : self.due)
        self.converted.push_back({frame, std::move(conversion)});
    self.due.clear();
    return {};
}

void SceneRegistry::Impl::recordCopies(VkCommandBuffer cmd, std::uint64_t frame)
{
    const auto copyBuffer = [&](const GpuBuffer& from, const GpuBuffer& to, VkDeviceSize at) {
        const VkBufferCopy2 region{VK_STRUCTURE_TYPE_BUFFER_COPY_2, nullptr, 0, at, from.size};
        const VkCopyBufferInfo2 info{VK_STRUCTURE_TYPE_COPY_BUFFER_INFO_2, nullptr, from.buffer, to.buffer, 1, &region};
        vk.vkCmdCopyBuffer2(cmd, &info);
    };
    bool any = false;
    for (const CopyPtr& copy : copies) {
        if (copy->frame != 0) continue;
        const BufferMesh& mesh = *copy->of->inBuffers;
        copyBuffer(mesh.vertices.get(), copy->content.get(), 0);
        copyBuffer(mesh.indices.get(), copy->content.get(), mesh.vertices.get().size);
        copy->frame = frame;
        any = true;
    }
    if (any) orderMemory(vk, cmd, kCopiesBeforeHost);
}

void SceneRegistry::Impl::dropConversions(std::uint64_t frame)
{
    for (const CopyPtr& copy : copies)
        if (copy->frame == frame && !copy->submitted) copy->frame = 0;
    makeRoom(due, converted.size());
    for (RecordedConversion& one : converted) {
        if (one.frame != frame) continue;
        // Older than what is due, if anything is.
        Conversion newest = std::move(one.conversion);
        for (const Conversion& other : due)
            if (other.revision->inBuffers == newest.revision->inBuffers) {
                newest.revision = other.revision;
                newest.positions = other.positions;
            }
        request(std::move(newest), due);
    }
    std::erase_if(converted, [frame](const RecordedConversion& one) { return one.frame == frame; });
}

// --- what becomes of it ---

void SceneRegistry::Impl::tell(const BufferMesh& mesh) const
{
    MeshFindings found{};
    std::memcpy(&found, mesh.findings.get().mapped, sizeof found);
    const std::string what = mesh.identity->what();
    if (found.firstWrongIndex != UINT32_MAX)
        messages.warn("MeshIndexOutOfRange", what + ": the index at position " + std::to_string(found.firstWrongIndex) +
                                                 " of its buffer is not one of the " +
                                                 std::to_string(mesh.layout.positionCount) +
                                                 " vertices; such triangles cast nothing");
    if (found.firstWrongVertex != UINT32_MAX)
        messages.warn("MeshPositionInvalid", what + ": vertex " + std::to_string(found.firstWrongVertex) +
                                                 " of its buffer is not finite, or beyond 1e18; it counts as 0");
}

/// A copy corrects the connectivity if the GPU has found it wrong, and it is the newest.
void SceneRegistry::Impl::watch(const MeshRevision& converted)
{
    BufferMesh& mesh = *converted.inBuffers;
    const MeshConnectivity* known = converted.connectivity.get();
    if (known && known == mesh.connectivity.get() && known->firstApart() != UINT32_MAX) mesh.cameApart = true;
}

void SceneRegistry::Impl::retireConversions(std::uint64_t completedFrame)
{
    std::vector<std::shared_ptr<BufferMesh>> wrong;
    std::vector<CopyPtr> arrived;
    {
        const std::lock_guard lock(mutex);
        for (const RecordedConversion& one : converted) {
            const std::shared_ptr<BufferMesh>& mesh = one.conversion.revision->inBuffers;
            if (one.frame <= completedFrame) watch(*one.conversion.revision);
            MeshFindings found{};
            std::memcpy(&found, mesh->findings.get().mapped, sizeof found);
            const bool fault = found.firstWrongIndex != UINT32_MAX || found.firstWrongVertex != UINT32_MAX;
            if (one.frame > completedFrame || !fault || mesh->told) continue;
            wrong.push_back(mesh);
            mesh->told = true;
        }
        std::erase_if(converted, [&](const RecordedConversion& one) { return one.frame <= completedFrame; });
        for (const CopyPtr& copy : copies)
            if (copy->frame != 0 && copy->frame <= completedFrame && !copy->submitted) arrived.push_back(copy);
        for (const CopyPtr& copy : arrived) {
            copy->submitted = true;
            copy->job.finished.store(false, std::memory_order_relaxed);
        }
    }
    for (const std::shared_ptr<BufferMesh>& mesh : wrong)
        tell(*mesh);
    for (const CopyPtr& copy : arrived) {
        copy->job.data = copy.get();
        copy->job.run = [](void* data) {
            MeshCopy& self = *static_cast<MeshCopy*>(data);
            self.registry->makeCopied(self);
        };
        if (builder.inBackground()) {
            jobs.submit(copy->job);
        } else {
            makeCopied(*copy);
            copy->job.finished.store(true, std::memory_order_release);
        }
    }
}

/// The job.
void SceneRegistry::Impl::makeCopied(MeshCopy& copy) const noexcept
{
    const auto failed = [&](const char* reason) {
        messages.warn("MeshNotCopied",
                      copy.of->identity->what() + " in a buffer could not be copied for the CPU: " + reason);
    };
    try {
        const std::byte* content = copy.content.get().mapped;
        if (Result<RevisionPtr> made = builder.copied(*copy.of, content, copy.uploads))
            copy.made = std::move(*made);
        else
            failed(made.error().text.c_str());
        if (!copy.connects) return;
        if (auto connectivity = builder.connected(*copy.of, content, copy.made.get()))
            copy.connectivity = std::move(*connectivity);
        else
            failed(connectivity.error().text.c_str());
    } catch (const std::exception& failure) {
        try {
            failed(failure.what());
        } catch (...) { // no memory for the sentence either; methods say that there is no copy
        }
    }
}

/// A copy is taken where nothing has rewritten the mesh meanwhile.
void SceneRegistry::Impl::adoptCopies(std::vector<RevisionPtr>& released)
{
    const auto done = [](const CopyPtr& copy) { return copy->submitted && copy->job.done(); };
    for (const CopyPtr& copy : copies) {
        if (!done(copy)) continue;
        makeRoom(released);
        makeRoom(graves);
        makeRoomFor(copy->uploads);
        copy->of->inBuffers->copying = false;
        copy->of->inBuffers->tried = true;
        // What failed is tried again when the mesh rests, not with every rewrite.
        if (copy->connects) copy->of->inBuffers->mendFailed = !copy->connectivity;
        if (copy->connectivity) copy->of->inBuffers->cameApart = false;
        if (copy->connectivity) copy->of->inBuffers->connectivity = copy->connectivity;
        if (copy->made) {
            copy->of->inBuffers->copiedFaces = copy->made->faces;
            // Also of a copy that is not taken: later ones share its faces. What nobody has any more is passed over.
            uploads.insert(uploads.end(), std::make_move_iterator(copy->uploads.begin()),
                           std::make_move_iterator(copy->uploads.end()));
            copy->uploads.clear();
        }
        RevisionPtr* current = meshes.find(copy->mesh);
        if (!current || *current != copy->of || !copy->made) continue; // rewritten: another copy is wanted already
        copy->made->shown = &copy->made->full;
        keepSafe(copy->made, copy->uploads);
        release(std::exchange(*current, copy->made), released);
    }
    std::erase_if(copies, done);
}

void SceneRegistry::finishCopies()
{
    std::vector<Impl::CopyPtr> underway;
    {
        const std::lock_guard lock(impl_->mutex);
        for (const Impl::CopyPtr& copy : impl_->copies)
            if (copy->submitted) underway.push_back(copy);
    }
    for (const Impl::CopyPtr& copy : underway)
        impl_->jobs.wait(copy->job);
}

} // namespace gnomon
