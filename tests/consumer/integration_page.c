/* Runs the C snippets of docs/integration.md, which the build collects: an engine that looks down at a floor and draws
its depth by a clear, with dynamic rendering and with a render pass in turn, and asks for shadows by both entry points.
The sun changes sides from frame to frame, so that an answer that was left from the frame before is seen. In the last
frames a crowd casts whose transforms lie in a buffer. Descriptors are written as the page does, under the validation
layer. Exits with 77 where there is no Vulkan device. */
#include <stdlib.h>

#include "integration_page_snippets.c"

#define CHECK(call) check((int)(call), #call)
static void check(int result, const char* call)
{
    if (result < 0) fprintf(stderr, "%s: %d\n", call, result), exit(1);
}

enum { SIZE = 64, FRAMES = 8, CROWD = 2, MORE_FRAMES = 4 }; /* pixels a side; frames without and with a crowd */
static const float kNear = 0.1f, kEyeHeight = 4.0f, kFocal = 4.0f / 1.5f; /* metres; 1.5 m of floor on each side */

typedef struct Host { /* what the page leaves to the engine */
    Engine engine;
    VkCommandBuffer commands;
    VkRenderPass depthPass;
    VkFramebuffer framebuffer;
    VkBuffer pixels, rows; /* read back; transforms of the crowd */
    VkDeviceMemory pixelMemory, rowMemory;
    const unsigned char* answer; /* `pixels`, mapped */
    VkSampler sampler;
    VkDescriptorSetLayout layouts[2];
    VkDescriptorPool descriptors;
    VkDescriptorSet sets[2]; /* of visibility, of maps */
    uint64_t mapsRevision;
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

static const float kBox[] = {-.5f, 0, 1.5f, .5f, 0, 1.5f, .5f, 1, 1.5f, -.5f, 1, 1.5f,
                             -.5f, 0, 2.5f, .5f, 0, 2.5f, .5f, 1, 2.5f, -.5f, 1, 2.5f};
static const uint32_t kBoxIndices[] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                       3, 7, 6, 3, 6, 2, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5};

/* A floor at y = 0, and a box that its matrix turns from z to -x and moves to x in [-3, -2], left of what the camera
sees. */
static void fillScene(Engine* e)
{
    static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const float turned[16] = {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, -.5f, 0, 0, 1};
    static const float floorAt[] = {-9, 0, -9, -9, 0, 9, 9, 0, 9, 9, 0, -9};
    static const uint32_t floorOf[] = {0, 1, 2, 0, 2, 3};
    static const float fromTheLeft[3] = {2, -1, 0};
    GnInstance placed;
    CHECK(addCaster(e, "floor", floorAt, 4, floorOf, 6, identity, &placed));
    CHECK(addCaster(e, "box", kBox, 8, kBoxIndices, 36, turned, &placed));
    CHECK(addSun(e, fromTheLeft));
}

static void* createMapped(const Engine* e, VkDeviceSize bytes, VkBufferUsageFlags usage, VkBuffer* buffer,
                          VkDeviceMemory* memory)
{
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
    VkPhysicalDeviceMemoryProperties types;
    VkMemoryRequirements size;
    void* at = NULL;
    const VkFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    CHECK(vkCreateBuffer(e->device, &info, NULL, buffer));
    vkGetPhysicalDeviceMemoryProperties(e->gpu, &types);
    vkGetBufferMemoryRequirements(e->device, *buffer, &size);
    VkMemoryAllocateInfo block = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = size.size};
    while (!(size.memoryTypeBits >> block.memoryTypeIndex & 1) ||
           (types.memoryTypes[block.memoryTypeIndex].propertyFlags & mapped) != mapped)
        ++block.memoryTypeIndex;
    CHECK(vkAllocateMemory(e->device, &block, NULL, memory));
    CHECK(vkBindBufferMemory(e->device, *buffer, *memory, 0));
    CHECK(vkMapMemory(e->device, *memory, 0, VK_WHOLE_SIZE, 0, &at));
    return at;
}

/* The box once more on either side of it: z in [-1.5, -0.5] and [0.5, 1.5]. */
static void fillCrowd(Host* h)
{
    static const float rows[CROWD * 12] = {0, 0, -1, -.5f, 0, 1, 0, 0, 1, 0, 0, -1,
                                           0, 0, -1, -.5f, 0, 1, 0, 0, 1, 0, 0, 1};
    static const float boxes[CROWD * 6] = {-3, 0, -1.5f, -2, 1, -.5f, -3, 0, .5f, -2, 1, 1.5f};
    const GnMeshCreateInfo info = {GN_INIT(GnMeshCreateInfo), .pName = "crowd",        .pPositions = kBox,
                                   .positionCount = 8,        .pIndices = kBoxIndices, .indexCount = 36};
    GnMesh mesh;
    GnInstance placed[CROWD];
    memcpy(createMapped(&h->engine, sizeof rows, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &h->rows, &h->rowMemory), rows,
           sizeof rows);
    CHECK(gnCreateMesh(h->engine.shadows, &info, &mesh));
    CHECK(addCrowd(&h->engine, mesh, h->rows, CROWD, boxes, placed));
}

static void createSets(Host* h)
{
    const VkDevice device = h->engine.device;
    const VkShaderStageFlags stage = VK_SHADER_STAGE_FRAGMENT_BIT;
    const VkDescriptorSetLayoutBinding visibility[] = {{1, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, stage, NULL}};
    const VkDescriptorSetLayoutBinding maps[] = {{1, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, SAMPLED, stage, NULL},
                                                 {2, VK_DESCRIPTOR_TYPE_SAMPLER, 1, stage, NULL}};
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1},
                                          {VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, SAMPLED},
                                          {VK_DESCRIPTOR_TYPE_SAMPLER, 1}};
    const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 2, .poolSizeCount = 3, .pPoolSizes = sizes};
    VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 1, .pBindings = visibility};
    CHECK(vkCreateSampler(device, &sampler, NULL, &h->sampler));
    CHECK(vkCreateDescriptorPool(device, &pool, NULL, &h->descriptors));
    CHECK(vkCreateDescriptorSetLayout(device, &layout, NULL, &h->layouts[0]));
    layout.bindingCount = 2;
    layout.pBindings = maps;
    CHECK(vkCreateDescriptorSetLayout(device, &layout, NULL, &h->layouts[1]));
    const VkDescriptorSetAllocateInfo sets = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = h->descriptors,
                                              .descriptorSetCount = 2,
                                              .pSetLayouts = h->layouts};
    CHECK(vkAllocateDescriptorSets(device, &sets, h->sets));
}

/* Returns 0 where descriptors or constants are not those of the frame. */
static int nameAll(Host* h, const GnVisibility* visibility)
{
    Engine* e = &h->engine;
    unsigned char constants[SAMPLED * GN_SAMPLED_LIGHT_SIZE] = {0}, nothing[sizeof constants] = {0};
    nameVisibility(e, h->sets[0], 1, h->sampler, visibility);
    CHECK(nameSampled(e, h->sets[1], constants, &h->mapsRevision));
    return e->revision == visibility->revision && h->mapsRevision > 0 &&
           memcmp(constants, nothing, sizeof nothing) != 0;
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

/* Returns how many of the four pixels are wrong: in the shadow of the box, beside it, and in the crowd's, if it is
there, on either side of the box's. */
static int drawFrame(Host* h, uint64_t frame, int byRenderPass, int recorded, int crowd)
{
    Engine* e = &h->engine;
    const float viewFromWorld[16] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -kEyeHeight, 1};
    const float clipFromView[16] = {kFocal, 0, 0, 0, 0, -kFocal, 0, 0, 0, 0, 0, -1, 0, 0, kNear, 0};
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {SIZE, SIZE, 1}};
    const int fromTheLeft = (int)(frame % 2);
    const GnLightInfo sun = {GN_INIT(GnLightInfo), .type = GN_LIGHT_TYPE_DIRECTIONAL, .flags = GN_LIGHT_SAMPLED_BIT,
                             .direction = {fromTheLeft ? 2.0f : -2.0f, -1, 0}};
    CHECK(gnUpdateLight(e->shadows, e->sun, &sun));

    CHECK(vkBeginCommandBuffer(h->commands, &begin));
    drawDepth(h, byRenderPass);
    if (!recorded) submit(h);
    GnVisibility visibility = {GN_INIT(GnVisibility)};
    const Submission submission = {frame, frame - 1, recorded ? h->commands : NULL, viewFromWorld, clipFromView};
    CHECK(renderShadows(e, &submission, &visibility));
    if (!nameAll(h, &visibility)) return 4;
    if (!recorded) CHECK(vkBeginCommandBuffer(h->commands, &begin));
    visibilityBarrier(h->commands, visibility.image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                      VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vkCmdCopyImageToBuffer(h->commands, visibility.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, h->pixels, 1, &copy);
    visibilityBarrier(h->commands, visibility.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                      VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    submit(h);

    /* From the left shadows end at x = 0; from the right they leave the picture alone. Rows are z, half a metre 11. */
    const unsigned char *const row = h->answer + SIZE / 2 * SIZE, *const before = row - 21 * SIZE,
                               *const after = row + 21 * SIZE;
    const unsigned char left = row[SIZE / 4], right = row[3 * SIZE / 4];
    printf("frame %d, %s, %s: visibility %d and %d, of the crowd %d and %d\n", (int)frame,
           byRenderPass ? "render pass" : "dynamic rendering", recorded ? "recorded" : "submitted", left, right,
           before[SIZE / 4], after[SIZE / 4]);
    const int crowdDark = crowd && fromTheLeft;
    return (fromTheLeft ? left > 63 : left < 192) + (right < 192) +
           (crowdDark ? before[SIZE / 4] > 63 : before[SIZE / 4] < 192) +
           (crowdDark ? after[SIZE / 4] > 63 : after[SIZE / 4] < 192);
}

int main(void)
{
    Host h = {.engine = {.size = {SIZE, SIZE}}};
    Engine* e = &h.engine;
    Enabled enabled;
    VkDeviceMemory depthMemory;
    if (!start(e, &enabled)) return 77;
    CHECK(createDepth(e, &depthMemory));
    CHECK(createDepthPass(e, &h.depthPass));
    CHECK(createShadows(e, &enabled));
    fillScene(e);
    createSets(&h);
    h.answer = createMapped(e, SIZE * SIZE, VK_BUFFER_USAGE_TRANSFER_DST_BIT, &h.pixels, &h.pixelMemory);
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
        wrong += drawFrame(&h, frame, frame / 4 % 2 == 0, frame / 2 % 2 == 0, 0);
    fillCrowd(&h);
    for (uint64_t frame = FRAMES + 1; frame <= FRAMES + MORE_FRAMES; ++frame)
        wrong += drawFrame(&h, frame, 0, frame / 2 % 2 == 0, 1);

    gnDestroyContext(e->shadows);
    vkDestroyCommandPool(e->device, commands.commandPool, NULL);
    vkDestroyFramebuffer(e->device, h.framebuffer, NULL);
    vkDestroyRenderPass(e->device, h.depthPass, NULL);
    vkDestroyDescriptorPool(e->device, h.descriptors, NULL);
    for (int i = 0; i < 2; ++i)
        vkDestroyDescriptorSetLayout(e->device, h.layouts[i], NULL);
    vkDestroySampler(e->device, h.sampler, NULL);
    vkDestroyBuffer(e->device, h.rows, NULL);
    vkDestroyBuffer(e->device, h.pixels, NULL);
    vkDestroyImageView(e->device, e->depthView, NULL);
    vkDestroyImage(e->device, e->depth, NULL);
    vkFreeMemory(e->device, h.rowMemory, NULL);
    vkFreeMemory(e->device, h.pixelMemory, NULL);
    vkFreeMemory(e->device, depthMemory, NULL);
    vkDestroyDevice(e->device, NULL);
    vkDestroyInstance(e->instance, NULL);
    return wrong == 0 ? 0 : 1;
}
