// Rays of blocks, handed on together or one by one: every pixel that wants an answer gets its own ray's, and nobody
// else.
#include <doctest/doctest.h>

#include <bit>
#include <random>
#include <vector>

#include "algorithms/host_frame.hpp"
#include "algorithms/hybrid/block_rays.hpp"
#include "algorithms/hybrid_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::uint8_t kLitByte = 200, kDarkByte = 3, kUntouched = 77;
constexpr std::size_t kStride = kWidth + 5, kFirst = 2; // answers start within the buffer

struct Lot {
    RayScene rays;
    TracedMesh mesh{makeScene(rays)};
    std::vector<Caster> casters{casterOf(mesh, 0)};
    std::vector<brute::Triangle> triangles = brute::trianglesOf(casters);
    Lot() { rays.update(casters); }
};

/// What each pixel's own ray says, from the scalar receivers.
std::vector<std::uint8_t> oneByOne(const Lot& lot, const Receivers& receivers, const LightPair& light,
                                   const std::vector<std::uint16_t>& wanted, std::uint64_t& rays)
{
    std::vector<std::uint8_t> bytes(kStride * kHeight + kFirst, kUntouched);
    for (std::uint32_t y = 0; y < kHeight; ++y) {
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const std::uint32_t block = y / 4 * (kWidth / 4) + x / 4, lane = y % 4 * 4 + x % 4;
            ShadowRay ray;
            if ((wanted[block] >> lane & 1) == 0 || receivers.at(x, y, ray) != Asked::ray) continue;
            std::uint8_t occluded = 0;
            if (!(ray.tfar < 0.0f)) lot.rays.occluded({&ray, 1}, light.view.mask, {&occluded, 1});
            bytes[kFirst + y * kStride + x] = occluded ? kDarkByte : kLitByte;
            ++rays;
        }
    }
    return bytes;
}

std::uint32_t askingLanes(const simd::Block& block)
{
    std::uint32_t lanes = 0;
    for (std::uint32_t i = 0; i < simd::kLanes; ++i)
        lanes |= block.asked[i] == simd::kRay ? 1u << i : 0u;
    return lanes;
}

} // namespace

TEST_CASE("every lane that is asked for has its own ray's answer, whether its block goes together or not")
{
    Lot lot;
    const Seen seen = look({}, lot.triangles);
    std::mt19937 random(7);
    for (const LightPair& light : {makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.4, -1.0, -0.3}, 0.0, 0.0),
                                   makeLight(GN_LIGHT_TYPE_POINT, {1, 9, 3}, {0, -1, 0}, 25.0, 0.0)}) {
        // All lanes, a few of each block (some go together), and whole blocks among blocks of which nothing is wanted.
        for (const std::uint32_t pattern : {0u, 1u, 2u}) {
            std::vector<std::uint16_t> wanted(kWidth * kHeight / 16);
            for (std::uint16_t& lanes : wanted)
                lanes = static_cast<std::uint16_t>(pattern == 0   ? 0xffffu
                                                   : pattern == 1 ? random() & random()
                                                                  : (random() % 5 == 0 ? 0xffffu : 0u));
            std::uint64_t expectedRays = 0;
            const Receivers receivers(seen.view, light.view, seen.depth, seen.normalBytes());
            const std::vector<std::uint8_t> expected = oneByOne(lot, receivers, light, wanted, expectedRays);
            CHECK(expectedRays > 300);
            CAPTURE(pattern);
            std::vector<std::uint8_t> bytes(expected.size(), kUntouched);
            HostFrame frame(lot.rays);
            const std::uint64_t rays = frame.run([&](const HostContext& host) {
                const BlockReader reader(widestKernels(), seen.view, light.view, seen.depth, seen.normalBytes());
                BlockRays asking(
                    {.host = host, .reader = reader, .light = light.view, .lit = kLitByte, .dark = kDarkByte}, bytes,
                    kStride);
                for (std::uint32_t y = 0; y < kHeight; y += 4) {
                    for (std::uint32_t x = 0; x < kWidth; x += 4) {
                        simd::Block block;
                        reader.read(x, y, block);
                        const std::uint32_t lanes = askingLanes(block) & wanted[y / 4 * (kWidth / 4) + x / 4];
                        if (lanes != 0) asking.ask(block, lanes, kFirst + y * kStride + x);
                    }
                }
                asking.flush();
            });
            CHECK(rays == expectedRays);
            CHECK(bytes == expected);
        }
    }
}
