#include "runtime/vk_stub.hpp"

#include <algorithm>
#include <cstring>

namespace gnomon::test {
namespace {

StubVulkan* installed = nullptr;

template <typename Handle>
std::uint64_t bitsOf(Handle handle)
{
    std::uint64_t bits = 0;
    std::memcpy(&bits, &handle, sizeof(handle));
    return bits;
}

template <typename Handle>
Handle handleOf(std::uint64_t bits)
{
    Handle handle{};
    std::memcpy(&handle, &bits, sizeof(handle));
    return handle;
}

VkResult VKAPI_PTR allocateMemory(VkDevice, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks*,
                                  VkDeviceMemory* out)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails("vkAllocateMemory")) return stub.failure;
    const bool full = stub.fullTypes >> info->memoryTypeIndex & 1;
    if (full || stub.liveBytes() + info->allocationSize > stub.heapSize) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const std::uint64_t handle = stub.make("memory");
    const std::lock_guard lock(stub.mutex);
    stub.memories[handle] = {info->allocationSize, info->memoryTypeIndex, nullptr};
    *out = handleOf<VkDeviceMemory>(handle);
    return VK_SUCCESS;
}

void VKAPI_PTR freeMemory(VkDevice, VkDeviceMemory memory, const VkAllocationCallbacks*)
{
    StubVulkan& stub = StubVulkan::current();
    stub.destroy(bitsOf(memory), "memory");
    const std::lock_guard lock(stub.mutex);
    for (const auto& [object, binding] : stub.bindings)
        if (binding.memory == bitsOf(memory)) stub.faults.push_back("memory freed under an object bound to it");
    std::free(stub.memories[bitsOf(memory)].bytes);
    stub.memories.erase(bitsOf(memory));
}

VkResult VKAPI_PTR mapMemory(VkDevice, VkDeviceMemory memory, VkDeviceSize, VkDeviceSize, VkMemoryMapFlags, void** out)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails("vkMapMemory")) return stub.failure;
    const std::lock_guard lock(stub.mutex);
    StubVulkan::Memory& entry = stub.memories[bitsOf(memory)];
    if (entry.bytes) stub.faults.push_back("memory mapped twice");
    entry.bytes = std::calloc(1, entry.size); // untouched pages cost nothing
    *out = entry.bytes;
    return VK_SUCCESS;
}

/// Create and destroy functions that differ in nothing but their types and names.
template <typename Info, typename Handle, const auto& Kind>
VkResult VKAPI_PTR createObject(VkDevice, const Info*, const VkAllocationCallbacks*, Handle* out)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails(Kind)) return stub.failure;
    *out = handleOf<Handle>(stub.make(Kind));
    return VK_SUCCESS;
}
template <typename Handle, const auto& Kind>
void VKAPI_PTR destroyObject(VkDevice, Handle handle, const VkAllocationCallbacks*)
{
    StubVulkan::current().destroy(bitsOf(handle), Kind);
}
template <typename Info, const auto& Kind>
VkResult VKAPI_PTR createPipelines(VkDevice, VkPipelineCache cache, std::uint32_t count, const Info*,
                                   const VkAllocationCallbacks*, VkPipeline* out)
{
    StubVulkan& stub = StubVulkan::current();
    stub.lastPipelineCache = cache;
    std::fill(out, out + count, VkPipeline(VK_NULL_HANDLE));
    if (stub.fails(Kind)) return stub.failure;
    for (std::uint32_t i = 0; i < count; ++i)
        out[i] = handleOf<VkPipeline>(stub.make(Kind));
    return VK_SUCCESS;
}

constexpr char kView[] = "view", kSampler[] = "sampler", kModule[] = "module", kLayout[] = "pipelineLayout",
               kCache[] = "cache", kPipeline[] = "pipeline", kSetLayout[] = "setLayout", kPool[] = "pool",
               kStructure[] = "structure", kQueries[] = "queries";

VkResult VKAPI_PTR createImage(VkDevice, const VkImageCreateInfo* info, const VkAllocationCallbacks*, VkImage* out)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails("vkCreateImage")) return stub.failure;
    const std::uint64_t handle = stub.make("image");
    const std::lock_guard lock(stub.mutex);
    stub.sizes[handle] = VkDeviceSize(info->extent.width) * info->extent.height * info->arrayLayers * 4;
    stub.lastImage = *info;
    stub.lastImageFamilies.assign(info->pQueueFamilyIndices, info->pQueueFamilyIndices + info->queueFamilyIndexCount);
    *out = handleOf<VkImage>(handle);
    return VK_SUCCESS;
}
void VKAPI_PTR destroyImage(VkDevice, VkImage image, const VkAllocationCallbacks*)
{
    StubVulkan::current().destroy(bitsOf(image), "image");
}
VkResult VKAPI_PTR createBuffer(VkDevice, const VkBufferCreateInfo* info, const VkAllocationCallbacks*, VkBuffer* out)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails("vkCreateBuffer")) return stub.failure;
    const std::uint64_t handle = stub.make("buffer");
    const std::lock_guard lock(stub.mutex);
    stub.sizes[handle] = info->size;
    *out = handleOf<VkBuffer>(handle);
    return VK_SUCCESS;
}
void VKAPI_PTR destroyBuffer(VkDevice, VkBuffer buffer, const VkAllocationCallbacks*)
{
    StubVulkan::current().destroy(bitsOf(buffer), "buffer");
}

void needsOf(std::uint64_t object, VkMemoryRequirements2* out)
{
    StubVulkan& stub = StubVulkan::current();
    const std::lock_guard lock(stub.mutex);
    const VkDeviceSize alignment = stub.alignment;
    const VkDeviceSize size = (stub.sizes[object] + alignment - 1) / alignment * alignment;
    stub.sizes[object] = size;
    out->memoryRequirements = {size, alignment, (1u << stub.table.memory.memoryTypeCount) - 1};
}
void VKAPI_PTR imageNeeds(VkDevice, const VkImageMemoryRequirementsInfo2* info, VkMemoryRequirements2* out)
{
    needsOf(bitsOf(info->image), out);
}
void VKAPI_PTR bufferNeeds(VkDevice, const VkBufferMemoryRequirementsInfo2* info, VkMemoryRequirements2* out)
{
    needsOf(bitsOf(info->buffer), out);
}
VkResult VKAPI_PTR bindImage(VkDevice, std::uint32_t, const VkBindImageMemoryInfo* info)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails("vkBindImageMemory2")) return stub.failure;
    stub.bind(bitsOf(info->image), bitsOf(info->memory), info->memoryOffset, stub.sizes[bitsOf(info->image)]);
    return VK_SUCCESS;
}
VkResult VKAPI_PTR bindBuffer(VkDevice, std::uint32_t, const VkBindBufferMemoryInfo* info)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails("vkBindBufferMemory2")) return stub.failure;
    stub.bind(bitsOf(info->buffer), bitsOf(info->memory), info->memoryOffset, stub.sizes[bitsOf(info->buffer)]);
    return VK_SUCCESS;
}

VkResult VKAPI_PTR allocateSets(VkDevice, const VkDescriptorSetAllocateInfo*, VkDescriptorSet* out)
{
    StubVulkan& stub = StubVulkan::current();
    if (stub.fails("vkAllocateDescriptorSets")) return stub.failure;
    const std::lock_guard lock(stub.mutex);
    *out = handleOf<VkDescriptorSet>(stub.nextHandle++); // freed with their pool, so not in the books
    return VK_SUCCESS;
}
void VKAPI_PTR updateSets(VkDevice, std::uint32_t, const VkWriteDescriptorSet*, std::uint32_t,
                          const VkCopyDescriptorSet*)
{
}

void VKAPI_PTR getProperties(VkPhysicalDevice, VkPhysicalDeviceProperties2* out)
{
    out->properties = StubVulkan::current().table.properties;
    out->properties.apiVersion = StubVulkan::current().deviceVersion;
    std::strcpy(out->properties.deviceName, "stub");
}
void VKAPI_PTR getMemory(VkPhysicalDevice, VkPhysicalDeviceMemoryProperties2* out)
{
    out->memoryProperties = StubVulkan::current().table.memory;
    auto* budget = static_cast<VkPhysicalDeviceMemoryBudgetPropertiesEXT*>(out->pNext);
    if (!budget || budget->sType != VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT) return;
    for (std::uint32_t i = 0; i < out->memoryProperties.memoryHeapCount; ++i) // the first is half full, others are free
        budget->heapBudget[i] = out->memoryProperties.memoryHeaps[i].size * (i == 0 ? 1 : 4) / 2;
}
void VKAPI_PTR getFormat(VkPhysicalDevice, VkFormat format, VkFormatProperties2* out)
{
    const bool absent = format == StubVulkan::current().absentFormat;
    out->formatProperties.optimalTilingFeatures = absent ? 0 : ~VkFormatFeatureFlags{0};
}
void VKAPI_PTR getFamilies(VkPhysicalDevice, std::uint32_t* count, VkQueueFamilyProperties2* out)
{
    *count = 1;
    if (!out) return;
    out->queueFamilyProperties.queueFlags = StubVulkan::current().queueFlags;
    out->queueFamilyProperties.timestampValidBits = 48;
}
void VKAPI_PTR getFeatures(VkPhysicalDevice, VkPhysicalDeviceFeatures2* out)
{
    const StubVulkan& stub = StubVulkan::current();
    out->features = stub.deviceFeatures;
    for (auto* at = static_cast<VkBaseOutStructure*>(out->pNext); at; at = at->pNext) {
        void* features = at;
        if (at->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES) {
            static_cast<VkPhysicalDeviceVulkan13Features*>(features)->dynamicRendering = stub.hasDynamicRendering;
            static_cast<VkPhysicalDeviceVulkan13Features*>(features)->synchronization2 = VK_TRUE;
        } else if (at->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES) {
            static_cast<VkPhysicalDeviceVulkan12Features*>(features)->timelineSemaphore = VK_TRUE;
            static_cast<VkPhysicalDeviceVulkan12Features*>(features)->bufferDeviceAddress = stub.hasBufferDeviceAddress;
        } else if (at->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR) {
            static_cast<VkPhysicalDeviceAccelerationStructureFeaturesKHR*>(features)->accelerationStructure = VK_TRUE;
        } else if (at->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR) {
            static_cast<VkPhysicalDeviceRayQueryFeaturesKHR*>(features)->rayQuery = stub.hasRayQueries;
        }
    }
}
VkResult VKAPI_PTR getExtensions(VkPhysicalDevice, const char*, std::uint32_t* count, VkExtensionProperties* out)
{
    const std::vector<const char*>& names = StubVulkan::current().deviceExtensions;
    *count = static_cast<std::uint32_t>(names.size());
    for (std::size_t i = 0; out && i < names.size(); ++i)
        std::strcpy(out[i].extensionName, names[i]);
    return VK_SUCCESS;
}
void VKAPI_PTR neverCalled() {}

PFN_vkVoidFunction VKAPI_PTR getDeviceProcAddr(VkDevice, const char* name)
{
    return StubVulkan::current().absentFunction == name ? nullptr : &neverCalled;
}

/// Commands are counted by name; Args follow from the function pointer's type.
template <const auto& Name, typename... Args>
void VKAPI_PTR countCommand(Args...)
{
    StubVulkan::current().count(Name);
}
template <const auto& Name, typename... Args>
void setCommand(void(VKAPI_PTR*& slot)(Args...))
{
    slot = &countCommand<Name, Args...>;
}

constexpr char kBegin[] = "begin", kEnd[] = "end", kBarrier[] = "barrier", kDraw[] = "draw", kIndexed[] = "drawIndexed",
               kDispatch[] = "dispatch", kClear[] = "clear", kFill[] = "fill", kOther[] = "other";

void setCommands(DeviceTable& table)
{
    setCommand<kBegin>(table.vkCmdBeginRendering);
    setCommand<kEnd>(table.vkCmdEndRendering);
    setCommand<kBarrier>(table.vkCmdPipelineBarrier2);
    setCommand<kDraw>(table.vkCmdDraw);
    setCommand<kIndexed>(table.vkCmdDrawIndexed);
    setCommand<kDispatch>(table.vkCmdDispatch);
    setCommand<kClear>(table.vkCmdClearColorImage);
    setCommand<kClear>(table.vkCmdClearDepthStencilImage);
    setCommand<kFill>(table.vkCmdFillBuffer);
    setCommand<kOther>(table.vkCmdBindPipeline);
    setCommand<kOther>(table.vkCmdBindDescriptorSets);
    setCommand<kOther>(table.vkCmdPushConstants);
    setCommand<kOther>(table.vkCmdSetViewport);
    setCommand<kOther>(table.vkCmdSetScissor);
    setCommand<kOther>(table.vkCmdBindVertexBuffers);
    setCommand<kOther>(table.vkCmdBindIndexBuffer);
    setCommand<kOther>(table.vkCmdSetCullMode);
    setCommand<kOther>(table.vkCmdSetFrontFace);
    setCommand<kOther>(table.vkCmdSetDepthBias);
}

VkDeviceAddress VKAPI_PTR bufferAddress(VkDevice, const VkBufferDeviceAddressInfo* info)
{
    return bitsOf(info->buffer) << 20;
}
VkDeviceAddress VKAPI_PTR structureAddress(VkDevice, const VkAccelerationStructureDeviceAddressInfoKHR* info)
{
    return bitsOf(info->accelerationStructure) << 20;
}
void VKAPI_PTR buildSizes(VkDevice, VkAccelerationStructureBuildTypeKHR,
                          const VkAccelerationStructureBuildGeometryInfoKHR*, const std::uint32_t* count,
                          VkAccelerationStructureBuildSizesInfoKHR* out)
{
    out->accelerationStructureSize = out->buildScratchSize = out->updateScratchSize = 64 + 64 * VkDeviceSize{*count};
}

VkResult VKAPI_PTR queryResults(VkDevice, VkQueryPool, std::uint32_t, std::uint32_t, std::size_t, void* out,
                                VkDeviceSize, VkQueryResultFlags)
{
    const std::uint64_t size = StubVulkan::current().compactSize;
    if (size == 0) return VK_NOT_READY;
    std::memcpy(out, &size, sizeof(size));
    return VK_SUCCESS;
}

void setObjects(DeviceTable& table)
{
    table.vkGetPhysicalDeviceFormatProperties2 = &getFormat;
    table.vkAllocateMemory = &allocateMemory;
    table.vkFreeMemory = &freeMemory;
    table.vkMapMemory = &mapMemory;
    table.vkCreateImage = &createImage;
    table.vkDestroyImage = &destroyImage;
    table.vkCreateBuffer = &createBuffer;
    table.vkDestroyBuffer = &destroyBuffer;
    table.vkGetImageMemoryRequirements2 = &imageNeeds;
    table.vkGetBufferMemoryRequirements2 = &bufferNeeds;
    table.vkBindImageMemory2 = &bindImage;
    table.vkBindBufferMemory2 = &bindBuffer;
    table.vkAllocateDescriptorSets = &allocateSets;
    table.vkUpdateDescriptorSets = &updateSets;
    table.vkCreateImageView = &createObject<VkImageViewCreateInfo, VkImageView, kView>;
    table.vkDestroyImageView = &destroyObject<VkImageView, kView>;
    table.vkCreateSampler = &createObject<VkSamplerCreateInfo, VkSampler, kSampler>;
    table.vkDestroySampler = &destroyObject<VkSampler, kSampler>;
    table.vkCreateShaderModule = &createObject<VkShaderModuleCreateInfo, VkShaderModule, kModule>;
    table.vkDestroyShaderModule = &destroyObject<VkShaderModule, kModule>;
    table.vkCreatePipelineLayout = &createObject<VkPipelineLayoutCreateInfo, VkPipelineLayout, kLayout>;
    table.vkDestroyPipelineLayout = &destroyObject<VkPipelineLayout, kLayout>;
    table.vkCreatePipelineCache = &createObject<VkPipelineCacheCreateInfo, VkPipelineCache, kCache>;
    table.vkDestroyPipelineCache = &destroyObject<VkPipelineCache, kCache>;
    table.vkCreateDescriptorSetLayout =
        &createObject<VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout, kSetLayout>;
    table.vkDestroyDescriptorSetLayout = &destroyObject<VkDescriptorSetLayout, kSetLayout>;
    table.vkCreateDescriptorPool = &createObject<VkDescriptorPoolCreateInfo, VkDescriptorPool, kPool>;
    table.vkDestroyDescriptorPool = &destroyObject<VkDescriptorPool, kPool>;
    table.vkCreateGraphicsPipelines = &createPipelines<VkGraphicsPipelineCreateInfo, kPipeline>;
    table.vkCreateComputePipelines = &createPipelines<VkComputePipelineCreateInfo, kPipeline>;
    table.vkDestroyPipeline = &destroyObject<VkPipeline, kPipeline>;
}

} // namespace

StubVulkan::StubVulkan()
{
    installed = this;
    setObjects(table);
    setCommands(table);
    table.properties.limits.maxImageDimension2D = 16384;
    VkPhysicalDeviceLimits& limits = table.properties.limits; // what every device has
    limits.maxImageArrayLayers = 256;
    limits.maxPerStageDescriptorUniformBuffers = 12;
    limits.maxDescriptorSetUniformBuffersDynamic = 8;
    limits.maxPerStageDescriptorSampledImages = limits.maxPerStageDescriptorSamplers = 16;
    limits.maxPerStageDescriptorStorageImages = limits.maxPerStageDescriptorStorageBuffers = 4;
    limits.maxPerStageResources = 128;
    setMemoryTypes({VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                    VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT},
                   {VkDeviceSize(2) << 30}, {0});
}

void StubVulkan::addRays()
{
    table.rayQueryMissing = nullptr;
    table.scratchAlignment = 256;
    table.vkGetBufferDeviceAddress = &bufferAddress;
    table.vkGetAccelerationStructureDeviceAddressKHR = &structureAddress;
    table.vkGetAccelerationStructureBuildSizesKHR = &buildSizes;
    table.vkCreateAccelerationStructureKHR =
        &createObject<VkAccelerationStructureCreateInfoKHR, VkAccelerationStructureKHR, kStructure>;
    table.vkDestroyAccelerationStructureKHR = &destroyObject<VkAccelerationStructureKHR, kStructure>;
    table.vkCreateQueryPool = &createObject<VkQueryPoolCreateInfo, VkQueryPool, kQueries>;
    table.vkDestroyQueryPool = &destroyObject<VkQueryPool, kQueries>;
    table.vkGetQueryPoolResults = &queryResults;
    setCommand<kOther>(table.vkCmdBuildAccelerationStructuresKHR);
}

StubVulkan::~StubVulkan()
{
    for (auto& [handle, memory] : memories)
        std::free(memory.bytes);
    installed = nullptr;
}

StubVulkan& StubVulkan::current()
{
    return *installed;
}

void StubVulkan::setMemoryTypes(const std::vector<VkMemoryPropertyFlags>& types, const std::vector<VkDeviceSize>& heaps,
                                const std::vector<std::uint32_t>& heapOfType)
{
    VkPhysicalDeviceMemoryProperties& memory = table.memory;
    memory = {};
    memory.memoryTypeCount = static_cast<std::uint32_t>(types.size());
    memory.memoryHeapCount = static_cast<std::uint32_t>(heaps.size());
    for (std::size_t i = 0; i < heaps.size(); ++i)
        memory.memoryHeaps[i] = {heaps[i], 0};
    for (std::size_t i = 0; i < types.size(); ++i) {
        memory.memoryTypes[i] = {types[i], heapOfType[i]};
        if (types[i] & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)
            memory.memoryHeaps[heapOfType[i]].flags = VK_MEMORY_HEAP_DEVICE_LOCAL_BIT;
    }
}

bool StubVulkan::fails(const char* call)
{
    const std::lock_guard lock(mutex);
    ++counts[call];
    return fallibleCalls++ == failAt;
}

void StubVulkan::count(const char* call)
{
    const std::lock_guard lock(mutex);
    ++counts[call];
}

std::uint64_t StubVulkan::make(const char* kind)
{
    const std::lock_guard lock(mutex);
    objects[nextHandle] = kind;
    return nextHandle++;
}

void StubVulkan::destroy(std::uint64_t handle, const char* kind)
{
    const std::lock_guard lock(mutex);
    const auto found = objects.find(handle);
    if (found == objects.end() || found->second != kind) {
        faults.push_back(std::string("destroyed what is not a living ") + kind);
        return;
    }
    objects.erase(found);
    bindings.erase(handle);
}

void StubVulkan::bind(std::uint64_t object, std::uint64_t memory, VkDeviceSize offset, VkDeviceSize size)
{
    const std::lock_guard lock(mutex);
    const auto found = memories.find(memory);
    if (found == memories.end()) {
        faults.push_back("bound to memory that is not alive");
        return;
    }
    if (offset % alignment) faults.push_back("bound at an unaligned offset");
    if (offset + size > found->second.size) faults.push_back("bound past the end of the memory");
    for (const auto& [other, binding] : bindings)
        if (binding.memory == memory && offset < binding.end && binding.begin < offset + size)
            faults.push_back("two objects overlap in memory");
    bindings[object] = {memory, offset, offset + size};
}

std::size_t StubVulkan::live() const
{
    const std::lock_guard lock(mutex);
    return objects.size();
}

std::size_t StubVulkan::live(const std::string& kind) const
{
    const std::lock_guard lock(mutex);
    return static_cast<std::size_t>(
        std::count_if(objects.begin(), objects.end(), [&kind](const auto& object) { return object.second == kind; }));
}

VkDeviceSize StubVulkan::liveBytes() const
{
    const std::lock_guard lock(mutex);
    VkDeviceSize bytes = 0;
    for (const auto& [handle, memory] : memories)
        bytes += memory.size;
    return bytes;
}

std::uint32_t StubVulkan::typeOf(VkDeviceMemory memory) const
{
    return memories.at(bitsOf(memory)).type;
}

VkDeviceMemory StubVulkan::memoryOf(VkBuffer buffer) const
{
    return handleOf<VkDeviceMemory>(bindings.at(bitsOf(buffer)).memory);
}

VkDeviceMemory StubVulkan::memoryOf(VkImage image) const
{
    return handleOf<VkDeviceMemory>(bindings.at(bitsOf(image)).memory);
}

PFN_vkVoidFunction VKAPI_PTR StubVulkan::getInstanceProcAddr(VkInstance, const char* name)
{
    StubVulkan& stub = current();
    stub.loaded.insert(name);
    if (stub.absentFunction == name) return nullptr;
    const std::map<std::string, PFN_vkVoidFunction> known{
        {"vkGetPhysicalDeviceProperties2", reinterpret_cast<PFN_vkVoidFunction>(&getProperties)},
        {"vkGetPhysicalDeviceMemoryProperties2", reinterpret_cast<PFN_vkVoidFunction>(&getMemory)},
        {"vkGetPhysicalDeviceQueueFamilyProperties2", reinterpret_cast<PFN_vkVoidFunction>(&getFamilies)},
        {"vkGetPhysicalDeviceFeatures2", reinterpret_cast<PFN_vkVoidFunction>(&getFeatures)},
        {"vkGetPhysicalDeviceFormatProperties2", reinterpret_cast<PFN_vkVoidFunction>(&getFormat)},
        {"vkEnumerateDeviceExtensionProperties", reinterpret_cast<PFN_vkVoidFunction>(&getExtensions)},
        {"vkGetDeviceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(&getDeviceProcAddr)},
    };
    const auto found = known.find(name);
    return found == known.end() ? &neverCalled : found->second;
}

} // namespace gnomon::test
