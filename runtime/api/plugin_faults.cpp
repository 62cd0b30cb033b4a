// What a plug-in may not ask for, by the member at fault.
#include <algorithm>

#include "runtime/api/plugin_abi.hpp"
#include "runtime/vk/memory.hpp"

namespace gnomon {
namespace {

constexpr std::uint32_t kMaxUserData = 256;
// Sizes are rounded up to a power of two, and the next is past the 32 bits of VkPhysicalDeviceLimits'
// maxStorageBufferRange.
constexpr VkDeviceSize kLargestBuffer = VkDeviceSize{1} << 31;

Error nameMissing(const char* call)
{
    return {GN_ERROR_NULL_ARGUMENT, "PluginNull", std::string(call) + ": pName is null"};
}

Error passFault(const GnPassInfo& info, GnResult result, const char* id, const std::string& what)
{
    return {result, id, "pass '" + std::string(info.pName) + "': " + what};
}

std::string accessName(std::uint32_t index)
{
    return "pAccesses[" + std::to_string(index) + "]";
}

/// Images are made without storage usage, which takes compression from them on some devices, and lie where the CPU does
/// not reach them: passes render to them or copy to them.
bool writesImageOtherwise(const GnPassInfo& info)
{
    const bool mayWrite = info.kind == GN_PASS_RASTER || info.kind == GN_PASS_TRANSFER;
    return std::any_of(info.pAccesses, info.pAccesses + info.accessCount, [&](const GnAccess& access) {
        return access.image && (access.kind == GN_ACCESS_UPDATE || (access.kind == GN_ACCESS_WRITE && !mayWrite));
    });
}

bool isColor(const GnAccess& access)
{
    return access.image && access.kind == GN_ACCESS_WRITE;
}

/// What an attachment's format has to have; of a raster pass. 0: it is none.
VkImageAspectFlags attachedAspect(const GnAccess& access)
{
    switch (access.kind) {
    case GN_ACCESS_WRITE:
        return access.image ? VK_IMAGE_ASPECT_COLOR_BIT : 0;
    case GN_ACCESS_DEPTH_TEST:
    case GN_ACCESS_DEPTH_WRITE:
        return access.image ? VK_IMAGE_ASPECT_DEPTH_BIT : 0;
    case GN_ACCESS_STENCIL_TEST:
    case GN_ACCESS_STENCIL_WRITE:
        return access.image ? VK_IMAGE_ASPECT_STENCIL_BIT : 0;
    default:
        return 0;
    }
}

bool isAttachment(const GnAccess& access)
{
    return attachedAspect(access) != 0;
}

bool isOfBuffers(GnAccessKind kind)
{
    return kind == GN_ACCESS_READ || kind == GN_ACCESS_VERTICES || kind == GN_ACCESS_INDICES ||
           kind == GN_ACCESS_INDIRECT;
}

/// What an access of this kind, in this pass, cannot be of; empty: nothing.
std::string misnamed(const GnPassInfo& info, const GnAccess& access)
{
    const bool either = access.kind == GN_ACCESS_WRITE || access.kind == GN_ACCESS_UPDATE;
    const bool cpu = info.kind == GN_PASS_PREPARE || info.kind == GN_PASS_HOST;
    if (access.image && access.buffer) return "names an image and a buffer";
    if (access.image && cpu) return "names an image in a pass of the CPU, which sees buffers only";
    if (access.image && isOfBuffers(access.kind)) return "names an image, but is of a kind for buffers";
    if (access.buffer && !either && !isOfBuffers(access.kind)) return "names a buffer, but is of a kind for images";
    if (info.kind != GN_PASS_RASTER && access.kind != GN_ACCESS_WRITE && isAttachment(access))
        return "is of a kind for attachments, which raster passes alone have";
    return {};
}

std::uint32_t layersOf(const GnAccess& access)
{
    return std::max(access.layerCount, 1u);
}

/// Part of the image, or nothing at all: everything.
bool isWithin(const VkRect2D& rect, VkExtent2D extent)
{
    if (rect.extent.width == 0 && rect.extent.height == 0) return true;
    const auto inside = [](std::int32_t from, std::uint32_t size, std::uint32_t whole) {
        return from >= 0 && size > 0 && std::uint64_t(from) + size <= whole;
    };
    return inside(rect.offset.x, rect.extent.width, extent.width) &&
           inside(rect.offset.y, rect.extent.height, extent.height);
}

std::string text(const VkRect2D& rect)
{
    return std::to_string(rect.extent.width) + " x " + std::to_string(rect.extent.height) + " at " +
           std::to_string(rect.offset.x) + ", " + std::to_string(rect.offset.y);
}

/// What is wrong with the pass itself.
std::optional<Error> faultOfPass(const GnPassInfo& info, std::uint32_t roundTrips)
{
    const auto fault = [&](GnResult result, const char* id, const std::string& what) {
        return passFault(info, result, id, what);
    };
    if (info.kind < GN_PASS_RASTER || info.kind > GN_PASS_HOST)
        return fault(GN_ERROR_OUT_OF_RANGE, "PassKind", "kind is " + std::to_string(info.kind) + ", no GnPassKind");
    const bool cpu = info.kind == GN_PASS_PREPARE || info.kind == GN_PASS_HOST;
    if (cpu && !info.pfnRun) return fault(GN_ERROR_NULL_ARGUMENT, "PassRun", "pfnRun is null");
    if (!cpu && !info.pfnRecord) return fault(GN_ERROR_NULL_ARGUMENT, "PassRecord", "pfnRecord is null");
    if (info.accessCount && !info.pAccesses) return fault(GN_ERROR_NULL_ARGUMENT, "PassAccesses", "pAccesses is null");
    if (info.userDataSize && !info.pUserData) return fault(GN_ERROR_NULL_ARGUMENT, "PassUserData", "pUserData is null");
    if (info.userDataSize > kMaxUserData)
        return fault(GN_ERROR_TOO_MANY, "PassUserData",
                     "userDataSize is " + std::to_string(info.userDataSize) + ", above " +
                         std::to_string(kMaxUserData));
    if (info.kind == GN_PASS_HOST && roundTrips == 0) // recorded frames would run without it
        return fault(GN_ERROR_UNSUPPORTED, "PassRoundTrips", "a host pass, but the algorithm's roundTrips is 0");
    return std::nullopt;
}

bool changes(const GnAccess& access)
{
    switch (access.kind) {
    case GN_ACCESS_WRITE:
    case GN_ACCESS_UPDATE:
    case GN_ACCESS_DEPTH_WRITE:
    case GN_ACCESS_STENCIL_WRITE:
        return true;
    default:
        return access.clear != VK_FALSE;
    }
}

std::optional<Error> faultOfAccess(const PassBuilder& passes, const GnPassInfo& info, std::uint32_t index)
{
    const GnAccess& access = info.pAccesses[index];
    if (access.kind < GN_ACCESS_SAMPLED || access.kind > GN_ACCESS_INDIRECT)
        return passFault(info, GN_ERROR_OUT_OF_RANGE, "PassAccess",
                         accessName(index) + ".kind is " + std::to_string(access.kind) + ", no GnAccessKind");
    const std::uint32_t layers = layersOf(access);
    const bool there = (!access.image || passes.has(imageOf(access.image), access.baseLayer, layers)) &&
                       (!access.buffer || passes.has(bufferOf(access.buffer)));
    if (there) {
        if (const std::string what = misnamed(info, access); !what.empty())
            return passFault(info, GN_ERROR_UNSUPPORTED, "PassAccess",
                             accessName(index) + ", of kind " + std::to_string(access.kind) + ", " + what);
        if (!access.image || !changes(access) || !passes.isHosts(imageOf(access.image))) return std::nullopt;
        return passFault(info, GN_ERROR_UNSUPPORTED, "HostImage",
                         accessName(index) + " changes the host's depth or normals, which are to be read only");
    }
    return passFault(info, GN_ERROR_OUT_OF_RANGE, "PassAccess",
                     accessName(index) + " names image " + std::to_string(access.image) + ", layers " +
                         std::to_string(access.baseLayer) + " + " + std::to_string(layers) + ", buffer " +
                         std::to_string(access.buffer) + ", which this frame has not");
}

/// Of an attachment that is there. @param first what the pass's first one is
std::optional<Error> faultOfAttachment(const PassBuilder& passes, const GnPassInfo& info, std::uint32_t index,
                                       const GnAccess& first)
{
    const GnAccess& access = info.pAccesses[index];
    if (!isWithin(access.rect, passes.extent(imageOf(access.image))))
        return passFault(info, GN_ERROR_OUT_OF_RANGE, "PassArea",
                         accessName(index) + ".rect is " + text(access.rect) + ", not within the image");
    const VkFormat format = passes.format(imageOf(access.image));
    if ((aspectsOf(format) & attachedAspect(access)) == 0)
        return passFault(info, GN_ERROR_UNSUPPORTED, "PassAttachmentFormat",
                         accessName(index) + ", of kind " + std::to_string(access.kind) +
                             ", names an image of VkFormat " + std::to_string(format) +
                             ", which cannot be attached so");
    if (layersOf(access) > 1 && access.baseLayer != 0) // its view is that of the whole image
        return passFault(info, GN_ERROR_UNSUPPORTED, "PassAttachmentLayers",
                         accessName(index) + " attaches layers " + std::to_string(access.baseLayer) + " + " +
                             std::to_string(access.layerCount) + "; several are attached from 0 on");
    if (layersOf(access) == layersOf(first)) return std::nullopt;
    return passFault(info, GN_ERROR_UNSUPPORTED, "PassAttachmentLayers",
                     accessName(index) + " attaches " + std::to_string(layersOf(access)) + " layers, another one " +
                         std::to_string(layersOf(first)));
}

/// Of a raster pass whose accesses are all there.
std::optional<Error> faultOfAttachments(const PassBuilder& passes, const GnPassInfo& info)
{
    const GnAccess* first = nullptr;
    std::uint32_t colors = 0;
    VkRect2D area = info.area;
    VkExtent2D common{UINT32_MAX, UINT32_MAX}; // of all attachments, the part that each of them has
    for (std::uint32_t i = 0; i < info.accessCount; ++i) {
        const GnAccess& access = info.pAccesses[i];
        if (!isAttachment(access)) continue;
        if (!first) first = &access;
        if (std::optional<Error> fault = faultOfAttachment(passes, info, i, *first)) return fault;
        colors += isColor(access);
        const VkExtent2D extent = passes.extent(imageOf(access.image));
        common = {std::min(common.width, extent.width), std::min(common.height, extent.height)};
        if (area.extent.width == 0 && area.extent.height == 0) area = access.rect;
    }
    if (!first) return passFault(info, GN_ERROR_EMPTY, "PassAttachments", "a raster pass has no attachment");
    if (colors > kMaxColorAttachments)
        return passFault(info, GN_ERROR_TOO_MANY, "PassAttachments",
                         std::to_string(colors) + " colour attachments, above " + std::to_string(kMaxColorAttachments));
    if (isWithin(area, common)) return std::nullopt;
    return passFault(info, GN_ERROR_OUT_OF_RANGE, "PassArea",
                     "area is " + text(area) + ", not within the " + std::to_string(common.width) + " x " +
                         std::to_string(common.height) + " of its attachments");
}

} // namespace

std::optional<Error> faultOf(const GnImageInfo& info)
{
    if (!info.pName) return nameMissing("pfnImage");
    return std::nullopt; // the rest depends on the device, and is looked at where the image is made
}

std::optional<Error> faultOf(const GnBufferInfo& info)
{
    if (!info.pName) return nameMissing("pfnBuffer");
    if (info.size <= kLargestBuffer) return std::nullopt;
    return Error{GN_ERROR_OUT_OF_RANGE, "BufferSize",
                 "buffer '" + std::string(info.pName) + "': size is " + std::to_string(info.size) + ", above " +
                     std::to_string(kLargestBuffer)};
}

std::optional<Error> faultOf(const PassBuilder& passes, const GnPassInfo& info, std::uint32_t roundTrips)
{
    if (!info.pName) return Error{GN_ERROR_NULL_ARGUMENT, "PassName", "a pass has no pName"};
    if (std::optional<Error> fault = faultOfPass(info, roundTrips)) return fault;
    for (std::uint32_t i = 0; i < info.accessCount; ++i)
        if (std::optional<Error> fault = faultOfAccess(passes, info, i)) return fault;
    if (writesImageOtherwise(info))
        return passFault(info, GN_ERROR_UNSUPPORTED, "StorageImage",
                         "it writes an image that is neither its attachment nor what it copies to");
    if (info.kind == GN_PASS_RASTER) return faultOfAttachments(passes, info);
    return std::nullopt;
}

} // namespace gnomon
