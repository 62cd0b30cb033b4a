// Meshes of many casters, each with one number.
#include <doctest/doctest.h>

#include <vector>

#include "algorithms/shared/mesh_numbers.hpp"

using namespace gnomon;

TEST_CASE("meshes are numbered in the order of the first question, and keep their numbers")
{
    FrameArena arena;
    for (const std::uint32_t count : {0u, 1u, 7u, 3000u}) {
        CAPTURE(count);
        std::vector<MeshView> meshes(count);
        for (std::uint32_t i = 0; i < count; ++i)
            meshes[i].id = 1 + i % 100 * 1024; // many share an id's place, and some the id
        MeshNumbers numbers(arena, count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t known = numbers.count();
            REQUIRE(numbers.of(meshes[i]) == known);
            REQUIRE(numbers.of(meshes[i / 2]) == i / 2);
        }
        CHECK(numbers.count() == count);
        for (std::uint32_t i = count; i-- > 0;)
            REQUIRE(numbers.of(meshes[i]) == i);
    }
}
