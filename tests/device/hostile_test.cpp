// Every pipeline's first run, with constants, push constants, buffers, vertices and images that no frame would hand it:
// whatever they hold, a shader ends. Indices stay 0: what they fetch is the caller's to keep in range.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "device/hooks.hpp"
#include "sanitized.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct Pattern {
    const char* name;
    uint32_t word;
};
constexpr Pattern kPatterns[] = {
    {"zero", 0u},
    {"ones", 0xffffffffu},            // the largest count; a NaN as well
    {"largest integer", 0x7fffffffu}, // and another NaN
    {"NaN", 0x7fc00000u},
    {"infinity", std::bit_cast<uint32_t>(HUGE_VALF)},
    {"negative infinity", std::bit_cast<uint32_t>(-HUGE_VALF)},
    {"largest float", std::bit_cast<uint32_t>(3.4028235e38f)},
    {"2^24", std::bit_cast<uint32_t>(16777216.0f)}, // + 1 changes nothing
    {"one", 1u},
    {"1.0", std::bit_cast<uint32_t>(1.0f)},
    {"-1.0", std::bit_cast<uint32_t>(-1.0f)},
};

/// What the hooks write in place of what gnomon's warmups hand to Vulkan.
struct Hostile {
    uint32_t word = 0;
    VkBuffer buffer = VK_NULL_HANDLE; ///< Full of the word.
    VkDeviceSize size = 0;
    uint32_t created = 0;
    std::set<VkPipeline> executed;
} hostile;

VKAPI_ATTR void VKAPI_CALL updateSets(VkDevice device, uint32_t count, const VkWriteDescriptorSet* writes,
                                      uint32_t copies, const VkCopyDescriptorSet* copied)
{
    std::vector<VkWriteDescriptorSet> ours(writes, writes + count);
    std::deque<VkDescriptorBufferInfo> buffers;
    for (VkWriteDescriptorSet& write : ours) {
        if (write.descriptorType != VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC) continue;
        REQUIRE(write.descriptorCount == 1);
        buffers.push_back({hostile.buffer, 0, write.pBufferInfo->range});
        write.pBufferInfo = &buffers.back();
    }
    vkUpdateDescriptorSets(device, count, ours.data(), copies, copied);
}

VKAPI_ATTR void VKAPI_CALL fillBuffer(VkCommandBuffer cmd, VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size,
                                      uint32_t data)
{
    vkCmdFillBuffer(cmd, buffer, offset, size, data == 0 ? hostile.word : data);
}

VKAPI_ATTR void VKAPI_CALL pushConstants(VkCommandBuffer cmd, VkPipelineLayout layout, VkShaderStageFlags stages,
                                         uint32_t offset, uint32_t size, const void*)
{
    std::array<uint32_t, 64> words;
    words.fill(hostile.word);
    REQUIRE(size <= sizeof(words));
    vkCmdPushConstants(cmd, layout, stages, offset, size, words.data());
}

VKAPI_ATTR void VKAPI_CALL bindVertexBuffers(VkCommandBuffer cmd, uint32_t first, uint32_t count, const VkBuffer*,
                                             const VkDeviceSize* offsets)
{
    const std::vector<VkBuffer> buffers(count, hostile.buffer);
    vkCmdBindVertexBuffers(cmd, first, count, buffers.data(), offsets);
}

VKAPI_ATTR void VKAPI_CALL clearColor(VkCommandBuffer cmd, VkImage image, VkImageLayout layout,
                                      const VkClearColorValue*, uint32_t count, const VkImageSubresourceRange* ranges)
{
    VkClearColorValue value;
    std::fill(std::begin(value.uint32), std::end(value.uint32), hostile.word);
    vkCmdClearColorImage(cmd, image, layout, &value, count, ranges);
}

VKAPI_ATTR void VKAPI_CALL clearDepth(VkCommandBuffer cmd, VkImage image, VkImageLayout layout,
                                      const VkClearDepthStencilValue*, uint32_t count,
                                      const VkImageSubresourceRange* ranges)
{
    const VkClearDepthStencilValue value{(hostile.word & 1u) ? 1.0f : 0.0f, hostile.word & 255u};
    vkCmdClearDepthStencilImage(cmd, image, layout, &value, count, ranges);
}

VKAPI_ATTR VkResult VKAPI_CALL createGraphics(VkDevice device, VkPipelineCache cache, uint32_t count,
                                              const VkGraphicsPipelineCreateInfo* infos,
                                              const VkAllocationCallbacks* allocator, VkPipeline* pipelines)
{
    std::atomic_ref(hostile.created) += count; // workers create them
    return vkCreateGraphicsPipelines(device, cache, count, infos, allocator, pipelines);
}

VKAPI_ATTR VkResult VKAPI_CALL createCompute(VkDevice device, VkPipelineCache cache, uint32_t count,
                                             const VkComputePipelineCreateInfo* infos,
                                             const VkAllocationCallbacks* allocator, VkPipeline* pipelines)
{
    std::atomic_ref(hostile.created) += count;
    return vkCreateComputePipelines(device, cache, count, infos, allocator, pipelines);
}

VKAPI_ATTR void VKAPI_CALL bindPipeline(VkCommandBuffer cmd, VkPipelineBindPoint point, VkPipeline pipeline)
{
    hostile.executed.insert(pipeline);
    vkCmdBindPipeline(cmd, point, pipeline);
}

HostOptions hostileOptions(uint32_t waitLimitMs)
{
    HostOptions options;
    options.extent = {64, 36};
    options.warmUp = false;
    options.context = [waitLimitMs](GnContextCreateInfo& info) { info.waitLimitMs = waitLimitMs; };
    return hooked(options,
                  {hook("vkUpdateDescriptorSets", &updateSets), hook("vkCmdFillBuffer", &fillBuffer),
                   hook("vkCmdPushConstants", &pushConstants), hook("vkCmdBindVertexBuffers", &bindVertexBuffers),
                   hook("vkCmdClearColorImage", &clearColor), hook("vkCmdClearDepthStencilImage", &clearDepth),
                   hook("vkCreateGraphicsPipelines", &createGraphics), hook("vkCreateComputePipelines", &createCompute),
                   hook("vkCmdBindPipeline", &bindPipeline)});
}

/// Runs every pipeline once. The device may never come back from one: then the program ends here.
void runAll(Host& host, const Pattern& pattern)
{
    if (gnWarmUp(host.context) == GN_SUCCESS) return;
    std::fprintf(stderr, "with %s everywhere: %s\n", pattern.name, host.lastError().c_str());
    std::fflush(nullptr);
    std::_Exit(1);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "every pipeline of every method ends within a second, whatever it is handed")
{
    constexpr uint32_t kSecond = 1000 * kSlowness;
    const demo::Buffer buffer =
        demo::makeBuffer(device(), 64 * 1024, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    hostile.buffer = buffer.get();
    for (const Pattern& pattern : kPatterns) {
        CAPTURE(pattern.name);
        hostile.word = pattern.word;
        hostile.created = 0;
        hostile.executed.clear();
        std::ranges::fill(buffer.as<uint32_t>(), pattern.word);
        // The first time compiles.
        Host host(smallScene(), hostileOptions(&pattern == kPatterns ? 10 * kSecond : kSecond));
        runAll(host, pattern);
        CHECK(hostile.executed.size() == hostile.created);
        const std::vector<GnMethodInfo> methods = availableMethods(host.context);
        CHECK(methods.size() > 1);
        CHECK(hostile.created > methods.size());
        for (const GnMethodInfo& method : methods) {
            CAPTURE(method.pName);
            CHECK(method.ready);
        }
    }
}
