/* Runs the C snippets of docs/integration.md, which the build collects: an engine that looks down at a floor and draws
its depth by a clear, with dynamic rendering and with a render pass in turn, and asks for shadows by both entry points.
The sun changes sides from frame to frame, so that an answer that was left from the frame before is seen. Exits with 77
where there is no Vulkan device. */
#include <stdlib.h>

#include "integration_page_snippets.c"

#define CHECK(call) check((int)(call), #call)
static void check(int result, const char* call)
{
    if (result < 0) fprintf(stderr, "%s: %d\n", call, result), exit(1);
}

enum { SIZE = 64, FRAMES = 8 };                                           /* pixels a side */
static const float kNear = 0.1f, kEyeHeight = 4.0f, kFocal = 4.0f / 1.5f; /* metres; 1.5 m of floor on each side */

typedef struct Host { /* what the page leaves to the engine */
    Engine engine;
    VkCommandBuffer commands;
    VkRenderPass depthPass;
    VkFramebuffer framebuffer;
    VkBuffer pixels;
    const unsigned char* answer; /* `pixels`, mapped */
} Host;

/* Returns 0 where no device can run gnomon. */
static int start(Engine* e, Enabled* enabled)
{
    const VkApplicationInfo app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &app};
    uint32_t count = 1;
    if (vkCreateInstance(&info, NULL, &e->instance) < 0) return 0;
    if (vkEnumeratePhysicalDevices(e->instance, &count, &e->gpu) < 0 || count == 0) return 0;
    if (chooseFeatures(e, enabled) < 0) return 0;
    CHECK(createDevice(e, enabled));
    return 1;
}

/* A floor at y = 0, and a box that its matrix turns from z to -x and moves to x in [-3, -2], left of what the camera
sees. */
static void fillScene(Engine* e)
{
    static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const float turned[16] = {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, -.5f, 0, 0, 1};
    static const float floorAt[] = {-9, 0, -9, -9, 0, 9, 9, 0, 9, 9, 0, -9};
    static const float boxAt[] = {-.5f, 0, 1.5f, .5f, 0, 1.5f, .5f, 1, 1.5f, -.5f, 1, 1.5f,
                                  -.5f, 0, 2.5f, .5f, 0, 2.5f, .5f, 1, 2.5f, -.5f, 1, 2.5f};
    static const uint32_t floorOf[] = {0, 1, 2, 0, 2, 3};
    static const uint32_t boxOf[] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                     3, 7, 6, 3, 6, 2, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5};
    static const float fromTheLeft[3] = {2, -1, 0};
    GnInstance placed;
    CHECK(addCaster(e, "floor", floorAt, 4, floorOf, 6, identity, &placed));
    CHECK(addCaster(e, "box", boxAt, 8, boxOf, 36, turned, &placed));
    CHECK(addSun(e, fromTheLeft));
}

static void createPixels(Host* h, VkDeviceMemory* memory)
{
    const VkDevice device = h->engine.device;
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = SIZE * SIZE, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkPhysicalDeviceMemoryProperties types;
    VkMemoryRequirements size;
    const VkFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    CHECK(vkCreateBuffer(device, &info, NULL, &h->pixels));
    vkGetPhysicalDeviceMemoryProperties(h->engine.gpu, &types);
    vkGetBufferMemoryRequirements(device, h->pixels, &size);
    VkMemoryAllocateInfo block = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = size.size};
    while (!(size.memoryTypeBits >> block.memoryTypeIndex & 1) ||
           (types.memoryTypes[block.memoryTypeIndex].propertyFlags & mapped) != mapped)
        ++block.memoryTypeIndex;
    CHECK(vkAllocateMemory(device, &block, NULL, memory));
    CHECK(vkBindBufferMemory(device, h->pixels, *memory, 0));
    CHECK(vkMapMemory(device, *memory, 0, VK_WHOLE_SIZE, 0, (void**)&h->answer));
}

/* Of a floor at constant distance (reversed depth: near / distance). */
static void drawDepth(const Host* h, int byRenderPass)
{
    const Engine* e = &h->engine;
    const VkClearValue clear = {.depthStencil = {kNear / kEyeHeight, 0}};
    const VkRect2D area = {{0, 0}, e->size};
    if (byRenderPass) {
        const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                            .renderPass = h->depthPass,
                                            .framebuffer = h->framebuffer,
                                            .renderArea = area,
                                            .clearValueCount = 1,
                                            .pClearValues = &clear};
        vkCmdBeginRenderPass(h->commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
        vkCmdEndRenderPass(h->commands);
        return;
    }
    const VkRenderingAttachmentInfo depth = {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                             .imageView = e->depthView,
                                             .imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                                             .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .clearValue = clear};
    const VkRenderingInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO, .renderArea = area, .layerCount = 1, .pDepthAttachment = &depth};
    beforeDepthIsDrawn(h->commands, e->depth);
    vkCmdBeginRendering(h->commands, &info);
    vkCmdEndRendering(h->commands);
    beforeShadows(h->commands, e->depth);
}

static void visibilityBarrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to)
{
    const VkAccessFlags all = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    const VkImageMemoryBarrier b = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                    .srcAccessMask = all,
                                    .dstAccessMask = all,
                                    .oldLayout = from,
                                    .newLayout = to,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .image = image,
                                    .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    const VkMemoryBarrier toHost = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                    .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                    .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    const VkPipelineStageFlags stages = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    vkCmdPipelineBarrier(commands, stages, stages | VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &toHost, 0, NULL, 1, &b);
}

static void submit(const Host* h)
{
    const VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &h->commands};
    CHECK(vkEndCommandBuffer(h->commands));
    CHECK(vkQueueSubmit(h->engine.queue, 1, &info, VK_NULL_HANDLE));
    CHECK(vkQueueWaitIdle(h->engine.queue)); /* an engine waits for the frame before the last one */
}

/* Returns how many of the two pixels are wrong: one in the shadow of the box, one beside it. */
static int drawFrame(Host* h, uint64_t frame, int byRenderPass, int recorded)
{
    Engine* e = &h->engine;
    const float viewFromWorld[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -kEyeHeight, 1};
    const float clipFromView[16] = {kFocal, 0, 0, 0, 0, -kFocal, 0, 0, 0, 0, 0, -1, 0, 0, kNear, 0};
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {SIZE, SIZE, 1}};
    const int fromTheLeft = (int)(frame % 2);
    const GnLightInfo sun = {GN_INIT(GnLightInfo), .type = GN_LIGHT_TYPE_DIRECTIONAL,
                             .direction = {fromTheLeft ? 2.0f : -2.0f, -1, 0}};
    CHECK(gnUpdateLight(e->shadows, e->sun, &sun));

    CHECK(vkBeginCommandBuffer(h->commands, &begin));
    drawDepth(h, byRenderPass);
    if (!recorded) submit(h);
    GnVisibility visibility = {GN_INIT(GnVisibility)};
    const Submission submission = {frame, frame - 1, recorded ? h->commands : NULL, viewFromWorld, clipFromView};
    CHECK(renderShadows(e, &submission, &visibility));
    if (!recorded) CHECK(vkBeginCommandBuffer(h->commands, &begin));
    visibilityBarrier(h->commands, visibility.image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                      VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vkCmdCopyImageToBuffer(h->commands, visibility.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, h->pixels, 1, &copy);
    visibilityBarrier(h->commands, visibility.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                      VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    submit(h);

    /* From the left the shadow of the box ends at x = 0; from the right it leaves the picture alone. */
    const unsigned char left = h->answer[SIZE / 2 * SIZE + SIZE / 4], right = h->answer[SIZE / 2 * SIZE + 3 * SIZE / 4];
    printf("frame %d, %s, %s: visibility %d and %d\n", (int)frame, byRenderPass ? "render pass" : "dynamic rendering",
           recorded ? "recorded" : "submitted", left, right);
    return (fromTheLeft ? left > 63 : left < 192) + (right < 192);
}

int main(void)
{
    Host h = {.engine = {.size = {SIZE, SIZE}}};
    Engine* e = &h.engine;
    Enabled enabled;
    VkDeviceMemory depthMemory, pixelMemory;
    if (!start(e, &enabled)) return 77;
    CHECK(createDepth(e, &depthMemory));
    CHECK(createDepthPass(e, &h.depthPass));
    CHECK(createShadows(e, &enabled));
    fillScene(e);
    createPixels(&h, &pixelMemory);
    const VkFramebufferCreateInfo framebuffer = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                 .renderPass = h.depthPass,
                                                 .attachmentCount = 1,
                                                 .pAttachments = &e->depthView,
                                                 .width = SIZE,
                                                 .height = SIZE,
                                                 .layers = 1};
    CHECK(vkCreateFramebuffer(e->device, &framebuffer, NULL, &h.framebuffer));
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = e->queueFamily};
    VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                            .commandBufferCount = 1};
    CHECK(vkCreateCommandPool(e->device, &pool, NULL, &commands.commandPool));
    CHECK(vkAllocateCommandBuffers(e->device, &commands, &h.commands));

    int wrong = 0;
    for (uint64_t frame = 1; frame <= FRAMES; ++frame) /* every way with the sun on either side */
        wrong += drawFrame(&h, frame, frame / 4 % 2 == 0, frame / 2 % 2 == 0);

    gnDestroyContext(e->shadows);
    vkDestroyCommandPool(e->device, commands.commandPool, NULL);
    vkDestroyFramebuffer(e->device, h.framebuffer, NULL);
    vkDestroyRenderPass(e->device, h.depthPass, NULL);
    vkDestroyBuffer(e->device, h.pixels, NULL);
    vkDestroyImageView(e->device, e->depthView, NULL);
    vkDestroyImage(e->device, e->depth, NULL);
    vkFreeMemory(e->device, pixelMemory, NULL);
    vkFreeMemory(e->device, depthMemory, NULL);
    vkDestroyDevice(e->device, NULL);
    vkDestroyInstance(e->instance, NULL);
    return wrong == 0 ? 0 : 1;
}
