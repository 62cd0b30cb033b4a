// No memory on the host, from some allocation on and for good: the call says so, and what was there is still there.
#include "device/fixture.hpp"
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

TEST_CASE_FIXTURE(DeviceTest, "a recorded frame can be dropped after the next one failed, and its map is drawn anew")
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
