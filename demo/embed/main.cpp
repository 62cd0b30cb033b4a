// gnomon in a small engine: a model, a floor and a pane of glass under three lights. Left button: turn, W and S: nearer
// and farther, Tab: the other way of asking for shadows, Esc: end. README.md has the options.
#include <optional>

#include "renderer.hpp" // Vulkan before the headers that take it from there

#include <CLI/CLI.hpp>
#include <gnomon/gnomon_imgui.h>
#include <imgui_impl_glfw.h>
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
    std::atexit(glfwTerminate); // long after all that belongs to the window
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    GLFWwindow* window = glfwCreateWindow(int(options.width), int(options.height), "gnomon embed", nullptr, nullptr);
    if (!window) throw std::runtime_error("no window");
    return window;
}

/// gnomon's panel over the picture.
class Ui {
public:
    /// \param window Null: none, and no mouse. \param picture Like those that are drawn over.
    Ui(const Gpu& gpu, GLFWwindow* window, const Canvas& picture) : window_(window)
    {
        const vk::DescriptorPoolSize size(vk::DescriptorType::eCombinedImageSampler, 1);
        constexpr auto freed = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet;
        descriptors_ = {gpu.device, vk::DescriptorPoolCreateInfo(freed, 1, size)};
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        ImGui::GetIO().DisplaySize = ImVec2(float(picture.size.width), float(picture.size.height));
        if (window) ImGui_ImplGlfw_InitForVulkan(window, true);
        ImGui_ImplVulkan_InitInfo info{.Instance = *gpu.instance, .PhysicalDevice = *gpu.physical};
        info.Device = *gpu.device;
        info.Queue = *gpu.queue; // of family 0
        info.DescriptorPool = *descriptors_;
        info.MinImageCount = info.ImageCount = kInFlight; // sets of its vertex buffers
        ImGui_ImplVulkan_Init(&info, *picture.pass);
#if IMGUI_VERSION_NUM < 19000 // later ones do it themselves
        const vk::raii::CommandPool pool(gpu.device, vk::CommandPoolCreateInfo());
        const vk::raii::CommandBuffers commands(gpu.device, {*pool, {}, 1});
        commands[0].begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        ImGui_ImplVulkan_CreateFontsTexture(*commands[0]);
        commands[0].end();
        gpu.queue.submit(vk::SubmitInfo({}, {}, *commands[0]));
        gpu.device.waitIdle();
#endif
    }
    ~Ui()
    {
        ImGui_ImplVulkan_Shutdown();
        if (window_) ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }

    /// What the panel has to say of the last frame.
    ImDrawData* draw(const Shadows& shadows, bool recorded)
    {
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
        return ImGui::GetDrawData();
    }

private:
    GLFWwindow* window_;
    vk::raii::DescriptorPool descriptors_ = nullptr;
    gnomon::ImguiPanel panel_;
};

void run(const Options& options)
{
    GLFWwindow* const window = options.headless ? nullptr : openWindow(options);
    const Gpu gpu(window);
    const Scene scene = loadScene(options.model);
    const auto format = window ? kWindowFormat : vk::Format::eR8G8B8A8Unorm; // PNG's order of bytes
    Canvas picture(gpu, {format}, vk::ImageLayout::eTransferSrcOptimal);
    picture.resize({options.width, options.height});
    std::optional<Swapchain> swapchain;
    if (window) swapchain.emplace(gpu, window);
    std::optional<Ui> ui;
    if (window || options.panel) ui.emplace(gpu, window, picture);
    Renderer renderer(gpu, scene, picture, window ? &*swapchain : nullptr); // ends first, and waits

    Camera camera;
    bool recorded = !options.submitted, tab = false;
    const uint32_t end = window ? options.frames : options.headless;
    for (uint32_t frame = 0; (end == 0 || frame < end) && !(window && glfwWindowShouldClose(window)); ++frame) {
        if (window) {
            glfwPollEvents();
            const auto held = [window](int key) { return glfwGetKey(window, key) == GLFW_PRESS; };
            if (held(GLFW_KEY_ESCAPE)) break;
            if (held(GLFW_KEY_TAB) && !tab) recorded = !recorded;
            tab = held(GLFW_KEY_TAB);
            camera.distance *= held(GLFW_KEY_W) ? 0.98f : held(GLFW_KEY_S) ? 1.02f : 1.0f;
            const ImGuiIO& io = ImGui::GetIO();
            if (io.MouseDown[0] && !io.WantCaptureMouse) {
                camera.yaw -= 0.01f * io.MouseDelta.x;
                camera.pitch = std::clamp(camera.pitch + 0.01f * io.MouseDelta.y, -0.1f, 1.5f);
            }
            if (options.exercise && frame % 7 == 6) recorded = !recorded;
            if (options.exercise && frame % 10 == 9)
                glfwSetWindowSize(window, 300 + int(frame * 37 % 400), 200 + int(frame * 23 % 300));
        }
        renderer.draw(camera, lightsAt(frame / 60.0), recorded, ui ? ui->draw(renderer.shadows, recorded) : nullptr);
    }
    if (window) return;
    if (const unsigned error = lodepng::encode(options.out, renderer.pixels(), options.width, options.height))
        throw std::runtime_error(options.out + ": " + lodepng_error_text(error));
}

} // namespace
} // namespace embed

int main(int argc, char** argv)
try {
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
    embed::run(options);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "gnomon_embed: %s\n", error.what());
    return 1;
}
