// Facing against one sum a face, bit by bit: random planes, planes that hold the light, and all that a broken mesh can
// leave in them.
#include <doctest/doctest.h>

#include <bit>
#include <limits>
#include <random>
#include <vector>

#include "algorithms/volumes/facing.hpp"

using namespace gnomon;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kTiny = std::numeric_limits<float>::denorm_min();
constexpr float kHuge = std::numeric_limits<float>::max();
constexpr float kOdd[] = {0.0f,  -0.0f,  kTiny,     -kTiny,     1e-38f, -3e-39f,
                          kHuge, -kHuge, kInfinity, -kInfinity, 1.0f,   std::numeric_limits<float>::quiet_NaN()};

struct Random {
    std::mt19937 engine;
    explicit Random(std::uint32_t seed) : engine(seed) {}
    std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(engine() % count); }
    float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); }
    /// Any float there is, most of them far from 1.
    float bits() { return std::bit_cast<float>(static_cast<std::uint32_t>(engine())); }
    float any(std::uint32_t kind)
    {
        if (kind == 0) return between(-1.0f, 1.0f);
        if (kind == 1) return static_cast<float>(static_cast<int>(below(5)) - 2); // sums of exactly 0
        return kind == 2 ? bits() : kOdd[below(static_cast<std::uint32_t>(std::size(kOdd)))];
    }
    glm::vec4 vector(std::uint32_t kind)
    {
        const float x = any(kind), y = any(kind), z = any(kind), w = any(kind);
        return {x, y, z, w};
    }
};

FacePlanes randomPlanes(Random& random, std::size_t count, std::uint32_t kind)
{
    FacePlanes planes;
    planes.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        planes.set(i, random.vector(kind));
    return planes;
}

/// The sentence of facing.hpp, face by face.
bool faces(const glm::vec4& plane, const glm::vec4& light)
{
    return plane.x * light.x + plane.y * light.y + plane.z * light.z + plane.w * light.w > 0.0f;
}

} // namespace

TEST_CASE("planes come back as they were set, and places behind the last face hold zeros")
{
    Random random(3);
    for (const std::size_t count : {1, 15, 16, 17, 100}) {
        FacePlanes planes;
        planes.resize(200); // used before
        for (std::size_t i = 0; i < 200; ++i)
            planes.set(i, glm::vec4(7.0f));
        planes.resize(count);
        std::vector<glm::vec4> given(count);
        for (std::size_t i = 0; i < count; ++i)
            planes.set(i, given[i] = random.vector(0));
        REQUIRE(planes.size() == count);
        for (std::size_t i = 0; i < count; ++i)
            CHECK(planes[i] == given[i]);
        for (std::size_t i = count; i % kBlockFaces != 0; ++i)
            CHECK(planes[i] == glm::vec4(0.0f));
    }
}

TEST_CASE("every face is answered as the sentence says, whatever planes and lights hold")
{
    Random random(5);
    std::size_t towards = 0, away = 0;
    for (std::uint32_t round = 0; round < 2000; ++round) {
        const std::size_t count = 1 + random.below(round % 10 == 0 ? 4000 : 70);
        const FacePlanes planes = randomPlanes(random, count, round % 4);
        const glm::vec4 light = random.vector(round / 4 % 4);
        std::vector<std::uint8_t> facing(count, 77);
        findFacing(planes, light, 0, facing);
        for (std::size_t i = 0; i < count; ++i) {
            REQUIRE(facing[i] == (faces(planes[i], light) ? 1 : 0));
            (facing[i] ? towards : away) += 1;
        }
    }
    CHECK(towards > 10000);
    CHECK(away > 10000);
}

TEST_CASE("any range of faces is answered, and nothing beside it is written")
{
    Random random(7);
    for (int round = 0; round < 2000; ++round) {
        const std::uint32_t count = 1 + random.below(100), first = random.below(count);
        const std::uint32_t length = random.below(count - first + 1);
        const FacePlanes planes = randomPlanes(random, count, 1);
        const glm::vec4 light = random.vector(1);
        constexpr std::size_t kGuard = 40;
        std::vector<std::uint8_t> bytes(length + 2 * kGuard, 77);
        findFacing(planes, light, first, std::span(bytes).subspan(kGuard, length));
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            const bool inside = i >= kGuard && i < kGuard + length;
            const int expected = inside ? faces(planes[first + i - kGuard], light) : 77;
            REQUIRE(static_cast<int>(bytes[i]) == expected);
        }
    }
}

TEST_CASE("a plane of zeros, and one that holds the light, face no light")
{
    FacePlanes planes;
    planes.resize(3);
    planes.set(1, {0.0f, 1.0f, 0.0f, -2.0f});
    planes.set(2, {0.0f, -1.0f, 0.0f, 2.0f});
    std::uint8_t facing[3] = {7, 7, 7};
    findFacing(planes, {5.0f, 2.0f, -3.0f, 1.0f}, 0, facing);
    CHECK(facing[0] + facing[1] + facing[2] == 0);
    findFacing(planes, {5.0f, 3.0f, -3.0f, 1.0f}, 0, facing);
    CHECK(facing[0] == 0);
    CHECK(facing[1] == 1);
    CHECK(facing[2] == 0);
}
