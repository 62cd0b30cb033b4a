// No memory on the host, from some allocation on and for good: the call says so, and what was there is still there.
#include "device/fixture.hpp"
#include "gnomon/algorithm.h"
#include "runtime/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

// The layer allocates by our operator new inside Vulkan's calls, where nothing may be thrown.
[[maybe_unused]] const bool unvalidated = (withoutValidation(), true);

constexpr float kCorners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

GnMeshCreateInfo triangle()
{
    GnMeshCreateInfo info{};
    info.pName = "a triangle with a name too long for a short string";
    info.pPositions = kCorners;
    info.positionCount = 3;
    return info;
}

bool alive(const Host& host, GnMesh mesh)
{
    return gnUpdateMeshPositions(host.context, mesh, kCorners, 3, 0) == GN_SUCCESS;
}

/// Outcome of a call whose allocations fail from the `first`-th on.
struct Outcome {
    GnResult result;
    bool struck;
};
template <typename Call>
Outcome without(std::size_t first, Call&& call)
{
    const NoMemory none(first);
    const GnResult result = call();
    return {result, none.struck()};
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a call without memory, nor any for the words about it, returns the code that says so")
{
    if (!countsOnlyOurs()) return;
    Host host(smallScene());
    const GnMeshCreateInfo info = triangle();
    GnMesh mesh = VK_NULL_HANDLE;
    std::size_t first = 0;
    for (; !mesh; ++first) {
        CAPTURE(first);
        const Outcome made = without(first, [&] { return gnCreateMesh(host.context, &info, &mesh); });
        CHECK((made.result == GN_SUCCESS) == (mesh != VK_NULL_HANDLE));
        if (made.result != GN_SUCCESS) CHECK(made.result == GN_ERROR_OUT_OF_HOST_MEMORY);
        REQUIRE(first < 1000);
    }
    CHECK(first > 5);
    CHECK(alive(host, mesh));
    CHECK(without(0, [&] { return gnLoadRules(host.context, "rules:", 6, "none"); }).result ==
          GN_ERROR_OUT_OF_HOST_MEMORY);
    host.pinAll("shadow_map");
    host.require(host.draw());
}

TEST_CASE_FIXTURE(DeviceTest, "an algorithm or a method that found no memory on its way in is not there at all")
{
    if (!countsOnlyOurs()) return;
    const auto methods = [](const Host& host) {
        uint32_t count = 0;
        host.require(gnEnumerateMethods(host.context, &count, nullptr));
        return count;
    };
    GnAlgorithmInfo info{};
    info.pName = "one that shines through everything, and is called so";
    info.traits = GN_TRAIT_SPOT_BIT;
    info.pfnDeclare = [](void*, GnPassBuilder, const GnShadowTask*) {};
    const auto struckAt = [&](std::size_t first) {
        CAPTURE(first);
        Host host(smallScene());
        host.require(gnLoadShippedRules(host.context, "default"));
        const uint32_t before = methods(host);
        const Outcome made = without(first, [&] { return gnRegisterAlgorithm(host.context, &info); });
        const Outcome added =
            without(first, [&] { return gnAddMethod(host.context, "another shadow map", "shadow_map"); });
        CHECK((made.result == GN_SUCCESS) == !made.struck);
        CHECK((added.result == GN_SUCCESS) == !added.struck);
        CHECK(methods(host) == before + !made.struck + !added.struck);
        host.draw(2, {}); // all of them are asked
        return made.struck || added.struck;
    };
    std::size_t last = 0, none = 1; // the last allocation that both make is between them
    for (; struckAt(none); none *= 2)
        last = none;
    while (none - last > 1) {
        const std::size_t middle = (last + none) / 2;
        (struckAt(middle) ? last : none) = middle;
    }
    CHECK(last > 20);
    for (std::size_t first = last - 12; first <= last; ++first) // around what changes the context
        CHECK(struckAt(first));
}

TEST_CASE_FIXTURE(DeviceTest, "a context that finds no memory says so")
{
    if (!countsOnlyOurs()) return;
    bool struck = true, told = false;
    for (std::size_t first = 0; struck; first += 1 + first / 8) {
        CAPTURE(first);
        told = false;
        GnContextCreateInfo info = device().contextInfo();
        info.pUserData = &told;
        info.pfnMessage = [](const GnMessage* message, void* user) {
            *static_cast<bool*>(user) = message->result == GN_ERROR_OUT_OF_HOST_MEMORY && message->pText[0] != '\0';
        };
        GnContext context = VK_NULL_HANDLE;
        const Outcome made = without(first, [&] { return gnCreateContext(&info, &context); });
        struck = made.struck;
        CHECK((made.result == GN_SUCCESS) == !struck);
        CHECK(told == struck);
        gnDestroyContext(context);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a mesh whose destruction found no memory is there or gone, never half")
{
    if (!countsOnlyOurs()) return;
    Host host(smallScene());
    const GnMeshCreateInfo info = triangle();
    bool struck = true;
    for (std::size_t first = 0; struck; ++first) {
        CAPTURE(first);
        GnMesh mesh = VK_NULL_HANDLE;
        host.require(gnCreateMesh(host.context, &info, &mesh));
        struck = without(first, [&] {
                     gnDestroyMesh(host.context, mesh);
                     return GN_SUCCESS;
                 }).struck;
        CHECK(alive(host, mesh) == struck);
        gnDestroyMesh(host.context, mesh);
        CHECK_FALSE(alive(host, mesh));
    }
    host.pinAll("shadow_map");
    host.require(host.draw());
}

TEST_CASE_FIXTURE(DeviceTest, "a recorded frame can be dropped after the next one failed, and its map is drawn again")
{
    if (!countsOnlyOurs()) return;
    std::vector<Image8> good;
    {
        Host host(smallScene());
        host.pinAll("shadow_map");
        host.require(host.draw());
        good = host.pictures();
    }
    bool struck = true;
    for (std::size_t first = 0; struck; first += 3) {
        CAPTURE(first);
        Host host(smallScene());
        host.pinAll("shadow_map");
        GnFrameInfo frame{};
        std::vector<GnViewFrame> views;
        FrameOptions record{.call = Call::record, .drop = true};
        record.adjust = [&](GnFrameInfo& info, std::vector<GnViewFrame>& given) {
            frame = info;
            views = given;
        };
        record.around = [&](VkCommandBuffer cmd, bool begins) { // the frame after it, into what nobody submits either
            if (begins) return;
            ++frame.frame;
            frame.pViews = views.data();
            GnInstanceCreateInfo more{};
            more.mesh = host.meshes[0];
            more.transform.translation[1] = -1000.0;
            std::vector<GnInstance> far(40);
            for (GnInstance& instance : far)
                host.require(gnCreateInstance(host.context, &more, &instance));
            const Outcome next = without(first, [&] { return gnCmdRenderShadows(host.context, cmd, &frame); });
            struck = next.struck;
            CHECK((next.result == GN_ERROR_OUT_OF_HOST_MEMORY) == struck);
            if (!struck) host.require(gnDropFrame(host.context, frame.frame));
            for (const GnInstance instance : far)
                gnDestroyInstance(host.context, instance);
        };
        const GnResult dropped = host.draw(record);
        if (!struck) break; // the second one was dropped, the first one is not the last any more
        CHECK(dropped == GN_SUCCESS);
        host.require(host.draw());
        CHECK(host.stats().passesKept == 0);
        CHECK(differences(host.pictures(), good) == 0);
        host.draw(2, {});
        CHECK(differences(host.pictures(), good) == 0);
    }
}
