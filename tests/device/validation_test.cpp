// Silence means something only where noise is heard.
#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// One submit that fills the buffer `times` times with nothing in between.
void fill(VkCommandPool pool, VkBuffer buffer, int times)
{
    demo::Device& d = device();
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    const VkCommandBufferAllocateInfo info{
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool, .commandBufferCount = 1};
    demo::vkCheck(vkAllocateCommandBuffers(d.handle, &info, &cmd), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    demo::vkCheck(vkBeginCommandBuffer(cmd, &begin), "vkBeginCommandBuffer");
    for (int i = 0; i < times; ++i)
        vkCmdFillBuffer(cmd, buffer, 0, VK_WHOLE_SIZE, static_cast<uint32_t>(i));
    demo::vkCheck(vkEndCommandBuffer(cmd), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo command{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = cmd};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &command};
    demo::vkCheck(vkQueueSubmit2(d.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2");
}

} // namespace

TEST_CASE("the layer hears a hazard inside a command buffer and one between two submits")
{
    demo::Device& d = device();
    const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .queueFamilyIndex = d.queueFamily};
    VkCommandPool handle = VK_NULL_HANDLE;
    demo::vkCheck(vkCreateCommandPool(d.handle, &poolInfo, nullptr, &handle), "vkCreateCommandPool");
    const demo::Buffer inside = demo::makeBuffer(d, 256, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const demo::Buffer between = demo::makeBuffer(d, 256, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    const demo::UniqueCommandPool pool(d.handle, handle);
    size_t before = d.validation.count();
    fill(pool.get(), inside.get(), 2);
    CHECK(d.validation.count() > before);
    fill(pool.get(), between.get(), 1);
    before = d.validation.count();
    fill(pool.get(), between.get(), 1);
    CHECK(d.validation.count() > before);
    vkQueueWaitIdle(d.queue); // ours, before the buffers go
}
