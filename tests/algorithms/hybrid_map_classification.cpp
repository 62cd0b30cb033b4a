// A map asked for all pixels on the CPU, sixteen at a time, against every receiver asked by itself (MapTexels).
#include <doctest/doctest.h>

#include <algorithm>

#include <glm/gtc/packing.hpp>

#include "algorithms/chain_pass_fixture.hpp"
#include "algorithms/hybrid/map_classification.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

const Lamp& sun()
{
    static const Lamp lamp(makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.4, -1.0, -0.3}, 0.0, 0.0).view);
    return lamp;
}

struct Case {
    const Lamp& lamp;
    VkRect2D area{{0, 0}, {kWidth, kHeight}};
    std::uint32_t missing = 6; ///< A layer that is not there; 6: none.
    bool halves = false;       ///< Normals.
};

/// Calls body(question, host) in a host pass; the case's view lives as long.
template <typename Body>
std::uint64_t inPass(const Case& of, const Body& body)
{
    HostFrame frame(const_cast<RayScene&>(world().rays));
    CameraView view = world().seen.view;
    view.area = of.area;
    std::vector<std::uint64_t> halves;
    for (const glm::vec4& normal : world().seen.normals)
        halves.push_back(glm::packHalf4x16(normal));
    if (of.halves) view.normalFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
    const DrawnMap& drawn = of.lamp.map;
    constexpr const char* kNames[] = {"d0", "d1", "d2", "d3", "d4", "d5"};
    HostMapCopy map{.layers = static_cast<std::uint32_t>(drawn.fits.size()), .needed = 0, .depth = {}};
    for (std::uint32_t layer = 0; layer < map.layers; ++layer) {
        if (layer == of.missing) continue;
        map.needed |= 1u << layer;
        map.depth[layer] = frame.holding<float>(kNames[layer], drawn.depth[layer]);
    }
    const MapQuestion question{.view = &view,
                               .light = &of.lamp.view,
                               .constants = &of.lamp.constants.base,
                               .map = map,
                               .depth = frame.holding<float>("depth", world().seen.depth),
                               .normals = of.halves ? frame.holding<std::uint64_t>("normals", halves)
                                                    : frame.holding<glm::vec4>("normals", world().seen.normals)};
    return frame.run([&](const HostContext& host) { body(question, host); });
}

/// How the pixels of two ways to ask compare.
struct Census {
    int pixels = 0, different = 0, wrong = 0; ///< wrong: one says lit, the other dark.
    int of[gpu::REASON_COUNT] = {};
    int traced = 0; ///< Pixels with the answer of a ray.
};

bool isTraced(std::uint32_t reason)
{
    return reason == gpu::REASON_RT_LIT || reason == gpu::REASON_RT_SHADOW;
}

/// The reason of a pixel by MapTexels.
std::uint32_t expectedVote(const Case& of, const Receivers& receivers, std::uint32_t x, std::uint32_t y)
{
    ShadowRay ray;
    Receiver receiver;
    const Asked asked = receivers.at(x, y, ray, receiver);
    if (asked != Asked::ray) return asked == Asked::lit ? gpu::REASON_OUTSIDE : gpu::REASON_BACKFACING;
    const HostMap map = of.lamp.map.view();
    const MapTexels texels(map, of.lamp.constants.base, of.lamp.cube(), receiver);
    if (texels.clearlyLit()) return gpu::REASON_TC_LIT;
    if (texels.agree(false, TexelBlock::four)) return gpu::REASON_TC_SHADOW;
    std::uint8_t occluded = 0;
    world().rays.occluded({&ray, 1}, 1u, {&occluded, 1});
    return occluded ? gpu::REASON_RT_SHADOW : gpu::REASON_RT_LIT;
}

Census compareVotes(const Case& of)
{
    const VkRect2D& area = of.area;
    std::vector<std::uint8_t> bytes(std::size_t(area.extent.width) * area.extent.height, 250);
    const std::uint64_t rays = inPass(of, [&](const MapQuestion& question, const HostContext& host) {
        classifiedPixels(question, true, host, bytes);
    });
    const Receivers receivers(world().seen.view, of.lamp.view, world().seen.depth, world().seen.normalBytes());
    Census census;
    for (std::uint32_t y = 0; y < area.extent.height; ++y)
        for (std::uint32_t x = 0; x < area.extent.width; ++x) {
            const std::uint32_t told = bytes[std::size_t(y) * area.extent.width + x];
            const std::uint32_t expected = expectedVote(of, receivers, static_cast<std::uint32_t>(area.offset.x) + x,
                                                        static_cast<std::uint32_t>(area.offset.y) + y);
            ++census.pixels;
            REQUIRE(told < gpu::REASON_COUNT);
            ++census.of[told];
            census.traced += isTraced(told);
            // Where one way traces and the other does not, texels are within rounding of a comparison.
            census.different += told != expected;
            census.wrong += told != expected && isTraced(told) == isTraced(expected);
        }
    CHECK(rays == static_cast<std::uint64_t>(census.traced));
    return census;
}

} // namespace

TEST_CASE("four texels say of sixteen pixels at a time what they say of each, and rays the rest")
{
    for (const Lamp* light : {&sun(), &lamp(false), &lamp(true)}) {
        CAPTURE(light->view.type);
        const Census census = compareVotes({.lamp = *light});
        MESSAGE("of " << census.pixels << " pixels " << census.different << " differ, " << census.traced << " traced");
        CHECK(census.wrong == 0);
        CHECK(census.different <= census.pixels / 2000);
        for (const std::uint32_t reason : {gpu::REASON_OUTSIDE, gpu::REASON_BACKFACING, gpu::REASON_TC_LIT,
                                           gpu::REASON_TC_SHADOW, gpu::REASON_RT_LIT, gpu::REASON_RT_SHADOW})
            CHECK(census.of[reason] > 20);
    }
}

TEST_CASE("an area of any place and size is answered as the whole picture is")
{
    for (const VkRect2D area : {VkRect2D{{7, 5}, {61, 43}}, VkRect2D{{0, 0}, {3, 2}}, VkRect2D{{150, 111}, {10, 9}}}) {
        const Census census = compareVotes({.lamp = lamp(true), .area = area});
        CHECK(census.pixels == static_cast<int>(area.extent.width * area.extent.height));
        CHECK(census.wrong == 0);
        CHECK(census.different <= 2);
    }
}

TEST_CASE("where a layer is missing nobody is believed: its pixels are traced")
{
    const Census whole = compareVotes({.lamp = lamp(true)}), without = compareVotes({.lamp = lamp(true), .missing = 3});
    CHECK(without.traced > whole.traced + 500); // the floor lies in -Y
    CHECK(without.of[gpu::REASON_OUTSIDE] == whole.of[gpu::REASON_OUTSIDE]);
}

TEST_CASE("half normals are asked as well")
{
    std::vector<std::uint8_t> full(kPixels), half(kPixels);
    for (auto* bytes : {&full, &half})
        inPass({.lamp = lamp(false), .halves = bytes == &half},
               [&](const MapQuestion& question, const HostContext& host) {
                   classifiedPixels(question, false, host, *bytes);
               });
    int different = 0, dark = 0;
    for (std::size_t i = 0; i < kPixels; ++i) {
        CHECK((full[i] == 0 || full[i] == 255));
        different += full[i] != half[i];
        dark += full[i] == 0;
    }
    CHECK(dark > 1000);
    CHECK(different <= 20); // normals of 11 bits turn few surfaces away
}

TEST_CASE("maps say the same whichever instructions ask them")
{
    for (const Lamp* light : {&sun(), &lamp(false), &lamp(true)}) {
        CAPTURE(light->view.type);
        const simd::Kernels& narrowest = *kernelsHere().front();
        simd::MapLookup map = mapLookupOf(light->constants.base, light->cube());
        for (std::size_t layer = 0; layer < light->map.fits.size(); ++layer)
            map.depth[layer] = light->map.depth[layer].data();
        const simd::MapBytes told{.outside = 1, .backfacing = 2, .lit = 3, .dark = 4, .unsure = 5};
        const auto answers = [&](const simd::Kernels& kernels) {
            const BlockReader reader(kernels, world().seen.view, light->view, world().seen.depth,
                                     world().seen.normalBytes());
            std::pair<std::vector<std::uint8_t>, std::vector<std::uint32_t>> all; // bytes, and who wants rays
            for (std::uint32_t y = 0; y < kHeight; y += 4)
                for (std::uint32_t x = 0; x < kWidth; x += 4) {
                    simd::MapPlaces places;
                    std::uint8_t bytes[2][simd::kLanes];
                    reader.place(x, y, map, places);
                    all.second.push_back(kernels.classifyTexels(map, places, told, bytes[0]));
                    const simd::MapLanes lanes = kernels.nearest(map, places, told, bytes[1]);
                    all.second.insert(all.second.end(), {lanes.asks, lanes.agree, lanes.clearlyLit});
                    for (const auto& of : bytes)
                        all.first.insert(all.first.end(), std::begin(of), std::end(of));
                }
            return all;
        };
        const auto expected = answers(narrowest);
        for (int byte = 1; byte <= 4; ++byte)
            CHECK(std::count(expected.first.begin(), expected.first.end(), byte) > 100);
        for (const simd::Kernels* kernels : kernelsHere())
            CHECK(answers(*kernels) == expected);
    }
}

TEST_CASE("the own texel says of sixteen pixels at a time what it says of each")
{
    const simd::MapBytes told{.outside = 1, .backfacing = 2, .lit = 3, .dark = 4, .unsure = 5};
    for (const Lamp* light : {&sun(), &lamp(false), &lamp(true)}) {
        CAPTURE(light->view.type);
        Lamp spoilt = *light; // something before the near end of a corner of every layer
        for (std::vector<float>& depth : spoilt.map.depth)
            for (std::size_t i = 0; i < depth.size(); ++i)
                if (i % kMapSide < kMapSide / 2) depth[i] = std::min(depth[i], i / kMapSide < 60 ? 1.0f : 0.0f);
        std::vector<std::uint8_t> bytes(kPixels);
        const std::size_t words = BitRows::wordsPerRow(kWidth) * kHeight;
        std::vector<std::uint64_t> bits[3];
        BitRows settled[3]; // by what is believed
        for (std::size_t i = 0; i < std::size(bits); ++i) {
            bits[i].assign(words, ~std::uint64_t{0});
            settled[i] = {kWidth, kHeight, bits[i]};
        }
        const auto [asksNothing, agrees, clear] = settled;
        inPass({.lamp = spoilt}, [&](const MapQuestion& question, const HostContext& host) {
            for (const Believed believed : {Believed::never, Believed::agreeing, Believed::clearlyLit})
                nearestPixels(question, told, host, bytes, settled[static_cast<std::size_t>(believed)], believed);
        });
        const Receivers receivers(world().seen.view, spoilt.view, world().seen.depth, world().seen.normalBytes());
        const HostMap map = spoilt.map.view();
        int different = 0, of[6] = {}, agreeing = 0, clearing = 0, unlike = 0;
        for (std::uint32_t i = 0; i < kPixels; ++i) {
            ShadowRay ray;
            Receiver receiver;
            const Asked asked = receivers.at(i % kWidth, i / kWidth, ray, receiver);
            REQUIRE(bytes[i] < 6);
            ++of[bytes[i]];
            const std::uint32_t x = i % kWidth, y = i / kWidth;
            CHECK(asksNothing.at(x, y) == (asked != Asked::ray));
            if (asked != Asked::ray) {
                CHECK(agrees.at(x, y));
                CHECK(clear.at(x, y));
                different += bytes[i] != (asked == Asked::lit ? 1 : 2);
                continue;
            }
            const MapTexels texels(map, spoilt.constants.base, spoilt.cube(), receiver);
            // MapTexels calls nothing lit for a texel at 0, but for what lies before the near end itself.
            const bool lit = texels.agree(true, TexelBlock::own), dark = texels.agree(false, TexelBlock::own);
            different += bytes[i] != (lit ? 3 : dark ? 4 : 5);
            const bool agree = (lit || dark) && texels.agree(lit, TexelBlock::four);
            agreeing += agree;
            unlike += agrees.at(x, y) != agree;
            clearing += texels.clearlyLit();
            unlike += clear.at(x, y) != texels.clearlyLit();
        }
        CHECK(different <= 8);
        CHECK(unlike <= 8);
        CHECK(agreeing > clearing); // some of the dark, and those that lie too near to tell
        CHECK(clearing > 100);
        for (const int told_ : {1, 2, 3, 4})
            CHECK(of[told_] > 20);
    }
}
