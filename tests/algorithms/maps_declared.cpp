// The maps that gnGetLightMap() asks for.
#include <doctest/doctest.h>

#include "algorithms/maps/declared_maps.hpp"

using namespace gnomon;

TEST_CASE("the map of a light is the one set last, its layers those of all views of the frame")
{
    DeclaredMaps maps;
    ShadowAlgorithm::Map map{};
    CHECK_FALSE(maps.get(3, map));
    maps.set(3, {.image = {7}, .validLayers = 1}, 1);
    maps.set(4, {.image = {8}, .validLayers = 2}, 1);
    maps.set(3, {.image = {9}, .validLayers = 4}, 1);
    REQUIRE(maps.get(3, map));
    CHECK(map.image.index == 9);
    CHECK(map.validLayers == 5);
    maps.set(3, {.image = {9}, .validLayers = 8}, 2);
    REQUIRE(maps.get(3, map));
    CHECK(map.validLayers == 8);
    CHECK_FALSE(maps.get(5, map));
}

TEST_CASE("maps of lights long gone are forgotten, those of the current frame never")
{
    DeclaredMaps maps;
    ShadowAlgorithm::Map map{};
    std::size_t most = 0;
    for (std::uint32_t frame = 1; frame < 20 * DeclaredMaps::kRemembered; ++frame) {
        maps.set(1, {.image = {frame}}, frame); // stands among those that come and go
        for (std::uint32_t light = 0; light < 3; ++light) {
            maps.set(10 + 3 * frame + light, {.image = {frame}}, frame);
            REQUIRE(maps.get(10 + 3 * frame + light, map));
        }
        most = std::max(most, maps.size());
    }
    REQUIRE(maps.get(1, map));
    CHECK(most <= 2 * 3 * DeclaredMaps::kRemembered + 4);
}
