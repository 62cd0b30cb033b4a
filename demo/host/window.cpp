#include "demo/host/window.hpp"

#include <algorithm>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <vulkan/vulkan.h>
// GLFW declares its Vulkan functions once vulkan.h is there.
#include <GLFW/glfw3.h>

namespace gnomon::demo {
namespace {

std::string glfwReason()
{
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "no reason given";
}

UniqueSemaphore makeBinary(const Device& device)
{
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    vkCheck(vkCreateSemaphore(device.handle, &info, nullptr, &semaphore), "vkCreateSemaphore");
    return {device.handle, semaphore};
}

// By name, not by place: the first format offered is often sRGB, and our pictures are encoded already.
VkSurfaceFormatKHR chooseFormat(const Device& device, VkSurfaceKHR surface)
{
    uint32_t count = 0;
    vkGetPhysicalDeviceSurfaceFormatsKHR(device.physicalDevice, surface, &count, nullptr);
    std::vector<VkSurfaceFormatKHR> formats(count);
    vkGetPhysicalDeviceSurfaceFormatsKHR(device.physicalDevice, surface, &count, formats.data());
    for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM})
        for (const VkSurfaceFormatKHR& format : formats)
            if (format.format == wanted) return format;
    throw HostError("the window offers no 8-bit UNORM format");
}

} // namespace

WindowSystem::WindowSystem()
{
    if (glfwInit() != GLFW_TRUE) throw HostError("no window system: " + glfwReason() + "; `gnomon run` needs none");
    if (glfwVulkanSupported() != GLFW_TRUE) {
        const std::string reason = glfwReason();
        glfwTerminate();
        throw HostError("the window system knows no Vulkan: " + reason);
    }
}

WindowSystem::~WindowSystem()
{
    glfwTerminate();
}

std::vector<const char*> WindowSystem::instanceExtensions() const
{
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (!names) throw HostError("no surface extension for this window system: " + glfwReason());
    return {names, names + count};
}

void Window::CloseWindow::operator()(GLFWwindow* window) const noexcept
{
    glfwDestroyWindow(window);
}

Window::Window(Device& device, VkExtent2D size, const std::string& title, uint32_t framesInFlight) : device_(device)
{
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window_.reset(glfwCreateWindow(int(size.width), int(size.height), title.c_str(), nullptr, nullptr));
    if (!window_) throw HostError("no window: " + glfwReason());
    glfwSetWindowUserPointer(handle(), this);
    glfwSetFramebufferSizeCallback(handle(), [](GLFWwindow* window, int, int) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->stale_ = true;
    });
    glfwSetKeyCallback(handle(), [](GLFWwindow* window, int key, int, int action, int) {
        if (action == GLFW_PRESS) static_cast<Window*>(glfwGetWindowUserPointer(window))->pressed_.push_back(key);
    });
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    vkCheck(glfwCreateWindowSurface(device.instance, handle(), nullptr, &surface), "glfwCreateWindowSurface");
    surface_ = {device.instance, surface};
    VkBool32 supported = VK_FALSE;
    vkCheck(vkGetPhysicalDeviceSurfaceSupportKHR(device.physicalDevice, device.queueFamily, surface, &supported),
            "vkGetPhysicalDeviceSurfaceSupportKHR");
    if (!supported)
        throw HostError(std::string(device.properties.deviceName) + " cannot present to a window of this display");
    // One more than frames in flight: an image is acquired for frame k before that is drawn, so all that is known to be
    // finished is what drawing frame k - 1 has waited for, frame k - 1 - framesInFlight and its wait for this
    // semaphore.
    for (uint32_t i = 0; i <= framesInFlight; ++i)
        acquired_.push_back(makeBinary(device));
}

Window::~Window()
{
    finish();
}

bool Window::closed() const
{
    return glfwWindowShouldClose(handle()) == GLFW_TRUE;
}

void Window::close()
{
    glfwSetWindowShouldClose(handle(), GLFW_TRUE);
}

void Window::pollEvents()
{
    glfwPollEvents();
}

void Window::setTitle(const std::string& title)
{
    glfwSetWindowTitle(handle(), title.c_str());
}

void Window::setSize(VkExtent2D size)
{
    glfwSetWindowSize(handle(), int(size.width), int(size.height));
}

VkExtent2D Window::extent() const
{
    int width = 0, height = 0;
    glfwGetFramebufferSize(handle(), &width, &height);
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

std::optional<double> Window::pressedAt() const
{
    if (glfwGetMouseButton(handle(), GLFW_MOUSE_BUTTON_LEFT) != GLFW_PRESS) return std::nullopt;
    int width = 0;
    double x = 0.0;
    glfwGetWindowSize(handle(), &width, nullptr); // in the cursor's unit, not in pixels
    glfwGetCursorPos(handle(), &x, nullptr);
    return width > 0 ? std::optional(std::clamp(x / width, 0.0, 1.0)) : std::nullopt;
}

bool Window::held(int key) const
{
    return glfwGetKey(handle(), key) == GLFW_PRESS;
}

std::vector<int> Window::takePressedKeys()
{
    return std::exchange(pressed_, {});
}

bool Window::dragging(double& dx, double& dy)
{
    double x = 0.0, y = 0.0;
    glfwGetCursorPos(handle(), &x, &y);
    const bool down = glfwGetMouseButton(handle(), GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
    const bool moved = down && wasDragging_;
    dx = moved ? x - lastX_ : 0.0;
    dy = moved ? y - lastY_ : 0.0;
    lastX_ = x;
    lastY_ = y;
    wasDragging_ = down;
    return moved;
}

// The device alone knows when presentation has let go of images and semaphores (VK_EXT_swapchain_maintenance1 is not
// everywhere), so a swapchain is replaced with the queue drained. gnomon is not involved: this is the host's own wait.
void Window::finish()
{
    vkCheck(vkQueueWaitIdle(device_.queue), "vkQueueWaitIdle");
}

bool Window::makeSwapchain()
{
    VkSurfaceCapabilitiesKHR limits{};
    vkCheck(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physicalDevice, surface_.get(), &limits),
            "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    extent_ = limits.currentExtent.width != UINT32_MAX ? limits.currentExtent : extent();
    extent_.width = std::clamp(extent_.width, limits.minImageExtent.width, limits.maxImageExtent.width);
    extent_.height = std::clamp(extent_.height, limits.minImageExtent.height, limits.maxImageExtent.height);
    if (extent_.width == 0 || extent_.height == 0) return false; // minimised
    finish();
    const VkSurfaceFormatKHR format = chooseFormat(device_, surface_.get());
    const uint32_t most = limits.maxImageCount == 0 ? UINT32_MAX : limits.maxImageCount;
    const VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                        .surface = surface_.get(),
                                        .minImageCount = std::min(limits.minImageCount + 1, most),
                                        .imageFormat = format.format,
                                        .imageColorSpace = format.colorSpace,
                                        .imageExtent = extent_,
                                        .imageArrayLayers = 1,
                                        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                        .preTransform = limits.currentTransform,
                                        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
                                        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
                                        .clipped = VK_TRUE,
                                        .oldSwapchain = swapchain_.get()};
    VkSwapchainKHR swapchain = VK_NULL_HANDLE;
    vkCheck(vkCreateSwapchainKHR(device_.handle, &info, nullptr, &swapchain), "vkCreateSwapchainKHR");
    images_.clear();
    swapchain_ = UniqueSwapchain(device_.handle, swapchain);
    uint32_t count = 0;
    vkCheck(vkGetSwapchainImagesKHR(device_.handle, swapchain, &count, nullptr), "vkGetSwapchainImagesKHR");
    std::vector<VkImage> images(count);
    vkCheck(vkGetSwapchainImagesKHR(device_.handle, swapchain, &count, images.data()), "vkGetSwapchainImagesKHR");
    for (VkImage image : images)
        images_.push_back({image, makeBinary(device_)});
    stale_ = false;
    return true;
}

bool Window::frame(const std::function<void(const PresentTarget&)>& draw)
{
    if (stale_ && !makeSwapchain()) return false;
    const UniqueSemaphore& acquired = acquired_[frames_ % acquired_.size()];
    uint32_t index = 0;
    const VkResult got =
        vkAcquireNextImageKHR(device_.handle, swapchain_.get(), UINT64_MAX, acquired.get(), VK_NULL_HANDLE, &index);
    if (got == VK_ERROR_OUT_OF_DATE_KHR) {
        stale_ = true;
        return false;
    }
    vkCheck(got, "vkAcquireNextImageKHR");
    ++frames_;
    draw({images_[index].image, extent_, acquired.get(), images_[index].drawn.get()});

    const VkSemaphore drawn = images_[index].drawn.get();
    const VkSwapchainKHR swapchain = swapchain_.get();
    const VkPresentInfoKHR present{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                   .waitSemaphoreCount = 1,
                                   .pWaitSemaphores = &drawn,
                                   .swapchainCount = 1,
                                   .pSwapchains = &swapchain,
                                   .pImageIndices = &index};
    const VkResult shown = vkQueuePresentKHR(device_.queue, &present);
    if (shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR)
        stale_ = true;
    else
        vkCheck(shown, "vkQueuePresentKHR");
    return true;
}

} // namespace gnomon::demo
