#include "runtime/store/scene_registry.hpp"

#include "runtime/store/scene_registry_impl.hpp"

namespace gnomon {

SceneRegistry::Impl::~Impl()
{
    meshes.forEach([](RevisionPtr& revision) { revision->abandoned.store(true, std::memory_order_relaxed); });
    for (const RevisionPtr& revision : building)
        jobs.wait(revision->job);
    for (const CopyPtr& copy : copies)
        jobs.wait(copy->job);
}

SceneRegistry::SceneRegistry(const DeviceTable& vk, DeviceMemory& memory, JobSystem& jobs, RayScene* rays,
                             const Messages& messages, bool background)
    : impl_(std::make_unique<Impl>(vk, memory, jobs, rays, messages, background))
{
}

SceneRegistry::~SceneRegistry() = default;

// --- instances ---

void SceneRegistry::Impl::mark(InstanceRecord& record)
{
    if (record.dirty) return;
    dirty.push_back(&record);
    record.dirty = true;
}

Result<InstancePtr> instanceRecordOf(const GnInstanceCreateInfo& info)
{
    Result<GnInstanceCreateInfo> read = readInstance(info);
    if (!read) return read.error();
    auto record = std::make_shared<InstanceRecord>();
    record->name = info.pName ? info.pName : "";
    record->transform = read->transform;
    record->isStatic = (info.flags & GN_INSTANCE_STATIC_BIT) != 0;
    Caster& caster = record->caster;
    caster.mask = read->casterMask;
    caster.alphaTested = (info.flags & GN_INSTANCE_ALPHA_TESTED_BIT) != 0;
    caster.hostDrawn = (info.flags & GN_INSTANCE_HOST_DRAWN_BIT) != 0;
    caster.mayBeMissed = (info.flags & GN_INSTANCE_MAY_BE_MISSED_BIT) != 0;
    caster.singleSided = (info.flags & GN_INSTANCE_SINGLE_SIDED_BIT) != 0;
    caster.drawCasters = info.pfnDrawCasters;
    caster.opacity = info.pfnOpacity;
    caster.userData = info.pUserData;
    caster.name = record->name.c_str();
    if (caster.hostDrawn)
        record->hostBounds = {{info.boundsMin[0], info.boundsMin[1], info.boundsMin[2]},
                              {info.boundsMax[0], info.boundsMax[1], info.boundsMax[2]}};
    else
        record->mesh = info.mesh;
    return record;
}

Error atElement(std::size_t index, const char* array, Error error)
{
    error.text = std::string(array) + "[" + std::to_string(index) + "]: " + error.text;
    return error;
}

/// Everything that inserting so many like this one may fail for.
Result<void> SceneRegistry::Impl::makeRoomLike(const InstanceRecord& record, std::size_t count)
{
    if (!record.caster.hostDrawn && !findMesh(record.mesh)) {
        Error error = invalidHandle("mesh");
        error.text = record.what() + ": " + error.text;
        return error;
    }
    makeRoom(order, count);
    if (record.caster.hostDrawn || record.placement) makeRoom(restless, count);
    dirty.reserve(order.capacity()); // begin() may have to look at all of them
    if (!instances.makeRoom(count)) return tooMany("instance");
    return {};
}

/// @pre makeRoomLike()
std::uint64_t SceneRegistry::Impl::insert(InstancePtr record) noexcept
{
    Caster& caster = record->caster;
    record->handle = instances.insert(record);
    caster.id = SlotMap<InstancePtr>::indexOf(record->handle) + 1;
    mark(*record);
    if (caster.hostDrawn || record->placement) restless.push_back(record.get());
    order.push_back(std::move(record));
    return order.back()->handle;
}

Result<GnInstance> SceneRegistry::createInstance(const GnInstanceCreateInfo& info)
{
    if (info.pTransformBuffer) {
        GnInstance placed = VK_NULL_HANDLE;
        if (Result<void> made = createPlacedInstances(info, 1, &placed); !made) return made.error();
        return placed;
    }
    Result<InstancePtr> record = instanceRecordOf(info);
    if (!record) return record.error();
    const std::lock_guard lock(impl_->mutex);
    if (Result<void> room = impl_->makeRoomLike(**record, 1); !room) return room.error();
    return handleFromBits<GnInstance>(impl_->insert(std::move(*record)));
}

Result<void> SceneRegistry::createInstances(const GnInstanceCreateInfo& info, std::span<const GnTransform> transforms,
                                            GnInstance* instances)
{
    std::vector<InstancePtr> records;
    records.reserve(transforms.size());
    GnInstanceCreateInfo each = info;
    for (const GnTransform& transform : transforms) {
        each.transform = transform;
        Result<InstancePtr> record = instanceRecordOf(each);
        if (!record) return atElement(records.size(), "pTransforms", record.error());
        records.push_back(std::move(*record));
    }
    if (records.empty()) return {};
    const std::lock_guard lock(impl_->mutex);
    if (Result<void> room = impl_->makeRoomLike(*records.front(), records.size()); !room) return room;
    for (InstancePtr& record : records)
        *instances++ = handleFromBits<GnInstance>(impl_->insert(std::move(record)));
    return {};
}

namespace {

Error inBuffer(const InstanceRecord& record)
{
    return {GN_ERROR_INVALID_HANDLE, "InstanceInBuffer",
            record.what() + " has its transform in a buffer: gnUpdateInstancesFromBuffer changes it"};
}

} // namespace

Result<void> SceneRegistry::setInstanceTransforms(std::span<const GnInstance> instances,
                                                  std::span<const GnTransform> transforms)
{
    std::vector<InstancePtr> moved; // static ones: the rest moves in every frame, and nothing is allocated for it
    {
        const std::lock_guard lock(impl_->mutex);
        const auto read = [&](std::size_t i, const InstanceRecord& record) {
            return readTransform({"instance", record.name.c_str()}, transforms[i]);
        };
        std::size_t statics = 0;
        for (std::size_t i = 0; i < instances.size(); ++i) {
            const InstancePtr* found = impl_->instances.find(bitsOf(instances[i]));
            if (!found) return atElement(i, "pInstances", invalidHandle("instance"));
            if ((*found)->placement) return atElement(i, "pInstances", inBuffer(**found));
            if (Result<GnTransform> transform = read(i, **found); !transform)
                return atElement(i, "pTransforms", transform.error());
            statics += (*found)->isStatic;
        }
        moved.reserve(statics);
        for (std::size_t i = 0; i < instances.size(); ++i) {
            const InstancePtr& found = *impl_->instances.find(bitsOf(instances[i]));
            const Result<GnTransform> transform = read(i, *found);
            if (sameTransform(found->transform, *transform)) continue;
            impl_->mark(*found);
            found->transform = *transform;
            if (std::exchange(found->isStatic, false)) moved.push_back(found);
        }
    }
    for (const InstancePtr& record : moved)
        impl_->reportMoved(*record);
    return {};
}

Result<void> SceneRegistry::setInstanceTransform(GnInstance instance, const GnTransform& transform)
{
    InstancePtr moved;
    {
        const std::lock_guard lock(impl_->mutex);
        const InstancePtr* found = impl_->instances.find(bitsOf(instance));
        if (!found) return invalidHandle("instance");
        InstanceRecord& record = **found;
        if (record.placement) return inBuffer(record);
        Result<GnTransform> read = readTransform({"instance", record.name.c_str()}, transform);
        if (!read) return read.error();
        if (sameTransform(record.transform, *read)) return {};
        impl_->mark(record);
        record.transform = *read;
        if (std::exchange(record.isStatic, false)) moved = *found;
    }
    if (moved) impl_->reportMoved(*moved);
    return {};
}

Result<void> SceneRegistry::setInstanceBounds(GnInstance instance, const float (&lower)[3], const float (&upper)[3])
{
    InstancePtr moved;
    {
        const std::lock_guard lock(impl_->mutex);
        const InstancePtr* found = impl_->instances.find(bitsOf(instance));
        if (!found) return invalidHandle("instance");
        InstanceRecord& record = **found;
        if (!record.caster.hostDrawn)
            return Error{GN_ERROR_INVALID_HANDLE, "InstanceHasMesh",
                         record.what() + " is not host-drawn, its bounds are its mesh's"};
        Result<Aabb> read = readBounds({"instance", record.name.c_str()}, lower, upper);
        if (!read) return read.error();
        if (record.hostBounds.lower == read->lower && record.hostBounds.upper == read->upper) return {};
        impl_->mark(record);
        record.hostBounds = *read;
        if (std::exchange(record.isStatic, false)) moved = *found;
    }
    if (moved) impl_->reportMoved(*moved);
    return {};
}

Result<void> SceneRegistry::setInstanceCasterMask(GnInstance instance, std::uint32_t mask)
{
    const std::lock_guard lock(impl_->mutex);
    const InstancePtr* found = impl_->instances.find(bitsOf(instance));
    if (!found) return invalidHandle("instance");
    InstanceRecord& record = **found;
    mask = mask ? mask : kAllMasks;
    if (record.caster.mask == mask) return {};
    impl_->mark(record);
    record.caster.mask = mask;
    return {};
}

Result<void> SceneRegistry::setInstanceMesh(GnInstance instance, GnMesh mesh)
{
    const std::lock_guard lock(impl_->mutex);
    const InstancePtr* found = impl_->instances.find(bitsOf(instance));
    if (!found) return invalidHandle("instance");
    InstanceRecord& record = **found;
    if (record.caster.hostDrawn)
        return Error{GN_ERROR_INVALID_HANDLE, "InstanceHostDrawn", record.what() + " is host-drawn, it has no mesh"};
    if (!impl_->findMesh(mesh)) return invalidHandle("mesh");
    if (record.mesh == mesh) return {};
    impl_->mark(record);
    record.mesh = mesh;
    return {};
}

void SceneRegistry::destroyInstance(GnInstance instance)
{
    const std::lock_guard lock(impl_->mutex);
    if (!impl_->instances.find(bitsOf(instance))) return;
    makeRoom(impl_->graves);
    const InstancePtr record = impl_->instances.take(bitsOf(instance));
    record->destroyed = true;
    ++impl_->destroyed;
    if (record->casting) {
        impl_->castersLeft = true;
        impl_->bury(record);
    }
    // A host that loads and unloads without drawing frames must not pile up records.
    if (impl_->destroyed > 256 + impl_->order.size() / 2) impl_->forgetDestroyed();
}

// --- lights ---

Result<GnLight> SceneRegistry::createLight(const GnLightInfo& info)
{
    Result<LightDescription> light = readLight({"light", info.pName}, info);
    if (!light) return light.error();
    auto record = std::make_shared<LightRecord>();
    record->name = info.pName ? info.pName : "";
    record->light = *light;
    const std::uint64_t handle = impl_->lights.insert(record);
    if (!handle) return tooMany("light");
    record->handle = handleFromBits<GnLight>(handle);
    record->id = ++impl_->lightIds;
    record->revision = ++impl_->lightRevisions;
    return record->handle;
}

Result<void> SceneRegistry::updateLight(GnLight light, const GnLightInfo& info)
{
    const LightPtr* found = impl_->lights.find(bitsOf(light));
    if (!found) return invalidHandle("light");
    LightRecord& record = **found;
    Result<LightDescription> read = readLight({"light", record.name.c_str()}, info);
    if (!read) return read.error();
    const LightDescription old = std::exchange(record.light, *read);
    if (!old.sameLight(*read)) record.revision = ++impl_->lightRevisions;
    record.dirty = record.dirty || !old.sameLight(*read) || old.isStatic != read->isStatic ||
                   old.sampled != read->sampled || old.importance != read->importance;
    if (!old.isStatic || !read->isStatic || old.samePose(*read) || record.moved) return {};
    record.moved = true;
    impl_->messages.warn("StaticLightMoved",
                         record.what() + " is static but has moved; it counts as moving from now on");
    return {};
}

void SceneRegistry::destroyLight(GnLight light)
{
    if (!impl_->lights.find(bitsOf(light))) return;
    const std::lock_guard lock(impl_->mutex);
    makeRoom(impl_->graves);
    LightPtr record = impl_->lights.take(bitsOf(light));
    if (record->published) impl_->bury(std::move(record));
}

bool SceneRegistry::validLight(GnLight light) const
{
    return impl_->lights.find(bitsOf(light)) != nullptr;
}

std::optional<SceneRegistry::LightInfo> SceneRegistry::lightInfo(GnLight light) const
{
    const LightPtr* found = impl_->lights.find(bitsOf(light));
    if (!found) return std::nullopt;
    return LightInfo{(*found)->id, (*found)->light.type, (*found)->name};
}

const LightView* SceneRegistry::light(GnLight light) const
{
    const LightPtr* found = impl_->lights.find(bitsOf(light));
    return found && (*found)->published ? &(*found)->views[(*found)->current] : nullptr;
}

} // namespace gnomon
