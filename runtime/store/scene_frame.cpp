#include <algorithm>

#include "runtime/store/scene_registry_impl.hpp"

namespace gnomon {
namespace {

/// Final mix of MurmurHash3 (Appleby, public domain): every bit of the input moves about half of the output's.
std::uint64_t mixed(std::uint64_t x) noexcept
{
    x = (x ^ x >> 33) * 0xff51afd7ed558ccdull;
    x = (x ^ x >> 33) * 0xc4ceb9fe1a85ec53ull;
    return x ^ x >> 33;
}

/// A sum of mixed members does not depend on their order. Revisions alone are unique; ids guard against their reuse.
std::uint64_t stampOf(std::span<const Caster* const> casters) noexcept
{
    std::uint64_t sum = casters.size();
    for (const Caster* caster : casters)
        sum += mixed(mixed(caster->revision) ^ caster->id);
    const std::uint64_t stamp = mixed(sum + 0x9e3779b97f4a7c15ull);
    return stamp ? stamp : 1;
}

} // namespace

void SceneRegistry::Impl::forgetDestroyed()
{
    if (destroyed == 0) return;
    std::erase_if(dirty, [](const InstanceRecord* record) { return record->destroyed; });
    std::erase_if(restless, [](const InstanceRecord* record) { return record->destroyed; });
    std::erase_if(order, [](const InstancePtr& record) { return record->destroyed; });
    destroyed = 0;
}

void SceneRegistry::Impl::markChangedMeshes()
{
    for (const InstancePtr& record : order) {
        if (record->caster.hostDrawn) continue;
        const RevisionPtr* revision = findMesh(record->mesh);
        const MeshView* view = revision ? (*revision)->shown : nullptr;
        if (view != record->seenView || (view && view->revision != record->seenPositions)) mark(*record);
    }
}

void SceneRegistry::Impl::markRestless()
{
    for (InstanceRecord* record : restless)
        if (record->changesUnseen()) mark(*record);
}

/// @return whether the instance entered or left the casters.
bool SceneRegistry::Impl::refresh(InstanceRecord& record)
{
    record.dirty = false;
    const RevisionPtr* revision = record.caster.hostDrawn ? nullptr : findMesh(record.mesh);
    const MeshView* view = revision ? (*revision)->shown : nullptr;
    const std::uint64_t positions = view ? view->revision : 0;
    const bool rewritten = record.seenMesh == record.mesh && record.seenPositions != positions;
    if (record.isStatic && record.seenPositions && positions && rewritten) {
        record.isStatic = false;
        reports.push_back(*instances.find(record.handle));
    }
    record.seenMesh = record.mesh;
    record.seenView = view;
    record.seenPositions = positions;
    if (revision) (*revision)->seen = true;

    const bool casts = view || record.caster.hostDrawn;
    const bool switched = casts != std::exchange(record.casting, casts);
    if (!casts) {
        record.caster.mesh = nullptr;
        return switched;
    }
    updateCaster(record, view, origin, ++casterRevisions);
    changed.push_back(&record);
    return switched;
}

/// All that the frame may need, before anything has changed: what fails for memory is then as if it had not begun.
void SceneRegistry::Impl::makeRoomForFrame()
{
    const std::size_t all = order.capacity(); // grows by doubling
    changed.reserve(all);
    casting.reserve(all);
    makeRoom(reports, order.size());
    placements.reserve(restless.size());
    arrays.makeRoom(all);
}

/// @return whether the set of casters changed.
bool SceneRegistry::Impl::refreshMarked()
{
    bool structural = std::exchange(castersLeft, false);
    changed.clear();
    for (InstanceRecord* record : dirty)
        if (refresh(*record)) structural = true;
    dirty.clear();
    if (!structural) return false;
    casting.clear();
    for (const InstancePtr& record : order) {
        if (!record->casting) continue;
        record->caster.index = static_cast<std::uint32_t>(casting.size());
        casting.push_back(record.get());
    }
    return true;
}

const SceneRegistry::Snapshot& SceneRegistry::begin(std::uint64_t frame, const std::array<double, 3>& origin)
{
    Impl& self = *impl_;
    {
        const std::lock_guard lock(self.mutex);
        self.adoptBuilt(self.releasedRevisions);
        self.takeConversions();
        self.forgetDestroyed();
        self.makeRoomForFrame(); // the last that may fail
        const bool shifted = self.lastFrame == 0 || origin != self.origin;
        self.lastFrame = frame;
        self.origin = origin;
        if (std::exchange(self.meshesChanged, false)) self.markChangedMeshes();
        self.markRestless();
        if (shifted)
            for (const InstancePtr& record : self.order)
                self.mark(*record);
        const bool structural = self.refreshMarked();
        self.arrays.publish(self.casting, self.changed, structural);
        self.findPlacements();
        self.refreshLights(shifted);
    }
    self.releasedRevisions.clear();
    self.reportWaitingCopies();
    for (const InstancePtr& record : self.reports)
        self.messages.warn("StaticInstanceMoved", record->what() +
                                                      " is static, but the positions of its mesh were rewritten; it "
                                                      "counts as moving from now on");
    self.reports.clear();
    return self.arrays.current();
}

LightCasters SceneRegistry::castersOf(const LightView& light, FrameArena& arena) const
{
    const Snapshot& snapshot = impl_->arrays.current();
    const std::span<const Caster*> all = arena.array<const Caster*>(snapshot.casters.size());
    const std::span<const Caster*> dynamics = arena.array<const Caster*>(snapshot.casters.size());
    std::size_t staticCount = 0, dynamicCount = 0;
    LightCasters result;
    for (const Caster& caster : snapshot.casters) {
        if (!(caster.mask & light.mask) || !reaches(light, caster.bounds)) continue;
        if (caster.isStatic)
            all[staticCount++] = &caster;
        else
            dynamics[dynamicCount++] = &caster;
        if (caster.mesh) result.triangles += caster.mesh->triangleCount();
        if (caster.hostDrawn && !caster.mayBeMissed) ++result.hostDrawn;
        if (caster.gpuPlaced) ++result.gpuPlaced;
        if (caster.mayBeMissed && (caster.hostDrawn || caster.alphaTested)) ++result.missable;
        if (caster.alphaTested && caster.opacity) ++result.opacities;
    }
    std::copy_n(dynamics.begin(), dynamicCount, all.begin() + staticCount);
    result.all = all.first(staticCount + dynamicCount);
    result.statics = result.all.first(staticCount);
    result.dynamics = result.all.subspan(staticCount);
    result.staticStamp = stampOf(result.statics);
    result.dynamicStamp = dynamicCount ? stampOf(result.dynamics) : 0;
    return result;
}

void SceneRegistry::Impl::refreshLights(bool shifted)
{
    lights.forEach([&](LightPtr& record) {
        if (shifted) record->revision = ++lightRevisions;
        if (shifted || record->dirty) record->publish(origin);
    });
}

} // namespace gnomon
