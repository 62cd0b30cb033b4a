// Vulkan as a small engine wraps it: a device, memory, images, render passes, pipelines.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <vulkan/vulkan_raii.hpp> // before GLFW, which offers Vulkan's functions then

#include <GLFW/glfw3.h>
#include <gnomon/gnomon.h>

namespace embed {

struct Image {
    vk::Format format = vk::Format::eUndefined;
    vk::raii::DeviceMemory memory = nullptr; // is freed last
    vk::raii::Image image = nullptr;
    vk::raii::ImageView view = nullptr;
};
constexpr auto kDepthFormat = vk::Format::eD32Sfloat; // of every image with depth

struct PipelineInfo {
    std::span<const uint32_t> vertex, fragment;
    vk::RenderPass pass;
    uint32_t colours = 1;
    bool positions = true, depth = false, blended = false;
};

class Gpu {
public:
    /// The first device that gnomon runs on and that can present. \param window Null: there is none.
    explicit Gpu(GLFWwindow* window)
    {
        uint32_t count = 0;
        const char** names = window ? glfwGetRequiredInstanceExtensions(&count) : nullptr;
        const vk::ApplicationInfo app(nullptr, 0, nullptr, 0, VK_API_VERSION_1_3);
        instance = {loader_, vk::InstanceCreateInfo({}, &app, 0, nullptr, count, names)};
        GnDeviceNeeds needs{};
        std::string why = "there is none";
        const auto serves = [&](const vk::raii::PhysicalDevice& candidate) {
            const GnResult runs = gnQueryDeviceNeeds(*instance, *candidate, vkGetInstanceProcAddr, &needs);
            why = runs < 0 ? needs.reason : "none of its queues draws, computes and presents";
            const auto families = candidate.getQueueFamilyProperties();
            constexpr auto wanted = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
            for (family = 0; runs >= 0 && family < families.size(); ++family)
                if ((families[family].queueFlags & wanted) == wanted &&
                    (!window || glfwGetPhysicalDevicePresentationSupport(*instance, *candidate, family)))
                    return true;
            return false;
        };
        vk::raii::PhysicalDevices devices(instance);
        const auto found = std::find_if(devices.begin(), devices.end(), serves);
        if (found == devices.end()) throw std::runtime_error("no device: " + why);
        physical = std::move(*found);

        extensions.assign(needs.ppOptionalExtensions, needs.ppOptionalExtensions + needs.optionalExtensionCount);
        extensions.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
        if (window) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
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

    /// Drawn into, then read by shaders and by copies.
    void create(Image& made, vk::Extent2D size) const
    {
        const bool depth = made.format == kDepthFormat;
        using Usage = vk::ImageUsageFlagBits;
        const auto drawn = depth ? Usage::eDepthStencilAttachment : Usage::eColorAttachment;
        const vk::ImageCreateInfo info({}, vk::ImageType::e2D, made.format, {size.width, size.height, 1}, 1, 1,
                                       vk::SampleCountFlagBits::e1, vk::ImageTiling::eOptimal,
                                       drawn | Usage::eSampled | Usage::eTransferSrc);
        made.image = {device, info};
        made.memory = place(made.image, vk::MemoryPropertyFlagBits::eDeviceLocal);
        using Aspect = vk::ImageAspectFlagBits;
        const vk::ImageSubresourceRange all(depth ? Aspect::eDepth : Aspect::eColor, 0, 1, 0, 1);
        made.view = {device, vk::ImageViewCreateInfo({}, *made.image, vk::ImageViewType::e2D, made.format, {}, all)};
    }

    /// Clears its images to 0 (depth is reversed: infinitely far), draws, and leaves them to whatever reads them.
    vk::raii::RenderPass createPass(std::initializer_list<vk::Format> formats, vk::ImageLayout after) const
    {
        std::vector<vk::AttachmentDescription> images;
        std::vector<vk::AttachmentReference> colours;
        vk::AttachmentReference depth(VK_ATTACHMENT_UNUSED);
        for (const vk::Format format : formats) {
            if (format == kDepthFormat)
                depth = {uint32_t(images.size()), vk::ImageLayout::eDepthStencilAttachmentOptimal};
            else
                colours.emplace_back(uint32_t(images.size()), vk::ImageLayout::eColorAttachmentOptimal);
            images.emplace_back().setFormat(format).setFinalLayout(after).setLoadOp(vk::AttachmentLoadOp::eClear);
        }
        const vk::SubpassDescription subpass({}, vk::PipelineBindPoint::eGraphics, {}, colours, {}, &depth);
        using Stage = vk::PipelineStageFlagBits;
        using Access = vk::AccessFlagBits;
        const auto draws = Stage::eColorAttachmentOutput | Stage::eEarlyFragmentTests | Stage::eLateFragmentTests;
        const auto writes = Access::eColorAttachmentWrite | Access::eDepthStencilAttachmentWrite;
        const auto uses = writes | Access::eColorAttachmentRead | Access::eDepthStencilAttachmentRead;
        const auto reads = Access::eShaderRead | Access::eTransferRead; // gnomon's may be at any stage
        const vk::SubpassDependency around[] = {
            {VK_SUBPASS_EXTERNAL, 0, Stage::eAllCommands, draws, {}, uses}, // the last frame's reads
            {0, VK_SUBPASS_EXTERNAL, draws, Stage::eAllCommands, writes, reads}};
        return {device, vk::RenderPassCreateInfo({}, images, subpass, around)};
    }

    vk::raii::Framebuffer createFramebuffer(vk::RenderPass pass,
                                            vk::ArrayProxyNoTemporaries<const vk::ImageView> images,
                                            vk::Extent2D size) const
    {
        return {device, vk::FramebufferCreateInfo({}, pass, images, size.width, size.height, 1)};
    }

    vk::raii::Pipeline createPipeline(vk::PipelineLayout layout, const PipelineInfo& wanted) const
    {
        const vk::raii::ShaderModule vertex(device, {{}, wanted.vertex.size_bytes(), wanted.vertex.data()});
        const vk::raii::ShaderModule fragment(device, {{}, wanted.fragment.size_bytes(), wanted.fragment.data()});
        const vk::PipelineShaderStageCreateInfo stages[] = {
            {{}, vk::ShaderStageFlagBits::eVertex, *vertex, "main"},
            {{}, vk::ShaderStageFlagBits::eFragment, *fragment, "main"}};
        const vk::VertexInputBindingDescription binding(0, 3 * sizeof(float));
        const vk::VertexInputAttributeDescription attribute(0, 0, vk::Format::eR32G32B32Sfloat, 0);
        vk::PipelineVertexInputStateCreateInfo vertices;
        if (wanted.positions) vertices = {{}, binding, attribute};
        const vk::PipelineInputAssemblyStateCreateInfo assembly({}, vk::PrimitiveTopology::eTriangleList);
        const vk::PipelineViewportStateCreateInfo viewport({}, 1, nullptr, 1, nullptr);
        const auto raster = vk::PipelineRasterizationStateCreateInfo().setLineWidth(1.0f);
        const vk::PipelineMultisampleStateCreateInfo samples;
        const vk::PipelineDepthStencilStateCreateInfo tests({}, wanted.depth, wanted.depth, vk::CompareOp::eGreater);
        auto target = vk::PipelineColorBlendAttachmentState().setColorWriteMask(vk::ColorComponentFlags(0xf));
        target.setBlendEnable(wanted.blended).setSrcColorBlendFactor(vk::BlendFactor::eSrcAlpha);
        target.setDstColorBlendFactor(vk::BlendFactor::eOneMinusSrcAlpha).setDstAlphaBlendFactor(vk::BlendFactor::eOne);
        const std::vector targets(wanted.colours, target);
        const vk::PipelineColorBlendStateCreateInfo blend({}, false, vk::LogicOp::eCopy, targets);
        const std::array states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
        const vk::PipelineDynamicStateCreateInfo dynamic({}, states);
        const vk::GraphicsPipelineCreateInfo info({}, stages, &vertices, &assembly, nullptr, &viewport, &raster,
                                                  &samples, &tests, &blend, &dynamic, layout, wanted.pass);
        return {device, nullptr, info};
    }

    /// Submits what is recorded, and waits.
    template <typename Record>
    void once(Record&& record) const
    {
        const vk::raii::CommandPool pool(device, vk::CommandPoolCreateInfo({}, family));
        const vk::raii::CommandBuffers commands(device, {*pool, {}, 1});
        commands[0].begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        record(commands[0]);
        commands[0].end();
        queue.submit(vk::SubmitInfo({}, {}, *commands[0]));
        device.waitIdle();
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
