// Revectorized edges as the device computes them, against the same header compiled as C++.
#include <cmath>
#include <random>

#include "algorithms/revectorized_fixture.hpp"
#include "device/dispatch.hpp"
#include "shaders/lines_probe_comp.h"

namespace gnomon::test {
namespace {

struct Place {
    glm::vec2 at;
    uint32_t picture;
    float longest;
    glm::vec4 answers;
};
static_assert(sizeof(Place) == 32);

std::vector<uint32_t> bitsOf(const std::vector<gpu::Picture>& pictures)
{
    std::vector<uint32_t> words;
    for (const gpu::Picture& picture : pictures)
        for (size_t i = 0; i < picture.shadow.size(); ++i) {
            if (i % 32 == 0) words.push_back(0);
            words.back() |= uint32_t{picture.shadow[i]} << i % 32;
        }
    return words;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "the device makes of stairs the lines that the CPU makes, bit by bit where these have no ramp")
{
    std::vector<gpu::Picture> pictures;
    for (const Shape& shape : halfPlanes())
        pictures.push_back(drawn(shape));
    for (const Shape& shape : discs(5.0, 10.0))
        pictures.push_back(drawn(shape));
    std::mt19937 random(12);
    gpu::Picture noise;
    for (bool& dark : noise.shadow)
        dark = random() % 3 == 0;
    pictures.push_back(noise);
    // Macedo's stairs, 4 texels long, a notch, a tip and lone texels.
    pictures.push_back(drawn([](double x, double y) { return y < 6.0 + std::floor(x / 4.0); }));
    pictures.push_back(drawn([](double x, double y) { return y < 20.0 && !(x >= 10.0 && x < 14.0 && y >= 19.0); }));
    pictures.push_back(drawn([](double x, double y) { return y < 20.0 || (x >= 10.0 && x < 14.0 && y < 21.0); }));
    pictures.push_back(drawn([](double x, double y) { return x >= 10.0 && x < 11.0 && y >= 10.0 && y < 11.0; }));
    std::vector<Place> places;
    for (uint32_t picture = 0; picture < pictures.size(); ++picture)
        for (int i = 0; i < 4000; ++i) {
            // Sixteenths of texels, on borders of texels too, and numbers of no pattern.
            glm::vec2 at(float(random() % 1024u) / 16.0f, float(random() % 1024u) / 16.0f);
            if (i % 2 == 1) at = {float(between(random, 0.0, 64.0)), float(between(random, 0.0, 64.0))};
            places.push_back({at, picture, i % 4 < 2 ? 16.0f : 9.0f, {}});
        }
    const demo::Buffer shadow = bufferOf(bitsOf(pictures)), asked = bufferOf(places);
    run({{.code = k_lines_probe_comp,
          .buffers = {{1, &shadow}, {2, &asked}},
          .x = static_cast<uint32_t>(places.size() / 64 + 1)}});
    const std::span<Place> found = asked.as<Place>();
    uint64_t edges = 0, apart[2] = {};
    float farthest = 0.0f;
    for (size_t i = 0; i < places.size(); ++i) {
        const gpu::Picture& picture = pictures[places[i].picture];
        float expected[3];
        for (const uint32_t mode : {0u, 1u, 2u})
            expected[mode] = revectorized(picture, places[i].at, mode, uint32_t(places[i].longest));
        for (const int mode : {0, 1})
            apart[mode] += found[i].answers[mode] != expected[mode];
        farthest = std::fmax(farthest, std::abs(found[i].answers[2] - expected[2]));
        edges += expected[1] != nearest(picture, places[i].at);
    }
    MESSAGE("of " << places.size() << " places, " << edges << " changed by lines, " << apart[0] << " and " << apart[1]
                  << " differ; ramps by " << farthest << " at most");
    CHECK(edges > 1000);
    CHECK(apart[0] == 0);
    CHECK(apart[1] == 0);
    CHECK(farthest <= 1e-4f);
}

} // namespace gnomon::test
