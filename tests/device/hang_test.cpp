// A device that does not come back: calls end at the context's limit, name what hangs, and touch nothing afterwards.
#include <algorithm>
#include <chrono>
#include <utility>

#include "device/hooks.hpp"
#include "sanitized.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr uint32_t kLimitMs = 1000;

/// The device waits for an event where a pass or a pipeline's first run begins.
struct Hang {
    VkEvent event = VK_NULL_HANDLE;
    std::vector<std::string> passes; ///< That were recorded so far.
    std::string atPass;              ///< The pass of that name; empty: none.
    uint32_t atCompute = UINT32_MAX; ///< Before so many compute pipelines are bound.
} hang;

void waitForEvent(VkCommandBuffer cmd)
{
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdWaitEvents2(cmd, 1, &hang.event, &info);
}

VKAPI_ATTR void VKAPI_CALL beginLabel(VkCommandBuffer cmd, const VkDebugUtilsLabelEXT* label)
{
    hang.passes.push_back(label->pLabelName);
    if (hang.atPass == label->pLabelName) waitForEvent(cmd);
}

VKAPI_ATTR void VKAPI_CALL endLabel(VkCommandBuffer) {}

VKAPI_ATTR void VKAPI_CALL bindPipeline(VkCommandBuffer cmd, VkPipelineBindPoint point, VkPipeline pipeline)
{
    if (point == VK_PIPELINE_BIND_POINT_COMPUTE && hang.atCompute != UINT32_MAX && hang.atCompute-- == 0)
        waitForEvent(cmd);
    vkCmdBindPipeline(cmd, point, pipeline);
}

HostOptions hanging()
{
    HostOptions options;
    options.context = [](GnContextCreateInfo& info) {
        static std::vector<const char*> extensions; // labels say which pass begins
        extensions.assign(info.ppEnabledExtensionNames, info.ppEnabledExtensionNames + info.enabledExtensionCount);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
        info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
        info.ppEnabledExtensionNames = extensions.data();
        info.waitLimitMs = kLimitMs;
    };
    return hooked(options, {hook("vkCmdBeginDebugUtilsLabelEXT", &beginLabel),
                            hook("vkCmdEndDebugUtilsLabelEXT", &endLabel), hook("vkCmdBindPipeline", &bindPipeline)});
}

/// Validation may say one thing only: to set an event that a device waits for is against the rules, and how this device
/// is made to hang.
class HangTest {
public:
    HangTest() : before_(device().validation.count())
    {
        hang = {};
        const VkEventCreateInfo info{.sType = VK_STRUCTURE_TYPE_EVENT_CREATE_INFO};
        demo::vkCheck(vkCreateEvent(device().handle, &info, nullptr, &hang.event), "vkCreateEvent");
    }
    ~HangTest()
    {
        comeBack();
        vkQueueWaitIdle(device().queue);
        vkDestroyEvent(device().handle, hang.event, nullptr);
        const std::vector<std::string> messages = device().validation.messages();
        for (size_t i = before_; i < messages.size(); ++i) {
            CAPTURE(messages[i]);
            CHECK(messages[i].find("VUID-vkSetEvent-event-09543") != std::string::npos);
        }
    }
    void comeBack() const { vkSetEvent(device().handle, hang.event); }

private:
    size_t before_;
};

double secondsOf(const std::function<void()>& call)
{
    const auto start = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The next frame hangs in its first pass, which is waited for: the method has a round trip.
void drawnThenHanging(Host& host)
{
    host.draw(2, {}); // the second runs what every frame runs
    hang.passes.clear();
    host.require(host.draw());
    REQUIRE(!hang.passes.empty());
    hang.atPass = hang.passes.front();
}

/// The limit, and what compiling on a busy machine adds.
bool endsAtTheLimit(double seconds)
{
    return seconds >= 1e-3 * kLimitMs && seconds < 1e-3 * kLimitMs + 30.0 * kSlowness;
}

bool told(Host& host, const char* id)
{
    const std::vector<std::string> messages = host.takeMessages();
    return std::ranges::any_of(messages, [id](const std::string& each) { return each.find(id) != std::string::npos; });
}

} // namespace

TEST_CASE_FIXTURE(HangTest, "a frame whose pass hangs ends at the limit and names the pass")
{
    for (const bool timed : {false, true}) {
        CAPTURE(timed);
        HostOptions options = hanging();
        if (timed) options.flags |= GN_CONTEXT_TIME_EVERY_FRAME_BIT;
        {
            Host host(smallScene(), options);
            host.pinAll("ray_traced");
            drawnThenHanging(host);
            CHECK(endsAtTheLimit(secondsOf([&] { CHECK(host.draw() == GN_ERROR_DEVICE_LOST); })));
            CAPTURE(host.lastError());
            CHECK(host.lastError().find("waitLimitMs") != std::string::npos);
            CHECK(host.lastError().find("'" + hang.atPass + "'") != std::string::npos);
            CHECK(secondsOf([&] { CHECK(gnWarmUp(host.context) == GN_ERROR_DEVICE_LOST); }) < 0.2 * kSlowness);
            comeBack(); // now the context can be destroyed like any other
            CHECK_FALSE(told(host, "ContextAbandoned"));
        }
        vkResetEvent(device().handle, hang.event);
        hang.atPass.clear();
    }
}

TEST_CASE_FIXTURE(HangTest, "a warm-up that hangs ends at the limit and names the pipeline")
{
    Host host(smallScene(), hanging());
    hang.atCompute = 1;
    CHECK(endsAtTheLimit(secondsOf([&] { CHECK(gnWarmUp(host.context) == GN_ERROR_DEVICE_LOST); })));
    CHECK(host.lastError().find("the first run of pipeline '") != std::string::npos);
    comeBack();
}

TEST_CASE_FIXTURE(HangTest, "a frame that waits for a semaphore nobody signals ends at the limit")
{
    const VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                         .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    demo::vkCheck(vkCreateSemaphore(device().handle, &info, nullptr, &semaphore), "vkCreateSemaphore");
    {
        Host host(smallScene(), hanging());
        host.pinAll("ray_traced");
        host.require(host.draw());
        const GnSemaphorePoint never{semaphore, 1};
        FrameOptions frame;
        frame.adjust = [&](GnFrameInfo& each, std::vector<GnViewFrame>&) {
            each.waitCount = 1;
            each.pWaits = &never;
        };
        CHECK(host.draw(frame) == GN_ERROR_DEVICE_LOST);
        CHECK(host.lastError().find("nothing that it waits for has begun") != std::string::npos);
        const VkSemaphoreSignalInfo signal{
            .sType = VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO, .semaphore = semaphore, .value = 1};
        demo::vkCheck(vkSignalSemaphore(device().handle, &signal), "vkSignalSemaphore");
    }
    vkQueueWaitIdle(device().queue);
    vkDestroySemaphore(device().handle, semaphore, nullptr);
}

TEST_CASE_FIXTURE(HangTest, "a context whose device hangs for good is left to it, and says so")
{
    Host host(smallScene(), hanging());
    host.pinAll("ray_traced");
    drawnThenHanging(host);
    CHECK(host.draw() == GN_ERROR_DEVICE_LOST);
    static_cast<void>(host.takeMessages());
    CHECK(endsAtTheLimit(secondsOf([&] { gnDestroyContext(std::exchange(host.context, nullptr)); })));
    CHECK(told(host, "ContextAbandoned"));
    comeBack(); // what the device still does finds all that it needs
}
