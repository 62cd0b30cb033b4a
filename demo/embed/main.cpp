// gnomon in a small engine: a model, a floor and a pane of glass under three lights. Left button: turn, W and S: nearer
// and farther, Tab: the other way of asking for shadows, Esc: end. README.md has the options.
#include <cstdio>
#include <optional>

#include "renderer.hpp" // Vulkan before the headers that take it from there

#include <CLI/CLI.hpp>
#include <gnomon/gnomon_imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_vulkan.h>
#include <lodepng.h>

namespace embed {
namespace {

struct Options {
    std::string model = "/usr/share/glmark2/models/bunny.obj", out = "embed.png";
    uint32_t width = 1280, height = 720, headless = 0, frames = 0;
    bool submitted = false, panel = false, exercise = false;
};

GLFWwindow* openWindow(const Options& options)
{
    if (!glfwInit() || !glfwVulkanSupported()) throw std::runtime_error("no window system with Vulkan");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    GLFWwindow* window = glfwCreateWindow(int(options.width), int(options.height), "gnomon embed", nullptr, nullptr);
    if (!window) throw std::runtime_error("no window");
    return window;
}

/// Images of a window, made anew when its size changes.
class Swapchain {
public:
    Swapchain(const Gpu& gpu, GLFWwindow* window) : gpu_(gpu), window_(window)
    {
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        if (glfwCreateWindowSurface(*gpu.instance, window, nullptr, &surface) < 0)
            throw std::runtime_error("no surface");
        surface_ = {gpu.instance, surface};
        for (vk::raii::Semaphore& semaphore : acquired_)
            semaphore = {gpu.device, vk::SemaphoreCreateInfo()};
    }
    ~Swapchain() { gpu_.device.waitIdle(); }

    /// False while there is nothing to draw to. The renderer is resized with the window.
    bool acquire(Renderer& renderer)
    try {
        const vk::SurfaceCapabilitiesKHR limits = gpu_.physical.getSurfaceCapabilitiesKHR(*surface_);
        vk::Extent2D now = limits.currentExtent;
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        if (now.width == UINT32_MAX) now = vk::Extent2D(uint32_t(width), uint32_t(height)); // Wayland
        if (now.width == 0 || now.height == 0) return false;                                // minimised
        const bool changes = now != std::exchange(size, now);
        if (std::exchange(stale_, false) || changes) create(limits);
        renderer.resize(size);
        const vk::Semaphore acquired = *acquired_[++frame_ % acquired_.size()];
        image_ = swapchain_.acquireNextImage(UINT64_MAX, acquired).second;
        target = {images_[image_], acquired, *drawn_[image_]};
        return true;
    } catch (const vk::OutOfDateKHRError&) {
        return !(stale_ = true);
    }
    void present()
    try {
        stale_ = gpu_.queue.presentKHR({target.drawn, *swapchain_, image_}) != vk::Result::eSuccess;
    } catch (const vk::OutOfDateKHRError&) {
        stale_ = true;
    }

    vk::Extent2D size;
    Target target;

private:
    void create(const vk::SurfaceCapabilitiesKHR& limits)
    {
        gpu_.device.waitIdle();
        const auto formats = gpu_.physical.getSurfaceFormatsKHR(*surface_);
        const auto unorm = [](const auto& offered) { return offered.format == vk::Format::eB8G8R8A8Unorm; };
        const auto format = std::find_if(formats.begin(), formats.end(), unorm);
        if (format == formats.end()) throw std::runtime_error("the window offers no B8G8R8A8_UNORM");
        const uint32_t most = limits.maxImageCount ? limits.maxImageCount : UINT32_MAX;
        vk::SwapchainCreateInfoKHR info({}, *surface_, std::clamp(3u, limits.minImageCount, most), format->format,
                                        format->colorSpace, size, 1, vk::ImageUsageFlagBits::eTransferDst);
        info.setPreTransform(limits.currentTransform).setPresentMode(vk::PresentModeKHR::eFifo).setClipped(true);
        swapchain_ = nullptr;
        swapchain_ = {gpu_.device, info};
        images_ = swapchain_.getImages();
        drawn_.clear();
        while (drawn_.size() < images_.size())
            drawn_.emplace_back(gpu_.device, vk::SemaphoreCreateInfo());
    }

    const Gpu& gpu_;
    GLFWwindow* window_;
    vk::raii::SurfaceKHR surface_ = nullptr;
    vk::raii::SwapchainKHR swapchain_ = nullptr;
    std::vector<vk::Image> images_;
    std::vector<vk::raii::Semaphore> drawn_; // one an image
    // One more than frames in flight: a semaphore is free when the frame that waited for it is known to be finished.
    std::array<vk::raii::Semaphore, kInFlight + 1> acquired_{nullptr, nullptr, nullptr};
    uint32_t image_ = 0;
    uint64_t frame_ = 0;
    bool stale_ = true;
};

/// gnomon's panel over the picture.
class Ui {
public:
    /// \param window Null: none, and no mouse. \param pass As the renderer's.
    Ui(const Gpu& gpu, GLFWwindow* window, vk::RenderPass pass) : gpu_(gpu), window_(window)
    {
        const vk::DescriptorPoolSize size(vk::DescriptorType::eCombinedImageSampler, 1);
        constexpr auto freed = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet;
        descriptors_ = {gpu.device, vk::DescriptorPoolCreateInfo(freed, 1, size)};
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        if (window) ImGui_ImplGlfw_InitForVulkan(window, true);
        ImGui_ImplVulkan_InitInfo info{};
        info.Instance = *gpu.instance;
        info.PhysicalDevice = *gpu.physical;
        info.Device = *gpu.device;
        info.QueueFamily = gpu.family;
        info.Queue = *gpu.queue;
        info.DescriptorPool = *descriptors_;
        info.MinImageCount = info.ImageCount = kInFlight; // sets of its vertex buffers
        ImGui_ImplVulkan_Init(&info, pass);
#if IMGUI_VERSION_NUM < 19000
        gpu.once([](const vk::raii::CommandBuffer& commands) { ImGui_ImplVulkan_CreateFontsTexture(*commands); });
#endif
    }
    ~Ui()
    {
        gpu_.device.waitIdle();
        ImGui_ImplVulkan_Shutdown();
        if (window_) ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
    void draw(const vk::raii::CommandBuffer& commands, const Shadows& shadows, vk::Extent2D size, bool recorded)
    {
        ImGui_ImplVulkan_NewFrame();
        ImGui::GetIO().DisplaySize = ImVec2(float(size.width), float(size.height));
        if (window_) ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        ImGui::SetNextWindowSize(ImVec2(780, 330), ImGuiCond_FirstUseEver);
        std::array<gnomon::ImguiLight, kLights> lights;
        for (size_t i = 0; i < kLights; ++i)
            lights[i] = {shadows.lights[i].get(), kLightNames[i]};
        panel_.draw(shadows.context.get(), shadows.view.get(), lights.data(), kLights,
                    recorded ? "gnCmdRenderShadows (Tab)###gnomon" : "gnSubmitShadows (Tab)###gnomon");
        ImGui::Render();
        ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), *commands);
    }

private:
    const Gpu& gpu_;
    GLFWwindow* window_;
    vk::raii::DescriptorPool descriptors_ = nullptr;
    gnomon::ImguiPanel panel_;
};

void write(const std::string& file, const Gpu& gpu, const Image& picture, const Options& options)
{
    using Property = vk::MemoryPropertyFlagBits;
    const vk::DeviceSize bytes = vk::DeviceSize(4) * options.width * options.height;
    vk::raii::Buffer buffer(gpu.device, vk::BufferCreateInfo({}, bytes, vk::BufferUsageFlagBits::eTransferDst));
    const auto memory = gpu.place(buffer, Property::eHostVisible | Property::eHostCoherent);
    const vk::BufferImageCopy all(0, 0, 0, {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, {},
                                  {options.width, options.height, 1});
    gpu.once([&](const vk::raii::CommandBuffer& commands) {
        commands.copyImageToBuffer(*picture.image, vk::ImageLayout::eTransferSrcOptimal, *buffer, all);
    });
    const auto* pixels = static_cast<const unsigned char*>(memory.mapMemory(0, VK_WHOLE_SIZE));
    if (const unsigned error = lodepng::encode(file, pixels, options.width, options.height))
        throw std::runtime_error(file + ": " + lodepng_error_text(error));
}

void run(const Options& options)
{
    const std::unique_ptr<GLFWwindow, void (*)(GLFWwindow*)> owner(options.headless ? nullptr : openWindow(options),
                                                                   [](GLFWwindow*) { glfwTerminate(); });
    GLFWwindow* const window = owner.get();
    const Gpu gpu(window);
    std::optional<Swapchain> swapchain;
    if (window) swapchain.emplace(gpu, window);
    const Scene scene = loadScene(options.model);
    Renderer renderer(gpu, scene);
    std::optional<Ui> ui;
    if (window || options.panel) ui.emplace(gpu, window, *renderer.picturePass);

    if (!window) renderer.resize({options.width, options.height});
    bool recorded = !options.submitted, tab = false;
    float yaw = kYaw, pitch = kPitch, distance = kDistance;
    const uint32_t end = window ? options.frames : options.headless;
    for (uint32_t frame = 0; (end == 0 || frame < end) && !(window && glfwWindowShouldClose(window)); ++frame) {
        if (window) {
            glfwPollEvents();
            const auto held = [window](int key) { return glfwGetKey(window, key) == GLFW_PRESS; };
            if (held(GLFW_KEY_ESCAPE)) break;
            if (held(GLFW_KEY_TAB) && !tab) recorded = !recorded;
            tab = held(GLFW_KEY_TAB);
            distance *= held(GLFW_KEY_W) ? 0.98f : held(GLFW_KEY_S) ? 1.02f : 1.0f;
            const ImGuiIO& io = ImGui::GetIO();
            if (io.MouseDown[0] && !io.WantCaptureMouse) {
                yaw -= 0.01f * io.MouseDelta.x;
                pitch = std::clamp(pitch + 0.01f * io.MouseDelta.y, -0.1f, 1.5f);
            }
            if (options.exercise && frame % 7 == 6) recorded = !recorded;
            if (options.exercise && frame % 10 == 9)
                glfwSetWindowSize(window, 300 + int(frame * 37 % 400), 200 + int(frame * 23 % 300));
            if (!swapchain->acquire(renderer)) continue;
        }
        const vk::Extent2D size = window ? swapchain->size : vk::Extent2D(options.width, options.height);
        const Camera camera = orbit(yaw, pitch, distance, float(size.width) / float(size.height));
        renderer.draw(camera, lightsAt(frame / 60.0), recorded, window ? swapchain->target : Target(),
                      [&](const vk::raii::CommandBuffer& commands) {
                          if (ui) ui->draw(commands, renderer.shadows, size, recorded);
                      });
        if (window) swapchain->present();
    }
    if (!window) write(options.out, gpu, renderer.picture, options);
}

} // namespace
} // namespace embed

int main(int argc, char** argv)
{
    embed::Options options;
    CLI::App app("gnomon in a small engine");
    app.option_defaults()->always_capture_default();
    app.add_option("model", options.model, "glTF, OBJ or what else Assimp reads");
    app.add_option("--width", options.width, "pixels")->check(CLI::Range(16, 8192));
    app.add_option("--height", options.height, "pixels")->check(CLI::Range(16, 8192));
    app.add_option("--headless", options.headless, "no window: draw so many frames, write the last one");
    app.add_option("--out", options.out, "PNG of --headless");
    app.add_option("--frames", options.frames, "of the window; 0: until it is closed");
    app.add_flag("--submitted", options.submitted, "begin with gnSubmitShadows()");
    app.add_flag("--panel", options.panel, "the panel without a window, too");
    app.add_flag("--exercise", options.exercise, "resize the window and press Tab every few frames, for tests");
    CLI11_PARSE(app, argc, argv);
    try {
        embed::run(options);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "gnomon_embed: %s\n", error.what());
        return 1;
    }
}
