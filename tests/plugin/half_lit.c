/* A shadow algorithm in plain C, as a plug-in: every pixel is half lit. It shows the abi, and nothing else: one raster
pass whose attachment is cleared by the callback, after a prepare pass has chosen the value. */
#include <gnomon/algorithm.h>

static const GnPluginInterface* gn;

typedef struct Work {
    GnBufferRef value;
    float shade;
} Work;

static void GN_CALL choose(GnPassContext context, void* pUserData)
{
    const Work* work = pUserData;
    float* value = gn->pfnMapped(context, work->value);
    *value = work->shade;
}

static void GN_CALL fill(GnPassContext context, VkCommandBuffer commandBuffer, const VkRect2D* pArea, void* pUserData)
{
    const Work* work = pUserData;
    const PFN_vkCmdClearAttachments clear =
        (PFN_vkCmdClearAttachments)gn->pfnGetDeviceProcAddr(gn->device, "vkCmdClearAttachments");
    const VkClearAttachment attachment = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT,
                                          .clearValue = {.color = {.float32 = {work->shade, 0, 0, 0}}}};
    const VkClearRect rect = {.rect = *pArea, .layerCount = 1};
    (void)context;
    clear(commandBuffer, 1, &attachment, 1, &rect);
}

static void GN_CALL declare(void* pAlgorithm, GnPassBuilder builder, const GnShadowTask* pTask)
{
    const GnBufferInfo bufferInfo = {
        GN_INIT(GnBufferInfo), .pName = "half_lit.value", .scope = GN_SCOPE_TASK, .size = 4, .place = GN_BUFFER_UPLOAD};
    const Work work = {.value = gn->pfnBuffer(builder, &bufferInfo), .shade = (float)pTask->pSettings[0]};
    const GnAccess chooses = {GN_INIT(GnAccess), .kind = GN_ACCESS_WRITE, .buffer = work.value};
    const GnPassInfo prepare = {GN_INIT(GnPassInfo), .pName = "half_lit.choose",
                                .kind = GN_PASS_PREPARE,
                                .scope = GN_SCOPE_TASK,
                                .accessCount = 1,
                                .pAccesses = &chooses,
                                .pfnRun = choose,
                                .pUserData = &work,
                                .userDataSize = sizeof work};
    const GnAccess fills[] = {
        {GN_INIT(GnAccess), .kind = GN_ACCESS_READ, .buffer = work.value},
        {GN_INIT(GnAccess), .kind = GN_ACCESS_WRITE, .image = pTask->visibility, .baseLayer = pTask->layer,
         .clear = VK_TRUE},
    };
    const GnPassInfo raster = {GN_INIT(GnPassInfo), .pName = "half_lit.fill",
                               .kind = GN_PASS_RASTER,
                               .scope = GN_SCOPE_TASK,
                               .accessCount = 2,
                               .pAccesses = fills,
                               .area = pTask->area,
                               .pfnRecord = fill,
                               .pUserData = &work,
                               .userDataSize = sizeof work};
    (void)pAlgorithm;
    gn->pfnPass(builder, &prepare);
    gn->pfnPass(builder, &raster);
}

const uint32_t gnPluginVersion = GN_PLUGIN_VERSION;

GnResult GN_CALL gnPluginMain(GnContext context, const GnPluginInterface* pInterface)
{
    const GnSettingInfo shade = {
        .pName = "shade", .pDescription = "Visibility of every pixel.", .minimum = 0, .maximum = 1, .value = 0.5};
    const GnAlgorithmInfo info = {GN_INIT(GnAlgorithmInfo), .pName = "half_lit",
                                  .pSource = "none",
                                  .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT,
                                  .settingCount = 1,
                                  .pSettings = &shade,
                                  .pfnDeclare = declare};
    gn = pInterface;
    return gn->pfnRegisterAlgorithm(context, &info);
}
