// Devices with less to offer: what they cannot bind or lack is refused by name, not bound.
#include <algorithm>
#include <cstring>
#include <map>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

// What warm-up binds takes as much. A view of kExtent fits; sides, caps and edges of fineScene() take several times
// that.
constexpr uint32_t kRange = 65536;
constexpr VkExtent2D kExtent{96, 54};

struct Lesser {
    bool stencil = true;         ///< D32_SFLOAT_S8_UINT.
    uint32_t range = UINT32_MAX; ///< maxStorageBufferRange.
    VkDeviceSize largest = 0;    ///< Bound so far as a storage buffer.
    VkDeviceSize memory = 0;     ///< Of the largest buffer of which a part was bound so.
    std::map<VkBuffer, VkDeviceSize> sizes;
} lesser;

PFN_vkCreateBuffer createBuffer = nullptr;
PFN_vkUpdateDescriptorSets updateDescriptorSets = nullptr;

VKAPI_ATTR VkResult VKAPI_CALL watchedCreateBuffer(VkDevice device, const VkBufferCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkBuffer* buffer)
{
    const VkResult result = createBuffer(device, info, allocator, buffer);
    if (result == VK_SUCCESS) lesser.sizes[*buffer] = info->size;
    return result;
}

VkDeviceSize sizeOf(const VkDescriptorBufferInfo& info)
{
    return info.range == VK_WHOLE_SIZE ? lesser.sizes.at(info.buffer) - info.offset : info.range;
}

VKAPI_ATTR void VKAPI_CALL watchedUpdateDescriptorSets(VkDevice device, uint32_t count,
                                                       const VkWriteDescriptorSet* writes, uint32_t copies,
                                                       const VkCopyDescriptorSet* copied)
{
    for (uint32_t i = 0; i < count; ++i)
        if (writes[i].descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)
            for (uint32_t k = 0; k < writes[i].descriptorCount; ++k) {
                lesser.largest = std::max(lesser.largest, sizeOf(writes[i].pBufferInfo[k]));
                lesser.memory = std::max(lesser.memory, lesser.sizes.at(writes[i].pBufferInfo[k].buffer));
            }
    updateDescriptorSets(device, count, writes, copies, copied);
}

VKAPI_ATTR void VKAPI_CALL lesserProperties(VkPhysicalDevice device, VkPhysicalDeviceProperties2* properties)
{
    vkGetPhysicalDeviceProperties2(device, properties);
    uint32_t& range = properties->properties.limits.maxStorageBufferRange;
    range = std::min(range, lesser.range);
}

VKAPI_ATTR void VKAPI_CALL lesserFormats(VkPhysicalDevice device, VkFormat format, VkFormatProperties2* properties)
{
    vkGetPhysicalDeviceFormatProperties2(device, format, properties);
    if (format == VK_FORMAT_D32_SFLOAT_S8_UINT && !lesser.stencil) properties->formatProperties = {};
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL lesserGetDeviceProcAddr(VkDevice handle, const char* name)
{
    const PFN_vkVoidFunction real = vkGetDeviceProcAddr(handle, name);
    if (std::strcmp(name, "vkCreateBuffer") == 0) {
        createBuffer = reinterpret_cast<PFN_vkCreateBuffer>(real);
        return reinterpret_cast<PFN_vkVoidFunction>(&watchedCreateBuffer);
    }
    if (std::strcmp(name, "vkUpdateDescriptorSets") != 0) return real;
    updateDescriptorSets = reinterpret_cast<PFN_vkUpdateDescriptorSets>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&watchedUpdateDescriptorSets);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL lesserGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&lesserGetDeviceProcAddr);
    if (std::strcmp(name, "vkGetPhysicalDeviceProperties2") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&lesserProperties);
    if (std::strcmp(name, "vkGetPhysicalDeviceFormatProperties2") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&lesserFormats);
    return vkGetInstanceProcAddr(instance, name);
}

HostOptions lesserOptions(VkExtent2D extent)
{
    return {.extent = extent,
            .context = [](GnContextCreateInfo& info) { info.pfnGetInstanceProcAddr = &lesserGetInstanceProcAddr; }};
}

/// Four balls whose lists are larger than kRange.
Scene fineScene()
{
    Scene scene = smallScene();
    scene.meshes[1] = demo::makeSphere({.radius = 0.8f, .slices = 48, .stacks = 24});
    scene.lights[0].radius = 0.2f;
    for (int i = 0; i < 3; ++i) {
        scene.instances.push_back(scene.instances[1]);
        scene.instances.back().pose.position += glm::dvec3(0.5 * i, 0.2, 1.2);
    }
    return scene;
}

/// Why the method does not serve the light of the host's newest frame: its line of the explanation.
std::string whyNot(Host& host, const char* method)
{
    host.pinAll(method);
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) != method);
    return host.explanation(0);
}

bool says(const std::string& text, const char* words)
{
    return text.find(words) != std::string::npos;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "lists that a shader cannot bind are refused by name, or drawn without being read")
{
    Host whole(fineScene(), {.extent = kExtent});
    lesser = {.range = kRange};
    Host host(fineScene(), lesserOptions(kExtent));
    const auto set = [&](const char* method, const char* setting, double value) {
        for (Host* each : {&whole, &host})
            each->require(gnSetMethodSetting(each->context, method, setting, value));
    };
    for (const char* method : {"stencil_volume", "octree_volume", "chan_durand", "mccool"}) {
        CAPTURE(std::string(method));
        if (std::string_view(method) == "mccool") set(method, "edges", 1.0);
        if (std::string_view(method) == "mccool") set(method, "resolution", 256.0);
        for (Host* each : {&whole, &host}) {
            each->pinAll(method);
            each->require(each->draw());
            CHECK(std::string(each->decision(0).pMethod) == method);
        }
        CHECK(differences(whole.pictures(), host.pictures()) == 0);
    }
    CHECK(says(whyNot(host, "penumbra_wedges"), "more edges than a storage buffer holds"));
    set("mccool", "edges", 256.0);
    CHECK(says(whyNot(host, "mccool"), "more polygons than a storage buffer holds"));
    set("stencil_volume", "silhouettes", 1.0);
    CHECK(says(whyNot(host, "stencil_volume"), "more edges than a storage buffer holds"));
    CHECK(says(whyNot(host, "all_edges_volume"), "more edges than the device can index"));
    CHECK(lesser.largest > 0);
    CHECK(lesser.largest <= kRange);

    lesser = {.range = kRange};
    Host large(smallScene(), lesserOptions({192, 108}));
    for (const char* method :
         {"stencil_volume", "octree_volume", "all_edges_volume", "chan_durand", "penumbra_wedges", "mccool"})
        CHECK(says(whyNot(large, method), "more pixels than a storage buffer holds"));
    CHECK(lesser.largest <= kRange);
    lesser = {};
}

TEST_CASE_FIXTURE(DeviceTest, "a list in memory that has held a larger one is bound as large as it is")
{
    Host whole(fineScene(), {.extent = kExtent});
    lesser = {.range = kRange};
    Host host(fineScene(), lesserOptions(kExtent));
    for (Host* each : {&whole, &host}) {
        std::vector<demo::Instance>& instances = each->scene.instances;
        const auto drawNext = [each] {
            (void)each->pictures(); // the memory of the frame before is free
            each->require(each->draw());
        };
        each->pinAll("chan_durand");
        each->require(each->draw()); // the list of what stands still is too large to be read
        for (demo::Instance& instance : instances)
            if (instance.mesh == 1) instance.pose.position.y += 1000.0; // the balls, out of range
        drawNext();                                                     // a short list, beside the large one
        instances[2].pose.position.x += 0.1;                            // the box is in the list of what moves
        drawNext();                                                     // a shorter one, in the large one's memory
        CHECK(std::string(each->decision(0).pMethod) == "chan_durand");
    }
    CHECK(differences(whole.pictures(), host.pictures()) == 0);
    CHECK(lesser.memory > kRange);
    CHECK(lesser.largest <= kRange);
    lesser = {};
}

TEST_CASE_FIXTURE(DeviceTest, "a device without 32 bits of depth beside a stencil has no stencil methods, and says so")
{
    lesser = {.stencil = false};
    Host host(smallScene(), lesserOptions(kExtent));
    uint32_t count = 0;
    host.require(gnEnumerateMethods(host.context, &count, nullptr));
    std::vector<GnMethodInfo> methods(count);
    host.require(gnEnumerateMethods(host.context, &count, methods.data()));
    uint32_t without = 0;
    for (const GnMethodInfo& method : methods)
        without += method.pUnavailable && std::string_view(method.pUnavailable) == "needs D32_SFLOAT_S8_UINT";
    CHECK(without >= 6); // those that count volumes in a stencil
    lesser = {};
}
