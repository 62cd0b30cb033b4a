// Devices with less to offer than the one at hand: an answer by name, and no call that Vulkan forbids.
#include <algorithm>

#include "device/hooks.hpp"
#include "gnomon/algorithm.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkFormat kMissing = VK_FORMAT_R16_UNORM;

struct Lesser {
    uint32_t storageBuffers = UINT32_MAX; ///< Of a stage.
    uint32_t subpixelBits = 8;
    bool format = true; ///< kMissing.
} lesser;
std::atomic<uint32_t> missingMade{0}; ///< Images of the format that is missing.

VKAPI_ATTR void VKAPI_CALL lesserProperties(VkPhysicalDevice device, VkPhysicalDeviceProperties2* properties)
{
    vkGetPhysicalDeviceProperties2(device, properties);
    VkPhysicalDeviceLimits& limits = properties->properties.limits;
    limits.maxPerStageDescriptorStorageBuffers =
        std::min(limits.maxPerStageDescriptorStorageBuffers, lesser.storageBuffers);
    limits.subPixelPrecisionBits = lesser.subpixelBits;
}

VKAPI_ATTR void VKAPI_CALL lesserFormats(VkPhysicalDevice device, VkFormat format, VkFormatProperties2* properties)
{
    vkGetPhysicalDeviceFormatProperties2(device, format, properties);
    if (format == kMissing && !lesser.format)
        properties->formatProperties.optimalTilingFeatures &=
            ~VkFormatFeatureFlags{VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT};
}

VKAPI_ATTR VkResult VKAPI_CALL watchedCreateImage(VkDevice device, const VkImageCreateInfo* info,
                                                  const VkAllocationCallbacks* allocator, VkImage* image)
{
    missingMade += info->format == kMissing;
    return vkCreateImage(device, info, allocator, image);
}

HostOptions lesserOptions(const Lesser& device)
{
    lesser = device;
    return hooked({.extent = {96, 54}}, {hook("vkGetPhysicalDeviceProperties2", &lesserProperties),
                                         hook("vkGetPhysicalDeviceFormatProperties2", &lesserFormats),
                                         hook("vkCreateImage", &watchedCreateImage)});
}

bool has(const std::vector<std::string>& messages, const char* words)
{
    return std::ranges::any_of(
        messages, [words](const std::string& message) { return message.find(words) != std::string::npos; });
}

/// A plug-in that fills its visibility, and asks for an image of kMissing before.
struct Painter {
    const GnPluginInterface* abi = nullptr;

    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        const GnPluginInterface& gn = *static_cast<Painter*>(self)->abi;
        GnImageInfo image{};
        image.pName = "painter.canvas";
        image.scope = GN_SCOPE_TASK;
        image.format = kMissing;
        image.extent = {16, 16};
        GnAccess paint{}, fill{};
        paint.kind = GN_ACCESS_WRITE;
        paint.image = gn.pfnImage(builder, &image);
        paint.clear = VK_TRUE;
        GnPassInfo pass{};
        pass.pName = "painter.paint";
        pass.kind = GN_PASS_RASTER;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 1;
        pass.pAccesses = &paint;
        pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        gn.pfnPass(builder, &pass);
        fill.kind = GN_ACCESS_WRITE;
        fill.image = task->visibility;
        fill.baseLayer = task->layer;
        fill.clear = VK_TRUE;
        pass.pName = "painter.fill";
        pass.pAccesses = &fill;
        pass.area = task->area;
        gn.pfnPass(builder, &pass);
    }

    void join(Host& host)
    {
        host.require(gnGetPluginInterface(host.context, &abi));
        GnAlgorithmInfo info{};
        info.pName = "painter";
        info.traits = GN_TRAIT_SPOT_BIT;
        info.pfnDeclare = &declare;
        info.pAlgorithm = this;
        host.require(gnRegisterAlgorithm(host.context, &info));
        host.pinAll("painter");
    }
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "methods that bind more buffers than a stage may have are not there, and say so")
{
    Host host(smallScene(), lesserOptions({.storageBuffers = 4}));
    host.require(gnWarmUp(host.context));
    const std::vector<std::string> messages = host.takeMessages();
    CHECK(has(messages, "6 storage buffers; at most 4"));
    uint32_t drawn = 0;
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        CAPTURE(std::string(method.pName));
        CHECK(std::string(method.pName) != "octree_volume");
        CHECK(std::string(method.pName) != "chan_durand");
        if (!serves(method, demo::LightKind::Spot) || !(method.traits & GN_TRAIT_HARD_BIT)) continue;
        host.pinAll(method.pName);
        host.require(host.draw());
        CHECK(dark(host.pictures()[0]) > 10);
        drawn += host.decision(0).reason == GN_REASON_PINNED;
    }
    CHECK(drawn > 6);
}

TEST_CASE_FIXTURE(DeviceTest, "a plug-in's image of a format that the device cannot draw to is refused by name")
{
    for (const bool there : {true, false}) {
        Painter painter;
        Host host(smallScene(), lesserOptions({.format = there}));
        missingMade = 0;
        painter.join(host);
        host.takeMessages();
        host.require(host.draw());
        CHECK(missingMade == (there ? 1 : 0));
        CHECK((std::string(host.decision(0).pMethod) == "painter") == there); // else another one serves
        CHECK(has(host.takeMessages(), "painter.canvas: the device has no images of VkFormat 70 for this use") !=
              there);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a device that rounds corners of triangles more coarsely is remarked on, once")
{
    for (const uint32_t bits : {4u, 8u}) {
        Host host(smallScene(), lesserOptions({.subpixelBits = bits}));
        host.pinAll("shadow_map");
        host.require(host.draw());
        host.require(host.draw());
        const auto remarks = std::ranges::count_if(host.takeMessages(), [](const std::string& message) {
            return message.find("rasterises to 1/16 pixel") != std::string::npos;
        });
        CHECK(remarks == (bits < 8 ? 1 : 0));
    }
}
