// Triangles that a volume may hold are found by chunks: too many may be, none may be missing.
#include <doctest/doctest.h>

#include <random>

#include <glm/geometric.hpp>

#include "runtime/scene/mesh_chunks.hpp"

using namespace gnomon;

namespace {

/// Small triangles along a winding way, as exporters write them.
struct Winding {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    std::vector<Aabb> chunks;
    MeshView mesh;
    Caster caster;

    Winding(std::uint32_t triangles, std::mt19937& random)
    {
        std::normal_distribution<float> step(0.0f, 0.05f);
        glm::vec3 at(0.0f);
        for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
            at += glm::vec3(step(random), step(random), step(random));
            positions.push_back(at);
            indices.push_back(i);
        }
        chunks = chunkBounds(positions, indices);
        mesh.positions = positions;
        mesh.indices = indices;
        mesh.chunks = chunks;
        mesh.bounds = chunks.front();
        for (const Aabb& box : chunks)
            mesh.bounds = unionOf(mesh.bounds, box);
        caster.mesh = &mesh;
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 3; ++row)
                caster.basis[column][row] += 4.0f * step(random);
        caster.translation = {10.0f, -2.0f, 5.0f};
        caster.bounds = transformed(mesh.bounds, caster.basis, caster.translation);
    }

    bool inside(std::uint32_t face, std::span<const Plane> volume) const
    {
        for (std::uint32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
            const glm::vec3 at = caster.basis * positions[indices[corner]] + caster.translation;
            bool in = true;
            for (const Plane& plane : volume)
                in = in && glm::dot(plane.normal, at) + plane.distance >= 0.0f;
            if (in) return true;
        }
        return false;
    }
};

std::vector<FaceRange> rangesOf(std::span<const Plane> volume, const Caster& caster, FaceRange among)
{
    std::vector<FaceRange> ranges;
    forFacesIn(volume, caster, among, [&](const FaceRange& range) { ranges.push_back(range); });
    return ranges;
}

} // namespace

TEST_CASE("every triangle with a corner in the volume is visited once, in order, and most others are not")
{
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::size_t visited = 0, all = 0, held = 0, several = 0;
    for (int round = 0; round < 60; ++round) {
        const Winding winding(round % 3 == 0 ? 20 * kChunkFaces : 20 * kChunkFaces - 77, random);
        const std::uint32_t count = winding.mesh.triangleCount();
        std::array<Plane, 6> volume;
        for (int i = 0; i < 6; ++i) { // a box about one of the triangles
            glm::vec3 normal(0.0f);
            normal[i / 2] = i % 2 ? 1.0f : -1.0f;
            normal = glm::normalize(normal + 0.2f * glm::vec3(unit(random), unit(random), unit(random)));
            const glm::vec3 about =
                winding.caster.basis * winding.positions[std::size_t{3} * (count / 2)] + winding.caster.translation;
            volume[i] = {normal, 1.5f - glm::dot(normal, about)};
        }
        const FaceRange among = round % 2 ? FaceRange{0, UINT32_MAX} : FaceRange{count / 3, count - 700};
        const std::vector<FaceRange> ranges = rangesOf(volume, winding.caster, among);
        std::vector<int> times(count);
        for (std::size_t i = 0; i < ranges.size(); ++i) {
            REQUIRE(ranges[i].first < ranges[i].end);
            REQUIRE(ranges[i].end <= count);
            if (i > 0) REQUIRE(ranges[i].first > ranges[i - 1].end); // touching ones are one draw
            for (std::uint32_t face = ranges[i].first; face < ranges[i].end; ++face)
                ++times[face];
        }
        several += ranges.size() > 1;
        for (std::uint32_t face = 0; face < count; ++face) {
            const bool asked = face >= among.first && face < among.end;
            REQUIRE(times[face] <= (asked ? 1 : 0));
            visited += times[face];
            all += asked;
            if (!asked || !winding.inside(face, volume)) continue;
            ++held;
            REQUIRE(times[face] == 1);
        }
    }
    MESSAGE(held << " of " << all << " triangles in their volumes, " << visited << " visited, " << several
                 << " of 60 in more than one range");
    CHECK(held > 20'000);
    CHECK(visited < all / 2);
    CHECK(several > 10);
}

TEST_CASE("what lies in the volume as a whole, or has no chunks, is visited as a whole; ranges past the end are cut")
{
    std::mt19937 random(12);
    Winding winding(3 * kChunkFaces, random);
    const Plane far{{0.0f, 1.0f, 0.0f}, 1e6f};
    const auto whole = rangesOf({&far, 1}, winding.caster, {0, UINT32_MAX});
    REQUIRE(whole.size() == 1);
    CHECK(whole[0].end == 3 * kChunkFaces);
    CHECK(rangesOf({}, winding.caster, {5, 9}).size() == 1);
    CHECK(rangesOf({}, winding.caster, {3 * kChunkFaces, UINT32_MAX}).empty());
    const Plane none{{0.0f, 1.0f, 0.0f}, -1e6f};
    CHECK(rangesOf({&none, 1}, winding.caster, {0, UINT32_MAX}).empty());
    winding.mesh.chunks = {};
    CHECK(rangesOf({&none, 1}, winding.caster, {0, UINT32_MAX}).size() == 1);
}
