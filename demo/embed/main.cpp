// gnomon in a small engine: a model, a floor and a pane of glass under three lights. Left button: turn, W and S: nearer
// and farther, Tab: the other way of asking for shadows, Esc: end. README.md has the options.
#include <cstdio>
#include <optional>

#include <CLI/CLI.hpp>
#include <lodepng.h>

#include "window.hpp"

namespace embed {
namespace {

struct Options {
    std::string model = "/usr/share/glmark2/models/bunny.obj", out = "embed.png";
    uint32_t width = 1280, height = 720, headless = 0, frames = 0;
    bool submitted = false, panel = false, exercise = false;
};

/// Where the last picture is copied to, and from there into a file.
struct Copy {
    Copy(const Gpu& gpu, vk::DeviceSize bytes)
        : buffer(gpu.device, vk::BufferCreateInfo({}, bytes, vk::BufferUsageFlagBits::eTransferDst)),
          memory(
              gpu.place(buffer, vk::MemoryPropertyFlagBits::eHostVisible | vk::MemoryPropertyFlagBits::eHostCoherent))
    {
    }
    void write(const Options& options) const
    {
        const auto* pixels = static_cast<const unsigned char*>(memory.mapMemory(0, VK_WHOLE_SIZE));
        if (const unsigned error = lodepng::encode(options.out, pixels, options.width, options.height))
            throw std::runtime_error(options.out + ": " + lodepng_error_text(error));
    }
    vk::raii::Buffer buffer;
    vk::raii::DeviceMemory memory;
};

void run(const Options& options)
{
    std::optional<Window> window;
    if (!options.headless) window.emplace(vk::Extent2D(options.width, options.height));
    Gpu gpu(window ? window->extensions : std::vector<const char*>(), window ? &Window::presents : nullptr);
    std::optional<Swapchain> swapchain;
    if (window) swapchain.emplace(gpu, *window);
    const Scene scene = loadScene(options.model);
    Renderer renderer(gpu, scene);
    std::optional<Ui> ui;
    if (window || options.panel) ui.emplace(gpu, window ? &*window : nullptr, renderer.picture.format);
    vk::Extent2D size;
    const auto resize = [&](vk::Extent2D to) {
        size = to;
        renderer.resize(to);
        if (ui) ui->resize(renderer.picture, to);
    };
    std::optional<Copy> copy;
    if (!window) {
        resize({options.width, options.height});
        copy.emplace(gpu, size_t(options.width) * options.height * 4);
    }

    bool recorded = !options.submitted, tab = false;
    float yaw = kYaw, pitch = kPitch, distance = kDistance;
    double x = 0.0, y = 0.0;
    const uint32_t end = window ? options.frames : options.headless;
    for (uint32_t frame = 0; (end == 0 || frame < end) && !(window && glfwWindowShouldClose(window->handle)); ++frame) {
        if (window) {
            glfwPollEvents();
            GLFWwindow* handle = window->handle;
            const auto held = [handle](int key) { return glfwGetKey(handle, key) == GLFW_PRESS; };
            if (held(GLFW_KEY_ESCAPE)) break;
            if (held(GLFW_KEY_TAB) && !tab) recorded = !recorded;
            tab = held(GLFW_KEY_TAB);
            distance *= held(GLFW_KEY_W) ? 0.98f : held(GLFW_KEY_S) ? 1.02f : 1.0f;
            const double fromX = std::exchange(x, ImGui::GetIO().MousePos.x),
                         fromY = std::exchange(y, ImGui::GetIO().MousePos.y);
            if (ImGui::GetIO().MouseDown[0] && !ImGui::GetIO().WantCaptureMouse) {
                yaw -= 0.01f * float(x - fromX);
                pitch = std::clamp(pitch + 0.01f * float(y - fromY), -0.1f, 1.5f);
            }
            if (options.exercise && frame % 7 == 6) recorded = !recorded;
            if (options.exercise && frame % 10 == 9)
                glfwSetWindowSize(handle, 300 + int(frame * 37 % 400), 200 + int(frame * 23 % 300));
            if (!swapchain->acquire(resize)) continue;
        }
        const Camera camera = orbit(yaw, pitch, distance, float(size.width) / float(size.height));
        const auto draw = [&](const vk::raii::CommandBuffer& commands) {
            if (ui) ui->draw(commands, renderer.shadows, recorded);
        };
        renderer.draw(camera, lightsAt(frame / 60.0), recorded, draw, window ? swapchain->target() : Target(),
                      copy && frame + 1 == end ? &copy->buffer : nullptr);
        if (window) swapchain->present();
    }
    renderer.waitFor(renderer.frame());
    if (copy) copy->write(options);
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
