// mccool's lists of polygons as the device leaves them: what is drawn indirectly stays within the buffer.
#include <cstring>
#include <random>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Copies the command of the list that was drawn last, once its rendering has ended. One frame at a time.
struct Watch {
    PFN_vkCmdDrawIndexedIndirect drawIndexedIndirect = nullptr;
    PFN_vkCmdEndRendering endRendering = nullptr;
    VkBuffer drawn = VK_NULL_HANDLE, copy = VK_NULL_HANDLE;
} watch;

VKAPI_ATTR void VKAPI_CALL watchedDrawIndexedIndirect(VkCommandBuffer cmd, VkBuffer buffer, VkDeviceSize offset,
                                                      uint32_t count, uint32_t stride)
{
    watch.drawn = buffer;
    watch.drawIndexedIndirect(cmd, buffer, offset, count, stride);
}

VKAPI_ATTR void VKAPI_CALL watchedEndRendering(VkCommandBuffer cmd)
{
    watch.endRendering(cmd);
    if (!watch.drawn) return;
    const VkMemoryBarrier2 memory{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                  .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                  .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                  .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                  .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const VkDependencyInfo all{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &memory};
    const VkBufferCopy command{.size = sizeof(VkDrawIndexedIndirectCommand)};
    vkCmdPipelineBarrier2(cmd, &all);
    vkCmdCopyBuffer(cmd, watch.drawn, watch.copy, 1, &command);
    vkCmdPipelineBarrier2(cmd, &all);
    watch.drawn = VK_NULL_HANDLE;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL watchedGetDeviceProcAddr(VkDevice handle, const char* name)
{
    const PFN_vkVoidFunction real = vkGetDeviceProcAddr(handle, name);
    if (std::strcmp(name, "vkCmdDrawIndexedIndirect") == 0) {
        watch.drawIndexedIndirect = reinterpret_cast<PFN_vkCmdDrawIndexedIndirect>(real);
        return reinterpret_cast<PFN_vkVoidFunction>(&watchedDrawIndexedIndirect);
    }
    if (std::strcmp(name, "vkCmdEndRendering") != 0) return real;
    watch.endRendering = reinterpret_cast<PFN_vkCmdEndRendering>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&watchedEndRendering);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL watchedGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&watchedGetDeviceProcAddr);
    return vkGetInstanceProcAddr(instance, name);
}

/// A lamp over flakes the size of its map's texels, no two at one height: depth jumps on nearly every side of a cell.
Scene confetti()
{
    std::mt19937 random(7);
    const auto in = [&](float low, float high) { return std::uniform_real_distribution(low, high)(random); };
    Scene scene = smallScene();
    demo::Mesh& flakes = scene.meshes.emplace_back();
    flakes.name = "flakes";
    for (uint32_t i = 0; i < 8000; ++i) {
        const glm::vec3 at(in(-5.0f, 5.0f), in(0.2f, 3.0f), in(-5.0f, 5.0f));
        for (const glm::vec3& corner :
             {glm::vec3(-0.15f, 0.0f, -0.1f), glm::vec3(0.0f, 0.0f, 0.2f), glm::vec3(0.15f, 0.0f, -0.1f)})
            flakes.positions.push_back(at + corner);
        for (uint32_t corner = 0; corner < 3; ++corner)
            flakes.indices.push_back(3 * i + corner);
    }
    demo::Instance& instance = scene.instances.emplace_back();
    instance.name = flakes.name;
    instance.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
    instance.isStatic = true;
    return scene;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "where mccool's polygons do not fit none is drawn, and their count stays within the list")
{
    const demo::Buffer copy =
        demo::makeBuffer(device(), sizeof(VkDrawIndexedIndirectCommand), VK_BUFFER_USAGE_TRANSFER_DST_BIT, true);
    const auto& command = copy.as<VkDrawIndexedIndirectCommand>()[0];
    constexpr double kSide = 64.0;
    // The list holds as many cells as its side times `edges`, and 18 indices each in the mean (mccool.cpp): of these
    // cells, with more than that, a fourth do not fit.
    for (const double edges : {16.0, 64.0}) {
        CAPTURE(edges);
        Host host(confetti(), {.context = [](GnContextCreateInfo& info) {
                      info.pfnGetInstanceProcAddr = &watchedGetInstanceProcAddr;
                  }});
        watch.copy = copy.get();
        host.require(gnSetMethodSetting(host.context, "mccool", "resolution", kSide));
        host.require(gnSetMethodSetting(host.context, "mccool", "edges", edges));
        host.pinAll("mccool");
        host.require(host.draw());
        REQUIRE(std::string(host.decision(0).pMethod) == "mccool");
        host.pictures(); // waits
        const bool fits = edges == 64.0;
        CHECK(command.instanceCount == (fits ? 1 : 0));
        CHECK(command.indexCount <= 18 * kSide * edges);
        if (fits) CHECK(command.indexCount > 18 * kSide * 16.0); // so many that they did not fit
        watch.copy = VK_NULL_HANDLE;
    }
}
