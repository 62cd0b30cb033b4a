// Views that draw a part of their images: what is copied of them, and what the pictures show.
#include <cstdlib>

#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kImage{320, 180};
constexpr VkRect2D kArea{{37, 22}, {243, 131}}; // no side a multiple of a tile or a strip
constexpr uint64_t kAreaTexels = uint64_t{kArea.extent.width} * kArea.extent.height;

struct Copied {
    uint64_t out = 0, in = 0; ///< Texels, from images and into images.
} copied;

uint64_t texels(uint32_t count, const VkBufferImageCopy2* regions)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count; ++i)
        sum += uint64_t{regions[i].imageExtent.width} * regions[i].imageExtent.height *
               regions[i].imageSubresource.layerCount;
    return sum;
}

VKAPI_ATTR void VKAPI_CALL countedOut(VkCommandBuffer cmd, const VkCopyImageToBufferInfo2* info)
{
    copied.out += texels(info->regionCount, info->pRegions);
    vkCmdCopyImageToBuffer2(cmd, info);
}

VKAPI_ATTR void VKAPI_CALL countedIn(VkCommandBuffer cmd, const VkCopyBufferToImageInfo2* info)
{
    copied.in += texels(info->regionCount, info->pRegions);
    vkCmdCopyBufferToImage2(cmd, info);
}

HostOptions counted()
{
    return hooked({.extent = kImage, .area = kArea},
                  {hook("vkCmdCopyImageToBuffer2", &countedOut), hook("vkCmdCopyBufferToImage2", &countedIn)});
}

struct Compared {
    size_t differing = 0; ///< By more than a 32nd: view rays of the two round apart.
    size_t dark = 0;
};

/// The part of one picture that the other is all of.
Compared compare(const Image8& part, const Image8& whole)
{
    Compared result;
    for (uint32_t y = 0; y < kArea.extent.height; ++y)
        for (uint32_t x = 0; x < kArea.extent.width; ++x) {
            const int left = *part.at(x + 37, y + 22), right = *whole.at(x, y);
            result.differing += std::abs(left - right) > 8;
            result.dark += right == 0;
        }
    return result;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "of depth and normals a view copies what it draws, and shows the same as images of its size")
{
    struct Expected {
        const char* method;
        uint64_t out, in; ///< Copies of the area in a frame.
    };
    for (const Expected& expected :
         {Expected{"ray_traced", 2, 1}, Expected{"tile_shafts", 2, 1}, Expected{"stencil_volume", 1, 1},
          Expected{"octree_volume", 1, 1}, Expected{"all_edges_volume", 1, 1}, Expected{"chan_durand", 1, 1},
          Expected{"mccool", 1, 1}, Expected{"penumbra_wedges", 1, 1}}) {
        CAPTURE(std::string(expected.method));
        Scene scene = smallScene();
        if (std::string_view(expected.method) == "penumbra_wedges") scene.lights[0].radius = 0.2f;
        Host part(scene, counted()), whole(scene, {.extent = kArea.extent});
        for (Host* host : {&part, &whole}) {
            host->pinAll(expected.method);
            copied = {};
            host->require(host->draw());
            REQUIRE(std::string(host->decision(0).pMethod) == expected.method);
            if (host == &whole) continue;
            CHECK(copied.out == expected.out * kAreaTexels);
            CHECK(copied.in == expected.in * kAreaTexels);
        }
        const Compared compared = compare(part.pictures()[0], whole.pictures()[0]);
        CHECK(compared.dark > 300);
        CHECK(compared.differing <= 3);
    }
}
