// Bytes of a pipeline cache that a host keeps from one run to the next.
#include "device/hooks.hpp"
#include "runtime/vk/pipeline_cache_data.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

std::string cacheBegins; ///< Initial data of the newest cache.

VKAPI_ATTR VkResult VKAPI_CALL notedCache(VkDevice handle, const VkPipelineCacheCreateInfo* info,
                                          const VkAllocationCallbacks* allocator, VkPipelineCache* cache)
{
    cacheBegins.assign(static_cast<const char*>(info->pInitialData), info->initialDataSize);
    return vkCreatePipelineCache(handle, info, allocator, cache);
}

HostOptions withCache(const std::string& data)
{
    cacheBegins = "none was made";
    HostOptions base{.extent = {96, 54}};
    base.context = [&data](GnContextCreateInfo& info) {
        info.pipelineCacheDataSize = data.size();
        info.pPipelineCacheData = data.data();
    };
    return hooked(std::move(base), {hook("vkCreatePipelineCache", &notedCache)});
}

std::string cacheDataOf(const Host& host)
{
    size_t size = 0;
    host.require(gnGetPipelineCacheData(host.context, &size, nullptr));
    std::string data(size, '\0');
    size_t less = size - 1;
    CHECK(gnGetPipelineCacheData(host.context, &less, data.data()) == GN_INCOMPLETE);
    CHECK(less == size);
    CHECK(data == std::string(size, '\0'));
    host.require(gnGetPipelineCacheData(host.context, &size, data.data()));
    return data;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "what one run's cache held is what the next one's begins with")
{
    std::string kept;
    {
        Host host(smallScene(), {.extent = {96, 54}});
        host.draw();
        kept = cacheDataOf(host);
    }
    const Result<std::string_view> driver = unpackCacheData(kept, device().properties);
    REQUIRE(driver);
    CHECK(driver->size() >= 32); // its header
    Host host(smallScene(), withCache(kept));
    CHECK(cacheBegins == *driver);
    CHECK(host.takeMessages().empty());
    host.draw();
    CHECK(dark(host.pictures()[0]) > 10);
}

TEST_CASE_FIXTURE(DeviceTest, "a cache that is damaged or of another device is refused with a remark and without harm")
{
    std::string kept;
    {
        Host host(smallScene(), {.extent = {96, 54}});
        kept = cacheDataOf(host);
    }
    std::string flipped = kept, other(*unpackCacheData(kept, device().properties)), longer = kept + "x";
    flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 4);
    other[8] = static_cast<char>(other[8] ^ 1); // the vendor
    other = packCacheData(other);
    const std::string cut = kept.substr(0, kept.size() - 1), zeros(100, '\0'), one = "g";
    for (const std::string& data : {flipped, other, longer, cut, zeros, one}) {
        CAPTURE(data.size());
        Host host(smallScene(), withCache(data));
        const std::vector<std::string> messages = host.takeMessages();
        REQUIRE(messages.size() == 1);
        CHECK(messages[0].find("pPipelineCacheData") != std::string::npos);
        host.draw();
        CHECK(cacheBegins.empty());
        CHECK(dark(host.pictures()[0]) > 10);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "the host's own pipeline cache takes no data and gives none")
{
    VkPipelineCache cache = VK_NULL_HANDLE;
    const VkPipelineCacheCreateInfo empty{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO, nullptr, 0, 0, nullptr};
    REQUIRE(vkCreatePipelineCache(device().handle, &empty, nullptr, &cache) == VK_SUCCESS);
    {
        Host host(smallScene(),
                  {.extent = {96, 54}, .context = [&](GnContextCreateInfo& info) { info.pipelineCache = cache; }});
        size_t size = 7;
        CHECK(gnGetPipelineCacheData(host.context, &size, nullptr) == GN_ERROR_UNSUPPORTED);
        CHECK(size == 0);
        GnContextCreateInfo info = device().contextInfo();
        info.pipelineCache = cache;
        info.pPipelineCacheData = "data";
        info.pipelineCacheDataSize = 4;
        GnContext second = VK_NULL_HANDLE;
        CHECK(gnCreateContext(&info, &second) == GN_ERROR_OUT_OF_RANGE);
        info.pipelineCache = VK_NULL_HANDLE;
        info.pPipelineCacheData = nullptr;
        CHECK(gnCreateContext(&info, &second) == GN_ERROR_NULL_ARGUMENT);
    }
    vkDestroyPipelineCache(device().handle, cache, nullptr);
}
