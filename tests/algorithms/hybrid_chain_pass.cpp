// The host pass of contour_chain: which pixels it marks, and how the list of marks is laid out. What it says of a pixel
// is what the stages say of it alone.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "algorithms/chain_pass_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Runs the pass and checks all of its marks. @return how many there are.
std::size_t check(const Asking& asking)
{
    const std::vector<Expected> expected = expect(asking);
    const std::vector<bool> inside = contourOf(asking, expected);
    const Outcome outcome = run(asking, expected);
    std::vector<std::vector<std::uint32_t>> wanted(outcome.ranges.size());
    std::uint64_t rays = 0;
    for (std::uint32_t i = 0; i < kPixels; ++i) {
        if (!inside[i]) continue;
        const Expected& pixel = expected[i];
        const bool lit = isLit(pixel.reason), said = asking.tells != ChainTells::visibility || lit != pixel.lit;
        rays += pixel.traced && !tellsAll(asking.tells);
        if (said)
            wanted[asking.tells == ChainTells::visibility ? lit : pixel.told(asking.tells)].push_back(
                gpu::packPixel(i % kWidth, i / kWidth));
    }
    CHECK(outcome.rays == rays);
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        CAPTURE(i);
        const MarkRange& range = outcome.ranges[i];
        CHECK(range.first == first);
        CHECK(range.value == static_cast<float>(i) / (asking.tells != ChainTells::visibility ? 255.0f : 1.0f));
        first += range.count;
        std::vector<std::uint32_t> got(outcome.marks.begin() + range.first,
                                       outcome.marks.begin() + range.first + range.count);
        std::sort(got.begin(), got.end());
        CHECK(got == wanted[i]);
    }
    return outcome.marks.size();
}

} // namespace

TEST_CASE("the pixels marked are those of which the map says otherwise, as dark or as lit")
{
    for (const bool cube : {false, true}) {
        for (const ChainMode mode : {ChainMode::chain, ChainMode::tcLit, ChainMode::strict, ChainMode::noRay}) {
            CAPTURE(cube);
            CAPTURE(static_cast<int>(mode));
            CHECK(check({.lamp = lamp(cube), .stages = stagesOf(mode)}) > 20);
            // Where the map's word is turned round even pixels that ask nobody are marked.
            CHECK(check({.lamp = lamp(cube), .stages = stagesOf(mode), .flipped = 7}) > kPixels / 8);
        }
        CHECK(check({.lamp = lamp(cube), .normals = false}) > 20);
    }
}

TEST_CASE("a contour of some pixels is all that is asked")
{
    for (const bool cube : {false, true}) {
        std::size_t before = 0;
        for (const std::uint32_t contour : {2u, 4u, 6u, 0u}) { // 0: everywhere
            CAPTURE(contour);
            check({.lamp = lamp(cube), .contour = contour});
            const std::size_t asked = check({.lamp = lamp(cube), .contour = contour, .tells = ChainTells::reason});
            CHECK(asked > before);
            before = asked;
        }
        CHECK(before == kPixels);
    }
}

TEST_CASE("candidates are counted whether they block or not, and no ray is traced")
{
    for (const ChainTells tells : {ChainTells::texelCandidates, ChainTells::ringCandidates})
        for (const bool cube : {false, true})
            CHECK(check({.lamp = lamp(cube), .tells = tells}) == kPixels);
}

TEST_CASE("with votes every pixel's byte is its votes, and no ray is traced")
{
    for (const bool cube : {false, true})
        for (const bool normals : {false, true})
            CHECK(check({.lamp = lamp(cube), .tells = ChainTells::votes, .normals = normals}) == kPixels);
}

TEST_CASE("marks of an area are in coordinates of the image, and a contour ends at its sides")
{
    const VkRect2D area{{37, 50}, {71, 53}}; // no side a multiple of a band or of a word
    CHECK(check({.lamp = lamp(false), .area = area}) > 20);
    CHECK(check({.lamp = lamp(true), .contour = 4, .tells = ChainTells::reason, .area = area}) > 100);
    CHECK(check({.lamp = lamp(false), .tells = ChainTells::votes, .area = area}) == 71 * 53);
    CHECK(check({.lamp = lamp(false), .area = {{5, 100}, {1, 1}}, .flipped = 1}) == 1);
}

TEST_CASE("the list is the same for any number of threads")
{
    Asking asking{.lamp = lamp(false), .tells = ChainTells::reason, .threads = 1};
    const std::vector<Expected> expected = expect(asking);
    const std::vector<std::uint32_t> alone = run(asking, expected).marks;
    asking.threads = 4;
    CHECK(run(asking, expected).marks == alone);
    CHECK(alone.size() == kPixels);
}
