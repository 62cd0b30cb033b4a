// Bytes of a pipeline cache, as they were and otherwise.
#include <cstdint>

#include <doctest/doctest.h>

#include "runtime/vk/pipeline_cache_data.hpp"

using namespace gnomon;

namespace {

VkPhysicalDeviceProperties someDevice()
{
    VkPhysicalDeviceProperties device{};
    device.vendorID = 0x10005;
    device.deviceID = 7;
    for (std::uint8_t i = 0; i < VK_UUID_SIZE; ++i)
        device.pipelineCacheUUID[i] = i;
    return device;
}

/// As a driver's vkGetPipelineCacheData() begins.
std::string driverData(const VkPhysicalDeviceProperties& device)
{
    std::string data("\x20\0\0\0\x01\0\0\0", 8);
    for (const std::uint32_t id : {device.vendorID, device.deviceID})
        for (int i = 0; i < 4; ++i)
            data += static_cast<char>(id >> (8 * i) & 0xff);
    data.append(reinterpret_cast<const char*>(device.pipelineCacheUUID), VK_UUID_SIZE);
    return data + "compiled";
}

} // namespace

TEST_CASE("a cache's bytes come back as they were, and with any one of them changed they do not")
{
    const VkPhysicalDeviceProperties device = someDevice();
    const std::string data = driverData(device), packed = packCacheData(data);
    const Result<std::string_view> whole = unpackCacheData(packed, device);
    REQUIRE(whole);
    CHECK(*whole == data);
    for (std::size_t i = 0; i < packed.size(); ++i) {
        std::string changed = packed;
        changed[i] = static_cast<char>(changed[i] ^ 0x10);
        CAPTURE(i);
        CHECK_FALSE(unpackCacheData(changed, device));
        CHECK_FALSE(unpackCacheData(packed.substr(0, i), device));
    }
    const std::string none = packCacheData({}); // where there is no cache
    REQUIRE(unpackCacheData(none, device));
    CHECK(unpackCacheData(none, device)->empty());
}

TEST_CASE("a cache of another device, or of another version of the driver, is told from damage")
{
    const std::string packed = packCacheData(driverData(someDevice()));
    const auto refusal = [&](auto change) {
        VkPhysicalDeviceProperties device = someDevice();
        change(device);
        const Result<std::string_view> read = unpackCacheData(packed, device);
        REQUIRE(!read);
        return read.error().text;
    };
    CHECK(refusal([](auto& device) { device.vendorID = 8; }).find("65541:7") != std::string::npos);
    CHECK(refusal([](auto& device) { device.deviceID = 8; }).find("65541:8") != std::string::npos);
    CHECK(refusal([](auto& device) { device.pipelineCacheUUID[15] = 0; }).find("version of the driver") !=
          std::string::npos);
    CHECK_FALSE(unpackCacheData(packCacheData("short"), someDevice()));
}
