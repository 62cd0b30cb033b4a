#include <algorithm>

#include "runtime/store/scene_registry_impl.hpp"

namespace gnomon {
namespace {

/// Moves the elements for which `gone` holds to the end of `out`, without allocating if there is room; order is lost.
template <typename T, typename Gone>
void moveOut(std::vector<T>& list, std::vector<T>& out, Gone&& gone)
{
    const auto end = std::partition(list.begin(), list.end(), [&gone](const T& element) { return !gone(element); });
    out.insert(out.end(), std::make_move_iterator(end), std::make_move_iterator(list.end()));
    list.erase(end, list.end());
}

} // namespace

/// Revisions whose jobs are done are seen by the next frame as a whole.
void SceneRegistry::Impl::adoptMany(std::vector<RevisionPtr>& released)
{
    if (building.size() < adoptAt) return;
    adoptBuilt(released);
    adoptAt = 64 + 2 * building.size();
}

void SceneRegistry::Impl::adoptBuilt(std::vector<RevisionPtr>& released)
{
    adoptCopies(released);
    if (building.empty()) return;
    const std::size_t before = released.size();
    moveOut(building, released, [](const RevisionPtr& revision) { return revision->job.done(); });
    for (std::size_t i = before; i < released.size(); ++i)
        released[i]->shown = &released[i]->full;
    meshesChanged = meshesChanged || released.size() != before;
}

void SceneRegistry::Impl::makeRoomFor(const std::vector<MeshUpload>& made)
{
    makeRoom(building);
    makeRoom(uploads, made.size() + recorded.size());
}

/// From here on the revision's job may be submitted: it stays alive until that is done.
void SceneRegistry::Impl::keepSafe(const RevisionPtr& revision, std::vector<MeshUpload>& made)
{
    uploads.insert(uploads.end(), std::make_move_iterator(made.begin()), std::make_move_iterator(made.end()));
    if (!revision->job.done()) building.push_back(revision);
    meshesChanged = true;
}

/// Frames in flight keep what they have seen; the rest goes as soon as its job is done.
void SceneRegistry::Impl::release(RevisionPtr revision, std::vector<RevisionPtr>& released)
{
    revision->abandoned.store(true, std::memory_order_relaxed);
    if (revision->seen) bury(revision);
    released.push_back(std::move(revision));
    meshesChanged = true;
}

void SceneRegistry::Impl::letGo(std::vector<RevisionPtr>& released)
{
    released.clear();
    const std::lock_guard lock(mutex);
    std::erase_if(uploads, [](const MeshUpload& upload) { return upload.owner.expired(); });
}

Result<GnMesh> SceneRegistry::createMesh(const GnMeshCreateInfo& info)
{
    if (info.pBuffers) return createMeshInBuffers(info);
    Result<MeshInput> input = readMesh(info, impl_->builder.limits());
    if (!input) return input.error();
    std::vector<MeshUpload> uploads;
    Result<RevisionPtr> revision = impl_->builder.create(std::move(*input), uploads);
    if (!revision) return revision.error();
    std::vector<RevisionPtr> released;
    std::uint64_t handle = 0;
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->adoptMany(released);
        impl_->makeRoomFor(uploads);
        handle = impl_->meshes.insert(*revision);
        if (!handle) return tooMany("mesh");
        impl_->keepSafe(*revision, uploads);
    }
    impl_->submit(**revision);
    return handleFromBits<GnMesh>(handle);
}

Result<void> SceneRegistry::updateMeshPositions(GnMesh mesh, const float* positions, std::uint32_t count,
                                                std::uint32_t stride)
{
    RevisionPtr old;
    {
        const std::lock_guard lock(impl_->mutex);
        if (const RevisionPtr* found = impl_->findMesh(mesh)) old = *found;
    }
    if (!old) return invalidHandle("mesh");
    const MeshIdentity& identity = *old->identity;
    if (old->inBuffers)
        return Error{GN_ERROR_INVALID_HANDLE, "MeshInBuffers",
                     identity.what() + " is in buffers: gnUpdateMeshFromBuffer replaces its positions"};
    if (count != identity.positionCount)
        return Error{GN_ERROR_OUT_OF_RANGE, "MeshPositionCount",
                     identity.what() + " has " + std::to_string(identity.positionCount) + " vertices, but " +
                         std::to_string(count) + " positions were given"};
    Result<std::vector<glm::vec3>> read = readPositions({"mesh", identity.name.c_str()}, positions, count, stride);
    if (!read) return read.error();
    std::vector<MeshUpload> uploads;
    Result<RevisionPtr> revision = impl_->builder.rewrite(*old, std::move(*read), uploads);
    if (!revision) return revision.error();
    old.reset();

    std::vector<RevisionPtr> released;
    {
        const std::lock_guard lock(impl_->mutex);
        RevisionPtr* current = impl_->findMesh(mesh);
        if (!current) return invalidHandle("mesh"); // destroyed meanwhile
        impl_->adoptBuilt(released);                // no frame may be there to do it
        makeRoom(released);
        makeRoom(impl_->graves);
        impl_->makeRoomFor(uploads);
        impl_->keepSafe(*revision, uploads);
        impl_->release(std::exchange(*current, *revision), released);
    }
    impl_->submit(**revision);
    impl_->letGo(released);
    return {};
}

void SceneRegistry::destroyMesh(GnMesh mesh)
{
    std::vector<RevisionPtr> released;
    {
        const std::lock_guard lock(impl_->mutex);
        if (!impl_->findMesh(mesh)) return;
        impl_->adoptBuilt(released);
        makeRoom(released);
        makeRoom(impl_->graves);
        if (const auto& inBuffers = (*impl_->findMesh(mesh))->inBuffers) inBuffers->destroyed = true;
        impl_->release(impl_->meshes.take(bitsOf(mesh)), released);
    }
    impl_->letGo(released);
}

// --- uploads and what waits for the GPU ---

bool SceneRegistry::uploadsPending() const
{
    const std::lock_guard lock(impl_->mutex);
    return !impl_->uploads.empty();
}

namespace {

// A mesh may lie where another resource lay. The CPU knows that the GPU has done with that; as of all fresh memory
// (kFreshSync), the queue is told so as well.
constexpr VkMemoryBarrier2 kUploadsAfterAll{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                            .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                            .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                            .dstStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                            .dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT};

} // namespace

void SceneRegistry::recordUploads(VkCommandBuffer cmd, std::uint64_t frame)
{
    Impl& self = *impl_;
    const std::lock_guard lock(self.mutex);
    if (self.uploads.empty()) return;
    self.recorded.reserve(self.recorded.size() + self.uploads.size());
    orderMemory(self.vk, cmd, kUploadsAfterAll);
    for (MeshUpload& upload : self.uploads) {
        std::shared_ptr<const void> target = upload.owner.lock();
        if (!target) continue;
        const VkBufferCopy2 region{VK_STRUCTURE_TYPE_BUFFER_COPY_2, nullptr, 0, 0, upload.size};
        const VkCopyBufferInfo2 copy{
            VK_STRUCTURE_TYPE_COPY_BUFFER_INFO_2, nullptr, upload.staging.get().buffer, upload.target, 1, &region};
        self.vk.vkCmdCopyBuffer2(cmd, &copy);
        self.recorded.push_back({frame, std::move(upload), std::move(target)});
    }
    self.uploads.clear();
    VkMemoryBarrier2 beforeReads = beforeMeshReads(self.vk);
    beforeReads.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
    beforeReads.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    orderMemory(self.vk, cmd, beforeReads);
}

void SceneRegistry::dropUploads(std::uint64_t frame)
{
    Impl& self = *impl_;
    const std::lock_guard lock(self.mutex);
    for (Impl::RecordedUpload& recorded : self.recorded)
        if (recorded.frame == frame) self.uploads.push_back(std::move(recorded.upload));
    std::erase_if(self.recorded, [frame](const Impl::RecordedUpload& recorded) { return recorded.frame == frame; });
    self.dropConversions(frame);
}

void SceneRegistry::retire(std::uint64_t completedFrame)
{
    Impl& self = *impl_;
    self.retireConversions(completedFrame);
    self.retirePlacements();
    const auto done = [completedFrame](const auto& waiting) { return waiting.frame <= completedFrame; };
    {
        const std::lock_guard lock(self.mutex);
        self.adoptBuilt(self.releasedRevisions);
        moveOut(self.graves, self.releasedGraves, done);
        moveOut(self.recorded, self.releasedUploads, done);
    }
    self.releasedUploads.clear();
    self.releasedGraves.clear();
    self.releasedRevisions.clear();
}

void SceneRegistry::finishBackground()
{
    finishCopies();
    std::size_t from = 0; // those before it were done
    while (true) {
        RevisionPtr revision;
        {
            const std::lock_guard lock(impl_->mutex);
            const std::vector<RevisionPtr>& building = impl_->building;
            const auto first = building.begin() + static_cast<std::ptrdiff_t>(std::min(from, building.size()));
            const auto unfinished =
                std::find_if(first, building.end(), [](const RevisionPtr& entry) { return !entry->job.done(); });
            if (unfinished == building.end()) {
                if (from == 0) return;
                from = 0; // others may have come or gone meanwhile
                continue;
            }
            from = static_cast<std::size_t>(unfinished - building.begin());
            revision = *unfinished;
        }
        impl_->jobs.wait(revision->job);
    }
}

} // namespace gnomon
