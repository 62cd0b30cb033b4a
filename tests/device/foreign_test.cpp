// Methods of the host's own, through the C door: what their passes may do, and what they get.
#include <utility>

#include "device/fixture.hpp"
#include "gnomon/algorithm.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A method that writes its visibility from a pass that cannot.
struct Storer {
    const GnPluginInterface* door = nullptr;
    GnPassKind pass = GN_PASS_COMPUTE;
    GnAccessKind access = GN_ACCESS_WRITE;
    GnResult answer = GN_SUCCESS;
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
        storer.answer = storer.door->pfnPass(builder, &pass);
    }
};

/// A method with a buffer of every place, which a CPU pass asks to see.
struct Looker {
    const GnPluginInterface* door = nullptr;
    GnBufferRef buffers[3]{}; ///< By place.
    void* seen[3]{};
    static void GN_CALL look(GnPassContext context, void* user)
    {
        Looker& looker = **static_cast<Looker* const*>(user);
        for (int place = 0; place < 3; ++place)
            looker.seen[place] = looker.door->pfnMapped(context, looker.buffers[place]);
    }
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        auto* const looker = static_cast<Looker*>(self);
        const GnPluginInterface& gn = *looker->door;
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

TEST_CASE_FIXTURE(DeviceTest, "a foreign pass that would write a storage image is refused, and its light is lit")
{
    Host host(smallScene());
    Storer storer;
    host.require(gnGetPluginInterface(host.context, &storer.door));
    serveAll(host, "storer", &Storer::declare, &storer);
    const std::pair<GnPassKind, GnAccessKind> refused[] = {{GN_PASS_COMPUTE, GN_ACCESS_WRITE},
                                                           {GN_PASS_COMPUTE, GN_ACCESS_UPDATE},
                                                           {GN_PASS_RASTER, GN_ACCESS_UPDATE},
                                                           {GN_PASS_PREPARE, GN_ACCESS_WRITE}};
    for (const auto& [pass, access] : refused) {
        storer.pass = pass;
        storer.access = access;
        storer.answer = GN_SUCCESS;
        host.takeMessages();
        host.require(host.draw());
        CHECK(storer.answer == GN_ERROR_UNSUPPORTED);
        const std::vector<std::string> messages = host.takeMessages();
        REQUIRE(messages.size() == 1);
        CHECK(messages[0].find("storer.store") != std::string::npos);
        const Image8 picture = host.pictures()[0];
        CHECK(lit(picture) == picture.texels.size());
        CHECK(host.explanation(0).find("memory") == std::string::npos);
        CHECK(host.explanation(0).find("a message says why") != std::string::npos);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a CPU pass sees upload and readback buffers, and on no device those that are the GPU's")
{
    Host host(smallScene());
    Looker looker;
    host.require(gnGetPluginInterface(host.context, &looker.door));
    serveAll(host, "looker", &Looker::declare, &looker);
    host.require(host.draw());
    CHECK(looker.seen[GN_BUFFER_DEVICE] == nullptr);
    CHECK(looker.seen[GN_BUFFER_UPLOAD] != nullptr);
    CHECK(looker.seen[GN_BUFFER_READBACK] != nullptr);
}
