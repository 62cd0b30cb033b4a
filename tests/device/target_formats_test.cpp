// Depth formats, projections, samples, layers and encodings of normals that engines have: ray_traced against the brute
// force, and every method against ray_traced.
#include <cmath>

#include "device/target_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr demo::DepthConvention kConventions[] = {demo::DepthConvention::ReversedInfinite,
                                                  demo::DepthConvention::Standard};
constexpr VkFormat kFormats[] = {VK_FORMAT_D32_SFLOAT,        VK_FORMAT_D32_SFLOAT_S8_UINT,
                                 VK_FORMAT_D24_UNORM_S8_UINT, VK_FORMAT_X8_D24_UNORM_PACK32,
                                 VK_FORMAT_D16_UNORM,         VK_FORMAT_D16_UNORM_S8_UINT};

// --- the truth ---

struct Tally {
    size_t asked = 0, dark = 0, disagreeing = 0, sky = 0;
};

/// One light's picture against the brute force, where that is firm.
Tally tallyOf(const brute::View& view, const brute::Light& light, const brute::Scene& casters,
              const std::vector<brute::Surface>& seen, const Image8& picture)
{
    const bool perspective = view.projection[15] == 0.0f;
    Tally tally;
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            const brute::Surface& surface = seen[size_t(y) * size_t(view.width) + size_t(x)];
            const bool lit = *picture.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)) >= 128;
            brute::Answer answer = brute::answerAt(view, light, casters, x, y, surface.depth, surface.normal);
            // The host's normals are turned to the eye, also where a near plane has opened a solid.
            if (perspective && glm::dot(surface.normal, answer.receiver - view.eye) > 0.0)
                answer = brute::answerAt(view, light, casters, x, y, surface.depth, -surface.normal);
            tally.sky += answer.state == brute::State::sky;
            if (answer.state != brute::State::asked || answer.grazing || answer.ambiguous) continue;
            ++tally.asked;
            tally.dark += !answer.lit;
            tally.disagreeing += answer.lit != lit;
        }
    return tally;
}

/// What each pixel shows, rounded as the format rounds.
std::vector<brute::Surface> surfacesOf(const brute::View& view, const std::vector<brute::Triangle>& triangles)
{
    std::vector<brute::Surface> seen;
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            brute::Surface surface = brute::surfaceAt(view, triangles, x, y);
            if (view.step > 0.0)
                surface.depth =
                    static_cast<float>(std::round(static_cast<double>(surface.depth) / view.step) * view.step);
            seen.push_back(surface);
        }
    return seen;
}

void checkTruth(Host& host, const Lens& lens, double step)
{
    CAPTURE(std::string(lens.name));
    host.pinAll("ray_traced");
    host.require(host.draw(through(lens)));
    const std::vector<Image8> pictures = host.pictures();
    const brute::View view = bruteView(host, lens, step);
    const std::vector<brute::Triangle> triangles = bruteTriangles(host);
    const brute::Scene casters(triangles);
    const std::vector<brute::Surface> seen = surfacesOf(view, triangles);
    for (size_t light = 0; light < pictures.size(); ++light) {
        CAPTURE(light);
        brute::Light lamp = bruteLight(host, light);
        const Tally tally = tallyOf(view, lamp, casters, seen, pictures[light]);
        MESSAGE(std::string(lens.name) << ", " << host.scene.lights[light].name << ": " << tally.asked << " asked, "
                                       << tally.dark << " dark, " << tally.disagreeing << " disagreeing");
        CHECK(tally.asked > 4000);
        CHECK(tally.dark > 40);
        // Of 16 bits a back side that was drawn first stays where it is less than a unit behind the front.
        CHECK(tally.disagreeing <= (step > 1e-6 ? 6 : 2));
        // Another lamp has another answer.
        lamp.position.x += 0.4;
        lamp.direction.x += 0.06;
        CHECK(tallyOf(view, lamp, casters, seen, pictures[light]).disagreeing > 10);
    }
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "ray_traced equals the brute force with every depth format and projection")
{
    for (const auto convention : kConventions)
        for (const VkFormat format : kFormats) {
            CAPTURE(static_cast<int>(format));
            if (!drawable(format)) {
                MESSAGE("format " << static_cast<int>(format) << " is not drawable here");
                continue;
            }
            Host host(targetScene(convention), {.extent = {160, 90}, .target = {.depth = format}});
            for (const Lens& lens : lensesFor(convention))
                checkTruth(host, lens, stepOf(format));
        }
}
