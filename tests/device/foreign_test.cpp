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
    }
}
