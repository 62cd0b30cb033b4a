// gnomon in a renderer that is not its own: the default choice must not lose against a pinned method, nor the first
// frames against later ones. The bounds are generous, for machines that do other things beside.
#include <doctest/doctest.h>

#include "contest.hpp"

using namespace stranger;

namespace {

/// Equal quality: a wrong share of at most the greater of the default's own and the shipped rules' near floor.
void checkEntry(bool recorded)
{
    const Device device;
    const Contest contest = holdContest(device, recorded);
    REQUIRE(contest.rivals.size() >= 3);
    CHECK(contest.defaultWrongPercent < 2.0); // a picture with shadows where they belong, before its price counts

    const Rival* pBest = contest.best();
    REQUIRE(pBest);
    CHECK(contest.defaultMs() <= 1.3 * summarise(pBest->turnsMs).median);
    CHECK(contest.firstFrameMs <= 3.0 * contest.defaultMs());
    CHECK(20 * contest.framesOver <= contest.framesBudgeted);
}
} // namespace

TEST_CASE("the meshes are open and non-manifold, and no larger than a small game's")
{
    size_t triangles = 0;
    for (const Mesh& mesh : makeMeshes()) {
        const EdgeCount edges = countEdges(mesh);
        CHECK(edges.boundary > 0);
        CHECK(edges.nonManifold > 0);
        triangles += mesh.indices.size() / 3;
    }
    CHECK(triangles >= 19000);
    CHECK(triangles <= 20000);
}

TEST_CASE("submitted: the default choice keeps up with the best pinned method, from the first frame, within a budget")
{
    checkEntry(false);
}

TEST_CASE("recorded: the default choice keeps up with the best pinned method, from the first frame, within a budget")
{
    checkEntry(true);
}
