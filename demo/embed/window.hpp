// A window with a swapchain that follows its size, and Dear ImGui with gnomon's panel in it.
#pragma once

#include "renderer.hpp" // has vulkan.h, for what follows

#include <GLFW/glfw3.h>
#include <gnomon/gnomon_imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_vulkan.h>

namespace embed {

struct Window {
    explicit Window(vk::Extent2D size)
    {
        if (!glfwInit() || !glfwVulkanSupported()) throw std::runtime_error("no window system with Vulkan");
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
        handle = glfwCreateWindow(int(size.width), int(size.height), "gnomon embed", nullptr, nullptr);
        if (!handle) throw std::runtime_error("no window");
        uint32_t count = 0;
        const char** names = glfwGetRequiredInstanceExtensions(&count);
        extensions.assign(names, names + count);
    }
    ~Window() { glfwTerminate(); }
    /// Gpu::Presents
    static bool presents(VkInstance instance, VkPhysicalDevice device, uint32_t family)
    {
        return glfwGetPhysicalDevicePresentationSupport(instance, device, family) == GLFW_TRUE;
    }
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    GLFWwindow* handle = nullptr;
    std::vector<const char*> extensions;
};

/// Images of a window, made anew when its size changes.
class Swapchain {
public:
    Swapchain(Gpu& gpu, const Window& window) : gpu_(gpu), window_(window.handle)
    {
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        if (glfwCreateWindowSurface(*gpu.instance, window.handle, nullptr, &surface) < 0)
            throw std::runtime_error("no surface");
        surface_ = {gpu.instance, surface};
        for (vk::raii::Semaphore& semaphore : acquired_)
            semaphore = {gpu.device, vk::SemaphoreCreateInfo()};
    }
    ~Swapchain() { gpu_.device.waitIdle(); }

    /// False while there is nothing to draw to. \param resize Called with a new size, after the device was waited for.
    template <typename Resize>
    bool acquire(Resize&& resize)
    try {
        vk::SurfaceCapabilitiesKHR limits = gpu_.physical.getSurfaceCapabilitiesKHR(*surface_);
        if (limits.currentExtent.width == UINT32_MAX) limits.currentExtent = framebufferExtent(limits); // Wayland
        if (limits.currentExtent.width == 0 || limits.currentExtent.height == 0) return false;          // minimised
        if (std::exchange(stale_, false) || limits.currentExtent != extent_) {
            extent_ = limits.currentExtent;
            create(limits);
            resize(extent_);
        }
        image_ = swapchain_.acquireNextImage(UINT64_MAX, *acquired_[++frame_ % acquired_.size()]).second;
        return true;
    } catch (const vk::OutOfDateKHRError&) {
        return !(stale_ = true);
    }
    Target target() const { return {images_[image_], *acquired_[frame_ % acquired_.size()], *drawn_[image_]}; }
    void present()
    try {
        stale_ = gpu_.queue.presentKHR({*drawn_[image_], *swapchain_, image_}) != vk::Result::eSuccess;
    } catch (const vk::OutOfDateKHRError&) {
        stale_ = true;
    }

private:
    static uint32_t imagesOf(const vk::SurfaceCapabilitiesKHR& limits)
    {
        const uint32_t wanted = std::max(limits.minImageCount, 3u);
        return limits.maxImageCount == 0 ? wanted : std::min(wanted, limits.maxImageCount);
    }
    vk::Extent2D framebufferExtent(const vk::SurfaceCapabilitiesKHR& limits) const
    {
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        return {std::min(uint32_t(width), limits.maxImageExtent.width),
                std::min(uint32_t(height), limits.maxImageExtent.height)};
    }
    void create(const vk::SurfaceCapabilitiesKHR& limits)
    {
        gpu_.device.waitIdle();
        const auto formats = gpu_.physical.getSurfaceFormatsKHR(*surface_);
        const auto unorm = [](const auto& offered) { return offered.format == vk::Format::eB8G8R8A8Unorm; };
        const auto found = std::find_if(formats.begin(), formats.end(), unorm);
        if (found == formats.end()) throw std::runtime_error("the window offers no B8G8R8A8_UNORM");
        vk::SwapchainCreateInfoKHR info({}, *surface_, imagesOf(limits), found->format, found->colorSpace, extent_, 1,
                                        vk::ImageUsageFlagBits::eTransferDst);
        info.setPreTransform(limits.currentTransform).setPresentMode(vk::PresentModeKHR::eFifo).setClipped(true);
        swapchain_ = nullptr;
        swapchain_ = {gpu_.device, info};
        images_ = swapchain_.getImages();
        drawn_.clear();
        while (drawn_.size() < images_.size())
            drawn_.emplace_back(gpu_.device, vk::SemaphoreCreateInfo());
    }

    Gpu& gpu_;
    GLFWwindow* window_;
    vk::raii::SurfaceKHR surface_ = nullptr;
    vk::raii::SwapchainKHR swapchain_ = nullptr;
    vk::Extent2D extent_;
    std::vector<vk::Image> images_;
    std::vector<vk::raii::Semaphore> drawn_; // one an image
    // One more than frames in flight: a semaphore is free when the frame that waited for it is known to be finished.
    std::array<vk::raii::Semaphore, kInFlight + 1> acquired_{nullptr, nullptr, nullptr};
    uint32_t image_ = 0;
    uint64_t frame_ = 0;
    bool stale_ = true;
};

/// ImGui's backend of this version draws in a render pass.
class Ui {
public:
    /// \param window Null: none, and no mouse.
    Ui(Gpu& gpu, const Window* window, vk::Format format) : gpu_(gpu), window_(window)
    {
        constexpr auto layout = vk::ImageLayout::eColorAttachmentOptimal;
        const vk::AttachmentDescription picture({}, format, vk::SampleCountFlagBits::e1, vk::AttachmentLoadOp::eLoad,
                                                vk::AttachmentStoreOp::eStore, {}, {}, layout, layout);
        const vk::AttachmentReference drawn(0, layout);
        const vk::SubpassDescription subpass({}, vk::PipelineBindPoint::eGraphics, {}, drawn);
        pass_ = {gpu.device, vk::RenderPassCreateInfo({}, picture, subpass)};
        const vk::DescriptorPoolSize size(vk::DescriptorType::eCombinedImageSampler, 1);
        pool_ = {gpu.device, {vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size}};
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        if (window) ImGui_ImplGlfw_InitForVulkan(window->handle, true);
        ImGui_ImplVulkan_InitInfo info{};
        info.Instance = *gpu.instance;
        info.PhysicalDevice = *gpu.physical;
        info.Device = *gpu.device;
        info.QueueFamily = gpu.family;
        info.Queue = *gpu.queue;
        info.DescriptorPool = *pool_;
        info.MinImageCount = info.ImageCount = kInFlight; // sets of its vertex buffers
        start(info, *pass_);
    }
    ~Ui()
    {
        gpu_.device.waitIdle();
        ImGui_ImplVulkan_Shutdown();
        if (window_) ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }

    void resize(const Image& picture, vk::Extent2D size)
    {
        size_ = size;
        framebuffer_ = {gpu_.device, vk::FramebufferCreateInfo({}, *pass_, *picture.view, size.width, size.height, 1)};
        if (!window_) ImGui::GetIO().DisplaySize = ImVec2(float(size.width), float(size.height));
    }
    /// gnomon's panel of its last frame.
    void draw(const vk::raii::CommandBuffer& commands, const Shadows& shadows, bool recorded)
    {
#if IMGUI_VERSION_NUM < 19000
        if (!std::exchange(hasFont_, true)) ImGui_ImplVulkan_CreateFontsTexture(*commands);
#endif
        ImGui_ImplVulkan_NewFrame();
        if (window_) ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        ImGui::SetNextWindowSize(ImVec2(780, 330), ImGuiCond_FirstUseEver);
        std::array<gnomon::ImguiLight, kLights> lights;
        for (size_t i = 0; i < kLights; ++i)
            lights[i] = {shadows.lights[i].get(), kLightNames[i]};
        panel_.draw(shadows.context.get(), shadows.view.get(), lights.data(), kLights,
                    recorded ? "gnCmdRenderShadows (Tab)###gnomon" : "gnSubmitShadows (Tab)###gnomon");
        ImGui::Render();
        commands.beginRenderPass({*pass_, *framebuffer_, {{}, size_}}, vk::SubpassContents::eInline);
        ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), *commands);
        commands.endRenderPass();
    }

private:
    /// The pass was a parameter until it became a member, between two releases 1.90.x.
    template <typename Info>
    static void start(Info& info, VkRenderPass pass)
    {
        if constexpr (requires { info.RenderPass; }) {
            info.RenderPass = pass;
            ImGui_ImplVulkan_Init(&info);
        } else {
            ImGui_ImplVulkan_Init(&info, pass);
        }
    }

    Gpu& gpu_;
    const Window* window_;
    vk::raii::RenderPass pass_ = nullptr;
    vk::raii::DescriptorPool pool_ = nullptr;
    vk::raii::Framebuffer framebuffer_ = nullptr;
    vk::Extent2D size_;
    gnomon::ImguiPanel panel_;
    bool hasFont_ = false;
};

} // namespace embed
