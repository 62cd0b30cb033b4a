// Instances whose transforms lie in the host's buffers: from the call to the rows of the frame's table.
#include <cstring>

#include "runtime/base/struct_size.hpp"
#include "runtime/store/scene_registry_impl.hpp"

namespace gnomon {

Result<void> SceneRegistry::createPlacedInstances(const GnInstanceCreateInfo& info, std::uint32_t count,
                                                  GnInstance* instances)
{
    if (count == 0) return {};
    const Subject what{"instance", info.pName};
    if (info.flags & (GN_INSTANCE_HOST_DRAWN_BIT | GN_INSTANCE_STATIC_BIT))
        return Error{
            GN_ERROR_OUT_OF_RANGE, "PlacedInstanceFlags",
            what.text() + ": flags has " +
                (info.flags & GN_INSTANCE_STATIC_BIT ? "GN_INSTANCE_STATIC_BIT" : "GN_INSTANCE_HOST_DRAWN_BIT") +
                ", but its transform is in a buffer"};
    const Result<GnTransformBuffer> transforms =
        readStruct<GnTransformBuffer>(info.pTransformBuffer, "pCreateInfo->pTransformBuffer");
    if (!transforms) return transforms.error();
    const Result<TransformArray> array = readTransformArray(what, *transforms, count, impl_->builder.limits());
    if (!array) return array.error();
    if (Result<void> ready = impl_->converter->prepare(); !ready) return ready;
    const auto findings = std::make_shared<PlacementFindings>();
    findings->what = what.text();
    Result<OwnedBuffer> buffer = impl_->builder.findings(sizeof(std::uint32_t), findings->what);
    if (!buffer) return buffer.error();
    findings->buffer = std::move(*buffer);

    std::vector<InstancePtr> records;
    records.reserve(count);
    GnInstanceCreateInfo each = info;
    each.transform = {}; // what stands there is ignored
    for (std::uint32_t i = 0; i < count; ++i) {
        const Result<Aabb> bounds = readPlacedBounds(what, *transforms, i);
        if (!bounds) return bounds.error();
        Result<InstancePtr> record = instanceRecordOf(each);
        if (!record) return record.error();
        (*record)->placement = BufferPlacement{*array, i, *bounds, findings};
        records.push_back(std::move(*record));
    }
    const std::lock_guard lock(impl_->mutex);
    if (Result<void> room = impl_->makeRoomLike(*records.front(), count); !room) return room;
    for (InstancePtr& record : records)
        *instances++ = handleFromBits<GnInstance>(impl_->insert(std::move(record)));
    return {};
}

Result<void> SceneRegistry::updatePlacedInstances(std::span<const GnInstance> instances,
                                                  const GnTransformBuffer& transforms)
{
    if (instances.empty()) return {};
    const auto count = static_cast<std::uint32_t>(instances.size());
    const std::lock_guard lock(impl_->mutex);
    for (std::uint32_t i = 0; i < count; ++i) {
        const InstancePtr* found = impl_->instances.find(bitsOf(instances[i]));
        if (!found) return atElement(i, "pInstances", invalidHandle("instance"));
        const InstanceRecord& record = **found;
        if (!record.placement)
            return atElement(i, "pInstances",
                             {GN_ERROR_INVALID_HANDLE, "InstanceNotInBuffer",
                              record.what() + " was made with a transform: gnSetInstanceTransforms changes it"});
    }
    const Subject first{"instance", (*impl_->instances.find(bitsOf(instances[0])))->name.c_str()};
    const Result<TransformArray> array = readTransformArray(first, transforms, count, impl_->builder.limits());
    if (!array) return array.error();
    for (std::uint32_t i = 0; i < count; ++i)
        if (Result<Aabb> bounds = readPlacedBounds(first, transforms, i); !bounds) return bounds.error();
    for (std::uint32_t i = 0; i < count; ++i) {
        BufferPlacement& placement = *(*impl_->instances.find(bitsOf(instances[i])))->placement;
        placement.array = *array;
        placement.element = i;
        placement.bounds = *readPlacedBounds(first, transforms, i);
    }
    return {};
}

/// Mutex held. Which rows of the frame's table the GPU has to write.
void SceneRegistry::Impl::findPlacements()
{
    placements.clear();
    for (const InstanceRecord* record : restless) {
        if (!record->casting || !record->placement) continue;
        const BufferPlacement& placement = *record->placement;
        if (!placements.empty()) {
            PlacementRun& run = placements.back();
            if (run.element + run.count == placement.element && run.index + run.count == record->caster.index &&
                run.findings == placement.findings && run.array == placement.array) {
                ++run.count;
                continue;
            }
        }
        PlacementRun run{placement.array, placement.element, record->caster.index, 1, {}, placement.findings};
        for (int i = 0; i < 3; ++i)
            run.shift[i] = static_cast<float>(placement.array.origin[i] - origin[i]);
        placements.push_back(std::move(run));
    }
}

/// Not with the mutex held.
void SceneRegistry::Impl::retirePlacements()
{
    while (true) {
        std::string text;
        {
            const std::lock_guard lock(mutex);
            for (const PlacementRun& run : placements) {
                PlacementFindings& findings = *run.findings;
                std::uint32_t element = UINT32_MAX;
                std::memcpy(&element, findings.buffer.get().mapped, sizeof element);
                if (element == UINT32_MAX || std::exchange(findings.told, true)) continue;
                text = findings.what + ": element " + std::to_string(element) +
                       " of its buffer of transforms is not finite, above 1e18, without an inverse, or mirrored where "
                       "GnTransformBuffer::mirrored says otherwise; such instances cast nothing";
                break;
            }
        }
        if (text.empty()) return;
        messages.warn("TransformInvalid", text);
    }
}

} // namespace gnomon
