// Every method is held against ray_traced; here ray_traced is held against a brute force in double precision that
// shares no code with it, over the depth and the normals that the host really drew.
#include "exactness/brute_stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

struct Tally {
    uint64_t facing = 0, dark = 0, ambiguous = 0, grazing = 0;
    uint64_t disagreeing = 0;      ///< Among those neither ambiguous nor grazing.
    uint64_t disagreeingAtAll = 0; ///< Of all light-facing ones.
    uint64_t notAsked = 0, notAskedWrong = 0;

    double percent(uint64_t count) const { return 100.0 * double(count) / double(facing); }
    void add(const brute::Answer& answer, bool tracedLit)
    {
        if (answer.state != brute::State::asked) {
            ++notAsked;
            notAskedWrong += answer.lit != tracedLit;
            return;
        }
        ++facing;
        dark += !answer.lit;
        grazing += answer.grazing;
        ambiguous += answer.ambiguous && !answer.grazing;
        disagreeingAtAll += answer.lit != tracedLit;
        disagreeing += answer.lit != tracedLit && !answer.ambiguous && !answer.grazing;
    }
};

Tally tallyOf(const Stage& stage, size_t layer, const brute::Light& light, const brute::Scene& casters)
{
    const brute::View view = bruteView(stage);
    Tally tally;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const auto px = static_cast<uint32_t>(x), py = static_cast<uint32_t>(y);
            const glm::dvec3 normal = drawnNormal(stage, px, py);
            const brute::Answer answer =
                brute::answerAt(view, light, casters, x, y, *stage.surfaces.depth.at(px, py), normal);
            tally.add(answer, *stage.truth[layer].at(px, py) >= 128);
        }
    }
    return tally;
}

void checkAgainstBruteForce(demo::DepthConvention convention, double ambiguousBound)
{
    const test::DeviceTest silence;
    const Stage stage(testbed(convention), {160, 120});
    const std::vector<brute::Triangle> triangles = bruteTriangles(stage);
    CHECK(triangles.size() > 500);
    CHECK(triangles.size() < 2000);
    const brute::Scene casters(triangles);
    REQUIRE(stage.present.size() == 3);
    for (size_t layer = 0; layer < stage.present.size(); ++layer) {
        const Tally tally = tallyOf(stage, layer, bruteLight(stage, layer), casters);
        MESSAGE(std::string(nameOf(convention))
                << " depth, " << stage.scene().lights[stage.present[layer]].name << ": " << tally.facing
                << " pixels face the light, dark " << percentText(tally.percent(tally.dark)) << ", ambiguous "
                << percentText(tally.percent(tally.ambiguous)) << ", grazing "
                << percentText(tally.percent(tally.grazing)) << "; disagreeing " << tally.disagreeing
                << ", ambiguous and grazing ones included " << tally.disagreeingAtAll);
        // A light that nothing stands before, or that reaches nothing, would prove nothing.
        CHECK(tally.facing > 3000);
        CHECK(tally.percent(tally.dark) > 3.0);
        CHECK(tally.percent(tally.dark) < 60.0);
        CHECK(tally.disagreeing <= 2);
        CHECK(tally.percent(tally.ambiguous) < ambiguousBound);
        // Sky and what the light does not reach is lit, what faces away is dark: borders of range, cone and facing are
        // decided in float there, in double here.
        CHECK(tally.notAskedWrong <= 2);

        // The comparison is sharp enough to tell: a lamp 10 cm aside, or the sun a degree, is another answer.
        brute::Light moved = bruteLight(stage, layer);
        moved.position.x += 0.1;
        moved.direction.x += 0.0175 * glm::length(moved.direction);
        CHECK(tallyOf(stage, layer, moved, casters).disagreeing > 10);
    }
}

} // namespace

// Each pixel is asked again at four places 1/128 pixel aside, so of the pixels on a shadow edge one in 64 is ambiguous;
// with one pixel in twenty on an edge that is 0.08 %. The bound leaves twice that for what the offset adds.
TEST_CASE("ray_traced equals the brute force where its answer is firm, reversed-Z with the far plane at infinity")
{
    checkAgainstBruteForce(demo::DepthConvention::ReversedInfinite, 0.2);
}

TEST_CASE("ray_traced equals the brute force where its answer is firm, standard depth from 0.1 to 200 m")
{
    checkAgainstBruteForce(demo::DepthConvention::Standard, 0.2);
}

} // namespace gnomon::exact
