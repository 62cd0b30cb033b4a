// Methods of the host's own, through the C plug-in interface: what their passes may do, and what they get.
#include <utility>

#include "device/hooks.hpp"
#include "gnomon/algorithm.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A method that writes its visibility from a pass that cannot.
struct Storer {
    const GnPluginInterface* abi = nullptr;
    GnPassKind pass = GN_PASS_COMPUTE;
    GnAccessKind access = GN_ACCESS_WRITE;
    GnResult answer = GN_SUCCESS;
    int asked = 0;
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        auto& storer = *static_cast<Storer*>(self);
        GnAccess store{};
        store.kind = storer.access;
        store.image = task->visibility;
        store.baseLayer = task->layer;
        GnPassInfo pass{};
        pass.pName = "storer.store";
        pass.kind = storer.pass;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 1;
        pass.pAccesses = &store;
        pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        pass.pfnRun = [](GnPassContext, void*) {};
        storer.answer = storer.abi->pfnPass(builder, &pass);
        ++storer.asked;
    }
};

/// A method with a buffer of every place, which a CPU pass asks to see.
struct Looker {
    const GnPluginInterface* abi = nullptr;
    GnBufferRef buffers[3]{}; ///< By place.
    void* seen[3]{};
    static void GN_CALL look(GnPassContext context, void* user)
    {
        Looker& looker = **static_cast<Looker* const*>(user);
        for (int place = 0; place < 3; ++place)
            looker.seen[place] = looker.abi->pfnMapped(context, looker.buffers[place]);
    }
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        auto* const looker = static_cast<Looker*>(self);
        const GnPluginInterface& gn = *looker->abi;
        constexpr const char* names[] = {"looker.device", "looker.upload", "looker.readback"};
        GnAccess accesses[4]{};
        for (uint32_t place = 0; place < 3; ++place) {
            GnBufferInfo info{};
            info.pName = names[place];
            info.scope = GN_SCOPE_TASK;
            info.size = 64;
            info.place = static_cast<GnBufferPlace>(place);
            looker->buffers[place] = gn.pfnBuffer(builder, &info);
            accesses[place].kind = GN_ACCESS_WRITE;
            accesses[place].buffer = looker->buffers[place];
        }
        GnPassInfo pass{};
        pass.pName = "looker.look";
        pass.kind = GN_PASS_PREPARE;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 3;
        pass.pAccesses = accesses;
        pass.pfnRun = &look;
        pass.pUserData = &looker;
        pass.userDataSize = sizeof looker;
        gn.pfnPass(builder, &pass);
        for (GnAccess& access : accesses)
            access.kind = GN_ACCESS_READ;
        accesses[3].kind = GN_ACCESS_WRITE;
        accesses[3].image = task->visibility;
        accesses[3].baseLayer = task->layer;
        accesses[3].clear = VK_TRUE;
        pass = {};
        pass.pName = "looker.fill";
        pass.kind = GN_PASS_RASTER;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 4;
        pass.pAccesses = accesses;
        pass.area = task->area;
        pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        gn.pfnPass(builder, &pass);
    }
};

/// A method that clears what it only tests, and tests it again in a pass of its own.
struct Clearer {
    const GnPluginInterface* abi = nullptr;
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        const GnPluginInterface& gn = *static_cast<Clearer*>(self)->abi;
        GnImageInfo info{};
        info.pName = "clearer.depth";
        info.scope = GN_SCOPE_TASK;
        info.format = VK_FORMAT_D32_SFLOAT;
        info.extent = task->extent;
        GnAccess accesses[2]{};
        accesses[0].kind = GN_ACCESS_DEPTH_TEST;
        accesses[0].image = gn.pfnImage(builder, &info);
        accesses[0].clear = VK_TRUE;
        accesses[1].kind = GN_ACCESS_WRITE;
        accesses[1].image = task->visibility;
        accesses[1].baseLayer = task->layer;
        accesses[1].clear = VK_TRUE;
        GnPassInfo pass{};
        pass.pName = "clearer.clear";
        pass.kind = GN_PASS_RASTER;
        pass.scope = GN_SCOPE_TASK;
        pass.accessCount = 1;
        pass.pAccesses = accesses;
        pass.area = task->area;
        pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        gn.pfnPass(builder, &pass);
        accesses[0].clear = VK_FALSE;
        pass.pName = "clearer.test";
        pass.accessCount = 2;
        gn.pfnPass(builder, &pass);
    }
};

// --- depth attachments: those that were cleared, and of these those that were kept ---

uint32_t cleared = 0, clearedAndStored = 0;

VKAPI_ATTR void VKAPI_CALL watchedRendering(VkCommandBuffer cmd, const VkRenderingInfo* info)
{
    const VkRenderingAttachmentInfo* depth = info->pDepthAttachment;
    if (depth && depth->loadOp == VK_ATTACHMENT_LOAD_OP_CLEAR) {
        ++cleared;
        clearedAndStored += depth->storeOp == VK_ATTACHMENT_STORE_OP_STORE;
    }
    vkCmdBeginRendering(cmd, info);
}

void serveAll(Host& host, const char* name, PFN_gnDeclare declare, void* self)
{
    GnAlgorithmInfo info{};
    info.pName = name;
    info.traits = GN_TRAIT_SPOT_BIT;
    info.pfnDeclare = declare;
    info.pAlgorithm = self;
    host.require(gnRegisterAlgorithm(host.context, &info));
    host.pinAll(name);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a foreign pass that cannot be is refused, and another method serves its light")
{
    Host host(smallScene());
    Storer storer;
    host.require(gnGetPluginInterface(host.context, &storer.abi));
    serveAll(host, "storer", &Storer::declare, &storer);
    const std::pair<GnPassKind, GnAccessKind> refused[] = {{GN_PASS_COMPUTE, GN_ACCESS_WRITE},
                                                           {GN_PASS_COMPUTE, GN_ACCESS_UPDATE},
                                                           {GN_PASS_RASTER, GN_ACCESS_UPDATE},
                                                           {GN_PASS_PREPARE, GN_ACCESS_WRITE},
                                                           {GN_PASS_HOST, GN_ACCESS_READ}}; // roundTrips is 0
    for (const auto& [pass, access] : refused) {
        storer.pass = pass;
        storer.access = access;
        storer.answer = GN_SUCCESS;
        host.takeMessages();
        host.pinAll("storer"); // which asks for it again
        host.require(host.draw());
        CHECK(storer.answer == GN_ERROR_UNSUPPORTED);
        const std::vector<std::string> messages = host.takeMessages();
        REQUIRE(messages.size() == 1);
        CHECK(messages[0].find("storer.store") != std::string::npos);
        REQUIRE(host.decision(0).pMethod);
        std::string serves = "'";
        serves.append(host.decision(0).pMethod).append("' serves it");
        CHECK(messages[0].find(serves) != std::string::npos);
        CHECK(dark(host.pictures()[0]) > 100);
        CHECK(host.explanation(0).find("memory") == std::string::npos);
        CHECK(host.explanation(0).find("a message says why") != std::string::npos);
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a method that failed is asked again after a second, then after two; at once if pinned again")
{
    Host host(smallScene());
    Storer storer;
    host.require(gnGetPluginInterface(host.context, &storer.abi));
    serveAll(host, "storer", &Storer::declare, &storer);
    host.require(host.draw());
    CHECK(storer.asked == 1);
    host.takeMessages();
    host.draw(59, {});
    CHECK(storer.asked == 1);
    CHECK(host.takeMessages().empty());
    CHECK(std::string(host.decision(0).pMethod) != "storer");
    CHECK(host.explanation(0).find("a message says why") != std::string::npos);
    host.require(host.draw());
    CHECK(storer.asked == 2);
    host.draw(119, {});
    CHECK(storer.asked == 2);
    host.require(host.draw());
    CHECK(storer.asked == 3);
    host.pinAll("storer");
    host.require(host.draw());
    CHECK(storer.asked == 4);
}

TEST_CASE_FIXTURE(DeviceTest, "accesses that the frame has nothing for are refused before they are followed")
{
    Host host(smallScene());
    struct Stray {
        const GnPluginInterface* abi = nullptr;
        GnAccess access{};
        uint32_t count = 1;
        GnResult answer = GN_SUCCESS;
        static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
        {
            auto& stray = *static_cast<Stray*>(self);
            GnAccess accesses[5];
            for (GnAccess& access : accesses) {
                access = stray.access;
                if (!access.image) access.image = task->visibility;
            }
            GnPassInfo pass{};
            pass.pName = "stray.pass";
            pass.kind = GN_PASS_RASTER;
            pass.scope = GN_SCOPE_TASK;
            pass.accessCount = stray.count;
            pass.pAccesses = accesses;
            pass.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
            stray.answer = stray.abi->pfnPass(builder, &pass);
        }
    } stray;
    host.require(gnGetPluginInterface(host.context, &stray.abi));
    serveAll(host, "stray", &Stray::declare, &stray);
    const auto refused = [&](GnResult expected, const char* words) {
        CAPTURE(std::string(words));
        host.pinAll("stray");
        host.takeMessages();
        host.require(host.draw());
        CHECK(stray.answer == expected);
        const std::vector<std::string> messages = host.takeMessages();
        REQUIRE(messages.size() == 1);
        CHECK_MESSAGE(messages[0].find(words) != std::string::npos, messages[0]);
    };
    stray.access.kind = GN_ACCESS_SAMPLED;
    stray.access.image = 1000;
    refused(GN_ERROR_OUT_OF_RANGE, "image 1000");
    stray.access.image = 0;
    stray.access.buffer = 2000;
    refused(GN_ERROR_OUT_OF_RANGE, "buffer 2000");
    stray.access = {};
    stray.access.kind = GN_ACCESS_WRITE;
    stray.access.baseLayer = 15;
    stray.access.layerCount = 2;
    refused(GN_ERROR_OUT_OF_RANGE, "layers 15 + 2");
    stray.access.baseLayer = stray.access.layerCount = 0;
    stray.count = 5;
    refused(GN_ERROR_TOO_MANY, "5 colour attachments");
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a method whose name the rules use for something else is not added, nor taken from its host")
{
    Host host(smallScene());
    const std::string rules = shippedRules("battery"); // has a concept `work`
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "battery.yaml"));
    const size_t before = availableMethods(host.context).size();
    static int destroyed;
    destroyed = 0;
    GnAlgorithmInfo info{};
    info.pName = "work";
    info.traits = GN_TRAIT_SPOT_BIT;
    info.pfnDeclare = [](void*, GnPassBuilder, const GnShadowTask*) {};
    info.pfnDestroy = [](void*) { ++destroyed; };
    for (int attempt = 0; attempt < 2; ++attempt) { // the second fails like the first: there is no such method yet
        CHECK(gnRegisterAlgorithm(host.context, &info) == GN_ERROR_RULES);
        CHECK(host.lastError().find("work") != std::string::npos);
        CHECK(gnAddMethod(host.context, "work", "shadow_map") == GN_ERROR_RULES);
    }
    CHECK(availableMethods(host.context).size() == before);
    CHECK(destroyed == 0);
    host.require(host.draw());
    CHECK(host.decision(0).pMethod);
}

TEST_CASE_FIXTURE(DeviceTest, "a CPU pass sees upload and readback buffers, and on no device those that are the GPU's")
{
    Host host(smallScene());
    Looker looker;
    host.require(gnGetPluginInterface(host.context, &looker.abi));
    serveAll(host, "looker", &Looker::declare, &looker);
    host.require(host.draw());
    CHECK(looker.seen[GN_BUFFER_DEVICE] == nullptr);
    CHECK(looker.seen[GN_BUFFER_UPLOAD] != nullptr);
    CHECK(looker.seen[GN_BUFFER_READBACK] != nullptr);
}

TEST_CASE_FIXTURE(DeviceTest, "what a foreign pass clears to test against is written, and there for the pass after it")
{
    Host host(smallScene(), hooked({}, {hook("vkCmdBeginRendering", &watchedRendering)}));
    Clearer clearer;
    host.require(gnGetPluginInterface(host.context, &clearer.abi));
    serveAll(host, "clearer", &Clearer::declare, &clearer);
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == "clearer");
    cleared = clearedAndStored = 0;
    host.require(host.draw()); // validation sees whether the second pass waits
    (void)host.pictures();
    CHECK(cleared == 1);
    CHECK(clearedAndStored == 1);
}
