// Vulkan as a small engine wraps it: a device, memory in blocks, pipelines, barriers.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <gnomon/gnomon.h>
#include <vulkan/vulkan_raii.hpp>

namespace embed {

struct Image {
    vk::Format format = vk::Format::eUndefined;
    vk::raii::Image image = nullptr;
    vk::raii::ImageView view = nullptr;
};

inline vk::ImageSubresourceRange wholeOf(vk::Format format)
{
    using Aspect = vk::ImageAspectFlagBits;
    return {format == vk::Format::eD32Sfloat ? Aspect::eDepth : Aspect::eColor, 0, 1, 0, 1};
}

/// Everything that was written is available to everything that follows: a small engine spells its barriers alike.
inline void barrier(const vk::raii::CommandBuffer& commands, vk::Image image, vk::Format format, vk::ImageLayout from,
                    vk::ImageLayout to)
{
    constexpr auto stage = vk::PipelineStageFlagBits2::eAllCommands;
    constexpr auto write = vk::AccessFlagBits2::eMemoryWrite, read = vk::AccessFlagBits2::eMemoryRead;
    const vk::ImageMemoryBarrier2 one(stage, write, stage, read | write, from, to, VK_QUEUE_FAMILY_IGNORED,
                                      VK_QUEUE_FAMILY_IGNORED, image, wholeOf(format));
    commands.pipelineBarrier2(vk::DependencyInfo({}, {}, {}, one));
}

class Gpu {
public:
    /// The first device that gnomon runs on. \param surface Instance extensions of the window; empty: there is none.
    explicit Gpu(const std::vector<const char*>& surface)
    {
        const vk::ApplicationInfo app(nullptr, 0, nullptr, 0, VK_API_VERSION_1_3);
        instance = vk::raii::Instance(loader_, vk::InstanceCreateInfo({}, &app, {}, surface));
        GnDeviceNeeds needs{};
        for (vk::raii::PhysicalDevice& candidate : vk::raii::PhysicalDevices(instance))
            if (!*physical && gnQueryDeviceNeeds(*instance, *candidate, vkGetInstanceProcAddr, &needs) >= 0)
                physical = std::move(candidate);
        if (!*physical) throw std::runtime_error(std::string("no device: ") + needs.reason);
        const auto families = physical.getQueueFamilyProperties();
        constexpr auto wanted = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute; // gnomon has seen one
        while ((families[family].queueFlags & wanted) != wanted)
            ++family;

        extensions.assign(needs.ppOptionalExtensions, needs.ppOptionalExtensions + needs.optionalExtensionCount);
        if (!surface.empty()) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
        features13_.setSynchronization2(true).setDynamicRendering(true);
        features13_.setPNext(const_cast<void*>(needs.pOptionalFeatures)); // of those extensions
        features12_.setTimelineSemaphore(true).setPNext(&features13_);
        features12_.setBufferDeviceAddress(needs.pOptionalFeatures != nullptr);
        features.setFeatures(needs.optional).setPNext(&features12_);
        const float priority = 1.0f;
        const vk::DeviceQueueCreateInfo one({}, family, 1, &priority);
        device = vk::raii::Device(physical, vk::DeviceCreateInfo({}, one, {}, extensions, nullptr, &features));
        queue = device.getQueue(family, 0);
    }
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;

    /// One block for all images or buffers, which are bound to it. \param places Where in it each stands.
    template <typename Resource>
    vk::raii::DeviceMemory place(std::span<Resource* const> resources, vk::MemoryPropertyFlags wanted,
                                 std::vector<vk::DeviceSize>& places) const
    {
        vk::MemoryAllocateInfo info;
        uint32_t allowed = ~0u;
        for (const Resource* resource : resources) {
            const vk::MemoryRequirements need = resource->getMemoryRequirements();
            places.push_back((info.allocationSize + need.alignment - 1) / need.alignment * need.alignment);
            info.allocationSize = places.back() + need.size;
            allowed &= need.memoryTypeBits;
        }
        const auto types = physical.getMemoryProperties().memoryTypes;
        while (!(allowed >> info.memoryTypeIndex & 1) || (types[info.memoryTypeIndex].propertyFlags & wanted) != wanted)
            if (++info.memoryTypeIndex == types.size()) throw std::runtime_error("no memory type fits");
        vk::raii::DeviceMemory memory(device, info);
        for (size_t i = 0; i < places.size(); ++i)
            resources[i]->bindMemory(*memory, places[i]);
        return memory;
    }

    /// \param fragment Empty: depth alone is drawn. \param depth Tested and written, reversed.
    vk::raii::Pipeline createPipeline(vk::PipelineLayout layout, std::span<const uint32_t> vertex,
                                      std::span<const uint32_t> fragment, const std::vector<vk::Format>& colours,
                                      vk::Format depth, bool positions, bool blended) const
    {
        using Stage = vk::ShaderStageFlagBits;
        std::vector<vk::raii::ShaderModule> modules;
        std::vector<vk::PipelineShaderStageCreateInfo> stages;
        for (const auto& [code, stage] : {std::pair(vertex, Stage::eVertex), std::pair(fragment, Stage::eFragment)}) {
            if (code.empty()) continue;
            modules.emplace_back(device, vk::ShaderModuleCreateInfo({}, code.size_bytes(), code.data()));
            stages.emplace_back(vk::PipelineShaderStageCreateFlags(), stage, *modules.back(), "main");
        }
        const vk::VertexInputBindingDescription binding(0, 3 * sizeof(float));
        const vk::VertexInputAttributeDescription attribute(0, 0, vk::Format::eR32G32B32Sfloat, 0);
        const vk::PipelineVertexInputStateCreateInfo vertices({}, positions, &binding, positions, &attribute);
        const vk::PipelineInputAssemblyStateCreateInfo assembly({}, vk::PrimitiveTopology::eTriangleList);
        const vk::PipelineViewportStateCreateInfo viewport({}, 1, nullptr, 1, nullptr);
        vk::PipelineRasterizationStateCreateInfo raster;
        raster.setLineWidth(1.0f);
        const vk::PipelineMultisampleStateCreateInfo samples;
        const bool hasDepth = depth != vk::Format::eUndefined;
        const vk::PipelineDepthStencilStateCreateInfo tests({}, hasDepth, hasDepth, vk::CompareOp::eGreater);
        const std::vector<vk::PipelineColorBlendAttachmentState> targets(
            colours.size(),
            {blended, vk::BlendFactor::eSrcAlpha, vk::BlendFactor::eOneMinusSrcAlpha, vk::BlendOp::eAdd,
             vk::BlendFactor::eZero, vk::BlendFactor::eOne, vk::BlendOp::eAdd, vk::ColorComponentFlags(0xf)});
        const vk::PipelineColorBlendStateCreateInfo blend({}, false, vk::LogicOp::eCopy, targets);
        const std::array states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
        const vk::PipelineDynamicStateCreateInfo dynamic({}, states);
        const vk::PipelineRenderingCreateInfo rendering(0, colours, depth);
        vk::GraphicsPipelineCreateInfo info({}, stages, &vertices, &assembly, nullptr, &viewport, &raster, &samples,
                                            &tests, &blend, &dynamic, layout);
        return {device, nullptr, info.setPNext(&rendering)};
    }

    /// Submits what is recorded, and waits for it.
    template <typename Record>
    void runOnce(Record&& record) const
    {
        const vk::raii::CommandPool pool(device, vk::CommandPoolCreateInfo({}, family));
        const vk::raii::CommandBuffers one(device, {*pool, vk::CommandBufferLevel::ePrimary, 1});
        one[0].begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        record(*one[0]);
        one[0].end();
        queue.submit(vk::SubmitInfo({}, {}, *one[0]));
        queue.waitIdle();
    }

private:
    vk::raii::Context loader_;
    vk::PhysicalDeviceVulkan13Features features13_;
    vk::PhysicalDeviceVulkan12Features features12_;

public:
    vk::PhysicalDeviceFeatures2 features; // the chain that the device was created with
    std::vector<const char*> extensions;
    vk::raii::Instance instance = nullptr;
    vk::raii::PhysicalDevice physical = nullptr;
    vk::raii::Device device = nullptr;
    vk::raii::Queue queue = nullptr;
    uint32_t family = 0;
};

} // namespace embed
