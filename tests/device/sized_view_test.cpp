// A view whose image is there before its first frame.
#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

GnVisibility visibilityOf(const Host& host, GnView view)
{
    GnVisibility out{};
    host.require(gnGetVisibility(host.context, view, &out));
    return out;
}

/// The host's one view, made with its size.
void renewView(Host& host, VkExtent2D extent)
{
    gnDestroyView(host.context, host.views[0]);
    const GnViewCreateInfo info{.maxLights = 4, .pName = "sized", .imageExtent = extent};
    host.require(gnCreateView(host.context, &info, &host.views[0]));
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a view that knows its size has its image before the first frame, and keeps it")
{
    constexpr VkExtent2D size{96, 54}, larger{120, 60};
    Host host(smallScene(), {.extent = size});
    renewView(host, size);
    const GnVisibility before = visibilityOf(host, host.views[0]);
    CHECK(before.image != VkImage(VK_NULL_HANDLE));
    CHECK(before.imageView != VkImageView(VK_NULL_HANDLE));
    CHECK(before.extent.width == size.width);
    CHECK(before.extent.height == size.height);
    CHECK(before.layerCount == 4);
    CHECK(before.revision == 1);
    const auto same = [&](const GnVisibility& now) {
        return now.image == before.image && now.imageView == before.imageView && now.revision == before.revision;
    };
    host.draw({.call = Call::record, .drop = true});
    CHECK(same(visibilityOf(host, host.views[0])));
    host.require(host.draw());
    CHECK(same(visibilityOf(host, host.views[0])));
    CHECK(dark(host.pictures()[0]) > 10);
    host.draw(3, {});
    CHECK(same(visibilityOf(host, host.views[0])));
    host.resize(larger);
    host.require(host.draw());
    const GnVisibility after = visibilityOf(host, host.views[0]);
    CHECK(after.revision == 2);
    CHECK(after.imageView != before.imageView);
    CHECK(dark(host.pictures()[0]) > 10);
}

TEST_CASE_FIXTURE(DeviceTest, "a first frame of another size replaces the image, and one that is dropped leaves it")
{
    constexpr VkExtent2D size{96, 54};
    Host host(smallScene(), {.extent = size});
    renewView(host, {40, 30});
    const GnVisibility before = visibilityOf(host, host.views[0]);
    host.draw({.call = Call::record, .drop = true});
    const GnVisibility dropped = visibilityOf(host, host.views[0]);
    CHECK(dropped.imageView == before.imageView);
    CHECK(dropped.revision > before.revision); // handles may have changed twice
    host.require(host.draw());
    const GnVisibility after = visibilityOf(host, host.views[0]);
    CHECK(after.extent.width == size.width);
    CHECK(after.revision > dropped.revision);
    CHECK(dark(host.pictures()[0]) > 10);
}

TEST_CASE_FIXTURE(DeviceTest, "a view whose size cannot be is refused by its numbers, and leaves nothing behind")
{
    Host host(smallScene(),
              {.extent = {96, 54}, .context = [](GnContextCreateInfo& info) { info.memoryLimit = 64u << 20; }});
    host.draw(2, {});
    const VkDeviceSize memory = host.stats().memory;
    const auto refused = [&](VkExtent2D extent, GnResult expected, const char* words) {
        GnView view = host.views[0];
        const GnViewCreateInfo info{.imageExtent = extent};
        CHECK(gnCreateView(host.context, &info, &view) == expected);
        CHECK(view == GnView(VK_NULL_HANDLE));
        CAPTURE(host.lastError());
        CHECK(host.lastError().find(words) != std::string::npos);
    };
    refused({0, 30}, GN_ERROR_OUT_OF_RANGE, "0 x 30");
    refused({1000000, 30}, GN_ERROR_OUT_OF_RANGE, "1000000 x 30");
    refused({4096, 4096}, GN_ERROR_OUT_OF_DEVICE_MEMORY, "256 MiB");
    host.draw(2, {});
    CHECK(host.stats().memory == memory);
}
