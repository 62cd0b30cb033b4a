// The device floor on a real device, under core and synchronization validation where the layer is installed. Skipped
// (exit code 77) where there is no device.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <dlfcn.h>
#include <string>
#include <vector>

#include "runtime/vk/pipeline_store.hpp"
#include "shaders/shared_fullscreen_vert.h"
#include "shaders/warmup_casters_vert.h"
#include "shaders/warmup_list_comp.h"
#include "shaders/warmup_resolve_frag.h"

using namespace gnomon;

// Loader, layer and driver keep memory and are unloaded before the leak check could name them. What we forget shows up
// in the tests against stub functions, and as a complaint of the layer when the device goes.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options()
{
    return "detect_leaks=0";
}

namespace {

constexpr VkDeviceSize kMiB = 1u << 20;
constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

std::vector<std::string> complaints; // of the validation layer

VkBool32 VKAPI_PTR complain(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                            const VkDebugUtilsMessengerCallbackDataEXT* data, void*)
{
    complaints.emplace_back(data->pMessage);
    return VK_FALSE;
}

/// A host with one device; lives as long as the program.
struct Host {
    PFN_vkGetInstanceProcAddr get = nullptr;
    VkInstance instance = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    VkPhysicalDeviceFeatures2 features{};
    VkPhysicalDeviceVulkan12Features features12{};
    VkPhysicalDeviceVulkan13Features features13{};
    bool validated = false;

    template <typename Function>
    Function load(const char* name) const
    {
        return reinterpret_cast<Function>(get(instance, name));
    }
    bool open();
    void close();
    GnContextCreateInfo info() const;

private:
    bool createInstance();
    bool createDevice();
};

Host host;

bool Host::createInstance()
{
    std::uint32_t count = 0;
    const auto enumerate = load<PFN_vkEnumerateInstanceLayerProperties>("vkEnumerateInstanceLayerProperties");
    enumerate(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    enumerate(&count, layers.data());
    for (const VkLayerProperties& layer : layers)
        validated |= std::string(layer.layerName) == kValidationLayer;

    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT checks{};
    checks.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    checks.enabledValidationFeatureCount = 1;
    checks.pEnabledValidationFeatures = &enabled;
    VkDebugUtilsMessengerCreateInfoEXT listen{};
    listen.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    listen.pNext = &checks;
    listen.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    listen.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    listen.pfnUserCallback = &complain;
    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    create.pApplicationInfo = &application;
    if (validated) {
        create.pNext = &listen;
        create.enabledLayerCount = 1;
        create.ppEnabledLayerNames = &kValidationLayer;
        create.enabledExtensionCount = 1;
        create.ppEnabledExtensionNames = &extension;
    }
    if (load<PFN_vkCreateInstance>("vkCreateInstance")(&create, nullptr, &instance) != VK_SUCCESS) return false;
    if (!validated) return true;
    listen.pNext = nullptr;
    return load<PFN_vkCreateDebugUtilsMessengerEXT>("vkCreateDebugUtilsMessengerEXT")(instance, &listen, nullptr,
                                                                                      &messenger) == VK_SUCCESS;
}

bool Host::createDevice()
{
    std::uint32_t count = 1; // the first will do
    load<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices")(instance, &count, &physical);
    GnDeviceNeeds needs{};
    if (!count || gnQueryDeviceNeeds(instance, physical, get, &needs) != GN_SUCCESS) return false;
    features13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    features13.dynamicRendering = features13.synchronization2 = VK_TRUE;
    features12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    features12.pNext = &features13;
    features12.timelineSemaphore = VK_TRUE;
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    features.pNext = &features12;
    features.features = needs.optional;
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queues{};
    queues.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queues.queueCount = 1;
    queues.pQueuePriorities = &priority;
    VkDeviceCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    create.pNext = &features;
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queues;
    if (load<PFN_vkCreateDevice>("vkCreateDevice")(physical, &create, nullptr, &device) != VK_SUCCESS) return false;
    load<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(device, 0, 0, &queue);
    return true;
}

bool Host::open()
{
    void* loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!loader) return false;
    get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader, "vkGetInstanceProcAddr"));
    return get && createInstance() && createDevice();
}

void Host::close()
{
    if (device) load<PFN_vkDestroyDevice>("vkDestroyDevice")(device, nullptr);
    if (messenger)
        load<PFN_vkDestroyDebugUtilsMessengerEXT>("vkDestroyDebugUtilsMessengerEXT")(instance, messenger, nullptr);
    if (instance) load<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, nullptr);
}

GnContextCreateInfo Host::info() const
{
    static const char* const kNames[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
    GnContextCreateInfo info{};
    info.instance = instance;
    info.physicalDevice = physical;
    info.device = device;
    info.queue = queue;
    info.apiVersion = VK_API_VERSION_1_3;
    info.pEnabledFeatures = &features;
    info.enabledExtensionCount = validated ? 1 : 0;
    info.ppEnabledExtensionNames = kNames;
    info.pfnGetInstanceProcAddr = get;
    return info;
}

/// Records with `body`, submits and waits.
template <typename Body>
void execute(const DeviceTable& vk, Body&& body)
{
    const VkCommandPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, 0, vk.queueFamily};
    VkCommandPool pool = VK_NULL_HANDLE;
    REQUIRE(vk.vkCreateCommandPool(vk.device, &poolInfo, nullptr, &pool) == VK_SUCCESS);
    const VkCommandBufferAllocateInfo ask{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                          VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    REQUIRE(vk.vkAllocateCommandBuffers(vk.device, &ask, &cmd) == VK_SUCCESS);
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    REQUIRE(vk.vkBeginCommandBuffer(cmd, &begin) == VK_SUCCESS);
    body(cmd);
    REQUIRE(vk.vkEndCommandBuffer(cmd) == VK_SUCCESS);
    const VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, cmd, 0};
    VkSubmitInfo2 submit{};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &buffer;
    REQUIRE(vk.vkQueueSubmit2(vk.queue, 1, &submit, VK_NULL_HANDLE) == VK_SUCCESS);
    const auto waitIdle = reinterpret_cast<PFN_vkQueueWaitIdle>(vk.vkGetDeviceProcAddr(vk.device, "vkQueueWaitIdle"));
    REQUIRE(waitIdle(vk.queue) == VK_SUCCESS);
    vk.vkDestroyCommandPool(vk.device, pool, nullptr);
}

constexpr BindingInfo kResolveBindings[] = {
    {.binding = 0, .kind = BindingKind::constants},
    {.binding = 1,
     .kind = BindingKind::sampledImage,
     .format = VK_FORMAT_D32_SFLOAT,
     .array = true,
     .sampler = SamplerKind::nearestBorderFar,
     .powerOfTwo = true},
    {.binding = 2, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT_S8_UINT, .stencil = true},
    {.binding = 3, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT_S8_UINT},
};
constexpr BindingInfo kListBindings[] = {
    {.binding = 0, .kind = BindingKind::constants},
    {.binding = 1, .kind = BindingKind::storageBuffer},
    {.binding = 2, .kind = BindingKind::storageBuffer},
    {.binding = 4, .kind = BindingKind::storageImage, .format = VK_FORMAT_R32_UINT},
};

void describeAll(PipelineStore& store)
{
    GraphicsPipelineInfo casters{.name = "warmup.casters", .vertex = {.code = k_warmup_casters_vert}};
    casters.pushBytes = 64;
    casters.vertexStride = 12;
    casters.casters = casters.transforms = casters.depthTest = casters.depthWrite = true;
    casters.depthCompare = VK_COMPARE_OP_LESS;
    casters.depthFormat = VK_FORMAT_D32_SFLOAT;
    store.graphics(casters);
    GraphicsPipelineInfo resolve{.name = "warmup.resolve", .vertex = {.code = k_shared_fullscreen_vert}};
    resolve.fragment = {k_warmup_resolve_frag, 1, {2}};
    resolve.bindings = kResolveBindings;
    resolve.blendScale = true;
    resolve.colorFormat = VK_FORMAT_R8_UNORM;
    resolve.depthFormat = VK_FORMAT_D32_SFLOAT_S8_UINT;
    resolve.stencil.enable = true;
    store.graphics(resolve);
    ComputePipelineInfo list{.name = "warmup.list", .compute = {.code = k_warmup_list_comp}};
    list.bindings = kListBindings;
    list.pushBytes = 4;
    store.compute(list);
}

} // namespace

TEST_CASE("pipelines of every kind are created and tried, twice in a row, and validation is silent")
{
    Result<std::unique_ptr<DeviceTable>> table = loadDeviceTable(host.info());
    REQUIRE(table);
    const DeviceTable& vk = **table;
    const std::string device = vk.properties.deviceName;
    const std::string validation = host.validated ? ", validated" : ", no validation layer";
    MESSAGE(device, validation);
    {
        DeviceMemory memory(vk, 64 * kMiB, {});
        SamplerSet samplers(vk);
        REQUIRE(samplers.create());
        PipelineStore store(vk, memory, samplers);
        store.setWarmupSlopeBias(1.0f);
        for (std::uint32_t owner : {0u, 1u}) { // the second starts from stand-ins that were used before
            store.setOwner(owner);
            describeAll(store);
            if (owner == 1) {
                ComputePipelineInfo other{.name = "warmup.other", .compute = {.code = k_warmup_list_comp}};
                other.bindings = kListBindings;
                other.pushBytes = 4;
                store.compute(other);
            }
            while (store.createNext(owner)) {
            }
            REQUIRE_MESSAGE(store.created(owner), store.failure(owner));
            execute(vk, [&](VkCommandBuffer cmd) { REQUIRE(store.recordWarmupDraws(cmd, owner)); });
            CHECK(store.ready(owner));
        }
        CHECK(memory.used() > 0);
    }
    CHECK(vk.pipelinesMade == 4);
    for (const std::string& complaint : complaints)
        FAIL_CHECK(complaint);
}

int main(int argc, char** argv)
{
    if (!host.open()) {
        std::puts("skipped: no Vulkan 1.3 device");
        host.close();
        return 77;
    }
    doctest::Context context(argc, argv);
    int result = context.run();
    host.close();
    if (result == 0 && !complaints.empty()) { // of what was left undestroyed
        std::puts(complaints.back().c_str());
        result = 1;
    }
    return result;
}
