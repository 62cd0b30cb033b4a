// What a timed frame does otherwise than the rest: CPU passes run in turn, so that each is charged with its own time.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>

#include <gnomon/algorithm.h>

#include "device/fade_support.hpp"
#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kMethod = "sleeper";
constexpr std::chrono::milliseconds kSleep{3};

const GnPluginInterface* gn = nullptr;
std::atomic<int> running{0}, most{0};

void GN_CALL sleepAWhile(GnPassContext, void*)
{
    const int now = ++running;
    int before = most;
    while (now > before && !most.compare_exchange_weak(before, now)) {
    }
    std::this_thread::sleep_for(kSleep);
    --running;
}

void GN_CALL nothing(GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {}

void GN_CALL declare(void*, GnPassBuilder builder, const GnShadowTask* task)
{
    const GnBufferInfo bufferInfo{
        .pName = "sleeper.dream", .scope = GN_SCOPE_TASK, .size = 4, .place = GN_BUFFER_UPLOAD};
    GnAccess dream{.kind = GN_ACCESS_WRITE};
    dream.buffer = gn->pfnBuffer(builder, &bufferInfo);
    const GnPassInfo prepare{.pName = "sleeper.sleep",
                             .kind = GN_PASS_PREPARE,
                             .scope = GN_SCOPE_TASK,
                             .accessCount = 1,
                             .pAccesses = &dream,
                             .pfnRun = sleepAWhile};
    gn->pfnPass(builder, &prepare);
    GnAccess fills[2]{{.kind = GN_ACCESS_READ}, {.kind = GN_ACCESS_WRITE}};
    fills[0].buffer = dream.buffer;
    fills[1].image = task->visibility;
    fills[1].baseLayer = task->layer;
    fills[1].clear = VK_TRUE;
    const GnPassInfo raster{.pName = "sleeper.fill",
                            .kind = GN_PASS_RASTER,
                            .scope = GN_SCOPE_TASK,
                            .accessCount = 2,
                            .pAccesses = fills,
                            .area = task->area,
                            .pfnRecord = nothing};
    gn->pfnPass(builder, &raster);
}

void registerMethod(const Host& host, const char* name, PFN_gnDeclare declare)
{
    host.require(gnGetPluginInterface(host.context, &gn));
    const GnAlgorithmInfo info{.pName = name,
                               .pSource = "none",
                               .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT,
                               .pfnDeclare = declare};
    host.require(gnRegisterAlgorithm(host.context, &info));
}

// --- a method of many passes ---

constexpr const char* kCrowd = "crowd";
// With two queries each, more than two pools of them.
constexpr uint32_t kCrowdPasses = 2500;
uint32_t crowdPasses = 0; // in the next frame

void GN_CALL declareCrowd(void*, GnPassBuilder builder, const GnShadowTask* task)
{
    GnAccess fill{.kind = GN_ACCESS_WRITE, .image = task->visibility, .baseLayer = task->layer, .clear = VK_TRUE};
    fill.rect = {task->area.offset, {1, 1}};
    for (uint32_t i = 0; i < crowdPasses; ++i) {
        const GnPassInfo raster{.pName = "crowd.fill",
                                .kind = GN_PASS_RASTER,
                                .scope = GN_SCOPE_TASK,
                                .variant = i,
                                .accessCount = 1,
                                .pAccesses = &fill,
                                .pfnRecord = nothing};
        gn->pfnPass(builder, &raster);
    }
}

// --- a queue without timestamps, and what is reset of queries ---

uint32_t queriesReset = 0;

VKAPI_ATTR void VKAPI_CALL countedReset(VkCommandBuffer cmd, VkQueryPool pool, uint32_t first, uint32_t count)
{
    queriesReset += count;
    vkCmdResetQueryPool(cmd, pool, first, count);
}

// --- a clock that does not tell the time ---

enum class Clock { right, still, backwards };
Clock queueClock = Clock::right;

VKAPI_ATTR VkResult VKAPI_CALL wrongTimestamps(VkDevice handle, VkQueryPool pool, uint32_t first, uint32_t count,
                                               size_t size, void* data, VkDeviceSize stride, VkQueryResultFlags flags)
{
    const VkResult result = vkGetQueryPoolResults(handle, pool, first, count, size, data, stride, flags);
    for (uint32_t i = 0; i < count && queueClock != Clock::right; ++i)
        static_cast<uint64_t*>(data)[i] = queueClock == Clock::still ? 7 : 1'000'000 - i;
    return result;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetDeviceProcAddr(VkDevice handle, const char* name)
{
    if (std::strcmp(name, "vkCmdResetQueryPool") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&countedReset);
    if (std::strcmp(name, "vkGetQueryPoolResults") == 0) return reinterpret_cast<PFN_vkVoidFunction>(&wrongTimestamps);
    return vkGetDeviceProcAddr(handle, name);
}

template <bool timestamps>
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (!timestamps && std::strcmp(name, "vkGetPhysicalDeviceQueueFamilyProperties2") == 0)
        return withoutTimestamps().instead;
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&hookedGetDeviceProcAddr);
    return vkGetInstanceProcAddr(instance, name);
}

template <bool timestamps>
HostOptions hooked()
{
    return {.context = [](GnContextCreateInfo& info) {
        info.pfnGetInstanceProcAddr = &hookedGetInstanceProcAddr<timestamps>;
    }};
}

/// Of the newest completed frame of which every pass was timed.
std::vector<GnPassTiming> newestTimings(const Host& host, uint64_t& frame)
{
    uint32_t count = 0;
    host.require(gnGetPassTimings(host.context, &frame, &count, nullptr));
    std::vector<GnPassTiming> passes(count);
    host.require(gnGetPassTimings(host.context, &frame, &count, passes.data()));
    return passes;
}

FrameOptions timed(GnFrameFlags flags)
{
    return {.adjust = [flags](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.flags = flags; }};
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "CPU passes of lights run side by side, but in turn where their times are taken")
{
    Scene scene = demo::valueOf(demo::loadScene("room"));
    demo::limitLights(scene, 4);
    Host host(std::move(scene), {.context = [](GnContextCreateInfo& info) { info.jobThreadCount = 4; }});
    registerMethod(host, kMethod, declare);
    host.pinAll(kMethod);
    host.draw(4, timed(0)); // the method becomes ready
    REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
    REQUIRE(host.decision(0).pMethod == std::string(kMethod));

    // One frame in eight is timed unasked; of three in a row at most one.
    most = 0;
    float leastMs = 1e9f;
    for (int i = 0; i < 3; ++i) {
        host.require(host.draw(timed(0)));
        leastMs = std::min(leastMs, host.stats().cpuMs);
    }
    CHECK(most >= 2);
    CHECK(leastMs < 4.0f * static_cast<float>(kSleep.count())); // side by side counts once

    most = 0;
    host.require(host.draw(timed(GN_FRAME_TIMED_BIT)));
    CHECK(most == 1);
    CHECK(host.stats().cpuMs >= 4.0f * static_cast<float>(kSleep.count()));
}

TEST_CASE_FIXTURE(DeviceTest, "GPU and CPU time of a frame are told together, and what no light is charged with apart")
{
    Host host(smallScene());
    host.pinAll("ray_traced");
    host.draw(4, timed(0));
    std::vector<GnFrameStats> frames;
    std::vector<float> least,
        greatest; // of what is shared, in timed frames: GPU times are scaled down to an untimed one's
    uint64_t timedFrame = 0;
    for (int i = 0; i < 40; ++i) {
        host.require(host.draw(timed(0)));
        const GnFrameStats now = host.stats();
        frames.push_back(now);
        CHECK(now.gpuFrame < now.frame);
        if (now.gpuFrame >= frames[0].frame) {
            const GnFrameStats& then = frames[now.gpuFrame - frames[0].frame];
            CHECK(then.frame == now.gpuFrame);
            CHECK(now.gpuFrameCpuMs == then.cpuMs);
        }
        uint64_t frame = 0;
        const std::vector<GnPassTiming> passes = newestTimings(host, frame);
        if (frame == timedFrame) continue;
        timedFrame = frame;
        least.push_back(0.0f);
        greatest.push_back(0.0f);
        for (const GnPassTiming& pass : passes) {
            if (pass.light) continue;
            least.back() += pass.cpuMs;
            greatest.back() += pass.cpuMs + pass.gpuMs;
        }
    }
    REQUIRE(greatest.size() >= 4);
    CHECK(greatest.back() > 0.0f);     // copies for the rays
    host.require(host.draw(timed(0))); // plans with what the frame before had learned
    CHECK(host.stats().sharedMs >= *std::max_element(least.end() - 4, least.end()));
    CHECK(host.stats().sharedMs <= 1.0001f * *std::max_element(greatest.end() - 4, greatest.end()));
}

TEST_CASE_FIXTURE(DeviceTest, "what is shared counts the depth grid also where every frame is timed")
{
    Host host(smallScene(), {.extent = {640, 360}});
    favour(host, "shadow_map", 0); // which has nothing that is shared
    float least = 1e9f;            // that frames with a grid took beside their lights
    uint64_t newest = 0;
    for (int i = 0; i < 40; ++i) {
        host.require(host.draw(timed(GN_FRAME_TIMED_BIT)));
        (void)host.pictures(); // waits, so that the next frame finds the timings of this one
        uint64_t frame = 0;
        const std::vector<GnPassTiming> passes = newestTimings(host, frame);
        const auto isGrid = [](const GnPassTiming& pass) { return pass.pName == std::string("view.depth_grid"); };
        if (frame == newest || std::none_of(passes.begin(), passes.end(), isGrid)) continue;
        newest = frame;
        float sum = 0.0f;
        for (const GnPassTiming& pass : passes)
            if (!pass.light) sum += pass.gpuMs + pass.cpuMs;
        least = std::min(least, sum);
    }
    REQUIRE(newest > 24); // three or more
    CHECK(host.stats().sharedMs >= least);
}

TEST_CASE_FIXTURE(DeviceTest, "CPU passes have their times on a queue without timestamps too")
{
    Host host(smallScene(), hooked<false>());
    host.pinAll("ray_traced");
    host.draw(6, timed(GN_FRAME_TIMED_BIT));
    uint64_t frame = 0;
    float cpuMs = 0.0f;
    for (const GnPassTiming& pass : newestTimings(host, frame)) {
        CHECK(pass.gpuMs == 0.0f);
        if (pass.pName == std::string("ray_traced.trace")) cpuMs += pass.cpuMs;
    }
    CHECK(frame + 2 >= host.frame());
    CHECK(cpuMs > 0.0f);
    GnLightTiming light{};
    host.require(gnGetLightTiming(host.context, host.views[0], host.lights[0], &light));
    CHECK(light.resolveCpuMs > 0.0f);
    CHECK(dark(host.pictures()[0]) > 100);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "timestamps that stand still or run backwards are said once, and nothing is learned from them")
{
    for (const Clock clock : {Clock::still, Clock::backwards}) {
        queueClock = clock;
        Host host(smallScene(), hooked<true>());
        host.pinAll("shadow_map");
        host.draw(1, timed(GN_FRAME_TIMED_BIT));
        const float predicted = host.decision(0).predictedMs;
        host.draw(12, timed(GN_FRAME_TIMED_BIT));
        CHECK(host.decision(0).predictedMs == doctest::Approx(predicted));
        CHECK(host.stats().gpuMs == 0.0f);
        const std::vector<std::string> said = host.takeMessages();
        const auto isSo = [](const std::string& message) { return message.find("NoTimestamps") != std::string::npos; };
        CHECK(std::count_if(said.begin(), said.end(), isSo) == 1);
        queueClock = Clock::right;
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a frame resets the queries that it writes, two a round where it is not timed")
{
    Host host(smallScene(), hooked<true>());
    host.pinAll("pcf_hybrid");
    host.draw(7, timed(0)); // the next frame is timed unasked, those after it are not
    const auto resetBy = [&](GnFrameFlags flags) {
        queriesReset = 0;
        host.require(host.draw(timed(flags)));
        return queriesReset;
    };
    const uint32_t whole = resetBy(GN_FRAME_TIMED_BIT);
    CHECK(whole >= 2 * host.stats().rounds + 2);
    CHECK(whole < 100);
    CHECK(resetBy(0) == 2 * host.stats().rounds);
}

TEST_CASE_FIXTURE(DeviceTest, "no pass of a timed frame is untimed, however many there are")
{
    Host host(smallScene());
    registerMethod(host, kCrowd, declareCrowd);
    host.pinAll(kCrowd);
    for (const uint32_t count :
         {1u, kCrowdPasses, 1u}) { // timings come with the frame after the one that is waited for
        crowdPasses = count;
        host.require(host.draw(timed(GN_FRAME_TIMED_BIT)));
        (void)host.pictures();
    }
    uint64_t frame = 0;
    uint32_t passes = 0, untimed = 0;
    for (const GnPassTiming& pass : newestTimings(host, frame)) {
        if (pass.pName != std::string("crowd.fill")) continue;
        ++passes;
        untimed += pass.gpuMs <= 0.0f;
    }
    CHECK(frame + 1 == host.frame());
    CHECK(passes == kCrowdPasses);
    CHECK(untimed == 0);
}
