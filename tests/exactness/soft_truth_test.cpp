// The soft truth: ray_traced with many samples of a light with a radius, against a closed form, against the brute
// force, and against itself with other samples.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{96, 72};

/// Share of a disc that lies on the far side of a line; `distance` from its centre to the line, in radii, towards that
/// side.
double beyondChord(double distance)
{
    if (distance >= 1.0) return 0.0;
    if (distance <= -1.0) return 1.0;
    return (std::acos(distance) - distance * std::sqrt(1.0 - distance * distance)) / std::numbers::pi;
}

/// A disc: its axis and its radius.
struct Disc {
    glm::dvec3 axis;
    double radius = 0.0;
};

/// What a point under halfPlane() sees of the lamp. \param towards From it to the disc's centre; \param height Of the
/// sheet's edge over it; \param edge Its x, from the point.
double seenPastEdge(const glm::dvec3& towards, const Disc& disc, double height, double edge)
{
    // The plane through the point and the edge cuts the disc along a line; x grows where the lamp is seen.
    const glm::dvec3 normal = glm::normalize(glm::dvec3(height, -edge, 0.0));
    const double tilt = glm::length(normal - disc.axis * glm::dot(normal, disc.axis));
    return beyondChord(-glm::dot(normal, towards) / (disc.radius * tilt));
}

/// Share of the square [-1, 1]^2 in which a + b u + c v > 0, of which neither b nor c is 0: the integral of what is
/// above 0 of a line's ends, twice.
double squareBeyond(double a, double b, double c)
{
    const auto part = [](double x) { return x > 0.0 ? x * x : 0.0; };
    b = std::abs(b), c = std::abs(c);
    return (part(a + b + c) - part(a + b - c) - part(a - b + c) + part(a - b - c)) / (8.0 * b * c);
}

/// seenPastEdge() of a rectangle.
double seenPastEdge(const glm::dvec3& towards, const RectangleAxes& axes, double height, double edge)
{
    const glm::dvec3 normal(height, -edge, 0.0);
    return squareBeyond(glm::dot(normal, towards), glm::dot(normal, axes.x), glm::dot(normal, axes.y));
}

struct Spread {
    uint64_t pixels = 0, beyond = 0;
    double sum = 0.0, squares = 0.0;

    void add(double off, double limit)
    {
        ++pixels;
        sum += off;
        squares += off * off;
        beyond += std::abs(off) > limit;
    }
    double mean() const { return sum / double(pixels); }
    double rmse() const { return std::sqrt(squares / double(pixels)); }
};

/// Pixels of the floor whose closed form is neither 0 nor 1.
Spread againstClosedForm(const Stage& stage, const Image8& picture, double height, uint32_t samples)
{
    const brute::View view = bruteView(stage);
    const brute::Light light = bruteLight(stage, 0);
    const bool sun = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const demo::Light& lamp = stage.scene().lights[0];
    const double size = double(lamp.radius), radius = sun ? std::tan(size) : size; // its radius is an angle
    const brute::Scene casters(bruteTriangles(stage));
    Spread spread;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const auto px = static_cast<uint32_t>(x), py = static_cast<uint32_t>(y);
            const glm::dvec3 normal = drawnNormal(stage, px, py);
            const brute::Answer answer =
                brute::answerAt(view, light, casters, x, y, *stage.surfaces.depth.at(px, py), normal);
            if (answer.state != brute::State::asked || std::abs(answer.receiver.y) > 0.01) continue;
            const glm::dvec3 from = answer.receiver + normal * answer.offset;
            const glm::dvec3 towards = sun ? -glm::normalize(light.direction) : light.position - from;
            const Disc disc{glm::normalize(lamp.disc ? lamp.direction : towards), radius};
            const double seen = lamp.rectangle.x > 0.0f
                                    ? seenPastEdge(towards, rectangleAxes(lamp), height - from.y, -from.x)
                                    : seenPastEdge(towards, disc, height - from.y, -from.x);
            if (seen <= 0.0 || seen >= 1.0) continue;
            // Points in parts of the disc vary less than free ones do. A byte rounds by half a step.
            const double sigma = std::sqrt(seen * (1.0 - seen) / samples);
            spread.add(*picture.at(px, py) / 255.0 - seen, 3.0 * sigma + 0.51 / 255.0 + 1.0 / samples);
        }
    }
    return spread;
}

/// \param scene halfPlane() of that height
void checkClosedForm(const demo::Scene& scene, double height)
{
    Stage stage(scene, kSize);
    for (const uint32_t samples : {2u, 30u, 1024u}) {
        const Image8 picture = stage.draw("ray_traced", {{"samples", double(samples)}})[0];
        const Spread spread = againstClosedForm(stage, picture, height, samples);
        MESSAGE(std::string(demo::nameOf(scene.lights[0].kind))
                << ", " << samples << " samples: " << spread.pixels << " pixels, mean " << spread.mean() << ", RMSE "
                << spread.rmse());
        CHECK(spread.pixels > 350);
        CHECK(spread.beyond == 0);
        CHECK(std::abs(spread.mean()) < 0.6 / std::sqrt(double(samples * spread.pixels)) + 0.002); // of bytes
        if (samples == 1024) CHECK(spread.rmse() < 0.005);
    }
}

/// halfPlane() before a disc that looks by 43 degrees aside.
demo::Scene tiltedDisc(float radius, double height)
{
    demo::Scene scene = halfPlane(LightKind::Spot, height, radius);
    demo::Light& lamp = scene.lights[0];
    lamp.disc = true;
    lamp.direction = glm::normalize(glm::dvec3(0.9, -1.0, 0.3));
    lamp.outerAngle = 1.2f;
    return scene;
}

/// Of the pixels that are asked and lie in the penumbra of the first.
double rmseBetween(const std::vector<SoftTruth>& a, const std::vector<SoftTruth>& b)
{
    demo::SoftError error;
    for (size_t layer = 0; layer < a.size(); ++layer)
        for (size_t i = 0; i < a[layer].asked.size(); ++i)
            if (a[layer].asked[i]) error.add(b[layer].visibility[i], a[layer].visibility[i]);
    CHECK(error.penumbra.pixels > 100);
    return error.penumbra.rmse();
}

} // namespace

TEST_CASE("half planes before the light's disc are seen as the closed form has it, within 3 sigma")
{
    const test::DeviceTest silence;
    checkClosedForm(halfPlane(LightKind::Point, 1.0, 0.5f), 1.0);
    checkClosedForm(halfPlane(LightKind::Spot, 1.6, 0.3f), 1.6);
    checkClosedForm(halfPlane(LightKind::Directional, 1.0, 0.2f), 1.0);
}

TEST_CASE("and before a rectangle, of which the edge cuts all four sides")
{
    const test::DeviceTest silence;
    demo::Scene scene = halfPlane(LightKind::Spot, 1.6, 0.0f);
    setRectangle(scene.lights[0], {0.5f, 0.2f});
    checkClosedForm(scene, 1.6);
    scene = halfPlane(LightKind::Spot, 1.0, 0.0f);
    setRectangle(scene.lights[0], {0.15f, 0.6f});
    checkClosedForm(scene, 1.0);
}

TEST_CASE("and before a disc that looks aside, of which the floor sees an ellipse")
{
    const test::DeviceTest silence;
    checkClosedForm(tiltedDisc(0.6f, 1.6), 1.6);
}

TEST_CASE("two sets of 1024 samples differ by an RMSE below 0.01, and by 0.02 at most from 256 rays of the brute force")
{
    const test::DeviceTest silence;
    demo::Scene panel = softScene(Caster::torus, LightKind::Spot, 1.6, 0.0f);
    setRectangle(panel.lights[0], {0.5f, 0.15f});
    for (const demo::Scene& scene :
         {softScene(Caster::torus, LightKind::Point, 1.6, 0.3f), softScene(Caster::torus, LightKind::Spot, 1.6, 0.3f),
          softScene(Caster::torus, LightKind::Directional, 1.6, 0.1f), panel}) {
        const std::string name = scene.lights[0].rectangle.x > 0.0f ? "rectangle" : demo::nameOf(scene.lights[0].kind);
        CAPTURE(name);
        Stage stage(scene, kSize);
        const std::vector<SoftTruth> first = tracedSoftTruths(stage, 1024, 0), other = tracedSoftTruths(stage, 1024, 1);
        const double seeds = rmseBetween(first, other), brute = rmseBetween(softTruths(stage), first);
        MESSAGE(name << ": RMSE between seeds " << seeds << ", to the brute force " << brute);
        CHECK(seeds < 0.01);
        CHECK(seeds > 0.0); // they are two
        CHECK(brute < 0.02);
        CHECK(rmseBetween(first, tracedSoftTruths(stage, 16, 0)) > 2.0 * seeds);
    }
}

TEST_CASE("rays on the device ask the points that rays on the CPU ask")
{
    const test::DeviceTest silence;
    demo::Scene panel = softScene(Caster::torus, LightKind::Spot, 1.6, 0.0f);
    setRectangle(panel.lights[0], {0.5f, 0.15f});
    for (const demo::Scene& scene :
         {softScene(Caster::torus, LightKind::Point, 1.6, 0.3f),
          softScene(Caster::torus, LightKind::Directional, 1.6, 0.1f), panel, tiltedDisc(0.6f, 1.6)}) {
        Stage stage(scene, kSize);
        if (!test::tracesRays(stage.session().shadows.context())) return;
        for (const uint32_t samples : {2u, 30u, 1024u}) {
            const std::vector<SoftTruth> cpu = tracedSoftTruths(stage, samples, 7);
            const double same = rmseBetween(cpu, tracedSoftTruths(stage, samples, 7, "ray_query"));
            const double other = rmseBetween(cpu, tracedSoftTruths(stage, samples, 8, "ray_query"));
            MESSAGE(std::string(demo::nameOf(scene.lights[0].kind))
                    << ", " << samples << " samples: RMSE " << same << ", to other points " << other);
            CHECK(same < 0.01);
            CHECK(10.0 * same < other);
        }
    }
}

TEST_CASE("with one sample, or of a light without a radius, the picture is the hard one, bit for bit")
{
    const test::DeviceTest silence;
    Stage hard(softScene(Caster::torus, LightKind::Point, 1.6, 0.0f), kSize);
    Stage soft(softScene(Caster::torus, LightKind::Point, 1.6, 0.3f), kSize);
    CHECK(test::differences(soft.truth[0], hard.truth[0]) == 0);
    const Image8 sampled = hard.draw("ray_traced", {{"samples", 64.0}})[0];
    CHECK(test::differences(sampled, hard.truth[0]) == 0);
    const Image8 penumbra = soft.draw("ray_traced", {{"samples", 64.0}})[0];
    CHECK(test::differences(penumbra, hard.truth[0]) > 100);
    CHECK(test::differences(soft.draw("ray_traced", {{"samples", 64.0}})[0], penumbra) == 0); // from frame to frame
}

TEST_CASE("methods with penumbrae are nearer to the truth on soft_table than a hard shadow, by half at least")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("views/soft_table"), {160, 90});
    const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
    uint32_t methods = 0;
    for (const GnMethodInfo& method : stage.methods()) {
        if (!(method.traits & GN_TRAIT_SOFT_PENUMBRA_BIT)) continue;
        const Pictures pictures = stage.draw(method.pName);
        SoftError soft, hard; // of the lights that it serves
        for (size_t layer = 0; layer < pictures.size(); ++layer) {
            if (pictures[layer].width == 0) continue;
            soft += compareSoft(pictures[layer], truths[layer]);
            hard += compareSoft(stage.truth[layer], truths[layer]);
        }
        MESSAGE(std::string(method.pName)
                << ": RMSE " << soft.penumbra.rmse() << ", hard " << hard.penumbra.rmse() << "; " << inWords(soft));
        CHECK(hard.penumbra.pixels > 300);
        CHECK(2.0 * soft.penumbra.rmse() <= hard.penumbra.rmse());
        CHECK(200 * soft.wrong <= soft.outside.pixels); // moments_soft 0.43 %, all others under 0.1
        ++methods;
    }
    CHECK(methods >= 2);
}

// A pixel that is no number comes out as dark, so it would show where the truth is far from that.
TEST_CASE("lamps wider than their distance and a sun of 44 degrees are shown by all methods with penumbrae, or refused")
{
    const test::DeviceTest silence;
    struct Row {
        const char* name;
        LightKind kind;
        float radius;
    };
    for (const Row& row : {Row{"spot of 5 m", LightKind::Spot, 5.0f}, Row{"point light of 5 m", LightKind::Point, 5.0f},
                           Row{"sun of 44 degrees", LightKind::Directional, 0.768f}}) {
        Stage stage(softScene(Caster::box, row.kind, 1.2, row.radius), {64, 48});
        const std::vector<SoftTruth> truths = tracedSoftTruths(stage, 64);
        uint32_t methods = 0;
        for (const GnMethodInfo& method : stage.methods()) {
            if (!(method.traits & GN_TRAIT_SOFT_PENUMBRA_BIT) || !serves(method.traits, row.kind)) continue;
            const Image8 picture = stage.draw(method.pName)[0];
            if (picture.width == 0) continue;
            const SoftError error = compareSoft(picture, truths[0]);
            uint64_t light = 0, none = 0;
            for (size_t i = 0; i < picture.texels.size(); ++i) {
                if (!truths[0].asked[i] || truths[0].visibility[i] < 0.4) continue;
                ++light;
                none += picture.texels[i] == 0;
            }
            MESSAGE(std::string(row.name) << ", " << std::string(method.pName) << ": dark " << none << " of " << light
                                          << ", RMSE " << error.penumbra.rmse() << "; " << inWords(error));
            CHECK(light > 1000);
            CHECK(none * 50 <= light); // edt_soft 1.2 %, moments_soft 1.0 % (their pages), all others none
            ++methods;
        }
        CHECK(methods >= 8);
    }
}

} // namespace gnomon::exact
