// Before everything is ready, with little memory, with the host's own job system, in two halves.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <set>
#include <thread>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A host's job system: two threads, and a gate that keeps them from starting anything.
class HostJobs {
public:
    HostJobs()
    {
        for (std::thread& thread : threads_)
            thread = std::thread([this] { work(); });
    }
    ~HostJobs()
    {
        {
            const std::lock_guard lock(mutex_);
            ending_ = true;
            open_ = true;
        }
        changed_.notify_all();
        for (std::thread& thread : threads_)
            thread.join();
    }
    static void GN_CALL schedule(PFN_gnJob run, void* job, void* user)
    {
        auto& self = *static_cast<HostJobs*>(user);
        {
            const std::lock_guard lock(self.mutex_);
            self.queue_.emplace_back(run, job);
            ++self.scheduled;
        }
        self.changed_.notify_one();
    }
    void open(bool isOpen)
    {
        {
            const std::lock_guard lock(mutex_);
            open_ = isOpen;
        }
        changed_.notify_all();
    }

    std::atomic<uint32_t> scheduled{0}, ran{0};

private:
    void work()
    {
        std::unique_lock lock(mutex_);
        while (true) {
            changed_.wait(lock, [this] { return open_ && (ending_ || !queue_.empty()); });
            if (queue_.empty()) return;
            const auto [run, job] = queue_.front();
            queue_.pop_front();
            lock.unlock();
            run(job);
            ++ran;
            lock.lock();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::pair<PFN_gnJob, void*>> queue_;
    bool open_ = true, ending_ = false;
    std::thread threads_[2];
};

HostOptions withJobs(HostJobs& jobs, GnContextCreateFlags flags)
{
    HostOptions options;
    options.flags = flags;
    options.context = [&jobs](GnContextCreateInfo& info) {
        info.pfnScheduleJob = &HostJobs::schedule;
        info.jobThreadCount = 2;
        info.pfnMessage = nullptr; // the user data belongs to the jobs
        info.pUserData = &jobs;
    };
    return options;
}

/// Whether a frame with all lights pinned to a method may need this one.
bool needed(const GnMethodInfo& method, const std::string& pinned)
{
    return (method.traits & GN_TRAIT_FALLBACK_BIT) != 0 || method.pName == pinned;
}

std::vector<Image8> submitted(const Scene& scene, const char* method)
{
    Host host(scene);
    host.pinAll(method);
    host.require(host.draw());
    return host.pictures();
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "without warm-up nothing is ready and all is lit, then one method after the other serves")
{
    for (const GnContextCreateFlags flags :
         {GnContextCreateFlags(GN_CONTEXT_NO_BACKGROUND_BIT), GnContextCreateFlags(0)}) {
        Host host(smallScene(), {.flags = flags, .warmUp = false});
        host.pinAll("ray_traced");
        CHECK(host.draw() == GN_NOT_READY);
        CHECK(host.decision(0).pMethod == nullptr);
        CHECK(host.decision(0).reason == GN_REASON_NOTHING_READY);
        CHECK(lit(host.pictures()[0]) == 320 * 180);

        std::set<GnReason> reasons;
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (host.decision(0).reason != GN_REASON_PINNED && std::chrono::steady_clock::now() < deadline) {
            host.require(host.draw());
            reasons.insert(host.decision(0).reason);
            if (flags == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        CHECK(host.decision(0).reason == GN_REASON_PINNED);
        CHECK(reasons.contains(GN_REASON_FALLBACK)); // shadow_map served meanwhile
        CHECK(differences(host.pictures(), submitted(smallScene(), "ray_traced")) == 0);
        if (flags == 0) continue;
        // As long as every light is pinned nobody can ask for another method; then all come, one a frame.
        const auto methods = static_cast<uint32_t>(availableMethods(host.context).size());
        host.draw(methods, {});
        for (const GnMethodInfo& method : availableMethods(host.context))
            CHECK_MESSAGE(bool(method.ready) == needed(method, "ray_traced"), std::string(method.pName));
        host.pin(0, nullptr);
        host.draw(methods, {});
        for (const GnMethodInfo& method : availableMethods(host.context))
            CHECK_MESSAGE(method.ready, std::string(method.pName));
    }
}

TEST_CASE_FIXTURE(DeviceTest, "frames make ready what the rules may choose, and nothing that they do not speak for")
{
    Host host(smallScene(), {.flags = GN_CONTEXT_NO_BACKGROUND_BIT, .warmUp = false});
    const auto spokenFor = [&](const char* method) {
        const std::string rules = std::string("version: 1\n"
                                              "variables: {screenShare: {universe: [0, 1], terms: "
                                              "{all: [-.inf, -.inf, .inf, .inf]}}}\n"
                                              "rules: [{rule: if screenShare is all then ") +
                                  method + " is favoured}]\n";
        host.require(gnLoadRules(host.context, rules.data(), rules.size(), method));
        for (size_t frames = availableMethods(host.context).size(); frames > 0; --frames)
            REQUIRE(host.draw() >= 0);
        CHECK(std::string(host.decision(0).pMethod) == method);
        for (const GnMethodInfo& each : availableMethods(host.context))
            if (!needed(each, "stencil_volume") && each.pName != std::string(method))
                CHECK_MESSAGE(!each.ready, std::string(each.pName));
    };
    spokenFor("stencil_volume");
    spokenFor("ray_traced");
}

TEST_CASE_FIXTURE(DeviceTest, "what ran for the first time in a frame that was dropped has not run")
{
    Host host(smallScene(), {.flags = GN_CONTEXT_NO_BACKGROUND_BIT, .warmUp = false});
    host.pinAll("shadow_map");
    const auto readyOnes = [&] {
        uint32_t count = 0;
        for (const GnMethodInfo& method : availableMethods(host.context))
            count += method.ready;
        return count;
    };
    bool served = false;
    for (int frame = 0; frame < 40 && !served; ++frame) {
        const uint32_t before = readyOnes();
        REQUIRE(host.draw({.call = Call::record, .drop = true}) >= 0);
        CHECK(readyOnes() == before);
        REQUIRE(host.draw({.call = Call::record}) >= 0);
        CHECK(readyOnes() <= before + 1);
        served = host.decision(0).reason == GN_REASON_PINNED;
    }
    CHECK(served);
    CHECK(differences(host.pictures(), submitted(smallScene(), "shadow_map")) == 0);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a method warmed up alone serves in the first frame, and only what stands in for it is compiled")
{
    Host host(smallScene(), {.warmUp = false});
    host.require(gnSetLightMethod(host.context, host.lights[0], "stencil_volume"));
    host.require(gnWarmUpMethod(host.context, "stencil_volume"));
    for (const GnMethodInfo& method : availableMethods(host.context))
        CHECK_MESSAGE(bool(method.ready) == needed(method, "stencil_volume"), std::string(method.pName));
    host.require(host.draw());
    CHECK(host.decision(0).reason == GN_REASON_PINNED);
    CHECK(differences(host.pictures(), submitted(smallScene(), "stencil_volume")) == 0);

    CHECK(gnWarmUpMethod(host.context, "magic") == GN_ERROR_UNKNOWN_METHOD);
    CHECK(host.lastError().find("'magic'") != std::string::npos);
    CHECK(gnWarmUpMethod(host.context, nullptr) == GN_ERROR_NULL_ARGUMENT);
    CHECK(gnWarmUpMethod(nullptr, "stencil_volume") == GN_ERROR_NULL_ARGUMENT);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame in two halves shows what a whole one shows; a timeout of 0 does not wait")
{
    for (const char* method : {"ray_traced", "pcf_hybrid", "shadow_map"}) {
        CAPTURE(std::string(method));
        Host host(smallScene());
        host.pinAll(method);
        for (int frame = 0; frame < 3; ++frame) {
            host.require(host.draw({.call = Call::begin}));
            GnResult result = GN_TIMEOUT;
            const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
            while (result == GN_TIMEOUT && std::chrono::steady_clock::now() < deadline) {
                result = host.finish(0);
                std::this_thread::yield();
            }
            CHECK(result == GN_SUCCESS);
            CHECK(host.decision(0).reason == GN_REASON_PINNED);
        }
        CHECK(differences(host.pictures(), submitted(smallScene(), method)) == 0);
        CHECK(gnFinishShadows(host.context, 0) == GN_ERROR_FRAME_ORDER);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "between the halves the depth is the host's to read, and the passes are not yet known")
{
    Host host(smallScene());
    host.pinAll("ray_traced");
    host.draw(2, {});
    const std::vector<std::byte> before = host.depthTexels();
    host.require(host.draw({.call = Call::begin})); // the depth was copied to the CPU
    CHECK(host.depthTexels() == before);            // validation knows the layout
    uint32_t count = 7;
    CHECK(gnGetFramePasses(host.context, &count, nullptr) == GN_ERROR_FRAME_ORDER);
    CHECK(count == 0);
    host.require(host.finish(UINT64_MAX));
    CHECK(host.depthTexels() == before);
    CHECK(host.passCount("ray_traced.trace") == 1);
    CHECK(differences(host.pictures(), submitted(smallScene(), "ray_traced")) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "while the host's workers are busy gnFinishShadows times out, then finishes")
{
    HostJobs jobs;
    Host host(smallScene(), withJobs(jobs, GN_CONTEXT_NO_BACKGROUND_BIT));
    host.pinAll("ray_traced");
    host.require(host.draw());
    jobs.open(false);
    const auto start = std::chrono::steady_clock::now();
    host.require(host.draw({.call = Call::begin}));
    CHECK(host.finish(0) == GN_TIMEOUT);
    CHECK(host.finish(2'000'000) == GN_TIMEOUT);
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(30)); // it did not wait for the workers
    jobs.open(true);
    CHECK(host.finish(UINT64_MAX) == GN_SUCCESS);
    CHECK(differences(host.pictures(), submitted(smallScene(), "ray_traced")) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "all work runs on the host's job system where it lends one, and all of it is waited for")
{
    HostJobs jobs;
    {
        Host host(smallScene(), withJobs(jobs, 0));
        for (const char* method : {"shadow_map", "stencil_volume", "pcf_hybrid", "ray_traced"}) {
            host.pinAll(method);
            host.draw(2, {});
            CHECK(differences(host.pictures(), submitted(smallScene(), method)) == 0);
        }
        CHECK(jobs.scheduled > 0);
    }
    CHECK(jobs.ran == jobs.scheduled);
}

TEST_CASE_FIXTURE(DeviceTest, "a method that does not fit the memory limit is out, and says how much it needs")
{
    HostOptions options;
    options.context = [](GnContextCreateInfo& info) { info.memoryLimit = 40u << 20; };
    Host host(smallScene(), options);
    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 4096));
    host.pinAll("shadow_map");
    host.draw(static_cast<uint32_t>(availableMethods(host.context).size()),
              {}); // the others are asked for in its place
    const std::string text = host.explanation(0);
    INFO(text);
    CHECK(text.find("shadow_map: out, memory: needs 128.0 MiB") != std::string::npos);
    REQUIRE(host.decision(0).pMethod); // something smaller serves
    CHECK(dark(host.pictures()[0]) > 100);
    CHECK(host.stats().memory <= 40u << 20);
    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 512));
    host.draw(2, {});
    CHECK(host.decision(0).reason == GN_REASON_PINNED);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a light whose method outgrows the memory limit is served by another, and by it again when it fits")
{
    HostOptions options;
    options.context = [](GnContextCreateInfo& info) { info.memoryLimit = 40u << 20; };
    Host host(smallScene(), options);
    host.pinAll("shadow_map");
    host.draw(2, {});
    CHECK(std::string(host.decision(0).pMethod) == "shadow_map");
    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 4096)); // what serves is not asked to fit
    host.require(gnWarmUp(host.context));
    host.takeMessages();
    host.draw(5, {});
    REQUIRE(host.decision(0).pMethod);
    CHECK(std::string(host.decision(0).pMethod) != "shadow_map");
    CHECK(dark(host.pictures()[0]) > 100);
    CHECK(host.takeMessages().size() <= 2); // not one a frame
    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 512));
    host.draw(2, {});
    CHECK(std::string(host.decision(0).pMethod) == "shadow_map");
}

TEST_CASE_FIXTURE(DeviceTest, "with hardly any memory the frame is lit or refused, never lost")
{
    for (const VkDeviceSize limit : {VkDeviceSize(1) << 16, VkDeviceSize(1) << 20, VkDeviceSize(3) << 20}) {
        CAPTURE(limit);
        GnContextCreateInfo info = device().contextInfo();
        info.memoryLimit = limit;
        info.flags = GN_CONTEXT_NO_BACKGROUND_BIT;
        GnContext context = nullptr;
        const GnResult made = gnCreateContext(&info, &context);
        CHECK((made == GN_SUCCESS || made == GN_ERROR_OUT_OF_DEVICE_MEMORY));
        if (made < 0) continue;
        const Scene scene = smallScene();
        bool held = true; // are the meshes, in what a device leaves of so little
        for (const demo::Mesh& mesh : scene.meshes) {
            const GnMeshCreateInfo meshInfo{.pName = mesh.name.c_str(),
                                            .pPositions = &mesh.positions[0].x,
                                            .positionCount = static_cast<uint32_t>(mesh.positions.size()),
                                            .indexCount = static_cast<uint32_t>(mesh.indices.size()),
                                            .pIndices = mesh.indices.data()};
            GnMesh created = VK_NULL_HANDLE;
            const GnResult result = gnCreateMesh(context, &meshInfo, &created);
            CHECK((result == GN_SUCCESS || result == GN_ERROR_OUT_OF_DEVICE_MEMORY));
            held = held && result == GN_SUCCESS;
        }
        gnDestroyContext(context);
        if (!held) continue;
        Host host(scene,
                  {.maxLights = 1, .warmUp = false, .context = [&](GnContextCreateInfo& i) { i.memoryLimit = limit; }});
        for (int frame = 0; frame < 12; ++frame) {
            const GnResult drawn = host.draw();
            CHECK((drawn >= 0 || drawn == GN_ERROR_OUT_OF_DEVICE_MEMORY));
            if (drawn < 0) CHECK(!host.lastError().empty());
        }
        CHECK(host.stats().memory <= limit);
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a megabyte is enough for a small view with a small map, also after a map that did not fit")
{
    Host host(smallScene(), {.extent = {160, 90},
                             .maxLights = 1,
                             .warmUp = false,
                             .mapSide = 1024.0,
                             .context = [](GnContextCreateInfo& info) { info.memoryLimit = 1u << 20; }});
    host.require(gnWarmUpMethod(host.context, "shadow_map"));
    host.pin(0, "shadow_map"); // 4 MiB
    host.draw(3, {});
    CHECK(host.decision(0).reason == GN_REASON_NOTHING_READY);
    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 64));
    host.draw(3, {});
    CHECK(host.decision(0).reason == GN_REASON_PINNED);
    CHECK(dark(host.pictures()[0]) > 100);
    CHECK(host.stats().memory <= 1u << 20);
}

TEST_CASE_FIXTURE(DeviceTest, "timings of a timed frame name every pass, two frames later")
{
    Host host(smallScene());
    host.pinAll("ray_traced"); // on the CPU, whatever the device has
    host.draw(3, {});
    const auto timed = [](GnFrameInfo& frame, std::vector<GnViewFrame>&) { frame.flags = GN_FRAME_TIMED_BIT; };
    host.require(host.draw({.adjust = timed}));
    const uint64_t asked = host.frame();
    const std::vector<GnPassTiming> passes = host.passes();
    uint64_t frame = 0;
    uint32_t count = 0;
    for (int i = 0; i < 4 && frame != asked; ++i) {
        host.require(host.draw());
        count = 0;
        host.require(gnGetPassTimings(host.context, &frame, &count, nullptr));
    }
    CHECK(frame == asked);
    std::vector<GnPassTiming> timings(count);
    host.require(gnGetPassTimings(host.context, &frame, &count, timings.data()));
    float gpuMs = 0.0f, cpuMs = 0.0f;
    for (const GnPassTiming& timing : timings) {
        gpuMs += timing.gpuMs;
        cpuMs += timing.cpuMs;
        CHECK(timing.gpuMs >= 0.0f);
    }
    CHECK(gpuMs > 0.0f);
    CHECK(cpuMs > 0.0f); // rays
    for (const GnPassTiming& pass : passes) {
        const bool found = std::any_of(timings.begin(), timings.end(), [&](const GnPassTiming& timing) {
            return std::string(timing.pName) == pass.pName && timing.round == pass.round;
        });
        CHECK_MESSAGE(found, std::string(pass.pName));
    }
    host.require(host.draw());
    CHECK(host.decision(0).measuredMs > 0.0f);
    CHECK(host.stats().gpuMs > 0.0f);
}

TEST_CASE_FIXTURE(DeviceTest, "every submit happens under the host's queue lock, none while it records")
{
    struct Lock {
        int depth = 0, taken = 0;
        static void GN_CALL lock(VkQueue, void* user) { ++static_cast<Lock*>(user)->depth; }
        static void GN_CALL unlock(VkQueue, void* user)
        {
            auto& self = *static_cast<Lock*>(user);
            --self.depth;
            ++self.taken;
        }
    } lock;
    HostOptions options;
    options.context = [&lock](GnContextCreateInfo& info) {
        info.pfnLockQueue = &Lock::lock;
        info.pfnUnlockQueue = &Lock::unlock;
        info.pfnMessage = nullptr; // the user data belongs to the lock
        info.pUserData = &lock;
    };
    Host host(smallScene(), options);
    host.require(gnWarmUp(host.context));
    CHECK(lock.taken == 1);
    for (const char* method : {"shadow_map", "ray_traced"}) {
        host.pinAll(method);
        const int before = lock.taken;
        host.require(host.draw());
        CHECK(lock.taken - before == static_cast<int>(host.stats().submits));
    }
    const int before = lock.taken;
    host.require(host.draw({.call = Call::record}));
    CHECK(lock.taken == before);
    CHECK(lock.depth == 0);
}
