// Work that methods share within a view, under a budget: a method is not tried again and again for what it takes.
#include <chrono>
#include <thread>

#include "device/fixture.hpp"
#include "gnomon/algorithm.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::chrono::milliseconds kSleep{12};
constexpr float kTight = 8.0f,
                kWide = 200.0f; // ms; shadow_map takes less than the one, all together less than the other

/// Next to nothing for its light, kSleep for the view.
struct Sharer {
    const GnPluginInterface* abi = nullptr;
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        const GnPluginInterface& gn = *static_cast<Sharer*>(self)->abi;
        GnBufferInfo info{};
        info.pName = "sharer.work";
        info.scope = GN_SCOPE_VIEW;
        info.size = 4;
        info.place = GN_BUFFER_UPLOAD;
        GnAccess accesses[2]{};
        accesses[0].kind = GN_ACCESS_WRITE;
        accesses[0].buffer = gn.pfnBuffer(builder, &info);
        GnPassInfo pass{};
        pass.pName = "sharer.prepare";
        pass.kind = GN_PASS_PREPARE;
        pass.scope = GN_SCOPE_VIEW;
        pass.accessCount = 1;
        pass.pAccesses = accesses;
        pass.pfnRun = [](GnPassContext, void*) { std::this_thread::sleep_for(kSleep); };
        gn.pfnPass(builder, &pass);
        accesses[0].kind = GN_ACCESS_READ;
        accesses[1].kind = GN_ACCESS_WRITE;
        accesses[1].image = task->visibility;
        accesses[1].baseLayer = task->layer;
        accesses[1].clear = VK_TRUE;
        pass = {};
        pass.pName = "sharer.fill";
        pass.kind = GN_PASS_RASTER;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 2;
        pass.pAccesses = accesses;
        pass.area = task->area;
        pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        gn.pfnPass(builder, &pass);
    }
    void join(Host& host)
    {
        host.require(gnGetPluginInterface(host.context, &abi));
        GnAlgorithmInfo info{};
        info.pName = "sharer";
        info.traits = GN_TRAIT_SPOT_BIT;
        info.pfnDeclare = &declare;
        info.pAlgorithm = this;
        host.require(gnRegisterAlgorithm(host.context, &info));
        const std::string text = "version: 1\n"
                                 "variables: {lightRadius: {universe: [0, 2], unit: m, terms: "
                                 "{all: [-.inf, -.inf, .inf, .inf]}}}\n"
                                 "options: {allocation: budget}\n"
                                 "rules:\n"
                                 "  - rule: if lightRadius is all then sharer is favoured\n"
                                 "  - rule: if lightRadius is all then shadow_map is acceptable\n"
                                 "policy: {hysteresis: {crossFadeFrames: 0, flipWindowFrames: 0, flipBanFrames: 0}}\n";
        host.require(gnLoadRules(host.context, text.data(), text.size(), "shared work"));
    }
};

FrameOptions within(float budgetMs)
{
    return {.adjust = [budgetMs](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.budgetMs = budgetMs; }};
}

/// Of so many frames, those that the sharer served.
int sharedFrames(Host& host, int frames, float budgetMs, uint32_t& switches)
{
    int shared = 0;
    for (int i = 0; i < frames; ++i) {
        host.require(host.draw(within(budgetMs)));
        shared += host.decision(0).pMethod == std::string("sharer");
        switches += host.stats().switches;
    }
    return shared;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a method is charged with the view's work that it alone needs, and remembered for it")
{
    Host host(smallScene());
    Sharer sharer;
    sharer.join(host);
    uint32_t switches = 0;
    sharedFrames(host, 60, kTight, switches); // what it takes is found out
    switches = 0;
    CHECK(sharedFrames(host, 300, kTight, switches) == 0); // no ban holds it back: the price does
    CHECK(switches == 0);
    sharedFrames(host, 60, kWide, switches);
    switches = 0;
    CHECK(sharedFrames(host, 60, kWide, switches) == 60);
    CHECK(host.stats().sharedMs >= static_cast<float>(kSleep.count()));
    CHECK(switches == 0);
}
