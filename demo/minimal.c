/* Embedding gnomon in one screenful: a box beside the picture throws its shadow into it. The camera looks straight down
at a floor, so the depth image a renderer would draw is one number here, and a clear stands in for the drawing. Exits
with 0 if a point in the shadow is dark and one beside it is lit, 77 where there is no Vulkan device. An argument names
a rule base, such as rules/default.yaml; without one the first exact method that may be recorded serves. */
#include <stdio.h>
#include <stdlib.h>
#include <vulkan/vulkan.h>

#include "gnomon/gnomon.h"

#define CHECK(call) check((int)(call), #call)
static void check(int result, const char* call)
{
    if (result < 0) fprintf(stderr, "%s: %d\n", call, result), exit(1);
}

enum { SIZE = 64 }; /* pixels a side */
static const float kNear = 0.1f, kEyeHeight = 4.0f, kFocal = 4.0f / 1.5f; /* metres; 1.5 m of floor on each side */

/* Memory of any type (image) or of one the CPU can read (buffer), bound to whichever is not null. */
static VkDeviceMemory bindMemory(VkPhysicalDevice gpu, VkDevice device, VkImage image, VkBuffer buffer)
{
    const VkFlags flags = buffer ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT : 0;
    VkPhysicalDeviceMemoryProperties types;
    VkMemoryRequirements needs;
    vkGetPhysicalDeviceMemoryProperties(gpu, &types);
    if (buffer)
        vkGetBufferMemoryRequirements(device, buffer, &needs);
    else
        vkGetImageMemoryRequirements(device, image, &needs);
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size};
    while (!(needs.memoryTypeBits >> info.memoryTypeIndex & 1) ||
           (types.memoryTypes[info.memoryTypeIndex].propertyFlags & flags) != flags)
        ++info.memoryTypeIndex;
    VkDeviceMemory memory;
    CHECK(vkAllocateMemory(device, &info, NULL, &memory));
    CHECK(buffer ? vkBindBufferMemory(device, buffer, memory, 0) : vkBindImageMemory(device, image, memory, 0));
    return memory;
}

static void barrier(VkCommandBuffer cmd, VkImage image, VkFlags aspect, VkImageLayout from, VkImageLayout to)
{
    const VkImageMemoryBarrier b = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                    .srcAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                    .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                    .oldLayout = from, .newLayout = to, .image = image,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .subresourceRange = {aspect, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0,
                         NULL, 1, &b);
}

/* Rules are text; an installed gnomon has them in share/gnomon/rules. */
static void loadRules(GnContext context, const char* path)
{
    static char text[1 << 16]; /* bytes; the longest that ships takes a quarter */
    FILE* file = fopen(path, "rb");
    if (!file) perror(path), exit(1);
    const size_t size = fread(text, 1, sizeof text, file);
    fclose(file);
    CHECK(gnLoadRules(context, text, size, path));
}

int main(int argc, char** argv)
{
    /* A device with what gnomon needs: three features of Vulkan 1.2 and 1.3. */
    const VkApplicationInfo app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo instanceInfo = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                               .pApplicationInfo = &app};
    VkInstance instance;
    VkPhysicalDevice gpu;
    uint32_t count = 1;
    if (vkCreateInstance(&instanceInfo, NULL, &instance) < 0 ||
        vkEnumeratePhysicalDevices(instance, &count, &gpu) < 0 || count == 0)
        return 77;
    GnDeviceNeeds needs = {GN_INIT(GnDeviceNeeds)};
    CHECK(gnQueryDeviceNeeds(instance, gpu, vkGetInstanceProcAddr, &needs));
    VkPhysicalDeviceVulkan13Features f13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                            .synchronization2 = VK_TRUE, .dynamicRendering = VK_TRUE};
    VkPhysicalDeviceVulkan12Features f12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                            .pNext = &f13, .timelineSemaphore = VK_TRUE};
    const VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &f12,
                                                .features = needs.optional};
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queueInfo = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1,
                                               .pQueuePriorities = &priority}; /* family 0 draws on desktop devices */
    const VkDeviceCreateInfo deviceInfo = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .pNext = &features,
                                           .queueCreateInfoCount = 1, .pQueueCreateInfos = &queueInfo};
    VkDevice device;
    VkQueue queue;
    CHECK(vkCreateDevice(gpu, &deviceInfo, NULL, &device));
    vkGetDeviceQueue(device, 0, 0, &queue);

    /* The scene: a floor at y = 0, a box of one metre left of what the camera sees, a light from the left. */
    const GnContextCreateInfo contextInfo = {GN_INIT(GnContextCreateInfo), .instance = instance,
                                             .physicalDevice = gpu, .device = device, .queue = queue,
                                             .apiVersion = VK_API_VERSION_1_3, .pEnabledFeatures = &features,
                                             .pfnGetInstanceProcAddr = vkGetInstanceProcAddr};
    GnContext context;
    CHECK(gnCreateContext(&contextInfo, &context));
    if (argc > 1) loadRules(context, argv[1]);
    const float positions[] = {-9, 0, -9, -9, 0, 9, 9, 0, 9, 9, 0, -9, /* floor, then x in [-3, -2], z in [-.5, .5] */
                               -3, 0, -.5f, -2, 0, -.5f, -2, 1, -.5f, -3, 1, -.5f,
                               -3, 0, .5f, -2, 0, .5f, -2, 1, .5f, -3, 1, .5f};
    const uint32_t indices[] = {0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6, 8, 9, 10, 8, 10, 11, 4, 5, 9, 4, 9, 8,
                                7, 11, 10, 7, 10, 6, 4, 8, 11, 4, 11, 7, 5, 6, 10, 5, 10, 9};
    const GnMeshCreateInfo meshInfo = {GN_INIT(GnMeshCreateInfo), .pName = "floor and box", .pPositions = positions,
                                       .positionCount = 12, .pIndices = indices, .indexCount = 42};
    GnInstanceCreateInfo placedInfo = {GN_INIT(GnInstanceCreateInfo), .flags = GN_INSTANCE_STATIC_BIT};
    GnInstance placed;
    CHECK(gnCreateMesh(context, &meshInfo, &placedInfo.mesh));
    CHECK(gnCreateInstance(context, &placedInfo, &placed));
    const GnLightInfo sun = {GN_INIT(GnLightInfo), .type = GN_LIGHT_TYPE_DIRECTIONAL, .pName = "sun",
                             .direction = {2.0f, -1.0f, 0.0f}};
    const GnViewCreateInfo viewInfo = {GN_INIT(GnViewCreateInfo), .pName = "from above", .maxLights = 1};
    GnLight light;
    GnView view;
    CHECK(gnCreateLight(context, &sun, &light));
    CHECK(gnCreateView(context, &viewInfo, &view));
    CHECK(gnWarmUp(context));

    /* What the renderer brings: a depth image, here of a floor at constant distance (reversed-Z: near / distance). */
    const VkImageCreateInfo imageInfo = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D, .format = VK_FORMAT_D32_SFLOAT,
        .extent = {SIZE, SIZE, 1}, .mipLevels = 1, .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    VkImage depth;
    CHECK(vkCreateImage(device, &imageInfo, NULL, &depth));
    const VkDeviceMemory depthMemory = bindMemory(gpu, device, depth, VK_NULL_HANDLE);
    const VkImageViewCreateInfo depthViewInfo = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = depth,
                                                 .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = VK_FORMAT_D32_SFLOAT,
                                                 .subresourceRange = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1}};
    const VkBufferCreateInfo bufferInfo = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = SIZE * SIZE,
                                           .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkImageView depthView;
    VkBuffer pixels;
    CHECK(vkCreateImageView(device, &depthViewInfo, NULL, &depthView));
    CHECK(vkCreateBuffer(device, &bufferInfo, NULL, &pixels));
    const VkDeviceMemory pixelMemory = bindMemory(gpu, device, VK_NULL_HANDLE, pixels);
    const VkCommandPoolCreateInfo poolInfo = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandBufferAllocateInfo cmdInfo = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandBufferCount = 1};
    VkCommandBuffer cmd;
    CHECK(vkCreateCommandPool(device, &poolInfo, NULL, &cmdInfo.commandPool));
    CHECK(vkAllocateCommandBuffers(device, &cmdInfo, &cmd));

    /* One frame in one command buffer: depth, shadows, and a copy of the answer. */
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    const VkClearDepthStencilValue floorDepth = {kNear / kEyeHeight, 0};
    const VkImageSubresourceRange depthRange = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1};
    CHECK(vkBeginCommandBuffer(cmd, &begin));
    barrier(cmd, depth, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdClearDepthStencilImage(cmd, depth, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &floorDepth, 1, &depthRange);
    barrier(cmd, depth, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
            VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);

    const GnViewFrame viewFrame = {
        GN_INIT(GnViewFrame), .view = view, .eye = {0.0, kEyeHeight, 0.0},
        .viewFromWorld = {1, 0, 0, 0, 0, -1, 0, 1, 0},
        .projection = {kFocal, 0, 0, 0, 0, -kFocal, 0, 0, 0, 0, 0, -1, 0, 0, kNear, 0}, .depthImage = depth,
        .depthView = depthView, .depthFormat = VK_FORMAT_D32_SFLOAT, .imageExtent = {SIZE, SIZE}, .lightCount = 1,
        .pLights = &light};
    const GnFrameInfo frame = {GN_INIT(GnFrameInfo), .frame = 1, .viewCount = 1, .pViews = &viewFrame};
    GnVisibility visibility = {GN_INIT(GnVisibility)};
    GnDecision decision = {GN_INIT(GnDecision)};
    CHECK(gnCmdRenderShadows(context, cmd, &frame));
    CHECK(gnGetVisibility(context, view, &visibility));
    CHECK(gnGetDecision(context, view, light, &decision));

    const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {SIZE, SIZE, 1}};
    const VkMemoryBarrier toHost = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                    .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                    .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                                 .pCommandBuffers = &cmd};
    const uint8_t* answer;
    barrier(cmd, visibility.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
            VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vkCmdCopyImageToBuffer(cmd, visibility.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels, 1, &copy);
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &toHost, 0, NULL, 0,
                         NULL); /* a wait alone does not show the CPU what was copied */
    CHECK(vkEndCommandBuffer(cmd));
    CHECK(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE));
    CHECK(vkQueueWaitIdle(queue)); /* a renderer would wait for its frame's semaphore instead */
    CHECK(vkMapMemory(device, pixelMemory, 0, VK_WHOLE_SIZE, 0, (void**)&answer));

    /* The shadow of the box ends at x = 0: the left half of the middle row is dark, the right half lit. */
    const int inShadow = answer[SIZE / 2 * SIZE + SIZE / 4], lit = answer[SIZE / 2 * SIZE + 3 * SIZE / 4];
    printf("%s: visibility %d in the shadow, %d beside it\n", decision.pMethod ? decision.pMethod : "no method",
           inShadow, lit);
    gnDestroyContext(context);
    vkDestroyCommandPool(device, cmdInfo.commandPool, NULL);
    vkDestroyBuffer(device, pixels, NULL);
    vkDestroyImageView(device, depthView, NULL);
    vkDestroyImage(device, depth, NULL);
    vkFreeMemory(device, pixelMemory, NULL);
    vkFreeMemory(device, depthMemory, NULL);
    vkDestroyDevice(device, NULL);
    vkDestroyInstance(instance, NULL);
    return inShadow < 64 && lit > 191 ? 0 : 1;
}
