// Every method on every depth format and projection, against ray_traced on the same.
#include <algorithm>
#include <cstdlib>

#include "device/target_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr demo::DepthConvention kConventions[] = {demo::DepthConvention::ReversedInfinite,
                                                  demo::DepthConvention::Standard};
constexpr double kMapSide = 1024.0; // bounds on wrong pixels are those of such maps

/// What ray_traced says through a lens, per light, and the pixels that are held against it: not the insides of solids
/// that an oblique near plane opens, which are lit by methods that draw the far sides of solids alone (frames.h).
struct Truth {
    Lens lens;
    std::vector<Image8> pictures;
    std::vector<bool> counts;
};

Truth truthOf(Host& host, const Lens& lens, double step)
{
    host.require(host.draw(through(lens)));
    Truth truth{lens, host.pictures(), std::vector<bool>(size_t{host.extent().width} * host.extent().height, true)};
    const brute::View view = bruteView(host, lens, step);
    if (view.projection[2] == 0.0f && view.projection[6] == 0.0f) return truth;
    const std::vector<brute::Triangle> triangles = bruteTriangles(host);
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            const brute::Surface surface = brute::surfaceAt(view, triangles, x, y);
            const glm::dvec3 place = brute::placeOf(view, x, y, surface.depth);
            truth.counts[size_t(y) * size_t(view.width) + size_t(x)] =
                glm::dot(surface.normal, place - view.eye) <= 0.0;
        }
    return truth;
}

/// Pixels that differ by more than a quarter of the light, and of those the ones that lie on no edge of the truth.
struct Wrong {
    size_t pixels = 0, clear = 0, lights = 0;

    void add(const Image8& picture, const Image8& truth, const std::vector<bool>& counts)
    {
        ++lights;
        for (uint32_t y = 0; y < truth.height; ++y)
            for (uint32_t x = 0; x < truth.width; ++x) {
                const int right = *truth.at(x, y);
                if (!counts[size_t{y} * truth.width + x] || std::abs(*picture.at(x, y) - right) <= 64) continue;
                ++pixels;
                bool edge = false;
                for (uint32_t by = std::max(y, 1u) - 1; by <= std::min(y + 1, truth.height - 1); ++by)
                    for (uint32_t bx = std::max(x, 1u) - 1; bx <= std::min(x + 1, truth.width - 1); ++bx)
                        edge = edge || *truth.at(bx, by) != right;
                clear += !edge;
            }
    }
    double pixelsEach() const { return lights ? double(pixels) / double(lights) : 0.0; }
    double clearEach() const { return lights ? double(clear) / double(lights) : 0.0; }
};

/// Of the lights that the method serves. What does not serve a light must say why.
Wrong wrongPixels(Host& host, const GnMethodInfo& method, const Truth& truth)
{
    Wrong wrong;
    host.require(host.draw(through(truth.lens)));
    const std::vector<Image8> pictures = host.pictures();
    for (size_t light = 0; light < pictures.size(); ++light) {
        if (!serves(method, host.scene.lights[light].kind)) continue;
        if (std::string(host.decision(light).pMethod) == method.pName) {
            wrong.add(pictures[light], truth.pictures[light], truth.counts);
            continue;
        }
        const std::string why = host.explanation(light);
        INFO(why);
        CHECK(why.find(method.pName) != std::string::npos);
    }
    return wrong;
}

/// By its traits: of exact methods the pixels, of others how they do through the plain lens. Of 16 bits a unit is a
/// third of a pixel's width, and edges move by so much: what counts is clear of them. An average over seven texels is
/// wrong along all edges, whatever the lens.
void checkMethod(Host& host, const GnMethodInfo& method, const std::vector<Truth>& truths, double step)
{
    const bool exact = (method.traits & GN_TRAIT_EXACT_BIT) != 0;
    const Wrong plain = wrongPixels(host, method, truths[0]);
    for (const Truth& truth : truths) {
        const Wrong wrong = wrongPixels(host, method, truth);
        INFO(std::string(method.pName) << ", " << std::string(truth.lens.name) << ": " << wrong.lights << " lights, "
                                       << wrong.pixelsEach() << " wrong pixels each, " << wrong.clearEach()
                                       << " clear of edges; through the plain lens " << plain.pixelsEach());
        CHECK(wrong.clearEach() <= (exact ? 2.0 : 12.0));
        const double least = step > 1e-6 ? 80.0 : exact ? 6.0 : 0.0;
        CHECK(wrong.pixelsEach() <= (exact ? least : std::max(least, 1.5 * plain.pixelsEach() + 20.0)));
    }
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "the rules choose for orthographic cameras, and what they choose shows the truth")
{
    const Lens lens = lensesFor(demo::DepthConvention::ReversedInfinite)[4];
    Host host(targetScene(demo::DepthConvention::ReversedInfinite), {.mapSide = kMapSide});
    host.pinAll("ray_traced");
    const Truth truth = truthOf(host, lens, 0.0);
    REQUIRE(gnLoadShippedRules(host.context, "default") == GN_SUCCESS);
    for (size_t i = 0; i < host.lights.size(); ++i)
        host.pin(i, nullptr);
    host.draw(20, through(lens)); // the depth grid has been measured
    const std::vector<Image8> pictures = host.pictures();
    for (size_t light = 0; light < pictures.size(); ++light) {
        Wrong wrong;
        wrong.add(pictures[light], truth.pictures[light], truth.counts);
        GnFact facts[32];
        uint32_t count = 32;
        for (GnFact& fact : facts)
            fact = {};
        host.require(gnGetFacts(host.context, host.views[0], host.lights[light], &count, facts));
        double distance = 0.0;
        for (uint32_t i = 0; i < count; ++i)
            if (std::string_view(facts[i].pName) == "viewerDistance") distance = facts[i].value;
        // 11 m over 180 pixels, of which a usual camera has one of 1/640 at 1 m.
        CHECK(distance == doctest::Approx(11.0 / 180.0 * 640.0).epsilon(0.01));
        CHECK_MESSAGE(wrong.clearEach() <= 12.0, host.explanation(light));
    }
}

// Faces all round a lamp have no side to end at: far away, parallel rays must meet them as those of a perspective do.
// And all of them are wound away from the lamp, or all towards it: maps must not leave them all out.
TEST_CASE_FIXTURE(DeviceTest, "a lamp in a crate lights nothing outside, seen by parallel rays, however it is wound")
{
    for (const auto convention : kConventions)
        for (const bool turned : {false, true}) {
            CAPTURE(turned);
            Scene scene = targetScene(convention);
            scene.meshes.push_back(demo::makeBox({}));
            std::vector<uint32_t>& corners = scene.meshes.back().indices;
            if (turned) std::reverse(corners.begin(), corners.end());
            scene.lights = {scene.lights[1]};
            scene.instances.push_back({.name = "crate", .mesh = uint32_t(scene.meshes.size() - 1)});
            scene.instances.back().pose.position = scene.lights[0].position + glm::dvec3(0.1, 0.2, -0.15);
            Host host(scene, {.mapSide = kMapSide});
            host.pinAll("ray_traced");
            const Truth truth = truthOf(host, lensesFor(convention)[4], 0.0);
            CHECK(dark(truth.pictures[0]) > 1000);
            for (const GnMethodInfo& method : availableMethods(host.context)) {
                const bool planar = (method.traits & GN_TRAIT_PLANAR_BIT) != 0;
                if (planar || !(method.traits & GN_TRAIT_HARD_BIT) || !serves(method, scene.lights[0].kind)) continue;
                CAPTURE(std::string(method.pName));
                pinServed(host, method);
                CHECK(wrongPixels(host, method, truth).clear <= (method.traits & GN_TRAIT_EXACT_BIT ? 2 : 12));
            }
        }
}

TEST_CASE_FIXTURE(DeviceTest, "every method shows the truth with every depth format and projection, or says why not")
{
    size_t turn = 0; // every method with half of the formats and conventions
    for (const auto convention : kConventions)
        for (const VkFormat format : {VK_FORMAT_D32_SFLOAT, VK_FORMAT_D24_UNORM_S8_UINT, VK_FORMAT_D16_UNORM}) {
            CAPTURE(static_cast<int>(format));
            if (!drawable(format)) continue;
            Host host(targetScene(convention), {.target = {.depth = format}, .mapSide = kMapSide});
            std::vector<Lens> lenses = lensesFor(convention);
            if (format != VK_FORMAT_D32_SFLOAT) lenses.resize(1);
            std::vector<Truth> truths;
            host.pinAll("ray_traced");
            for (const Lens& lens : lenses)
                truths.push_back(truthOf(host, lens, stepOf(format)));
            const std::vector<GnMethodInfo> methods = availableMethods(host.context);
            for (size_t i = turn++ % 2; i < methods.size(); i += 2) {
                const GnMethodInfo& method = methods[i];
                if (!(method.traits & GN_TRAIT_HARD_BIT)) continue;
                if (method.traits & GN_TRAIT_PLANAR_BIT) continue; // right on one plane only
                CAPTURE(std::string(method.pName));
                pinServed(host, method);
                checkMethod(host, method, truths, stepOf(format));
            }
        }
}
