#pragma once
// A GLFW window with a swapchain that survives resizing.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "demo/host/renderer.hpp"

struct GLFWwindow;

namespace gnomon::demo {

/// Initialises GLFW for as long as it lives.
class WindowSystem {
public:
    WindowSystem(); ///< Throws HostError where there is no display or no Vulkan.
    ~WindowSystem();
    WindowSystem(const WindowSystem&) = delete;
    WindowSystem& operator=(const WindowSystem&) = delete;

    std::vector<const char*> instanceExtensions() const;
};

class Window {
public:
    /// Throws HostError where the device cannot present to it. \param framesInFlight as the Renderer's that draws to
    /// it, in every frame once.
    Window(Device& device, VkExtent2D size, const std::string& title, uint32_t framesInFlight);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    GLFWwindow* handle() const noexcept { return window_.get(); }
    bool closed() const;
    void close();
    void pollEvents();
    void setTitle(const std::string& title);
    void setSize(VkExtent2D size);
    /// Of the window's pixels; zero while minimised.
    VkExtent2D extent() const;

    /// Across the window, 0 at the left edge and 1 at the right one; nothing: the left button is up.
    std::optional<double> pressedAt() const;
    bool held(int key) const;              ///< A GLFW key.
    std::vector<int> takePressedKeys();    ///< Since the last call, without repeats.
    bool dragging(double& dx, double& dy); ///< Mouse moved with the right button held.

    /// Acquires an image, lets `draw` fill it, presents it. Makes the swapchain again when the window changed; then the
    /// frame is skipped. \return whether a frame was drawn.
    bool frame(const std::function<void(const PresentTarget&)>& draw);
    /// Until everything presented is finished. Before destruction of what frames use.
    void finish();

private:
    struct CloseWindow {
        void operator()(GLFWwindow* window) const noexcept;
    };
    struct SwapImage {
        VkImage image = VK_NULL_HANDLE;
        UniqueSemaphore drawn; ///< One per image: presentation may hold it until the image comes round again.
    };
    bool makeSwapchain();

    Device& device_;
    std::unique_ptr<GLFWwindow, CloseWindow> window_;
    UniqueSurface surface_;
    UniqueSwapchain swapchain_;
    std::vector<SwapImage> images_;
    std::vector<UniqueSemaphore> acquired_; ///< In turns.
    VkExtent2D extent_{};
    uint64_t frames_ = 0;
    bool stale_ = true;
    std::vector<int> pressed_;
    double lastX_ = 0.0, lastY_ = 0.0;
    bool wasDragging_ = false;
};

} // namespace gnomon::demo
