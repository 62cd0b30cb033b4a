// Hosts that were compiled with another header: their structures end earlier, or later, than the library's.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <optional>

#include <doctest/doctest.h>

#include "device/error_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::byte kUntouched{0xA5};

/// A structure of so many bytes and not one more; what the library's has not is filled with `tail`.
template <typename T>
class Sized {
public:
    Sized(const T& value, size_t size, std::byte tail = {}) : bytes_(size, tail)
    {
        std::memcpy(bytes_.data(), &value, std::min(size, sizeof(T)));
        const auto given = static_cast<uint32_t>(size);
        std::memcpy(bytes_.data(), &given, sizeof given);
    }
    T* get() { return reinterpret_cast<T*>(bytes_.data()); }
    const std::vector<std::byte>& bytes() const { return bytes_; }

private:
    std::vector<std::byte> bytes_;
};

/// Elements of so many bytes, one after the other.
template <typename T>
class SizedArray {
public:
    SizedArray(const std::vector<T>& values, size_t size) : size_(size), bytes_(values.size() * size)
    {
        for (size_t i = 0; i < values.size(); ++i)
            std::ranges::copy(Sized<T>(values[i], size).bytes(), bytes_.begin() + static_cast<ptrdiff_t>(i * size));
    }
    T* get() { return reinterpret_cast<T*>(bytes_.data()); }
    /// A member of the i-th, which lies there within its size.
    template <typename Member>
    Member at(size_t i, size_t offset) const
    {
        Member value;
        std::memcpy(&value, bytes_.data() + i * size_ + offset, sizeof value);
        return value;
    }

private:
    size_t size_;
    std::vector<std::byte> bytes_;
};

// The size of a structure that ends with this member.
#define THROUGH(Type, member) (offsetof(Type, member) + sizeof(Type::member))

GnLightInfo sunInfo()
{
    return {.type = GN_LIGHT_TYPE_DIRECTIONAL, .direction = {0.3f, -1.0f, 0.2f}};
}

std::vector<Image8> litBy(Host& host, GnLight light)
{
    host.require(gnSetLightMethod(host.context, light, "shadow_map"));
    const std::vector<GnLight> lights{light};
    host.draw(2, {.lights = &lights});
    return host.pictures();
}

/// What a frame is drawn from, without what is the fixture's own: it may be drawn once more by hand.
struct Captured {
    GnFrameInfo info;
    std::vector<GnViewFrame> views;
    std::vector<GnLight> lights; ///< Of all views.

    explicit Captured(Host& host)
    {
        host.require(host.draw({.adjust = [&](GnFrameInfo& frame, std::vector<GnViewFrame>& seen) {
            info = frame;
            views = seen;
            lights.assign(seen[0].pLights, seen[0].pLights + seen[0].lightCount);
        }}));
        for (GnViewFrame& view : views)
            view.pLights = lights.data();
        static_cast<void>(host.pictures()); // the device is done with it
        info.completedFrame = info.frame++;
        info.pViews = views.data();
    }
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "an older host makes a context, and objects in it")
{
    const GnContextCreateInfo contextInfo = device().contextInfo();
    GnContext context = VK_NULL_HANDLE;
    Sized older(contextInfo, THROUGH(GnContextCreateInfo, pfnGetInstanceProcAddr));
    REQUIRE(gnCreateContext(older.get(), &context) == GN_SUCCESS);
    const float corners[] = {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f};
    Sized mesh(GnMeshCreateInfo{.pPositions = corners, .positionCount = 3}, THROUGH(GnMeshCreateInfo, positionCount));
    GnMesh madeMesh = VK_NULL_HANDLE;
    CHECK(gnCreateMesh(context, mesh.get(), &madeMesh) == GN_SUCCESS);
    Sized instance(GnInstanceCreateInfo{.mesh = madeMesh}, THROUGH(GnInstanceCreateInfo, mesh));
    GnInstance madeInstance = VK_NULL_HANDLE;
    CHECK(gnCreateInstance(context, instance.get(), &madeInstance) == GN_SUCCESS);
    Sized view(GnViewCreateInfo{}, THROUGH(GnViewCreateInfo, maxLights));
    GnView madeView = VK_NULL_HANDLE;
    CHECK(gnCreateView(context, view.get(), &madeView) == GN_SUCCESS);
    gnDestroyContext(context);

    // One of a member less lacks what has to be there.
    Sized less(contextInfo, THROUGH(GnContextCreateInfo, pfnGetInstanceProcAddr) - sizeof(void*));
    CHECK(gnCreateContext(less.get(), &context) == GN_ERROR_OUT_OF_RANGE);
    CHECK(context == VK_NULL_HANDLE);
}

TEST_CASE_FIXTURE(DeviceTest, "a newer host's context is made unless it needs what the library does not know")
{
    GnContextCreateInfo info = device().contextInfo();
    std::string told;
    info.pUserData = &told;
    info.pfnMessage = [](const GnMessage* message, void* user) {
        CHECK(message->structSize == sizeof(GnMessage));
        *static_cast<std::string*>(user) = message->pText;
    };
    GnContext context = VK_NULL_HANDLE;
    Sized newer(info, sizeof info + 16);
    CHECK(gnCreateContext(newer.get(), &context) == GN_SUCCESS);
    gnDestroyContext(context);
    CHECK(told.empty());
    Sized needy(info, sizeof info + 16, std::byte{1});
    CHECK(gnCreateContext(needy.get(), &context) == GN_ERROR_UNSUPPORTED);
    CHECK(context == VK_NULL_HANDLE);
    CHECK(told.find("GnContextCreateInfo::structSize is " + std::to_string(sizeof info + 16)) != std::string::npos);
}

TEST_CASE_FIXTURE(DeviceTest, "members that an older host lacks are as if they were zero, those of a newer one ignored")
{
    Host host(smallScene());
    const GnLightInfo info = sunInfo();
    GnLight sun = VK_NULL_HANDLE, older = VK_NULL_HANDLE, newer = VK_NULL_HANDLE;
    Sized shorter(info, THROUGH(GnLightInfo, direction)), longer(info, sizeof info + 24);
    host.require(gnCreateLight(host.context, &info, &sun));
    host.require(gnCreateLight(host.context, shorter.get(), &older));
    host.require(gnCreateLight(host.context, longer.get(), &newer));
    const std::vector<Image8> good = litBy(host, sun);
    CHECK(dark(good[0]) > 100);
    CHECK(differences(litBy(host, older), good) == 0);
    CHECK(differences(litBy(host, newer), good) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a frame of another version's structures is drawn alike")
{
    Host host(smallScene(), {.viewCount = 2});
    host.pinAll("shadow_map");
    host.draw(2, {});
    const std::vector<Image8> good[2] = {host.pictures(0), host.pictures(1)};
    std::optional<SizedArray<GnViewFrame>> newer;
    host.require(host.draw({.adjust = [&](GnFrameInfo& info, std::vector<GnViewFrame>& views) {
        newer.emplace(views, sizeof(GnViewFrame) + 8);
        info.pViews = newer->get();
    }}));
    for (uint32_t view = 0; view < 2; ++view)
        CHECK(differences(host.pictures(view), good[view]) == 0);

    Captured frame(host);
    Sized older(frame.info, THROUGH(GnFrameInfo, pViews));
    CHECK(gnSubmitShadows(host.context, older.get()) == GN_SUCCESS);
    CHECK(host.stats().frame == frame.info.frame);

    // Views that end with what is required have no lights.
    SizedArray bare(frame.views, THROUGH(GnViewFrame, imageExtent));
    ++frame.info.frame;
    frame.info.pViews = bare.get();
    CHECK(gnSubmitShadows(host.context, &frame.info) == GN_SUCCESS);
    GnDecision decision{};
    CHECK(gnGetDecision(host.context, host.views[1], host.lights[0], &decision) == GN_ERROR_INVALID_HANDLE);
}

TEST_CASE_FIXTURE(DeviceTest, "what is filled for another version has its size")
{
    Host host(smallScene());
    host.pinAll("shadow_map");
    host.draw(2, {});
    GnVisibility whole{};
    host.require(gnGetVisibility(host.context, host.views[0], &whole));

    GnVisibility older{};
    std::memset(static_cast<void*>(&older), static_cast<int>(kUntouched), sizeof older);
    older.structSize = THROUGH(GnVisibility, imageView);
    host.require(gnGetVisibility(host.context, host.views[0], &older));
    CHECK(older.image == whole.image);
    CHECK(older.imageView == whole.imageView);
    CHECK(older.structSize == THROUGH(GnVisibility, imageView));
    const auto* bytes = reinterpret_cast<const std::byte*>(&older);
    CHECK(std::all_of(bytes + older.structSize, bytes + sizeof older, [](std::byte b) { return b == kUntouched; }));

    Sized newer(GnVisibility{}, sizeof(GnVisibility) + 16, kUntouched);
    host.require(gnGetVisibility(host.context, host.views[0], newer.get()));
    CHECK(newer.get()->revision == whole.revision);
    CHECK(std::all_of(newer.bytes().begin() + sizeof(GnVisibility), newer.bytes().end(),
                      [](std::byte b) { return b == std::byte{}; }));

    // Zero after a failure, too.
    Sized failed(whole, sizeof whole + 16, kUntouched);
    CHECK(gnGetVisibility(host.context, VK_NULL_HANDLE, failed.get()) == GN_ERROR_INVALID_HANDLE);
    CHECK(std::all_of(failed.bytes().begin() + sizeof(uint32_t), failed.bytes().end(),
                      [](std::byte b) { return b == std::byte{}; }));
}

TEST_CASE_FIXTURE(DeviceTest, "lists are filled with the host's stride")
{
    Host host(smallScene());
    uint32_t count = 0;
    host.require(gnEnumerateMethods(host.context, &count, nullptr));
    std::vector<GnMethodInfo> methods(count);
    host.require(gnEnumerateMethods(host.context, &count, methods.data()));
    REQUIRE(count > 3);
    for (const size_t size : {THROUGH(GnMethodInfo, pName), sizeof(GnMethodInfo) + 16}) {
        CAPTURE(size);
        SizedArray<GnMethodInfo> others(std::vector<GnMethodInfo>(count), size);
        host.require(gnEnumerateMethods(host.context, &count, others.get()));
        REQUIRE(count == methods.size());
        for (uint32_t i = 0; i < count; ++i) {
            CHECK(others.at<uint32_t>(i, 0) == size);
            CHECK(others.at<const char*>(i, offsetof(GnMethodInfo, pName)) == methods[i].pName);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a structure whose size was forgotten is refused by name, and nothing changes")
{
    Watched watched;
    Host& host = watched.host;
    const GnContext c = host.context;
    const GnLight lamp = host.lights[0];
    const auto refused = [&](const char* named, GnResult result) {
        watched.refused(named, result, GN_ERROR_OUT_OF_RANGE, named);
    };
    const auto forgotten = [](auto info) {
        info.structSize = 0;
        return info;
    };
    const GnLightInfo light = forgotten(sunInfo());
    const GnMeshCreateInfo mesh = forgotten(GnMeshCreateInfo{});
    const GnQuestion question = forgotten(GnQuestion{});
    const GnFrameInfo frame = forgotten(GnFrameInfo{});
    GnLight madeLight = VK_NULL_HANDLE;
    GnMesh madeMesh = VK_NULL_HANDLE;
    size_t size = 0;
    refused("pInfo: GnLightInfo::structSize is 0", gnCreateLight(c, &light, &madeLight));
    refused("pInfo: GnLightInfo::structSize is 0", gnUpdateLight(c, lamp, &light));
    refused("pCreateInfo: GnMeshCreateInfo::structSize is 0", gnCreateMesh(c, &mesh, &madeMesh));
    refused("pQuestion: GnQuestion::structSize is 0", gnExplain(c, host.views[0], lamp, &question, &size, nullptr));
    refused("pFrame: GnFrameInfo::structSize is 0", gnSubmitShadows(c, &frame));

    GnFrameStats stats = forgotten(GnFrameStats{});
    refused("pStats: GnFrameStats::structSize is 0", gnGetFrameStats(c, &stats));
    std::vector<GnMethodInfo> methods(3, forgotten(GnMethodInfo{}));
    uint32_t count = 3;
    refused("pMethods[0]: GnMethodInfo::structSize is 0", gnEnumerateMethods(c, &count, methods.data()));
    CHECK(count == 0);

    Captured captured(host);
    captured.views.push_back(forgotten(captured.views[0]));
    captured.info.viewCount = 2;
    captured.info.pViews = captured.views.data();
    refused("pViews[1]: GnViewFrame::structSize is 0", gnSubmitShadows(c, &captured.info));
    Sized needy(sunInfo(), sizeof(GnLightInfo) + 8, std::byte{1});
    watched.refused("needy", gnUpdateLight(c, lamp, needy.get()), GN_ERROR_UNSUPPORTED, "is not 0");
}
