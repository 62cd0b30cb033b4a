// A shadow algorithm in C++, as a plug-in: every pixel is lit. The version is said in the very line that the header
// asks for.
#include <gnomon/algorithm.h>

namespace {

const GnPluginInterface* gn = nullptr;

void GN_CALL declare(void*, GnPassBuilder builder, const GnShadowTask* task)
{
    GnAccess fill{};
    fill.kind = GN_ACCESS_WRITE;
    fill.image = task->visibility;
    fill.baseLayer = task->layer;
    fill.clear = VK_TRUE;
    fill.clearValue.color.float32[0] = 1.0f;
    GnPassInfo pass{};
    pass.pName = "lit.fill";
    pass.kind = GN_PASS_RASTER;
    pass.scope = GN_SCOPE_TASK;
    pass.accessCount = 1;
    pass.pAccesses = &fill;
    pass.area = task->area;
    pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
    gn->pfnPass(builder, &pass);
}

} // namespace

const uint32_t gnPluginVersion = GN_PLUGIN_VERSION;

GnResult GN_CALL gnPluginMain(GnContext context, const GnPluginInterface* pInterface)
{
    GnAlgorithmInfo info{};
    info.pName = "lit";
    info.traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT;
    info.pfnDeclare = &declare;
    gn = pInterface;
    return gn->pfnRegisterAlgorithm(context, &info);
}
