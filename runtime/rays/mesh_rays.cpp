#include "runtime/rays/mesh_rays.hpp"

#include <algorithm>
#include <utility>

#include "runtime/scene/long_edges.hpp"

namespace gnomon {
namespace {

// Revisions that frames in flight still trace come back one by one; more than three would have to come at once.
constexpr std::size_t kSpares = 3;

void setPositions(RTCGeometry geometry, std::span<const glm::vec3> positions)
{
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions.data(), 0,
                               sizeof(glm::vec3), positions.size());
}

} // namespace

// --- Embree's tree ---

EmbreeTree::EmbreeTree(RTCDevice device, std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                       bool movable)
{
    const std::ptrdiff_t before = embreeBytesHere;
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    setPositions(geometry, positions);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0,
                               3 * sizeof(std::uint32_t), indices.size() / 3);
    rtcSetGeometryMask(geometry, ~0u); // masks are the instances'; Embree 4 gives a geometry the mask 1
    // Embree moves a geometry's own tree only, which there is in dynamic scenes.
    if (movable) rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    rtcCommitGeometry(geometry);
    scene_ = rtcNewScene(device);
    rtcSetSceneFlags(scene_, movable ? kSceneFlags | RTC_SCENE_FLAG_DYNAMIC : kSceneFlags);
    rtcSetSceneBuildQuality(scene_, movable ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(scene_, geometry);
    commitHere(scene_);
    if (movable)
        geometry_ = geometry;
    else
        rtcReleaseGeometry(geometry);
    bytes_ = static_cast<std::size_t>(std::max<std::ptrdiff_t>(embreeBytesHere - before, 0));
}

EmbreeTree::~EmbreeTree()
{
    if (geometry_) rtcReleaseGeometry(geometry_);
    if (scene_) rtcReleaseScene(scene_);
}

void EmbreeTree::move(std::span<const glm::vec3> positions)
{
    setPositions(geometry_, positions);
    rtcCommitGeometry(geometry_);
    commitHere(scene_);
}

void EmbreeTree::swap(EmbreeTree& other) noexcept
{
    std::swap(scene_, other.scene_);
    std::swap(geometry_, other.geometry_);
    std::swap(bytes_, other.bytes_);
}

// --- what revisions hand on ---

MeshRaysHistory::MeshRaysHistory() : impl_(std::make_shared<Impl>()) {}
MeshRaysHistory::~MeshRaysHistory() = default;

MeshRaysHistory::Impl::Impl()
{
    spares_.reserve(kSpares); // trees are given back where nothing may be thrown
}

MeshRaysHistory::Impl::Latest MeshRaysHistory::Impl::latest() const
{
    const std::lock_guard lock(mutex_);
    return latest_;
}

std::uint32_t MeshRaysHistory::Impl::startOver()
{
    const std::lock_guard lock(mutex_);
    spares_.clear();
    return ++latest_.generation;
}

EmbreeTree MeshRaysHistory::Impl::exchange(const Latest& made)
{
    const std::lock_guard lock(mutex_);
    if (made.generation != latest_.generation) return {};
    latest_.tree = made.tree;
    if (spares_.empty()) return {};
    EmbreeTree spare = std::move(spares_.back());
    spares_.pop_back();
    return spare;
}

void MeshRaysHistory::Impl::giveBack(EmbreeTree tree, std::uint32_t generation)
{
    const std::lock_guard lock(mutex_);
    if (generation == latest_.generation && spares_.size() < kSpares) spares_.push_back(std::move(tree));
}

// --- a revision's trees ---

MeshRays::Impl::~Impl()
{
    if (tree && treeBytes)
        treeBytes->fetch_sub(static_cast<std::ptrdiff_t>(tree->memoryBytes()), std::memory_order_relaxed);
    if (history && embree.movable()) history->giveBack(std::move(embree), generation);
}

std::unique_ptr<MeshRays::Impl> makeMeshRays(RTCDevice device, std::span<const glm::vec3> positions,
                                             std::span<const std::uint32_t> indices,
                                             std::shared_ptr<MeshRaysHistory::Impl> history)
{
    static_cast<void>(rtcGetDeviceError(device)); // of this thread; clears what an earlier call left
    auto mesh = std::make_unique<MeshRays::Impl>();
    const MeshRaysHistory::Impl::Latest before = history ? history->latest() : MeshRaysHistory::Impl::Latest{};
    mesh->generation = before.generation;
    if (before.tree) mesh->tree = before.tree->refitted(positions, indices);
    if (!mesh->tree || mesh->tree->worn()) {
        mesh->tree = TriangleTree::build(device, positions, indices);
        if (history) mesh->generation = history->startOver();
    }
    if (history) mesh->embree = history->exchange({mesh->tree, mesh->generation});
    mesh->moved = mesh->embree.movable();
    if (mesh->moved)
        mesh->embree.move(positions);
    else
        mesh->embree = EmbreeTree(device, positions, indices, before.tree != nullptr);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) return nullptr; // out of memory: the mesh casts no rays
    mesh->longest = longestOf(positions, indices);
    mesh->history = std::move(history);
    return mesh;
}

} // namespace gnomon
