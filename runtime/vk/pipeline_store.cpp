#include "runtime/vk/pipeline_store.hpp"

#include <algorithm>
#include <cassert>
#include <new>
#include <utility>

#include "runtime/vk/pipeline_cache_data.hpp"

namespace gnomon {
namespace {

enum class Stage : std::uint8_t { described, creating, created, tried, failed };

/// Runs on workers, where nobody catches: a pipeline that host memory did not suffice for has failed like any other.
Result<Pipeline> createOrExplain(const DeviceTable& vk, VkPipelineCache cache, const PipelineDescription& description)
{
    try {
        return createPipeline(vk, cache, description);
    } catch (const std::bad_alloc&) {
        return Error{GN_ERROR_OUT_OF_HOST_MEMORY, "OutOfHostMemory", "out of memory"}; // short: needs no allocation
    }
}

} // namespace

struct PipelineStore::Item {
    explicit Item(PipelineDescription what) : description(std::move(what)) {}

    const PipelineDescription description;
    Pipeline pipeline; ///< Written by the one who set `creating`, read from `created` on.
    // Guarded by the store's mutex.
    Stage stage = Stage::described;
    std::vector<std::uint32_t> owners;
    std::string failure;

    bool belongsTo(std::uint32_t owner) const { return std::find(owners.begin(), owners.end(), owner) != owners.end(); }
};

PipelineStore::PipelineStore(const DeviceTable& vk, DeviceMemory& memory, const SamplerSet& samplers)
    : vk_(vk), warmups_(vk, memory, samplers)
{
}

PipelineStore::~PipelineStore()
{
    for (const std::unique_ptr<Item>& item : items_)
        destroyPipeline(vk_, item->pipeline);
    if (ownCache_) vk_.vkDestroyPipelineCache(vk_.device, ownCache_, vk_.hostAllocator);
}

PipelineId PipelineStore::graphics(const GraphicsPipelineInfo& info)
{
    return describe(PipelineDescription(info));
}

PipelineId PipelineStore::compute(const ComputePipelineInfo& info)
{
    return describe(PipelineDescription(info));
}

PipelineId PipelineStore::describe(PipelineDescription description)
{
    const std::lock_guard lock(mutex_);
    auto found = std::find_if(items_.begin(), items_.end(), [&description](const std::unique_ptr<Item>& item) {
        return item->description == description;
    });
    if (found == items_.end()) found = items_.insert(items_.end(), std::make_unique<Item>(std::move(description)));
    if (!(*found)->belongsTo(owner_)) (*found)->owners.push_back(owner_);
    return {static_cast<std::uint32_t>(found - items_.begin())};
}

void PipelineStore::setOwner(std::uint32_t owner)
{
    const std::lock_guard lock(mutex_);
    owner_ = owner;
}

void PipelineStore::setWarmupSlopeBias(float bias)
{
    const std::lock_guard lock(mutex_);
    warmupSlopeBias_ = bias;
}

/// The host's, or one of our own: pipelines of one source share compiled parts. Without a cache everything works, so a
/// failure is not passed on. With the mutex held.
VkPipelineCache PipelineStore::cache(std::string_view initial)
{
    if (vk_.pipelineCache) return vk_.pipelineCache;
    if (std::exchange(cacheAsked_, true)) return ownCache_;
    VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO, nullptr, 0, initial.size(),
                                   initial.data()};
    VkResult made = vk_.vkCreatePipelineCache(vk_.device, &info, vk_.hostAllocator, &ownCache_);
    if (made != VK_SUCCESS && info.initialDataSize > 0) { // the driver does not like the data
        info.initialDataSize = 0;
        made = vk_.vkCreatePipelineCache(vk_.device, &info, vk_.hostAllocator, &ownCache_);
    }
    if (made == VK_SUCCESS)
        ++vk_.objectsMade;
    else
        ownCache_ = VK_NULL_HANDLE;
    return ownCache_;
}

Result<void> PipelineStore::beginCache(std::string_view data)
{
    const Result<std::string_view> driverData = unpackCacheData(data, vk_.properties);
    if (!driverData) return driverData.error();
    const std::lock_guard lock(mutex_);
    cache(*driverData);
    return {};
}

Result<std::string> PipelineStore::cacheData()
{
    if (vk_.pipelineCache)
        return Error{GN_ERROR_UNSUPPORTED, "PipelineCacheOfHost",
                     "the pipeline cache is the host's, GnContextCreateInfo::pipelineCache, which saves it itself"};
    const std::lock_guard lock(mutex_);
    const VkPipelineCache own = cache();
    if (!own) return packCacheData({});
    std::size_t size = 0;
    VkResult result = vk_.vkGetPipelineCacheData(vk_.device, own, &size, nullptr);
    std::string data(size, '\0');
    // Workers may have added to it since: what fits is whole entries, and valid (VK_INCOMPLETE).
    if (result >= 0) result = vk_.vkGetPipelineCacheData(vk_.device, own, &size, data.data());
    if (result < 0) return vulkanError(result, "vkGetPipelineCacheData");
    data.resize(size);
    return packCacheData(data);
}

bool PipelineStore::createNext(std::uint32_t owner)
{
    std::unique_lock lock(mutex_);
    const auto next = std::find_if(items_.begin(), items_.end(), [owner](const std::unique_ptr<Item>& item) {
        return item->stage == Stage::described && item->belongsTo(owner);
    });
    if (next == items_.end()) return false;
    Item& item = **next;
    item.stage = Stage::creating;
    const VkPipelineCache shared = cache();

    lock.unlock(); // creation takes milliseconds; the frame's thread goes on describing and asking
    Result<Pipeline> made = createOrExplain(vk_, shared, item.description);
    lock.lock();
    if (made) {
        item.pipeline = std::move(*made);
        item.stage = Stage::created;
    } else {
        item.stage = Stage::failed;
        item.failure = std::move(made.error().text); // a copy might find no memory, on a worker
    }
    return true;
}

bool PipelineStore::created(std::uint32_t owner) const
{
    const std::lock_guard lock(mutex_);
    return std::all_of(items_.begin(), items_.end(), [owner](const std::unique_ptr<Item>& item) {
        return !item->belongsTo(owner) || item->stage == Stage::created || item->stage == Stage::tried;
    });
}

Result<void> PipelineStore::recordWarmupDraws(VkCommandBuffer cmd, std::uint32_t owner)
{
    const std::lock_guard lock(mutex_);
    std::vector<Item*> untried;
    std::vector<WarmupDraws::Candidate> candidates;
    for (const std::unique_ptr<Item>& item : items_) {
        if (item->stage != Stage::created || !item->belongsTo(owner)) continue;
        untried.push_back(item.get());
        candidates.push_back({&item->description, &item->pipeline});
    }
    if (Result<void> recorded = warmups_.record(cmd, candidates, warmupSlopeBias_); !recorded) return recorded;
    for (Item* item : untried)
        item->stage = Stage::tried;
    return {};
}

bool PipelineStore::ready(std::uint32_t owner) const
{
    const std::lock_guard lock(mutex_);
    return std::all_of(items_.begin(), items_.end(), [owner](const std::unique_ptr<Item>& item) {
        return !item->belongsTo(owner) || item->stage == Stage::tried;
    });
}

std::string PipelineStore::failure(std::uint32_t owner) const
{
    const std::lock_guard lock(mutex_);
    for (const std::unique_ptr<Item>& item : items_)
        if (item->stage == Stage::failed && item->belongsTo(owner)) return item->failure;
    return {};
}

const Pipeline& PipelineStore::get(PipelineId id) const
{
    const std::lock_guard lock(mutex_);
    assert(id.index < items_.size());
    const Item& item = *items_[id.index];
    assert(item.stage == Stage::created || item.stage == Stage::tried);
    return item.pipeline;
}

} // namespace gnomon
