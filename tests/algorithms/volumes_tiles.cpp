// What is said of whole tiles of receivers, against their receivers one by one; no device.
#include <doctest/doctest.h>

#include <limits>
#include <utility>
#include <vector>

#include "shaders/volumes/resolve.h"
#include "tests/algorithms/volume_meshes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr int kReceivers = 60;

struct Receiver {
    glm::vec3 at, normal;
};

glm::vec3 randomUnit(Random& random)
{
    return glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)) + glm::vec3(1e-3f));
}

/// Receivers about a place, of a size and with normals about a direction, none to all of them much apart.
struct RandomTile {
    std::vector<Receiver> receivers;
    gpu::ReceiverTile tile{};

    explicit RandomTile(Random& random)
    {
        const glm::vec3 place = random.inBox(glm::vec3(-10.0f), glm::vec3(10.0f)), direction = randomUnit(random);
        const float size = std::exp(random(-4.0f, 1.0f)), bend = random(0.0f, 1.0f) < 0.4f ? 0.0f : random(0.0f, 1.5f);
        tile.lower = glm::vec4(1e38f, 1e38f, 1e38f, 0.0f);
        tile.upper = glm::vec4(-1e38f);
        tile.normalLower = glm::vec4(1.0f);
        tile.normalUpper = glm::vec4(-1.0f);
        for (int i = 0; i < kReceivers; ++i) {
            const glm::vec3 at = place + size * random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f));
            const glm::vec3 normal = glm::normalize(direction + bend * random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
            receivers.push_back({at, normal});
            tile.lower = glm::min(tile.lower, glm::vec4(at, 0.0f));
            tile.upper = glm::max(tile.upper, glm::vec4(at, 0.0f));
            tile.normalLower = glm::min(tile.normalLower, glm::vec4(normal, 0.0f));
            tile.normalUpper = glm::max(tile.normalUpper, glm::vec4(normal, 0.0f));
        }
    }
};

gpu::VolumeResolve randomLight(Random& random)
{
    gpu::VolumeResolve resolve{};
    resolve.view.hasNormals = 1;
    const bool directional = random(0.0f, 1.0f) < 0.2f, spot = !directional && random(0.0f, 1.0f) < 0.6f;
    resolve.lightEs = directional ? glm::vec4(randomUnit(random), 0.0f)
                                  : glm::vec4(random.inBox(glm::vec3(-10.0f), glm::vec3(10.0f)), 1.0f);
    const float cosine = spot ? std::cos(random(0.1f, 2.5f)) : -2.0f;
    resolve.cone = glm::vec4(randomUnit(random), cosine * std::abs(cosine));
    const float range = directional ? std::numeric_limits<float>::infinity() : random(1.0f, 40.0f);
    resolve.rangeSquared = range * range;
    return resolve;
}

/// As resolve.frag asks.
bool reached(const gpu::VolumeResolve& resolve, const Receiver& receiver)
{
    const glm::vec3 toLight = glm::vec3(resolve.lightEs) - resolve.lightEs.w * receiver.at;
    return gpu::reaches(-toLight, resolve.cone, resolve.rangeSquared);
}
bool facing(const gpu::VolumeResolve& resolve, const Receiver& receiver)
{
    return glm::dot(receiver.normal, glm::vec3(resolve.lightEs) - resolve.lightEs.w * receiver.at) > 0.0f;
}

gpu::ViewConstants depthView(bool reversed)
{
    constexpr float nearPlane = 0.1f, farPlane = 200.0f;
    gpu::ViewConstants view{};
    // Reversed: w = near / depth. Standard: w = near far / (far - depth (far - near)).
    view.depthScale = reversed ? nearPlane : nearPlane * farPlane;
    view.depthMul = reversed ? 1.0f : nearPlane - farPlane;
    view.depthAdd = reversed ? 0.0f : farPlane;
    view.offsetFactor = reversed ? 1.0f : 3.0f;
    view.pixelSize = 0.002f;
    return view;
}

} // namespace

TEST_CASE("what is said of a tile is so for each of its receivers, and is said of most tiles that allow it")
{
    Random random(20261123);
    constexpr uint32_t kAll = gpu::TILE_REACHED | gpu::TILE_PARTLY | gpu::TILE_TURNED;
    int said[kAll + 1] = {}, alike[kAll + 1] = {};
    for (int i = 0; i < 40000; ++i) {
        const RandomTile tile(random);
        const gpu::VolumeResolve resolve = randomLight(random);
        int turned = 0, unreached = 0;
        for (const Receiver& receiver : tile.receivers) {
            unreached += !reached(resolve, receiver);
            turned += !facing(resolve, receiver);
        }
        const uint32_t answer = gpu::tileAnswer(tile.tile, resolve);
        REQUIRE(answer <= kAll);
        ++said[answer];
        if (answer == gpu::TILE_UNREACHED) {
            REQUIRE(unreached == kReceivers);
        } else {
            REQUIRE((answer & gpu::TILE_REACHED) != 0);
            if ((answer & gpu::TILE_PARTLY) == 0) REQUIRE(unreached == 0);
            if ((answer & gpu::TILE_TURNED) == 0) REQUIRE(turned == 0);
        }
        const uint32_t exact =
            gpu::TILE_REACHED | (unreached != 0 ? gpu::TILE_PARTLY : 0) | (turned != 0 ? gpu::TILE_TURNED : 0);
        ++alike[unreached == kReceivers ? gpu::TILE_UNREACHED : exact];
    }
    MESSAGE("unreached " << said[gpu::TILE_UNREACHED] << " of " << alike[gpu::TILE_UNREACHED] << ", counted "
                         << said[gpu::TILE_REACHED] << " of " << alike[gpu::TILE_REACHED]);
    for (const uint32_t answer : {gpu::TILE_UNREACHED, gpu::TILE_REACHED}) {
        CHECK(said[answer] > 1000);
        CHECK(10 * said[answer] >= 7 * alike[answer]);
    }
}

TEST_CASE("a tile without receivers is not reached, and one with a gap is reached in part")
{
    gpu::VolumeResolve resolve{};
    resolve.view.hasNormals = 1;
    resolve.lightEs = {0.0f, 5.0f, 0.0f, 1.0f};
    resolve.cone = {0.0f, -1.0f, 0.0f, -4.0f};
    resolve.rangeSquared = 100.0f;
    gpu::ReceiverTile tile{.lower = {-1.0f, 0.0f, -1.0f, 0.0f},
                           .upper = {1.0f, 0.0f, 1.0f, 0.0f},
                           .normalLower = {0.0f, 1.0f, 0.0f, 0.0f},
                           .normalUpper = {0.0f, 1.0f, 0.0f, 0.0f}};
    CHECK(gpu::tileAnswer(tile, resolve) == gpu::TILE_REACHED);
    tile.lower.w = 1.0f;
    CHECK(gpu::tileAnswer(tile, resolve) == (gpu::TILE_REACHED | gpu::TILE_PARTLY));
    tile.lower.w = 0.0f;
    tile.normalLower = tile.normalUpper = {0.0f, -1.0f, 0.0f, 0.0f};
    CHECK(gpu::tileAnswer(tile, resolve) == (gpu::TILE_REACHED | gpu::TILE_TURNED));
    resolve.view.hasNormals = 0;
    CHECK(gpu::tileAnswer(tile, resolve) == gpu::TILE_REACHED);
    tile.lower.x = 1e38f;
    tile.upper.x = -1e38f;
    CHECK(gpu::tileAnswer(tile, resolve) == gpu::TILE_UNREACHED);
}

namespace {

/// A pixel of a tile; `counted`: its stencil is not 0.
struct Pixel {
    bool reached, facing, counted;
};

bool agrees(const Pixel& pixel, uint32_t answer)
{
    if (answer == gpu::TILE_UNREACHED) return !pixel.reached;
    return (pixel.reached || (answer & gpu::TILE_PARTLY) != 0) && (pixel.facing || (answer & gpu::TILE_TURNED) != 0);
}

/// What resolve.frag writes where it shades.
float shaded(const Pixel& pixel, float counted, float turnedAway)
{
    return !pixel.reached ? 1.0f : pixel.facing ? counted : turnedAway;
}

} // namespace

TEST_CASE("the resolve's draws show every pixel that a tile's answer allows as what it is, and write it once at most")
{
    int written = 0, checked = 0;
    for (const auto& [shadow, turnedAway] : {std::pair{0.0f, 0.0f}, {0.3f, 0.0f}, {0.3f, 0.3f}}) {
        gpu::VolumeResolve resolve{};
        resolve.shadow = shadow;
        resolve.turnedAway = turnedAway;
        for (uint32_t bits = 0; bits < 64; ++bits) {
            const Pixel pixel{.reached = (bits & 8) != 0, .facing = (bits & 16) != 0, .counted = (bits & 32) != 0};
            const uint32_t answer = bits & 7;
            if ((answer != gpu::TILE_UNREACHED && (answer & gpu::TILE_REACHED) == 0) || !agrees(pixel, answer))
                continue;
            CAPTURE(bits);
            float visibility = 1.0f; // as cleared
            int writes = 0;
            for (uint32_t part = 0; part < gpu::RESOLVE_PARTS; ++part) {
                if (!gpu::partCovers(part, answer, resolve)) continue;
                if (pixel.counted == (part == gpu::RESOLVE_UNCOUNTED)) continue; // the stencil test
                const float counted = part == gpu::RESOLVE_UNCOUNTED ? 1.0f : shadow;
                visibility = part == gpu::RESOLVE_DARK ? shadow : shaded(pixel, counted, turnedAway);
                ++writes;
            }
            CHECK(writes <= 1);
            CHECK(visibility == shaded(pixel, pixel.counted ? shadow : 1.0f, turnedAway));
            written += writes;
            ++checked;
        }
    }
    CHECK(checked > 60);
    CHECK(written > 30);
}

TEST_CASE("a lifted receiver lies LIFT of the offset's footprint term above its surface, and nearer in its pixel")
{
    Random random(20261123);
    for (const bool reversed : {true, false}) {
        CAPTURE(reversed);
        const gpu::ViewConstants view = depthView(reversed);
        for (int i = 0; i < 2000; ++i) {
            const float depth = reversed ? std::exp(random(-6.0f, -0.1f)) : random(0.5f, 0.97f); // 0.1 to 40 m; 6 m
            const float cosine = random(0.0f, 1.0f), w = gpu::linearDepth(view, depth);
            const float lifted = gpu::liftedDepth(gpu::depthLift(view), depth, cosine);
            const float ulps = 2.0f * std::abs(view.depthMul / view.depthScale) * w * w * 6e-8f; // of rounding
            const float above = (w - gpu::linearDepth(view, lifted)) * std::max(cosine, gpu::LEAST_LIFT_COSINE);
            const float wanted = gpu::LIFT * view.offsetFactor * w * view.pixelSize / 256.0f;
            CAPTURE(depth);
            CAPTURE(cosine);
            CHECK(std::abs(above - wanted) <= 1e-3f * wanted + ulps + 2e-7f * w);
            CHECK(gpu::linearDepth(view, lifted) < w);
        }
    }
}
