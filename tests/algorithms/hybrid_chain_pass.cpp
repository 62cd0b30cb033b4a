// The host pass of contour_chain: which pixels it tells otherwise than the map. What it says of a pixel is what the
// stages say of it alone.
#include <doctest/doctest.h>

#include <algorithm>

#include "algorithms/chain_pass_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Runs the pass and checks what every pixel shows. @return how many show something else than the map said.
std::size_t check(const Asking& asking)
{
    const std::vector<Expected> expected = expect(asking);
    const std::vector<bool> inside = contourOf(asking, expected);
    const Outcome outcome = run(asking, expected);
    const std::uint32_t width = asking.area.extent.width;
    std::size_t told = 0, wrong = 0;
    std::uint64_t rays = 0;
    for (std::uint32_t i = 0; i < outcome.rows.size(); ++i) {
        const std::size_t at = asking.pixel(i % width, i / width);
        const Expected& pixel = expected[at];
        const bool lit = isLit(pixel.reason);
        std::uint32_t wanted = outcome.status[i];
        if (wanted == gpu::MAP_UNSURE || inside[at]) {
            rays += pixel.traced && !tellsAll(asking.tells);
            if (asking.tells != ChainDebugOutput::visibility)
                wanted = pixel.told(asking.tells), ++told;
            else if (lit != pixel.lit)
                wanted = lit ? 255 : 0, ++told;
            else if (wanted == gpu::MAP_UNSURE)
                wanted = 255;
        }
        wrong += outcome.rows[i] != wanted;
    }
    CHECK(wrong == 0);
    CHECK(outcome.rays == rays);
    return told;
}

} // namespace

TEST_CASE("what changes are the pixels of which the map says otherwise")
{
    for (const bool cube : {false, true}) {
        for (const ChainMode mode : {ChainMode::chain, ChainMode::tcLit, ChainMode::strict, ChainMode::noRay}) {
            CAPTURE(cube);
            CAPTURE(static_cast<int>(mode));
            CHECK(check({.lamp = lamp(cube), .stages = stagesOf(mode)}) > 20);
            // Where the map's word is turned round even pixels that ask nobody change.
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
            const std::size_t asked =
                check({.lamp = lamp(cube), .contour = contour, .tells = ChainDebugOutput::reason});
            CHECK(asked > before);
            before = asked;
        }
        CHECK(before == kPixels);
    }
}

TEST_CASE("what the map is unsure of is asked beside the contour, too, and shown lit or dark")
{
    for (const bool cube : {false, true}) {
        CAPTURE(cube);
        const std::size_t before = check({.lamp = lamp(cube), .contour = 2, .tells = ChainDebugOutput::reason});
        const std::size_t with =
            check({.lamp = lamp(cube), .contour = 2, .tells = ChainDebugOutput::reason, .unsure = 5});
        CHECK(with > before + kPixels / 20);
        check({.lamp = lamp(cube), .stages = stagesOf(ChainMode::strict), .contour = 2, .unsure = 1});
        check({.lamp = lamp(cube), .contour = 2, .area = {{37, 50}, {71, 53}}, .unsure = 2});
    }
}

TEST_CASE("what is settled before is not asked again, and told as if it were")
{
    for (const ChainMode mode : {ChainMode::chain, ChainMode::tcOnly})
        for (const bool cube : {false, true})
            for (const std::uint32_t contour : {0u, 4u})
                for (const ChainDebugOutput tells : {ChainDebugOutput::visibility, ChainDebugOutput::reason}) {
                    CAPTURE(static_cast<int>(mode));
                    CAPTURE(cube);
                    CAPTURE(contour);
                    Asking asking{.lamp = lamp(cube),
                                  .stages = stagesOf(mode),
                                  .contour = contour,
                                  .tells = tells,
                                  .settled = true};
                    CHECK(check(asking) > 20);
                    const std::vector<Expected> expected = expect(asking);
                    const Outcome without = run(asking, expected);
                    asking.settled = false;
                    const Outcome with = run(asking, expected);
                    CHECK(without.rays == with.rays);
                    CHECK(without.rays > 20);
                    asking.settled = true;
                    asking.area = {{37, 50}, {71, 53}};
                    check(asking);
                }
}

TEST_CASE("where the host's own casters are nearest the map's word stands, since no ray sees them")
{
    for (const bool cube : {false, true})
        for (const bool settled : {false, true}) {
            CAPTURE(cube);
            CAPTURE(settled);
            Asking asking{.lamp = lamp(cube),
                          .stages = stagesOf(ChainMode::tcOnly),
                          .tells = ChainDebugOutput::reason,
                          .settled = settled};
            check(asking);
            const std::uint64_t before = run(asking, expect(asking)).rays;
            asking.foreign = true;
            check(asking);
            const Outcome outcome = run(asking, expect(asking));
            CHECK(outcome.rays < before);
            CHECK(std::ranges::count(outcome.rows, std::uint8_t{gpu::REASON_MAP_SHADOW}) > 20);
        }
}

TEST_CASE("candidates are counted whether they block or not, and no ray is traced")
{
    for (const ChainDebugOutput tells : {ChainDebugOutput::texelCandidates, ChainDebugOutput::ringCandidates})
        for (const bool cube : {false, true})
            CHECK(check({.lamp = lamp(cube), .tells = tells}) == kPixels);
}

TEST_CASE("with votes every pixel's byte is its votes, and no ray is traced")
{
    for (const bool cube : {false, true})
        for (const bool normals : {false, true})
            CHECK(check({.lamp = lamp(cube), .tells = ChainDebugOutput::votes, .normals = normals}) == kPixels);
}

TEST_CASE("an area is a part of the image, and a contour ends at its sides")
{
    const VkRect2D area{{37, 50}, {71, 53}}; // no side a multiple of a band or of a word
    CHECK(check({.lamp = lamp(false), .area = area}) > 20);
    CHECK(check({.lamp = lamp(true), .contour = 4, .tells = ChainDebugOutput::reason, .area = area}) > 100);
    CHECK(check({.lamp = lamp(false), .tells = ChainDebugOutput::votes, .area = area}) == 71 * 53);
    CHECK(check({.lamp = lamp(false), .area = {{5, 100}, {1, 1}}, .flipped = 1}) == 1);
}

TEST_CASE("the picture is the same for any number of threads")
{
    Asking asking{.lamp = lamp(false), .tells = ChainDebugOutput::reason, .threads = 1};
    const std::vector<Expected> expected = expect(asking);
    const std::vector<std::uint8_t> alone = run(asking, expected).rows;
    asking.threads = 4;
    CHECK(run(asking, expected).rows == alone);
}
