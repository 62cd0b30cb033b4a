// What a pass writes without loading it is undefined where it does not draw: here such attachments begin as grey, and
// no picture may show it.
#include <cstring>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

PFN_vkCmdBeginRendering beginRendering = nullptr;
bool spoils = false;

VKAPI_ATTR void VKAPI_CALL spoilingBeginRendering(VkCommandBuffer cmd, const VkRenderingInfo* info)
{
    VkRenderingInfo spoilt = *info;
    std::vector<VkRenderingAttachmentInfo> colours(info->pColorAttachments,
                                                   info->pColorAttachments + info->colorAttachmentCount);
    for (VkRenderingAttachmentInfo& colour : colours) {
        if (!spoils || colour.loadOp != VK_ATTACHMENT_LOAD_OP_DONT_CARE) continue;
        colour.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
        colour.clearValue = {.color = {{0.3f, 0.3f, 0.3f, 0.3f}}};
    }
    spoilt.pColorAttachments = colours.data();
    beginRendering(cmd, &spoilt);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL spoilingGetDeviceProcAddr(VkDevice handle, const char* name)
{
    const PFN_vkVoidFunction real = vkGetDeviceProcAddr(handle, name);
    if (std::strcmp(name, "vkCmdBeginRendering") != 0) return real;
    beginRendering = reinterpret_cast<PFN_vkCmdBeginRendering>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&spoilingBeginRendering);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL spoilingGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&spoilingGetDeviceProcAddr);
    return vkGetInstanceProcAddr(instance, name);
}

HostOptions spoilingOptions()
{
    return {.context = [](GnContextCreateInfo& info) { info.pfnGetInstanceProcAddr = &spoilingGetInstanceProcAddr; }};
}

/// One light of each kind; spot and point reach a part of the pixels.
Scene partlyLit()
{
    Scene scene = smallScene();
    scene.lights[0].outerAngle = 0.2f;
    scene.lights[0].innerAngle = 0.1f;
    scene.lights[0].radius = 0.3f;
    scene.lights.push_back(pointLight("bulb", {1.0, 3.0, 1.0}, true));
    scene.lights[1].radius = 0.3f;
    scene.lights[1].range = 2.9f;
    scene.lights.push_back(scene.lights[0]);
    scene.lights[2].name = "sun";
    scene.lights[2].kind = demo::LightKind::Directional;
    scene.lights[2].radius = 0.0f;
    return scene;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "what no pass has loaded shows in no picture, of no method")
{
    Host clean(partlyLit(), spoilingOptions()), spoilt(partlyLit(), spoilingOptions());
    for (const GnMethodInfo& method : availableMethods(clean.context)) {
        CAPTURE(std::string(method.pName));
        for (Host* host : {&clean, &spoilt}) {
            for (size_t light = 0; light < host->lights.size(); ++light)
                host->pin(light, serves(method, host->scene.lights[light].kind) ? method.pName : "ray_traced");
            spoils = host == &spoilt;
            host->require(host->draw());
            host->require(host->draw()); // what a method keeps is taken up again
            spoils = false;
        }
        CHECK(differences(clean.pictures(), spoilt.pictures()) == 0);
    }
}
