// The maps that gnGetLightMap() asks for.
#include <doctest/doctest.h>

#include "algorithms/maps/declared_maps.hpp"

using namespace gnomon;

TEST_CASE("the map of a light is the one set last")
{
    DeclaredMaps maps;
    ShadowAlgorithm::Map map{};
    CHECK_FALSE(maps.get(3, map));
    maps.set(3, {.image = {7}});
    maps.set(4, {.image = {8}});
    maps.set(3, {.image = {9}});
    REQUIRE(maps.get(3, map));
    CHECK(map.image.index == 9);
    CHECK_FALSE(maps.get(5, map));
}

TEST_CASE("maps of lights long gone are forgotten, those of the current frame never")
{
    DeclaredMaps maps;
    ShadowAlgorithm::Map map{};
    std::size_t most = 0;
    for (std::uint32_t light = 10; light < 8 * DeclaredMaps::kRemembered; ++light) {
        if (light % 1000 == 0) maps.set(1, {.image = {light}}); // stands among those that come and go
        maps.set(light, {.image = {light}});
        most = std::max(most, maps.size());
        REQUIRE(maps.get(light, map));
    }
    REQUIRE(maps.get(1, map));
    CHECK(most <= 2 * DeclaredMaps::kRemembered);
}
