#include "device.h"

#include <stdio.h>
#include <string.h>

static VkPhysicalDeviceVulkan13Features f13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                               .synchronization2 = VK_TRUE,
                                               .dynamicRendering = VK_TRUE};
static VkPhysicalDeviceVulkan12Features f12 = {
    .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &f13, .timelineSemaphore = VK_TRUE};
static VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &f12};

static int failed(const char* call)
{
    fprintf(stderr, "%s failed\n", call);
    return 1;
}
#define TRY(call)                                                                                                      \
    if ((call) < 0) return failed(#call)

static int openDevice(ConsumerDevice* out)
{
    const VkApplicationInfo app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo instanceInfo = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                               .pApplicationInfo = &app};
    uint32_t count = 1;
    if (vkCreateInstance(&instanceInfo, NULL, &out->instance) < 0 ||
        vkEnumeratePhysicalDevices(out->instance, &count, &out->gpu) < 0 || count == 0)
        return 77;
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queueInfo = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    const VkDeviceCreateInfo deviceInfo = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                           .pNext = &features,
                                           .queueCreateInfoCount = 1,
                                           .pQueueCreateInfos = &queueInfo};
    TRY(vkCreateDevice(out->gpu, &deviceInfo, NULL, &out->device));
    vkGetDeviceQueue(out->device, 0, 0, &out->queue);
    out->pFeatures = &features;
    out->pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
    return 0;
}

static int makeDepth(ConsumerDevice* out)
{
    const VkImageCreateInfo imageInfo = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                         .imageType = VK_IMAGE_TYPE_2D,
                                         .format = VK_FORMAT_D32_SFLOAT,
                                         .extent = {CONSUMER_SIZE, CONSUMER_SIZE, 1},
                                         .mipLevels = 1,
                                         .arrayLayers = 1,
                                         .samples = VK_SAMPLE_COUNT_1_BIT,
                                         .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                                  VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    TRY(vkCreateImage(out->device, &imageInfo, NULL, &out->depth));
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(out->device, out->depth, &needs);
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size};
    while (!(needs.memoryTypeBits >> info.memoryTypeIndex & 1))
        ++info.memoryTypeIndex;
    TRY(vkAllocateMemory(out->device, &info, NULL, &out->memory));
    TRY(vkBindImageMemory(out->device, out->depth, out->memory, 0));
    const VkImageViewCreateInfo viewInfo = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                            .image = out->depth,
                                            .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                            .format = VK_FORMAT_D32_SFLOAT,
                                            .subresourceRange = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1}};
    TRY(vkCreateImageView(out->device, &viewInfo, NULL, &out->depthView));
    return 0;
}

static void toLayout(VkCommandBuffer cmd, VkImage image, VkImageLayout from, VkImageLayout to)
{
    const VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                          .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                          .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                          .oldLayout = from,
                                          .newLayout = to,
                                          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                          .image = image,
                                          .subresourceRange = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0,
                         NULL, 1, &barrier);
}

static int drawDepth(ConsumerDevice* out)
{
    const VkCommandPoolCreateInfo poolInfo = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    TRY(vkCreateCommandPool(out->device, &poolInfo, NULL, &out->pool));
    const VkCommandBufferAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = out->pool, .commandBufferCount = 1};
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    const VkClearDepthStencilValue fourMetres = {0.1f / 4.0f, 0};
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1};
    VkCommandBuffer cmd;
    TRY(vkAllocateCommandBuffers(out->device, &info, &cmd));
    TRY(vkBeginCommandBuffer(cmd, &begin));
    toLayout(cmd, out->depth, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdClearDepthStencilImage(cmd, out->depth, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &fourMetres, 1, &all);
    toLayout(cmd, out->depth, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    TRY(vkEndCommandBuffer(cmd));
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &cmd};
    TRY(vkQueueSubmit(out->queue, 1, &submit, VK_NULL_HANDLE));
    TRY(vkQueueWaitIdle(out->queue));
    return 0;
}

int consumerOpen(ConsumerDevice* out)
{
    memset(out, 0, sizeof *out);
    int result = openDevice(out);
    if (result == 0) result = makeDepth(out);
    if (result == 0) result = drawDepth(out);
    return result;
}

void consumerClose(ConsumerDevice* device)
{
    if (device->device) {
        vkDestroyCommandPool(device->device, device->pool, NULL);
        vkDestroyImageView(device->device, device->depthView, NULL);
        vkDestroyImage(device->device, device->depth, NULL);
        vkFreeMemory(device->device, device->memory, NULL);
        vkDestroyDevice(device->device, NULL);
    }
    if (device->instance) vkDestroyInstance(device->instance, NULL);
    memset(device, 0, sizeof *device);
}
