// Packets with every pattern of masked lanes and anything in them, with every instruction set that the processor has:
// Embree has kernels of another width for each.
#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "runtime/base/instruction_set.hpp"
#include "runtime/brute_force.hpp"
#include "runtime/ray_fixture.hpp"

using namespace gnomon;
using test::casterOf;
using test::randomRays;
using test::TracedMesh;

namespace {

constexpr std::uint32_t kWidth = RayPacket::kWidth;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Limits what is created while it lives.
class Limit {
public:
    explicit Limit(InstructionSet set) { limitInstructionSet(set); }
    ~Limit() { limitInstructionSet(before_); }
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;

private:
    InstructionSet before_ = instructionSetLimit();
};

std::vector<InstructionSet> setsHere()
{
    std::vector<InstructionSet> sets;
    for (const auto set :
         {InstructionSet::Baseline, InstructionSet::Sse42, InstructionSet::Avx2, InstructionSet::Avx512})
        if (isSupported(set)) sets.push_back(set);
    return sets;
}

void put(RayPacket& packet, std::uint32_t lane, const ShadowRay& ray)
{
    for (int axis = 0; axis < 3; ++axis) {
        packet.origin[axis][lane] = ray.origin[axis];
        packet.direction[axis][lane] = ray.direction[axis];
    }
    packet.tfar[lane] = ray.tfar;
}

// What may lie in a lane that is not there: numbers of each kind that trouble arithmetic, and all bits set.
constexpr float kLargest = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();
constexpr std::array<float, 9> kLeft = {
    0.0f,  std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, kLargest, -kLargest, kTiny,
    -1.0f, std::bit_cast<float>(0xffffffffu)};

/// A packet of one ray in the first lane.
bool alone(const RayScene& scene, const ShadowRay& ray)
{
    RayPacket packet{};
    put(packet, 0, ray);
    packet.there[0] = -1;
    scene.occluded({&packet, 1}, 1u);
    return packet.tfar[0] == -kInfinity;
}

/// Instances side by side, each with its own transform: packets change spaces.
struct World {
    RayScene scene;
    TracedMesh mesh;
    std::vector<Caster> casters;

    explicit World(std::mt19937 random) : mesh(scene, test::randomTriangles(random, 400, 4.0f, 0.6f))
    {
        for (std::uint32_t i = 0; i < 4; ++i)
            casters.push_back(casterOf(mesh, i, glm::mat3(i % 2 ? 0.5f : -1.0f), test::randomPoint(random, 3.0f)));
        scene.update(casters);
    }
};

/// Rays of packets one after the other, answered with each instruction set.
struct Asked {
    std::vector<ShadowRay> rays;
    std::vector<std::uint8_t> answers;

    Asked(const World& world, std::mt19937 random) : rays(randomRays(random, std::size_t(64) * kWidth, 6.0f))
    {
        for (const ShadowRay& ray : rays)
            answers.push_back(alone(world.scene, ray));
    }
};

/// Lane i of packet `number` asks if bit i of `pattern` is set; the others hold what `kLeft` says.
RayPacket packetOf(const Asked& asked, std::size_t number, std::uint32_t pattern)
{
    RayPacket packet;
    std::memset(static_cast<void*>(&packet), 0xff, sizeof packet);
    for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
        packet.there[lane] = (pattern >> lane & 1u) != 0 ? -1 : 0;
        const float left = kLeft[(pattern + lane) % kLeft.size()];
        put(packet, lane,
            packet.there[lane] ? asked.rays[number * kWidth + lane]
                               : ShadowRay{glm::vec3(left), left, glm::vec3(left)});
    }
    return packet;
}

} // namespace

TEST_CASE("a lane is answered as if its ray were alone, whichever lanes are masked out and whatever they hold")
{
    for (const InstructionSet set : setsHere()) {
        CAPTURE(nameOf(set));
        const Limit limit(set);
        const World world(std::mt19937(21));
        const Asked asked(world, std::mt19937(22));
        std::size_t blocked = 0, wrong = 0;
        for (std::uint32_t pattern = 0; pattern < 1u << kWidth; ++pattern) {
            const std::size_t number = pattern * 7 % (asked.rays.size() / kWidth);
            RayPacket packet = packetOf(asked, number, pattern);
            world.scene.occluded({&packet, 1}, 1u);
            for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
                if ((pattern >> lane & 1u) == 0) continue;
                const bool answer = packet.tfar[lane] == -kInfinity;
                wrong += answer != (asked.answers[number * kWidth + lane] != 0);
                blocked += answer;
            }
        }
        CHECK(wrong == 0);
        CHECK(blocked > kWidth << (kWidth - 4)); // of half the lanes, an eighth and more
    }
}

TEST_CASE("a masked lane's end stays as it was")
{
    for (const InstructionSet set : setsHere()) {
        CAPTURE(nameOf(set));
        const Limit limit(set);
        const World world(std::mt19937(23));
        const Asked asked(world, std::mt19937(24));
        for (std::uint32_t pattern = 0; pattern < 1u << kWidth; pattern += 13) {
            const RayPacket before = packetOf(asked, pattern % 64, pattern);
            RayPacket after = before;
            world.scene.occluded({&after, 1}, 1u);
            for (std::uint32_t lane = 0; lane < kWidth; ++lane)
                if (before.there[lane] == 0)
                    REQUIRE(std::memcmp(&before.tfar[lane], &after.tfar[lane], sizeof(float)) == 0);
        }
    }
}

TEST_CASE("every instruction set gives the same answers, those of double precision")
{
    std::vector<std::vector<std::uint8_t>> answers;
    std::vector<ShadowRay> rays;
    std::vector<Caster> casters;
    for (const InstructionSet set : setsHere()) {
        const Limit limit(set);
        const World world(std::mt19937(25));
        std::mt19937 random(26);
        rays = randomRays(random, 20000, 6.0f);
        answers.push_back(test::trace(world.scene, rays));
        casters = world.casters;
        if (answers.size() > 1) continue;
        const brute::Scene truth(brute::trianglesOf(casters, ~0u));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < rays.size(); i += 10)
            wrong += (answers[0][i] != 0) != truth.blocked(glm::dvec3(rays[i].origin), glm::dvec3(rays[i].direction),
                                                           static_cast<double>(rays[i].tfar));
        CHECK(wrong == 0);
    }
    for (const auto& others : answers) {
        std::size_t apart = 0;
        for (std::size_t i = 0; i < rays.size(); ++i)
            apart += others[i] != answers[0][i];
        CHECK(apart == 0);
    }
}
