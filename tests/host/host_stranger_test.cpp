// gnomon in a renderer that is not its own: the default choice must not lose against a pinned method, nor the first
// frames against later ones. The bounds are generous, for machines that do other things beside.
#include <doctest/doctest.h>

#include "comparison.hpp"

using namespace stranger;

namespace {

void checkEntry(bool recorded)
{
    const Device device;
    const Comparison comparison = compareEntry(device, recorded);
    REQUIRE(comparison.pinned.size() >= 3);
    // All lamps are near. The floor is about what is expected of a method; a scene may show twice that.
    CHECK(comparison.defaultWrongPercent <= 2.0 * kFloorWrongPercent);

    const PinnedMethod* pBest = comparison.best();
    REQUIRE(pBest);
    CHECK(comparison.timesMethod(*pBest) <= 1.3);
    CHECK(comparison.firstFrameMs <= 3.0 * comparison.steadyFrameMs);
    const BudgetRun &kept = comparison.kept, &tooTight = comparison.tooTight;
    CHECK(kept.framesOver <= kept.frames / 20 + 2 * kept.bestFramesOver);
    // What has not been measured must not look cheap to a plan in need.
    CHECK(tooTight.timesBest <= 1.3);
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
