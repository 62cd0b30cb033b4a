#include "runtime/vk/pipeline_cache_data.hpp"

#include <cstring>

#include "runtime/base/bytes.hpp"
#include "runtime/base/hash.hpp"

namespace gnomon {
namespace {

// Magic, length and checksum of the driver's data, which follow.
constexpr std::string_view kMagic = "gnomonPC";
constexpr std::uint32_t kDriverHeaderBytes = 32; // VkPipelineCacheHeaderVersionOne

Error refused(const std::string& what)
{
    return {GN_ERROR_OUT_OF_RANGE, "PipelineCacheData", "pPipelineCacheData " + what + "; the cache begins empty"};
}

/// Every driver's data begin so, lowest byte first.
Result<void> checkDriverHeader(std::string_view data, const VkPhysicalDeviceProperties& device)
{
    ByteReader header(data);
    const auto size = header.integer<std::uint32_t>();
    const auto version = header.integer<std::uint32_t>();
    const auto vendor = header.integer<std::uint32_t>();
    const auto model = header.integer<std::uint32_t>();
    const std::string_view uuid = header.take(VK_UUID_SIZE);
    if (header.failed || size < kDriverHeaderBytes || version != VK_PIPELINE_CACHE_HEADER_VERSION_ONE)
        return refused("has no driver's header");
    if (vendor != device.vendorID || model != device.deviceID)
        return refused("is of device " + std::to_string(vendor) + ":" + std::to_string(model) + ", not of this one, " +
                       std::to_string(device.vendorID) + ":" + std::to_string(device.deviceID));
    if (std::memcmp(uuid.data(), device.pipelineCacheUUID, VK_UUID_SIZE) != 0)
        return refused("is of another version of the driver");
    return {};
}

} // namespace

std::string packCacheData(std::string_view driverData)
{
    ByteWriter out;
    out.bytes = kMagic;
    out.integer(std::uint64_t{driverData.size()});
    out.integer(hashOfBytes(driverData));
    out.bytes += driverData;
    return std::move(out.bytes);
}

Result<std::string_view> unpackCacheData(std::string_view packed, const VkPhysicalDeviceProperties& device)
{
    ByteReader in(packed);
    if (in.take(kMagic.size()) != kMagic) return refused("is not of gnGetPipelineCacheData()");
    const auto size = in.integer<std::uint64_t>();
    const auto hash = in.integer<std::uint64_t>();
    if (in.failed || in.left() != size)
        return refused("is damaged: it should have " + std::to_string(size) + " bytes behind its header, and has " +
                       std::to_string(in.left()));
    const std::string_view data = in.take(in.left());
    if (hashOfBytes(data) != hash) return refused("is damaged: its checksum is another one");
    if (data.empty()) return data; // of a device without a cache
    if (Result<void> ours = checkDriverHeader(data, device); !ours) return ours.error();
    return data;
}

} // namespace gnomon
