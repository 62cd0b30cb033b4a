#pragma once
// Passes on the CPU without a device: the executor of one frame over a Vulkan that does nothing, with buffers, threads
// and counters as they are.
#include <cstdint>
#include <cstring>
#include <span>

#include <doctest/doctest.h>

#include "runtime/passes/pass_executor.hpp"
#include "runtime/vk_stub.hpp"

namespace gnomon::test {

class HostFrame {
public:
    explicit HostFrame(RayScene& rays, std::uint32_t threads = 2) : jobs_(nullptr, nullptr, threads), rays_(rays)
    {
        // What the executor calls besides: it has nothing to submit.
        vulkan_.table.vkCreateSemaphore = [](VkDevice, const VkSemaphoreCreateInfo*, const VkAllocationCallbacks*,
                                             VkSemaphore*) { return VK_SUCCESS; };
        vulkan_.table.vkCreateCommandPool = [](VkDevice, const VkCommandPoolCreateInfo*, const VkAllocationCallbacks*,
                                               VkCommandPool*) { return VK_SUCCESS; };
        vulkan_.table.vkResetCommandPool = [](VkDevice, VkCommandPool, VkCommandPoolResetFlags) { return VK_SUCCESS; };
        REQUIRE(executor_.create(1));
        pool_.begin(1, 0);
        graph_.reset();
        graph_.beginTask({.view = 1, .light = 1, .method = 0}, nullptr, {}, {});
    }

    /// A readback buffer that holds these.
    template <typename T>
    BufferId holding(const char* name, std::span<const T> values)
    {
        const BufferId id = buffer(name, values.size_bytes(), BufferPlace::readback);
        std::memcpy(graph_.buffer(id).gpu.mapped, values.data(), values.size_bytes());
        return id;
    }
    BufferId buffer(const char* name, std::size_t size, BufferPlace place = BufferPlace::upload)
    {
        return PassBuilder(graph_).transient(BufferInfo{.name = name, .size = size, .place = place});
    }
    template <typename T>
    std::span<const T> content(BufferId id) const
    {
        const GpuBuffer& gpu = graph_.buffer(id).gpu;
        return {reinterpret_cast<const T*>(gpu.mapped), static_cast<std::size_t>(gpu.size) / sizeof(T)};
    }

    /// Runs `body(const HostContext&)` as the frame's only pass. @return rays it traced.
    template <typename Body>
    std::uint64_t run(const Body& body)
    {
        const Body* what = &body;
        PassBuilder(graph_).prepare("test.host").run([what](HostContext& host) { (*what)(host); });
        REQUIRE(!graph_.endTask());
        REQUIRE(executor_.begin({.frame = 1, .scene = &scene_, .rays = &rays_, .waits = {}, .signals = {}}));
        REQUIRE(executor_.record(VK_NULL_HANDLE));
        return executor_.counters().rays;
    }
    FrameArena& arena() { return arena_; }

private:
    StubVulkan vulkan_;
    DeviceMemory memory_{vulkan_.table, VkDeviceSize{1} << 30, {}};
    SamplerSet samplers_{vulkan_.table};
    PipelineStore pipelines_{vulkan_.table, memory_, samplers_};
    JobSystem jobs_;
    RayScene& rays_;
    FrameArena arena_;
    ResourcePool pool_{memory_};
    PassGraph graph_{pool_, arena_};
    PassExecutor executor_{vulkan_.table, memory_, pipelines_, samplers_, jobs_, pool_, graph_, GnContextCreateInfo{}};
    SceneRegistry::Snapshot scene_;
};

} // namespace gnomon::test
