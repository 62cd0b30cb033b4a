// Vulkan as a small engine wraps it: a device, buffers, images that are drawn into, pipelines.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <vulkan/vulkan_raii.hpp> // before GLFW, which offers Vulkan's functions then

#include <GLFW/glfw3.h>
#include <gnomon/gnomon.hpp>

#include "embed_shaders.h"

namespace embed {

struct Gpu {
    /// The first device that gnomon runs on and whose queue family 0 can present. \param window Null: there is none.
    explicit Gpu(GLFWwindow* window)
    {
        uint32_t count = 0;
        const char** names = window ? glfwGetRequiredInstanceExtensions(&count) : nullptr;
        const vk::ApplicationInfo app(nullptr, 0, nullptr, 0, VK_API_VERSION_1_3);
        instance = {loader, vk::InstanceCreateInfo({}, &app, 0, nullptr, count, names)};
        GnDeviceNeeds needs{};
        vk::raii::PhysicalDevices all(instance);
        const auto found = std::find_if(all.begin(), all.end(), [&](const vk::raii::PhysicalDevice& candidate) {
            needs = *gn::queryDeviceNeeds(*instance, *candidate, vkGetInstanceProcAddr);
            constexpr auto works = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute; // on all drivers we know
            return needs.supported && (candidate.getQueueFamilyProperties()[0].queueFlags & works) == works &&
                   (!window || glfwGetPhysicalDevicePresentationSupport(*instance, *candidate, 0));
        });
        if (found == all.end()) throw std::runtime_error(std::string("no device that serves. ") + needs.reason);
        physical = std::move(*found);

        extensions.assign(needs.ppOptionalExtensions, needs.ppOptionalExtensions + needs.optionalExtensionCount);
        extensions.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
        if (window) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
        features.get<vk::PhysicalDeviceFeatures2>().setFeatures(needs.optional);
        auto& features12 = features.get<vk::PhysicalDeviceVulkan12Features>().setTimelineSemaphore(true);
        features12.setBufferDeviceAddress(needs.pOptionalFeatures != nullptr);
        auto& features13 = features.get<vk::PhysicalDeviceVulkan13Features>().setSynchronization2(true);
        features13.setDynamicRendering(true).setPNext(const_cast<void*>(needs.pOptionalFeatures)); // of the extensions
        const float priority = 1.0f;
        const vk::DeviceQueueCreateInfo one({}, 0, 1, &priority);
        device = {physical, vk::DeviceCreateInfo({}, one, {}, extensions, nullptr, &features.get())};
        queue = device.getQueue(0, 0);
    }

    /// Memory for an image or a buffer, which is bound to it.
    template <typename Resource>
    vk::raii::DeviceMemory place(Resource& resource, vk::MemoryPropertyFlags wanted) const
    {
        const vk::MemoryRequirements need = resource.getMemoryRequirements();
        const auto types = physical.getMemoryProperties().memoryTypes;
        uint32_t type = 0; // Vulkan promises that one fits
        while (!(need.memoryTypeBits >> type & 1) || (types[type].propertyFlags & wanted) != wanted)
            ++type;
        const vk::MemoryAllocateInfo info(std::max<vk::DeviceSize>(need.size, 2 << 20), type); // not a small one
        vk::raii::DeviceMemory memory(device, info);
        resource.bindMemory(*memory, 0);
        return memory;
    }

    vk::raii::Context loader;
    vk::raii::Instance instance = nullptr;
    vk::raii::PhysicalDevice physical = nullptr;
    vk::raii::Device device = nullptr;
    vk::raii::Queue queue = nullptr;
    std::vector<const char*> extensions; // and features: what the device was created with
    vk::StructureChain<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features,
                       vk::PhysicalDeviceVulkan13Features>
        features;
};

struct Image {
    vk::Format format;
    vk::raii::DeviceMemory memory = nullptr;
    vk::raii::Image image = nullptr;
    vk::raii::ImageView view = nullptr;
};
constexpr auto kDepthFormat = vk::Format::eD32Sfloat, kWindowFormat = vk::Format::eB8G8R8A8Unorm;

/// Images that are drawn into together.
struct Canvas {
    /// \param after Their layout once they are drawn.
    Canvas(const Gpu& gpu, std::initializer_list<vk::Format> formats, vk::ImageLayout after) : gpu_(gpu)
    {
        std::vector<vk::AttachmentDescription> attachments;
        std::vector<vk::AttachmentReference> colours, depths;
        for (const vk::Format format : formats) {
            auto& references = format == kDepthFormat ? depths : colours;
            references.emplace_back(uint32_t(images.size()), vk::ImageLayout::eAttachmentOptimal);
            attachments.emplace_back().setFormat(format).setFinalLayout(after).setLoadOp(vk::AttachmentLoadOp::eClear);
            images.push_back({format});
        }
        const vk::SubpassDescription subpass({}, vk::PipelineBindPoint::eGraphics, {}, colours, {}, depths.data());
        using Stage = vk::PipelineStageFlagBits;
        const auto any = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
        const vk::SubpassDependency around[] = {
            // gnomon reads at stages of its own
            {VK_SUBPASS_EXTERNAL, 0, Stage::eAllCommands, Stage::eAllGraphics, any, any},
            {0, VK_SUBPASS_EXTERNAL, Stage::eAllGraphics, Stage::eAllCommands, any, any}};
        pass = {gpu_.device, vk::RenderPassCreateInfo({}, attachments, subpass, around)};
    }

    /// Makes the images again; the device is done with the old ones. \param shown The one image, where it is a
    /// swapchain's.
    void resize(vk::Extent2D wanted, vk::Image shown = {})
    {
        size = wanted;
        std::vector<vk::ImageView> views;
        for (Image& made : images) {
            const bool depth = made.format == kDepthFormat;
            if (!shown) {
                using Usage = vk::ImageUsageFlagBits;
                const auto drawn = depth ? Usage::eDepthStencilAttachment : Usage::eColorAttachment;
                const vk::ImageCreateInfo info({}, vk::ImageType::e2D, made.format, vk::Extent3D(size, 1), 1, 1,
                                               vk::SampleCountFlagBits::e1, vk::ImageTiling::eOptimal,
                                               drawn | Usage::eSampled | Usage::eTransferSrc);
                made.image = {gpu_.device, info};
                made.memory = gpu_.place(made.image, vk::MemoryPropertyFlagBits::eDeviceLocal);
            }
            const auto aspect = depth ? vk::ImageAspectFlagBits::eDepth : vk::ImageAspectFlagBits::eColor;
            made.view = {gpu_.device, vk::ImageViewCreateInfo({}, shown ? shown : *made.image, vk::ImageViewType::e2D,
                                                              made.format, {}, {aspect, 0, 1, 0, 1})};
            views.push_back(*made.view);
        }
        framebuffer = {gpu_.device, vk::FramebufferCreateInfo({}, *pass, views, size.width, size.height, 1)};
    }

    /// Clears the images to 0: of depth, which is reversed, infinitely far.
    void begin(const vk::raii::CommandBuffer& commands) const
    {
        const std::vector<vk::ClearValue> zeros(images.size());
        commands.beginRenderPass({*pass, *framebuffer, {{}, size}, zeros}, vk::SubpassContents::eInline);
        commands.setViewport(0, vk::Viewport(0, 0, float(size.width), float(size.height), 0, 1));
        commands.setScissor(0, vk::Rect2D({}, size));
    }

    /// Draws triangles. \param code Of fragments, SPIR-V. \param blended By alpha, with what has been drawn.
    vk::raii::Pipeline createPipeline(vk::PipelineLayout layout, std::span<const uint32_t> code, bool blended) const
    {
        const vk::raii::ShaderModule vertex(gpu_.device, {{}, sizeof k_corner_vert, k_corner_vert});
        const vk::raii::ShaderModule fragment(gpu_.device, {{}, code.size_bytes(), code.data()});
        const vk::PipelineShaderStageCreateInfo stages[] = {
            {{}, vk::ShaderStageFlagBits::eVertex, *vertex, "main"},
            {{}, vk::ShaderStageFlagBits::eFragment, *fragment, "main"}};
        const vk::VertexInputBindingDescription binding(0, 3 * sizeof(float));
        const vk::VertexInputAttributeDescription position(0, 0, vk::Format::eR32G32B32Sfloat, 0);
        const vk::PipelineVertexInputStateCreateInfo vertices({}, binding, position);
        const vk::PipelineInputAssemblyStateCreateInfo assembly({}, vk::PrimitiveTopology::eTriangleList);
        const vk::PipelineViewportStateCreateInfo viewport({}, 1, nullptr, 1, nullptr);
        const auto raster = vk::PipelineRasterizationStateCreateInfo().setLineWidth(1.0f);
        const vk::PipelineMultisampleStateCreateInfo samples;
        const vk::PipelineDepthStencilStateCreateInfo tests({}, true, true, vk::CompareOp::eGreater); // if it has depth
        using Blend = vk::BlendFactor;
        const vk::PipelineColorBlendAttachmentState one(blended, Blend::eSrcAlpha, Blend::eOneMinusSrcAlpha, {},
                                                        Blend::eZero, Blend::eOne, {}, vk::ColorComponentFlags(0xf));
        const size_t depths = images.back().format == kDepthFormat ? 1 : 0;
        const std::vector targets(images.size() - depths, one);
        const vk::PipelineColorBlendStateCreateInfo blend({}, false, {}, targets);
        const std::array states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
        const vk::PipelineDynamicStateCreateInfo dynamic({}, states);
        return {gpu_.device, nullptr,
                vk::GraphicsPipelineCreateInfo({}, stages, &vertices, &assembly, nullptr, &viewport, &raster, &samples,
                                               &tests, &blend, &dynamic, layout, *pass)};
    }

    const Gpu& gpu_;
    std::vector<Image> images;
    vk::raii::RenderPass pass = nullptr;
    vk::raii::Framebuffer framebuffer = nullptr;
    vk::Extent2D size;
};

/// Images of a window, made again when its size changes.
class Swapchain {
public:
    Swapchain(const Gpu& gpu, GLFWwindow* window) : gpu_(gpu), window_(window)
    {
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        if (glfwCreateWindowSurface(*gpu.instance, window, nullptr, &surface) != VK_SUCCESS)
            throw std::runtime_error("no surface");
        surface_ = {gpu.instance, surface};
        const auto offered = gpu.physical.getSurfaceFormatsKHR(*surface_);
        if (std::find(offered.begin(), offered.end(), kFormat) == offered.end())
            throw std::runtime_error("the window offers no B8G8R8A8_UNORM");
    }

    /// The image to draw into next; null while there is none. \param free Is signalled once it may be written.
    const Canvas* acquire(vk::Semaphore free)
    {
        const vk::SurfaceCapabilitiesKHR limits = gpu_.physical.getSurfaceCapabilitiesKHR(*surface_);
        vk::Extent2D size = limits.currentExtent;
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        if (size.width == UINT32_MAX) size = vk::Extent2D(uint32_t(width), uint32_t(height)); // Wayland
        if (size.width == 0 || size.height == 0) return nullptr;                              // minimised
        if (stale_ || size != images_[0].size) create(limits, size);
        const vk::Result result = (*gpu_.device).acquireNextImageKHR(*swapchain_, UINT64_MAX, free, {}, &image_);
        stale_ = result != vk::Result::eSuccess && result != vk::Result::eSuboptimalKHR;
        return stale_ ? nullptr : &images_[image_];
    }

    /// Submits what draws the image that was acquired, and shows it. \param done Is signalled when it is drawn.
    void show(vk::CommandBuffer commands, vk::Semaphore free, vk::Fence done)
    {
        const vk::PipelineStageFlags draws = vk::PipelineStageFlagBits::eColorAttachmentOutput;
        const vk::Semaphore drawn = *drawn_[image_];
        gpu_.queue.submit(vk::SubmitInfo(free, draws, commands, drawn), done);
        const vk::PresentInfoKHR info(drawn, *swapchain_, image_);
        stale_ = (*gpu_.queue).presentKHR(&info) != vk::Result::eSuccess;
    }

private:
    static constexpr vk::SurfaceFormatKHR kFormat{kWindowFormat, vk::ColorSpaceKHR::eSrgbNonlinear};

    void create(const vk::SurfaceCapabilitiesKHR& limits, vk::Extent2D size)
    {
        gpu_.device.waitIdle();
        const uint32_t most = limits.maxImageCount ? limits.maxImageCount : UINT32_MAX;
        vk::SwapchainCreateInfoKHR info({}, *surface_, std::clamp(3u, limits.minImageCount, most), kFormat.format, {},
                                        size, 1, vk::ImageUsageFlagBits::eColorAttachment);
        info.setPreTransform(limits.currentTransform).setPresentMode(vk::PresentModeKHR::eFifo).setClipped(true);
        images_.clear();
        drawn_.clear();
        swapchain_ = nullptr;
        swapchain_ = {gpu_.device, info};
        for (const vk::Image image : swapchain_.getImages()) {
            images_.push_back({gpu_, {kWindowFormat}, vk::ImageLayout::ePresentSrcKHR});
            images_.back().resize(size, image);
            drawn_.emplace_back(gpu_.device, vk::SemaphoreCreateInfo());
        }
    }

    const Gpu& gpu_;
    GLFWwindow* window_;
    vk::raii::SurfaceKHR surface_ = nullptr;
    vk::raii::SwapchainKHR swapchain_ = nullptr;
    std::vector<Canvas> images_;
    std::vector<vk::raii::Semaphore> drawn_; // one an image
    uint32_t image_ = 0;
    bool stale_ = true;
};

} // namespace embed
