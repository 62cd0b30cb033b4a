// The window, under a virtual X server: resized twenty times with validation on, then looked at; and when its
// semaphores are used again. This executable's own Vulkan functions stand before the loader's.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "demo/host/window.hpp"
#include "demo/io/png.hpp"
#include "demo/program/session.hpp"
#include "x_server.hpp"

namespace {

/// What is known to be finished of the waits for semaphores that images were acquired with.
struct Acquired {
    uint64_t waitedFor = 0;                     ///< Of the renderer's timeline.
    std::map<VkSemaphore, uint64_t> finishedBy; ///< Value of the timeline once the newest wait for it is over.
    uint32_t images = 0, early = 0;             ///< Acquired; of these with a semaphore that may be waited for.
} acquired;

/// Of the next windows.
struct Surfaces {
    bool supported = true; ///< By the device.
    uint32_t asked = 0, destroyed = 0;
} surfaces;

template <typename Function>
Function* loaders(const char* name, Function*)
{
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

} // namespace

extern "C" {

VKAPI_ATTR VkResult VKAPI_CALL vkAcquireNextImageKHR(VkDevice device, VkSwapchainKHR swapchain, uint64_t timeout,
                                                     VkSemaphore semaphore, VkFence fence, uint32_t* index)
{
    ++acquired.images;
    const auto used = acquired.finishedBy.find(semaphore);
    acquired.early += used != acquired.finishedBy.end() && used->second > acquired.waitedFor;
    return loaders("vkAcquireNextImageKHR", &vkAcquireNextImageKHR)(device, swapchain, timeout, semaphore, fence,
                                                                    index);
}

VKAPI_ATTR VkResult VKAPI_CALL vkQueueSubmit2(VkQueue queue, uint32_t count, const VkSubmitInfo2* submits,
                                              VkFence fence)
{
    for (uint32_t i = 0; i < count; ++i)
        if (submits[i].waitSemaphoreInfoCount > 0) // the renderer waits for an image, and signals its timeline first
            acquired.finishedBy[submits[i].pWaitSemaphoreInfos[0].semaphore] =
                submits[i].pSignalSemaphoreInfos[0].value;
    return loaders("vkQueueSubmit2", &vkQueueSubmit2)(queue, count, submits, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL vkWaitSemaphores(VkDevice device, const VkSemaphoreWaitInfo* info, uint64_t timeout)
{
    acquired.waitedFor = std::max(acquired.waitedFor, info->pValues[0]);
    return loaders("vkWaitSemaphores", &vkWaitSemaphores)(device, info, timeout);
}

VKAPI_ATTR VkResult VKAPI_CALL vkGetPhysicalDeviceSurfaceSupportKHR(VkPhysicalDevice device, uint32_t family,
                                                                    VkSurfaceKHR surface, VkBool32* supported)
{
    ++surfaces.asked;
    const VkResult result = loaders("vkGetPhysicalDeviceSurfaceSupportKHR",
                                    &vkGetPhysicalDeviceSurfaceSupportKHR)(device, family, surface, supported);
    if (!surfaces.supported) *supported = VK_FALSE;
    return result;
}

VKAPI_ATTR void VKAPI_CALL vkDestroySurfaceKHR(VkInstance instance, VkSurfaceKHR surface,
                                               const VkAllocationCallbacks* allocator)
{
    ++surfaces.destroyed;
    loaders("vkDestroySurfaceKHR", &vkDestroySurfaceKHR)(instance, surface, allocator);
}

} // extern "C"

namespace gnomon::demo {

TEST_CASE("a window resized twenty times keeps validation silent and shows the scene")
{
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "gnomon_window_test.png";
    const std::filesystem::path said = std::filesystem::temp_directory_path() / "gnomon_window_test.txt";
    std::filesystem::remove(file);
    const std::string command =
        "'" GNOMON_PROGRAM
        "' run room --window --size 320x180 --validate --resize-test 20 --why 30:spot1 --screenshot '" +
        file.string() + "' >'" + said.string() + "'";
    CHECK(std::system(command.c_str()) == 0);
    std::ostringstream text;
    text << std::ifstream(said).rdbuf();
    CHECK_MESSAGE(text.str().find("light 'spot1', frame 30") != std::string::npos, text.str()); // --why, at the end
    std::filesystem::remove(said);
    const Outcome<Image8> picture = readPng(file, 3);
    REQUIRE_MESSAGE(picture, picture.error());
    CHECK(picture->width == 640); // the last size the test asks for
    CHECK(picture->height == 360);
    std::set<uint32_t> colours;
    for (size_t i = 0; i < picture->texels.size(); i += 3)
        colours.insert(uint32_t(picture->texels[i]) << 16 | picture->texels[i + 1] << 8 | picture->texels[i + 2]);
    CHECK(colours.size() > 200); // a room under several lights, not a clear colour
#if GNOMON_WITH_IMGUI
    size_t title = 0; // of the panel, in the colour of ImGui's dark style: 0.16, 0.29, 0.48
    for (size_t i = 0; i < picture->texels.size(); i += 3)
        title += picture->texels[i] == 41 && picture->texels[i + 1] == 74 && picture->texels[i + 2] == 122;
    CHECK(title > 2000);
#endif
    std::filesystem::remove(file);
}

TEST_CASE("no image is acquired with a semaphore that a frame in flight may still wait for")
{
    const WindowSystem system;
    for (const uint32_t inFlight : {1u, 2u, 3u}) {
        CAPTURE(inFlight);
        acquired = {};
        Session session({.scene = "room",
                         .size = {64, 48},
                         .framesInFlight = inFlight,
                         .instanceExtensions = system.instanceExtensions()});
        Window window(session.device, session.renderer.extent(), "gnomon", inFlight);
        const CameraState camera = session.camera(0.0);
        for (int i = 0; i < 12; ++i) {
            window.pollEvents();
            window.frame([&](const PresentTarget& target) {
                session.renderer.resize(target.extent);
                session.renderer.draw({.cameras = {&camera, 1}, .present = &target});
            });
        }
        window.finish();
        CHECK(acquired.images == 12);
        CHECK(acquired.early == 0);
    }
}

TEST_CASE("a device that cannot present to the window is named, and nothing of the window is left")
{
    const WindowSystem system;
    Session session({.scene = "room", .size = {64, 48}, .instanceExtensions = system.instanceExtensions()});
    surfaces = {.supported = false};
    std::string said;
    try {
        const Window window(session.device, session.renderer.extent(), "gnomon_refused", 2);
    } catch (const HostError& error) {
        said = error.what();
    }
    CHECK(said == std::string(session.device.properties.deviceName) + " cannot present to a window of this display");
    CHECK(surfaces.asked == 1);
    CHECK(surfaces.destroyed == 1);
    surfaces = {};
    {
        const Window window(session.device, session.renderer.extent(), "gnomon", 2);
        CHECK(surfaces.destroyed == 0);
    }
    CHECK(surfaces.destroyed == 1);
    CHECK(session.device.validation.messages().empty());
}

} // namespace gnomon::demo

int main(int argc, char** argv)
{
    if (!gnomon::demo::serverPurpose()) return gnomon::demo::runUnderServer("1280x1024", "1", argc, argv);
    if (gnomon::demo::Device::nonePresent() || !gnomon::demo::Device::validationPresent()) return 77;
    return doctest::Context(argc, argv).run();
}
