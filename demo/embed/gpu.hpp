// Vulkan as a small engine wraps it: a device, memory, pipelines, barriers.
#pragma once

#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <gnomon/gnomon.h>
#include <vulkan/vulkan_raii.hpp>

namespace embed {

struct Image {
    vk::Format format = vk::Format::eUndefined;
    vk::raii::DeviceMemory memory = nullptr; // is freed last
    vk::raii::Image image = nullptr;
    vk::raii::ImageView view = nullptr;
};

inline vk::ImageSubresourceRange wholeOf(vk::Format format)
{
    using Aspect = vk::ImageAspectFlagBits;
    return {format == vk::Format::eD32Sfloat ? Aspect::eDepth : Aspect::eColor, 0, 1, 0, 1};
}

/// What an image is used for, before a barrier or after it.
struct Use {
    vk::PipelineStageFlags2 stages;
    vk::AccessFlags2 access;
    vk::ImageLayout layout;
};
using Stage2 = vk::PipelineStageFlagBits2;
using Access2 = vk::AccessFlagBits2;
inline const Use kColour{Stage2::eColorAttachmentOutput, Access2::eColorAttachmentRead | Access2::eColorAttachmentWrite,
                         vk::ImageLayout::eColorAttachmentOptimal};
inline const Use kDepth{Stage2::eEarlyFragmentTests | Stage2::eLateFragmentTests,
                        Access2::eDepthStencilAttachmentRead | Access2::eDepthStencilAttachmentWrite,
                        vk::ImageLayout::eDepthAttachmentOptimal};
/// By gnomon, which may read at any stage, and by lighting.
inline const Use kRead{Stage2::eAllCommands, Access2::eShaderRead, vk::ImageLayout::eShaderReadOnlyOptimal};
inline const Use kCopied{Stage2::eTransfer, Access2::eTransferRead, vk::ImageLayout::eTransferSrcOptimal};

inline void barrier(const vk::raii::CommandBuffer& commands, vk::Image image, vk::Format format, const Use& from,
                    const Use& to)
{
    const vk::ImageMemoryBarrier2 one(from.stages, from.access, to.stages, to.access, from.layout, to.layout,
                                      VK_QUEUE_FAMILY_IGNORED, VK_QUEUE_FAMILY_IGNORED, image, wholeOf(format));
    commands.pipelineBarrier2(vk::DependencyInfo({}, {}, {}, one));
}

class Gpu {
public:
    /// Whether queues of a family can present to the window.
    using Presents = std::function<bool(VkInstance, VkPhysicalDevice, uint32_t family)>;
    /// The first device that gnomon runs on and that can present. \param surface Instance extensions of the window;
    /// empty: there is none.
    explicit Gpu(const std::vector<const char*>& surface, const Presents& presents = nullptr)
    {
        const vk::ApplicationInfo app(nullptr, 0, nullptr, 0, VK_API_VERSION_1_3);
        instance = vk::raii::Instance(loader_, vk::InstanceCreateInfo({}, &app, {}, surface));
        GnDeviceNeeds needs{};
        std::string why = "there is none";
        for (vk::raii::PhysicalDevice& candidate : vk::raii::PhysicalDevices(instance)) {
            if (gnQueryDeviceNeeds(*instance, *candidate, vkGetInstanceProcAddr, &needs) < 0) {
                why = needs.reason;
                continue;
            }
            const auto families = candidate.getQueueFamilyProperties();
            constexpr auto wanted = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
            const auto fits = [&] {
                return (families[family].queueFlags & wanted) == wanted &&
                       (!presents || presents(*instance, *candidate, family));
            };
            for (family = 0; family < families.size() && !fits();)
                ++family;
            why = "none of its queues presents to the window";
            if (family == families.size()) continue;
            physical = std::move(candidate);
            break;
        }
        if (!*physical) throw std::runtime_error("no device: " + why);

        extensions.assign(needs.ppOptionalExtensions, needs.ppOptionalExtensions + needs.optionalExtensionCount);
        extensions.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
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

    /// Memory for an image or a buffer, which is bound to it.
    template <typename Resource>
    vk::raii::DeviceMemory place(Resource& resource, vk::MemoryPropertyFlags wanted) const
    {
        const vk::MemoryRequirements need = resource.getMemoryRequirements();
        const auto types = physical.getMemoryProperties().memoryTypes;
        uint32_t type = 0;
        while (!(need.memoryTypeBits >> type & 1) || (types[type].propertyFlags & wanted) != wanted)
            if (++type == types.size()) throw std::runtime_error("no memory type fits");
        const vk::MemoryAllocateInfo info(std::max<vk::DeviceSize>(need.size, 2 << 20), type); // not a small one
        vk::raii::DeviceMemory memory(device, info);
        resource.bindMemory(*memory, 0);
        return memory;
    }

    /// \param depth Tested and written, reversed. \param positions Read as vertices; else there are none.
    vk::raii::Pipeline createPipeline(vk::PipelineLayout layout, std::span<const uint32_t> vertex,
                                      std::span<const uint32_t> fragment, const std::vector<vk::Format>& colours,
                                      vk::Format depth, bool positions, bool blended) const
    {
        const vk::raii::ShaderModule modules[] = {{device, {{}, vertex.size_bytes(), vertex.data()}},
                                                  {device, {{}, fragment.size_bytes(), fragment.data()}}};
        const vk::PipelineShaderStageCreateInfo stages[] = {
            {{}, vk::ShaderStageFlagBits::eVertex, *modules[0], "main"},
            {{}, vk::ShaderStageFlagBits::eFragment, *modules[1], "main"}};
        const vk::VertexInputBindingDescription binding(0, 3 * sizeof(float));
        const vk::VertexInputAttributeDescription attribute(0, 0, vk::Format::eR32G32B32Sfloat, 0);
        const vk::PipelineVertexInputStateCreateInfo vertices({}, positions, &binding, positions, &attribute);
        const vk::PipelineInputAssemblyStateCreateInfo assembly({}, vk::PrimitiveTopology::eTriangleList);
        const vk::PipelineViewportStateCreateInfo viewport({}, 1, nullptr, 1, nullptr);
        const auto raster = vk::PipelineRasterizationStateCreateInfo().setLineWidth(1.0f);
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
