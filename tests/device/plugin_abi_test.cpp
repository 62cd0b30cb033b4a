// What a plug-in hands through the C plug-in interface that cannot be: refused with words, and another method serves
// the light.
#include <climits>
#include <functional>

#include "device/fixture.hpp"
#include "gnomon/algorithm.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A method whose declaration, and whose one pass, are the test's.
struct Caller {
    const GnPluginInterface* gn = nullptr;
    std::function<void(GnPassBuilder, const GnShadowTask&)> act;
    GnResult answer = GN_SUCCESS; ///< Of pass().

    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        static_cast<Caller*>(self)->act(builder, *task);
    }

    /// A host that all of whose lights ask for it.
    void join(Host& host)
    {
        host.require(gnGetPluginInterface(host.context, &gn));
        GnAlgorithmInfo info{};
        info.pName = "caller";
        info.traits = GN_TRAIT_SPOT_BIT;
        info.pfnDeclare = &Caller::declare;
        info.pAlgorithm = this;
        host.require(gnRegisterAlgorithm(host.context, &info));
    }

    /// A raster pass that fills the task's layer, changed by `change`.
    void pass(GnPassBuilder builder, const GnShadowTask& task,
              const std::function<void(GnPassInfo&, GnAccess&)>& change)
    {
        GnAccess fill{};
        fill.kind = GN_ACCESS_WRITE;
        fill.image = task.visibility;
        fill.baseLayer = task.layer;
        fill.clear = VK_TRUE;
        GnPassInfo info{};
        info.pName = "caller.fill";
        info.kind = GN_PASS_RASTER;
        info.scope = GN_SCOPE_TASK;
        info.accessCount = 1;
        info.pAccesses = &fill;
        info.area = task.area;
        info.pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {};
        if (change) change(info, fill);
        answer = gn->pfnPass(builder, &info);
    }
};

/// A host and a caller whose declaration fails, saying `words`.
struct Refusing {
    Refusing() : host(smallScene()) { caller.join(host); }

    void says(const char* words)
    {
        CAPTURE(std::string(words));
        host.pinAll("caller"); // which asks for it again
        host.takeMessages();
        host.require(host.draw());
        const std::vector<std::string> messages = host.takeMessages();
        REQUIRE(messages.size() == 1);
        CHECK_MESSAGE(messages[0].find(words) != std::string::npos, messages[0]);
        CHECK(messages[0].find("serves it") != std::string::npos);
        CHECK(dark(host.pictures()[0]) > 100);
    }
    void passSays(GnResult expected, const char* words, const std::function<void(GnPassInfo&, GnAccess&)>& change)
    {
        caller.act = [this, change](GnPassBuilder builder, const GnShadowTask& task) {
            caller.pass(builder, task, change);
        };
        says(words);
        CHECK(caller.answer == expected);
    }

    Host host;
    Caller caller;
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "images and buffers that a plug-in does not describe are refused by the member at fault")
{
    Refusing test;
    Caller& caller = test.caller;
    GnImageInfo image{};
    image.scope = GN_SCOPE_TASK;
    image.format = VK_FORMAT_R8_UNORM;
    image.extent = {4, 4};
    GnBufferInfo buffer{};
    buffer.scope = GN_SCOPE_TASK;
    buffer.size = 4;
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) { CHECK(caller.gn->pfnImage(builder, nullptr) == 0); };
    test.says("pfnImage: pInfo is null");
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) { CHECK(caller.gn->pfnImage(builder, &image) == 0); };
    test.says("pfnImage: pName is null");
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) {
        CHECK(caller.gn->pfnBuffer(builder, nullptr) == 0);
    };
    test.says("pfnBuffer: pInfo is null");
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) {
        CHECK(caller.gn->pfnBuffer(builder, &buffer) == 0);
    };
    test.says("pfnBuffer: pName is null");
    image.pName = "caller.image";
    image.extent.height = 0;
    test.says("pfnBuffer: pName is null");
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) { CHECK(caller.gn->pfnImage(builder, &image) == 0); };
    test.says("caller.image: 4 x 0");
    buffer.pName = "caller.buffer";
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) {
        CHECK(caller.gn->pfnBuffer(builder, &buffer) == 0);
    };
    for (const auto& [size, words] : {std::pair{UINT64_MAX, "buffer 'caller.buffer': size is 18446744073709551615"},
                                      std::pair{UINT64_MAX / 2 + 2, "size is 9223372036854775809"},
                                      std::pair{(uint64_t{1} << 31) + 1, "size is 2147483649"}}) {
        buffer.size = size;
        test.says(words);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "stamps of what the frame has not are stale, and the task is refused")
{
    Refusing test;
    Caller& caller = test.caller;
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) {
        CHECK(caller.gn->pfnImageStale(builder, 1000, 7) == VK_TRUE);
    };
    test.says("pfnImageStale: the frame has no image 1000");
    caller.act = [&](GnPassBuilder builder, const GnShadowTask&) {
        CHECK(caller.gn->pfnBufferStale(builder, 2000, 7) == VK_TRUE);
    };
    test.says("pfnBufferStale: the frame has no buffer 2000");
}

TEST_CASE_FIXTURE(DeviceTest, "passes that cannot be are refused by the member at fault")
{
    Refusing test;
    test.caller.act = [&](GnPassBuilder builder, const GnShadowTask&) {
        CHECK(test.caller.gn->pfnPass(builder, nullptr) == GN_ERROR_NULL_ARGUMENT);
    };
    test.says("pfnPass: pInfo is null");
    test.passSays(GN_ERROR_OUT_OF_RANGE, "pfnPass: pInfo: GnPassInfo::structSize is 0",
                  [](GnPassInfo& info, GnAccess&) { info.structSize = 0; });
    test.passSays(GN_ERROR_OUT_OF_RANGE, "pAccesses[0]: GnAccess::structSize is 0",
                  [](GnPassInfo&, GnAccess& access) { access.structSize = 0; });
    test.passSays(GN_ERROR_OUT_OF_RANGE, "kind is 9", [](GnPassInfo& info, GnAccess&) { info.kind = GnPassKind(9); });
    test.passSays(GN_ERROR_OUT_OF_RANGE, "pAccesses[0].kind is 77",
                  [](GnPassInfo&, GnAccess& access) { access.kind = GnAccessKind(77); });
    test.passSays(GN_ERROR_EMPTY, "no attachment", [](GnPassInfo& info, GnAccess&) { info.accessCount = 0; });
    test.passSays(GN_ERROR_EMPTY, "no attachment", [](GnPassInfo&, GnAccess& access) {
        access.kind = GN_ACCESS_SAMPLED;
        access.clear = VK_FALSE;
    });
    for (const GnAccessKind kind : {GN_ACCESS_DEPTH_WRITE, GN_ACCESS_DEPTH_TEST, GN_ACCESS_WRITE}) {
        test.caller.act = [&](GnPassBuilder builder, const GnShadowTask& task) {
            test.caller.pass(builder, task, [&](GnPassInfo&, GnAccess& access) {
                access.image = task.depth;
                access.kind = kind;
                access.clear = kind == GN_ACCESS_DEPTH_TEST ? VK_TRUE : VK_FALSE;
            });
        };
        test.says("pAccesses[0] changes the host's depth");
        CHECK(test.caller.answer == GN_ERROR_UNSUPPORTED);
    }
    test.caller.act = [&](GnPassBuilder builder, const GnShadowTask& task) {
        test.caller.pass(builder, task, [&](GnPassInfo&, GnAccess& access) {
            access.image = task.depth;
            access.kind = GN_ACCESS_READ; // of buffers: nothing would be waited for
        });
    };
    test.says("pAccesses[0], of kind 1, names an image, but is of a kind for buffers");
    for (const bool both : {true, false}) {
        test.caller.act = [&](GnPassBuilder builder, const GnShadowTask& task) {
            GnBufferInfo some{};
            some.pName = "caller.some";
            some.scope = GN_SCOPE_TASK;
            some.size = 4;
            test.caller.pass(builder, task, [&](GnPassInfo&, GnAccess& access) {
                access.buffer = test.caller.gn->pfnBuffer(builder, &some);
                access.kind = GN_ACCESS_SAMPLED;
                if (!both) access.image = 0;
            });
        };
        test.says(both ? "names an image and a buffer" : "names a buffer, but is of a kind for images");
        CHECK(test.caller.answer == GN_ERROR_UNSUPPORTED);
    }
    test.passSays(GN_ERROR_UNSUPPORTED, "sees buffers only", [](GnPassInfo& info, GnAccess&) {
        info.kind = GN_PASS_PREPARE;
        info.pfnRun = [](GnPassContext, void*) {};
    });
    test.passSays(GN_ERROR_UNSUPPORTED, "raster passes alone", [](GnPassInfo& info, GnAccess& access) {
        info.kind = GN_PASS_COMPUTE;
        access.kind = GN_ACCESS_DEPTH_TEST;
    });
    for (const GnAccessKind kind : {GN_ACCESS_DEPTH_WRITE, GN_ACCESS_STENCIL_WRITE}) // visibility is R8_UNORM
        test.passSays(GN_ERROR_UNSUPPORTED, "VkFormat 9", [&](GnPassInfo&, GnAccess& access) { access.kind = kind; });
    constexpr VkRect2D kBeyond[] = {
        {{0, 0}, {321, 180}}, {{0, 1}, {320, 180}},       {{-1, 0}, {320, 180}},
        {{0, 0}, {320, 0}},   {{INT_MAX, 0}, {320, 180}}, {{1, 0}, {UINT32_MAX, 180}},
    };
    for (const VkRect2D& area : kBeyond) {
        test.passSays(GN_ERROR_OUT_OF_RANGE, "area", [&](GnPassInfo& info, GnAccess&) { info.area = area; });
        test.passSays(GN_ERROR_OUT_OF_RANGE, "pAccesses[0].rect", [&](GnPassInfo& info, GnAccess& access) {
            info.area = {};
            access.rect = area;
        });
    }
}

TEST_CASE_FIXTURE(DeviceTest, "layers are attached one by one, or from the first on and as many of each image")
{
    Refusing test;
    GnAccess accesses[2]{};
    const auto attaches = [&](uint32_t base, uint32_t count, VkFormat format) {
        test.caller.act = [&, base, count, format](GnPassBuilder builder, const GnShadowTask& task) {
            GnImageInfo image{};
            image.pName = "caller.layers";
            image.scope = GN_SCOPE_TASK;
            image.format = format;
            image.extent = task.extent;
            image.layers = 4;
            test.caller.pass(builder, task, [&](GnPassInfo& info, GnAccess& access) {
                accesses[0] = accesses[1] = access;
                accesses[1].image = test.caller.gn->pfnImage(builder, &image);
                accesses[1].kind = format == VK_FORMAT_R8_UNORM ? GN_ACCESS_WRITE : GN_ACCESS_DEPTH_WRITE;
                accesses[1].baseLayer = base;
                accesses[1].layerCount = count;
                info.pAccesses = accesses;
                info.accessCount = 2;
            });
        };
    };
    attaches(2, 2, VK_FORMAT_R8_UNORM);
    test.says("pAccesses[1] attaches layers 2 + 2; several are attached from 0 on");
    CHECK(test.caller.answer == GN_ERROR_UNSUPPORTED);
    attaches(0, 4, VK_FORMAT_D32_SFLOAT);
    test.says("pAccesses[1] attaches 4 layers, another one 1");
    CHECK(test.caller.answer == GN_ERROR_UNSUPPORTED);
    attaches(3, 1, VK_FORMAT_D32_SFLOAT);
    test.host.pinAll("caller");
    test.host.require(test.host.draw());
    CHECK(test.caller.answer == GN_SUCCESS);
}

TEST_CASE_FIXTURE(DeviceTest, "a pass asks for the handles of what the frame has not, and gets none")
{
    struct Seen {
        const GnPluginInterface* gn = nullptr;
        GnImageRef visibility = 0;
        int asked = 0, given = 0;
    } seen;
    Host host(smallScene());
    Caller caller;
    caller.join(host);
    seen.gn = caller.gn;
    caller.act = [&](GnPassBuilder builder, const GnShadowTask& task) {
        seen.visibility = task.visibility;
        Seen* const self = &seen;
        GnPassInfo prepare{};
        prepare.pName = "caller.look";
        prepare.kind = GN_PASS_PREPARE;
        prepare.scope = GN_SCOPE_TASK;
        prepare.pUserData = &self;
        prepare.userDataSize = sizeof self;
        prepare.pfnRun = [](GnPassContext context, void* user) {
            Seen& s = **static_cast<Seen* const*>(user);
            ++s.asked;
            s.given += s.gn->pfnMapped(context, 2000) != nullptr;
        };
        caller.gn->pfnPass(builder, &prepare);
        caller.pass(builder, task, [&](GnPassInfo& info, GnAccess&) {
            info.pUserData = &self;
            info.userDataSize = sizeof self;
            info.pfnRecord = [](GnPassContext context, VkCommandBuffer, const VkRect2D*, void* user) {
                Seen& s = **static_cast<Seen* const*>(user);
                ++s.asked;
                s.given += s.gn->pfnVkImage(context, 1000) != VK_NULL_HANDLE;
                s.given += s.gn->pfnVkImageView(context, 1000, 0) != VK_NULL_HANDLE;
                s.given += s.gn->pfnVkImageView(context, s.visibility, 16) != VK_NULL_HANDLE;
                s.given += s.gn->pfnVkBuffer(context, 2000) != VK_NULL_HANDLE;
            };
        });
    };
    host.pinAll("caller");
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == "caller");
    CHECK(seen.asked == 2);
    CHECK(seen.given == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a plug-in in C++ that says its version as the header asks is loaded, and serves")
{
    Host host(smallScene());
    const GnResult loaded = gnLoadPlugin(host.context, GNOMON_LIT);
    CHECK_MESSAGE(loaded == GN_SUCCESS, host.lastError());
    REQUIRE(loaded == GN_SUCCESS);
    host.pinAll("lit");
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == "lit");
    CHECK(lit(host.pictures()[0]) == host.pictures()[0].texels.size());
}

TEST_CASE_FIXTURE(DeviceTest, "traits that only built-in methods can have are refused by name")
{
    Host host(smallScene(), {.warmUp = false});
    const auto refused = [&](GnTraits trait, const char* name) {
        GnAlgorithmInfo info{};
        info.pName = "boaster";
        info.traits = GN_TRAIT_SPOT_BIT | trait;
        info.pfnDeclare = &Caller::declare;
        CHECK(gnRegisterAlgorithm(host.context, &info) == GN_ERROR_UNSUPPORTED);
        CHECK(host.lastError().find(std::string("algorithm 'boaster': traits have ") + name) != std::string::npos);
    };
    refused(GN_TRAIT_DEVICE_RAYS_BIT, "GN_TRAIT_DEVICE_RAYS_BIT");
    refused(GN_TRAIT_GPU_TRANSFORMS_BIT, "GN_TRAIT_GPU_TRANSFORMS_BIT");
}
