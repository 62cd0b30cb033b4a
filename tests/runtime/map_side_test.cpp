// Sides of shadow maps: by screen coverage, from frame to frame, and within a memory for all maps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/scene/light_pixels.hpp"
#include "runtime/select/map_side.hpp"
#include "runtime/select/methods.hpp"
#include "tests/runtime/light_fixture.hpp"

using namespace gnomon;

namespace {

/// Of a lamp with six faces that reaches the whole of a picture of 1280x720, 8 m away from receivers at 4 m.
MapCoverage lampNearby()
{
    return {.texelAtOne = 2.0, .nearness = 8.0 / 4.0, .pixelAngle = 0.0016, .pixels = 1280.0 * 720.0, .maps = 6.0};
}

void follow(MapSide& side, double wish, std::uint32_t frames)
{
    for (std::uint32_t frame = 0; frame < frames; ++frame)
        side.follow(wish, false);
}

MapSide sideOf(double wish)
{
    MapSide side;
    side.follow(wish, true);
    side.take();
    return side;
}

} // namespace

TEST_CASE("a texel is a pixel wide at the nearest receiver, unless more texels would be drawn than pixels can show")
{
    // Few pixels in the way, as seen from far: a texel at 8 m is 2 * 8 / side wide, a pixel at 400 m 400 * 0.0016.
    MapCoverage far = lampNearby();
    far.nearness = 8.0 / 400.0;
    CHECK(2.0 * 8.0 / sideFor(far) == doctest::Approx(400.0 * 0.0016));
    // Near by, as many texels in all faces as there are pixels, times four.
    const double side = sideFor(lampNearby());
    CHECK(6.0 * side * side == doctest::Approx(4.0 * 1280.0 * 720.0));
    CHECK(side < 2.0 * 2.0 / 0.0016);
    // The fixed sides of before are what a light gets that reaches all of such a picture.
    CHECK(sideOf(side).wanted() == 1024);
    // Nobody sees it.
    MapCoverage unseen = lampNearby();
    unseen.nearness = 0.0;
    CHECK(sideFor(unseen) == 0.0);
}

TEST_CASE("a side is always one of the ladder's, and its wish within a factor of it")
{
    for (double wish = 1.0; wish < 20000.0; wish *= 1.03) {
        const std::uint32_t side = sideOf(wish).side();
        CAPTURE(wish);
        REQUIRE(std::count(kMapSides.begin(), kMapSides.end(), side) == 1);
        CHECK(kMapSides[rungOf(side)] == side);
        if (side < kMapSides.back()) CHECK(wish <= MapSide::kGrow * side);
        if (side > kMapSides.front()) CHECK(wish > MapSide::kShrink * side);
    }
}

TEST_CASE("a side grows at once, and shrinks once the wish has been small for half a second")
{
    MapSide side = sideOf(512.0);
    side.follow(1.39 * 512.0, false);
    CHECK(side.wanted() == 512);
    side.follow(1.41 * 512.0, false);
    CHECK(side.wanted() == 1024);
    follow(side, 0.61 * 1024.0, 10 * MapSide::kShrinkFrames);
    CHECK(side.wanted() == 1024);
    follow(side, 0.59 * 1024.0, MapSide::kShrinkFrames - 1);
    CHECK(side.wanted() == 1024);
    follow(side, 0.61 * 1024.0, 1); // begins to count again
    follow(side, 0.59 * 1024.0, MapSide::kShrinkFrames - 1);
    CHECK(side.wanted() == 1024);
    follow(side, 0.59 * 1024.0, 1);
    CHECK(side.wanted() == 512);
    follow(side, 0.0, 10 * MapSide::kShrinkFrames); // no receiver is visible: nothing is known
    CHECK(side.wanted() == 512);
    side.follow(100.0, true); // a cut
    CHECK(side.wanted() == 128);
}

TEST_CASE("a wish that swings about the border of two sides changes the side once at most")
{
    std::mt19937 random(3);
    for (const double border : {0.6 * 512.0, 512.0, 1.4 * 512.0}) {
        MapSide side = sideOf(border);
        std::uint32_t changes = 0;
        for (int frame = 0; frame < 2000; ++frame) {
            const std::uint32_t before = side.wanted();
            side.follow(border * (0.9 + 0.2 * static_cast<double>(random()) / 0x1p32), false);
            changes += side.wanted() != before;
        }
        CAPTURE(border);
        CHECK(changes <= 1);
    }
}

TEST_CASE(
    "of kept maps one a frame is drawn for another side, the farthest off first; what is drawn anyway changes at once")
{
    std::vector<MapSide> sides(4, sideOf(1024.0));
    const double wishes[] = {512.0, 4096.0, 2048.0, 128.0};
    std::vector<SideRequest> requests;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        sides[i].follow(wishes[i], true);
        requests.push_back({.side = &sides[i], .redraws = i != 0});
    }
    const auto taken = [&] {
        return std::count_if(sides.begin(), sides.end(), [](const MapSide& s) { return s.side() == s.wanted(); });
    };
    takeSides(requests);
    CHECK(sides[0].side() == 512); // draws in every frame
    CHECK(sides[3].side() == 128); // three steps
    CHECK(taken() == 2);
    takeSides(requests);
    CHECK(sides[1].side() == 4096); // two
    CHECK(taken() == 3);
    takeSides(requests);
    CHECK(taken() == 4);
}

TEST_CASE("maps that do not fit get smaller where the least is seen a byte, none is left out, and they come back")
{
    std::vector<MapSide> sides(3, sideOf(1024.0));
    std::vector<SideRequest> requests;
    for (MapSide& side : sides)
        requests.push_back({.side = &side, .redraws = true, .bytesPerTexel = 8.0, .worth = 1000.0});
    requests[1].worth = 10.0;        // far, small or unimportant
    requests[2].bytesPerTexel = 0.0; // has no map
    const auto bytes = [&] {
        double sum = 0.0;
        for (const SideRequest& request : requests)
            sum += request.bytes(request.side->side());
        return sum;
    };
    const double all = requests[0].bytes(1024) + requests[1].bytes(1024);

    fitSides(requests, all, 0);
    takeSides(requests);
    CHECK(bytes() == all);

    fitSides(requests, 0.7 * all, 0);
    takeSides(requests);
    CHECK(bytes() <= 0.7 * all);
    CHECK(sides[0].side() == 1024);
    CHECK(sides[1].side() < 1024);
    CHECK(sides[1].wanted() == 1024); // what it could show is still known
    CHECK(sides[2].side() == 1024);

    fitSides(requests, 0.0, 0); // nothing goes below the least side: a method may be refused for memory then
    takeSides(requests);
    CHECK(sides[0].side() == 128);
    CHECK(sides[1].side() == 128);

    for (int frame = 0; frame < 12; ++frame) {
        fitSides(requests, 1.2 * all, 0);
        takeSides(requests);
    }
    CHECK(bytes() == all);
}

TEST_CASE("a light without maps keeps no limit of earlier ones, but has the room that there is")
{
    MapSide drawn = sideOf(2048.0), other = sideOf(2048.0);
    std::vector<SideRequest> requests{{.side = &drawn, .bytesPerTexel = 48.0, .worth = 1e6},
                                      {.side = &other, .bytesPerTexel = 48.0, .worth = 1.0}};
    const double one = requests[0].bytes(2048);
    fitSides(requests, one + requests[1].bytes(128), 0);
    CHECK(drawn.affordable() == 2048);
    CHECK(other.affordable() == 128);
    requests[1].drawn = false; // a volume serves
    fitSides(requests, 2.3 * one, 0);
    CHECK(other.affordable() == 2048);
    fitSides(requests, 1.5 * one, 0);
    CHECK(other.affordable() == 1024); // 0.35 of `one` is left
    fitSides(requests, one, 0);
    CHECK(drawn.affordable() == 2048);
    CHECK(other.affordable() == 128);
}

TEST_CASE("lights without maps are offered room that they may all take, in turns")
{
    std::array<MapSide, 3> sides{sideOf(2048.0), sideOf(2048.0), sideOf(2048.0)};
    std::vector<SideRequest> requests;
    for (MapSide& side : sides)
        requests.push_back({.side = &side, .bytesPerTexel = 48.0, .drawn = false});
    const double one = requests[0].bytes(2048);
    for (std::uint64_t turn = 0; turn < 6; ++turn) {
        fitSides(requests, 1.2 * one, turn);
        double all = 0.0;
        for (std::size_t i = 0; i < sides.size(); ++i) {
            CHECK((sides[i].affordable() == 2048) == (i == turn % 3));
            all += requests[i].bytes(sides[i].affordable());
        }
        CHECK(all <= 1.2 * one);
    }
    requests[1].drawn = true; // has its turn no more
    sides[1].limit(2048);
    for (std::uint64_t turn = 0; turn < 6; ++turn) {
        fitSides(requests, 2.4 * one, turn);
        CHECK((sides[0].affordable() == 2048) == (turn % 2 == 0));
        CHECK((sides[2].affordable() == 2048) == (turn % 2 == 1));
    }
}

TEST_CASE("sides under a tight memory rest: none goes down and up again from frame to frame")
{
    std::mt19937 random(5);
    std::vector<MapSide> sides;
    for (int i = 0; i < 12; ++i)
        sides.push_back(sideOf(128.0 * (1 << random() % 6)));
    std::vector<SideRequest> requests;
    double all = 0.0;
    for (MapSide& side : sides) {
        requests.push_back({.side = &side, .bytesPerTexel = 48.0, .worth = 1.0 + double(random() % 1000)});
        all += requests.back().bytes(side.side());
    }
    std::vector<std::uint32_t> before;
    for (int frame = 0; frame < 200; ++frame) {
        fitSides(requests, 0.4 * all, 0);
        takeSides(requests);
        std::vector<std::uint32_t> now;
        double sum = 0.0;
        for (const SideRequest& request : requests) {
            now.push_back(request.side->side());
            sum += request.bytes(now.back());
        }
        REQUIRE(sum <= 0.4 * all);
        if (frame > 100) CHECK(now == before);
        before = now;
    }
}

TEST_CASE("a method's maps have its own side for a light's plain one, and fixed sides stay as they are set")
{
    static constexpr SettingSpec kHalf[] = {{"blur", "Texels.", 0, 9, 2},
                                            {"resolution", "Texels.", 64, 2048, 512, true}};
    const AlgorithmEntry entry{.name = "half", .settings = kHalf};
    Method method;
    method.entry = &entry;
    method.settings = {2.0, 0.0};
    method.noteSettings();
    CHECK(method.followsCoverage());
    CHECK(method.mapSide(1024) == 512.0);
    CHECK(method.mapSide(128) == 64.0);
    CHECK(method.mapSide(4096) == 2048.0);
    CHECK(method.settingsAt(256)[0] == 2.0);
    CHECK(method.settingsAt(256)[1] == 128.0);
    method.settings[1] = 700.0;
    method.noteSettings();
    CHECK(!method.followsCoverage());
    for (const std::uint32_t side : kMapSides)
        CHECK(method.mapSide(side) == 700.0);
    method.settings = {2.0, 0.0};
    static constexpr SettingSpec kNone[] = {{"blur", "Texels.", 0, 9, 2}};
    const AlgorithmEntry mapless{.name = "mapless", .settings = kNone};
    method.entry = &mapless;
    method.settings = {2.0};
    method.noteSettings();
    CHECK(method.mapSide(1024) == 0.0);
    CHECK(!method.followsCoverage());
}

TEST_CASE("a light that cannot be seen has no point of its range in the frustum; a light is not lost at its border")
{
    // Looks along -z, 45 degrees to each side.
    CameraView view;
    const float h = std::sqrt(0.5f);
    view.frustum = {Plane{{h, 0, -h}, 0}, {{-h, 0, -h}, 0},    {{0, h, -h}, 0},
                    {{0, -h, -h}, 0},     {{0, 0, -1}, -0.1f}, {{0, 0, 0}, 1}};
    std::mt19937 random(9);
    const auto in = [&](float low, float high) { return low + (high - low) * static_cast<float>(random()) / 0x1p32f; };
    std::uint32_t hidden = 0;
    for (int round = 0; round < 2000; ++round) {
        const bool spot = round % 2 != 0;
        const glm::vec3 at(in(-20, 20), in(-20, 20), in(-20, 20));
        const LightView light = test::lightOf(spot ? GN_LIGHT_TYPE_SPOT : GN_LIGHT_TYPE_POINT, at,
                                              glm::vec3(in(-1, 1), in(-1, 1), in(-1, 1)), in(1, 8), in(0.1f, 1.2f));
        if (canBeSeen(light, view)) continue;
        ++hidden;
        for (int k = 0; k < 200; ++k) { // points that it reaches
            const glm::vec3 way(in(-1, 1), in(-1, 1), in(-1, 1));
            if (glm::length(way) > 1.0f) continue;
            if (spot && glm::dot(glm::normalize(way), light.direction()) < std::cos(light.coneAngle)) continue;
            const glm::vec3 point = at + way * light.constants.range;
            const bool inside = std::all_of(view.frustum.begin(), view.frustum.end(), [&](const Plane& plane) {
                return glm::dot(plane.normal, point) + plane.distance >= 0.0f;
            });
            REQUIRE(!inside);
        }
    }
    CHECK(hidden > 500);
    const LightView sun = test::lightOf(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0, 0, 1}, 0, 0);
    CHECK(canBeSeen(sun, view));
    const LightView behind = test::lightOf(GN_LIGHT_TYPE_POINT, {0, 0, 5}, {0, 0, -1}, 4.8f, 0);
    CHECK(!canBeSeen(behind, view)); // 0.1 m before the near plane it ends
    const LightView touching = test::lightOf(GN_LIGHT_TYPE_POINT, {0, 0, 5}, {0, 0, -1}, 5.2f, 0);
    CHECK(canBeSeen(touching, view));
}
