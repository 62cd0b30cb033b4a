// What a driver has to say about what gnomon gives it.
#include "demo/host/pipelines.hpp"
#include "device/fixture.hpp"
#include "shaders/invariant_vert.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Listens to the driver while it lives, from warnings on; what the validation layer says is of other types.
class DriverLog {
public:
    DriverLog()
    {
        const VkDebugUtilsMessengerCreateInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
                                                      .messageSeverity =
                                                          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                                          VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
                                                      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT,
                                                      .pfnUserCallback = &add,
                                                      .pUserData = &log_};
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(device().instance, "vkCreateDebugUtilsMessengerEXT"));
        REQUIRE(static_cast<bool>(create));
        REQUIRE(create(device().instance, &info, nullptr, &messenger_) == VK_SUCCESS);
    }
    ~DriverLog()
    {
        reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
            device().instance, "vkDestroyDebugUtilsMessengerEXT"))(device().instance, messenger_, nullptr);
    }
    DriverLog(const DriverLog&) = delete;
    DriverLog& operator=(const DriverLog&) = delete;
    std::vector<std::string> messages() const { return log_.messages(); }

private:
    static VKAPI_ATTR VkBool32 VKAPI_CALL add(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                              const VkDebugUtilsMessengerCallbackDataEXT* data, void* user)
    {
        static_cast<demo::ValidationLog*>(user)->add(data->pMessage ? data->pMessage : "(no text)");
        return VK_FALSE;
    }
    demo::ValidationLog log_;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

} // namespace

// Silence means something only where words are heard.
TEST_CASE_FIXTURE(DeviceTest, "a driver's warning is heard")
{
    const demo::UniquePipelineLayout layout = demo::makePipelineLayout(device(), {}, 0, 0);
    const DriverLog log;
    const demo::UniquePipeline pipeline =
        demo::makeGraphicsPipeline(device(), {.vertex = k_invariant_vert,
                                              .fragment = {},
                                              .layout = layout.get(),
                                              .depth = VK_FORMAT_D32_SFLOAT});
    for (const std::string& message : log.messages())
        MESSAGE("driver: " << message);
    if (device().driver.starts_with("Mesa 22.")) // Mesa 25.0.7 takes it without a word
        CHECK(!log.messages().empty());
    else
        MESSAGE("nothing is known that this driver warns of");
}

TEST_CASE_FIXTURE(DeviceTest, "the driver has nothing to say about any method")
{
    const DriverLog log;
    const Host host(smallScene(), {.extent = {96, 54}});
    host.require(gnWarmUp(host.context)); // makes and runs every pipeline
    for (const std::string& message : log.messages())
        FAIL_CHECK("driver: " << message);
}
