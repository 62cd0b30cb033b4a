// Angular spans: tables against brute force in double precision, what rows cost in accuracy, and what is kept.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "algorithms/shared/light_cache.hpp"
#include "algorithms/volumes/light_spans.hpp"
#include "tests/algorithms/volume_meshes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

LightView spotLight(glm::vec3 position, glm::vec3 direction, float coneAngle)
{
    LightView light = pointLight(position);
    light.type = GN_LIGHT_TYPE_SPOT;
    light.constants.type = gpu::LIGHT_SPOT;
    light.constants.directionWs = glm::vec4(glm::normalize(direction), std::cos(coneAngle));
    light.coneAngle = coneAngle;
    return light;
}

/// Tori joined into one mesh that overlaps itself as the light sees it: winding of more than one.
Mesh linked()
{
    Mesh mesh = torus(1.0f, 0.3f, 24, 12), other = torus(0.8f, 0.25f, 20, 10);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& p : other.positions)
        mesh.positions.emplace_back(p.x + 0.9f, p.z, p.y);
    for (const std::uint32_t index : other.indices)
        mesh.indices.push_back(first + index);
    return mesh;
}

struct Case {
    LightView light;
    const char* name;
};

const std::vector<Case>& cases()
{
    static const std::vector<Case> all = {{pointLight({0.4f, 5.0f, 1.0f}), "lamp above"},
                                          {pointLight({-4.8f, -0.5f, -3.4f}), "lamp along the pole"},
                                          {pointLight({0.05f, -0.15f, -0.45f}), "lamp within the ring"},
                                          {spotLight({3.0f, 4.0f, 1.0f}, {-3.0f, -4.0f, -1.0f}, 0.6f), "spot"},
                                          {directionalLight({0.3f, -1.0f, 0.2f}), "sun"}};
    return all;
}

/// A caster with its table, and what really lies between a place and the light.
struct Scene {
    Placed placed;
    LightView light;
    SpanSpace space;
    CasterSpans table;
    std::vector<glm::dvec3> local;

    Scene(Mesh mesh, const LightView& of, std::uint32_t rows, const glm::mat3& basis = glm::mat3(1.0f))
        : placed(std::move(mesh), basis, glm::vec3(0.1f, -0.2f, 0.05f)), light(of), space(of)
    {
        FrameArena arena;
        table.build(space, light, placed.caster, rows, arena);
        for (std::uint32_t v = 0; v < placed.mesh.positions.size(); ++v)
            local.push_back(space.local(glm::dvec3(placed.world(v))));
    }

    glm::dvec3 source(const glm::dvec3& p) const
    {
        return space.round() ? glm::dvec3(0.0) : p - glm::dvec3(0.0, 0.0, 1000.0);
    }

    struct Crossed {
        int faces = 0, sum = 0; ///< Of signs: not 0 inside a closed mesh.
    };
    Crossed crossed(const glm::dvec3& p) const
    {
        Crossed result;
        const std::vector<std::uint32_t>& i = placed.mesh.indices;
        for (std::size_t t = 0; t < i.size(); t += 3) {
            const int sign = crossing(source(p), p, local[i[t]], local[i[t + 1]], local[i[t + 2]]);
            result.faces += sign != 0;
            result.sum += sign;
        }
        return result;
    }

    /// In the middle of a row, about where a vertex is seen, in front of it or behind.
    glm::dvec3 inRow(Random& random) const
    {
        const CasterSpans::Extent& extent = table.extent();
        const double height = double(extent.thetaWidth) / double(table.rowCount());
        const auto vertex = static_cast<std::size_t>(random(0.0f, static_cast<float>(local.size()) - 0.01f));
        const SpanPoint seen = space.at(glm::vec3(local[vertex]));
        double from = double(seen.theta) - double(extent.thetaFirst);
        if (space.round()) from -= 2.0 * 3.14159265358979 * std::floor(from / (2.0 * 3.14159265358979));
        const double row = std::clamp(std::floor(from / height), 0.0, double(table.rowCount() - 1));
        const double theta = double(extent.thetaFirst) + (row + 0.5) * height;
        if (!space.round()) return {theta, double(seen.phi + random(-0.3f, 0.3f)), double(seen.r + random(-1, 1))};
        const double phi = std::tan(std::atan(double(seen.phi)) + double(random(-0.05f, 0.05f)));
        const double r = double(seen.r * random(0.6f, 1.8f)), out = r / std::sqrt(1.0 + phi * phi);
        return {std::cos(theta) * out, std::sin(theta) * out, phi * out};
    }

    SpanAnswer ask(const glm::dvec3& p, CasterSpans::Cursor& cursor) const
    {
        return table.ask(glm::vec3(p), space.at(glm::vec3(p)), cursor);
    }
    bool dark(const glm::dvec3& p) const
    {
        CasterSpans::Cursor cursor;
        return ask(p, cursor) != SpanAnswer::lit;
    }
};

/// Whether the truth is the same all around p, so that float may not change it.
bool clear(const Scene& scene, const glm::dvec3& p, bool dark)
{
    for (int axis = 0; axis < 3; ++axis)
        for (const double step : {-1e-4, 1e-4}) {
            glm::dvec3 q = p;
            q[axis] += step;
            if ((scene.crossed(q).faces > 0) != dark) return false;
        }
    return true;
}

} // namespace

TEST_CASE("in the middle of a row a table says what brute force says, in front of, beside, behind and between casters")
{
    const std::pair<const char*, Mesh> meshes[] = {
        {"torus", torus(1.0f, 0.35f, 24, 12)}, {"linked", linked()}, {"sheet", sheet(6, 0.3f)}};
    const glm::mat3 mirror(glm::vec3(-1.2f, 0.1f, 0.0f), glm::vec3(0.0f, 0.9f, 0.2f), glm::vec3(0.1f, 0.0f, 1.0f));
    for (const auto& mesh : meshes)
        for (const Case& each : cases())
            for (const glm::mat3& basis : {glm::mat3(1.0f), mirror}) {
                CAPTURE(std::string(mesh.first));
                CAPTURE(std::string(each.name));
                const Scene scene(mesh.second, each.light, 64, basis);
                REQUIRE(scene.table.rowCount() == 64);
                Random random(7);
                int dark = 0, lit = 0, wrong = 0;
                for (int i = 0; i < 400; ++i) {
                    const glm::dvec3 p = scene.inRow(random);
                    const Scene::Crossed truth = scene.crossed(p);
                    if (scene.placed.topology.closed && truth.sum != 0) continue; // nobody sees the inside
                    if (!clear(scene, p, truth.faces > 0)) continue;
                    ++(truth.faces > 0 ? dark : lit);
                    wrong += scene.dark(p) != (truth.faces > 0);
                }
                CHECK(dark > 50);
                CHECK(lit > 50);
                CHECK(wrong == 0);
            }
}

TEST_CASE("places beyond what a caster covers are lit, in every direction")
{
    for (const Case& each : cases()) {
        CAPTURE(std::string(each.name));
        const Scene scene(torus(0.3f, 0.1f, 16, 8), each.light, 100);
        Random random(3);
        for (int i = 0; i < 1000; ++i) {
            const glm::vec3 p = random.inBox(glm::vec3(-8.0f), glm::vec3(8.0f));
            const glm::dvec3 local = scene.space.local(glm::dvec3(p));
            const bool truth = scene.crossed(local).faces > 0;
            // A tenth of the caster's radius: far more than a row.
            bool near = truth;
            for (int axis = 0; axis < 3; ++axis)
                for (const double step : {-0.3, 0.3}) {
                    glm::dvec3 q = local;
                    q[axis] += step;
                    near = near || scene.crossed(q).faces > 0;
                }
            if (!near) CHECK_FALSE(scene.dark(local));
        }
    }
}

TEST_CASE("twice the rows, half the wrong places")
{
    for (const Case& each : cases()) {
        CAPTURE(std::string(each.name));
        std::vector<double> shares;
        const Scene coarse(linked(), each.light, 75);
        Random random(11);
        std::vector<std::pair<glm::dvec3, bool>> places;
        while (places.size() < 20000) {
            const glm::dvec3 p = coarse.space.local(glm::dvec3(random.inBox(glm::vec3(-2.5f), glm::vec3(2.5f))));
            const Scene::Crossed truth = coarse.crossed(p);
            if (truth.sum == 0) places.emplace_back(p, truth.faces > 0);
        }
        for (const std::uint32_t rows : {75u, 150u, 300u, 600u}) {
            const Scene scene(linked(), each.light, rows);
            int wrong = 0;
            for (const auto& place : places)
                wrong += scene.dark(place.first) != place.second;
            shares.push_back(wrong / double(places.size()));
        }
        MESSAGE(std::string(each.name) << ": wrong " << 100 * shares[0] << " % at 75 rows, " << 100 * shares[1] << ", "
                                       << 100 * shares[2] << ", " << 100 * shares[3] << " % at 600");
        // From 75 to 600 rows three doublings; single ones scatter with some dozen wrong places.
        CHECK(shares[0] > 1.4 * 1.4 * 1.4 * shares[3]);
        CHECK(shares[0] < 2.6 * 2.6 * 2.6 * shares[3]);
    }
}

TEST_CASE("a row holds rising, disjoint spans, and only ridges bound them")
{
    for (const Case& each : cases()) {
        CAPTURE(std::string(each.name));
        const Scene scene(linked(), each.light, 128);
        for (std::uint32_t row = 0; row < scene.table.rowCount(); ++row) {
            const std::span<const CasterSpans::Span> spans = scene.table.row(row);
            for (std::size_t i = 0; i < spans.size(); ++i) {
                CHECK(spans[i].first <= spans[i].last);
                CHECK(spans[i].nearest <= spans[i].farthest);
                if (i > 0) CHECK(spans[i - 1].last < spans[i].first);
                float reach = spans[i].first, first = spans[i].first;
                for (const CasterSpans::Piece& piece : scene.table.pieces(spans[i])) {
                    CHECK(piece.first >= first);
                    CHECK(piece.first <= reach); // no gap within a span
                    reach = std::max(reach, piece.last);
                    CHECK(piece.reach == reach);
                    first = piece.first;
                }
                CHECK(reach == spans[i].last);
            }
        }
    }
    // A torus seen along its axis: one span a row beside the hole, two across it.
    const Scene ring(torus(1.0f, 0.3f, 48, 24), directionalLight({0.0f, -1.0f, 0.0f}), 200);
    std::size_t most = 0;
    for (std::uint32_t row = 0; row < 200; ++row)
        most = std::max(most, ring.table.row(row).size());
    CHECK(most == 2);
    CHECK(ring.table.row(3).size() == 1);
    CHECK(ring.table.row(100).size() == 2);
}

TEST_CASE("a cursor along a scan line answers as a fresh search does")
{
    for (const Case& each : cases()) {
        const Scene scene(linked(), each.light, 96);
        Random random(5);
        for (int line = 0; line < 40; ++line) {
            const glm::vec3 from = random.inBox(glm::vec3(-3.0f), glm::vec3(3.0f));
            const glm::vec3 step = 0.01f * random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f));
            CasterSpans::Cursor cursor;
            for (int i = 0; i < 300; ++i) {
                const glm::vec3 p = scene.space.local(from + float(i) * step);
                CasterSpans::Cursor fresh;
                CHECK(scene.table.ask(p, scene.space.at(p), cursor) == scene.table.ask(p, scene.space.at(p), fresh));
            }
        }
    }
}

TEST_CASE("an open mesh says that it may be its own receiver, a closed one never shades its lit faces")
{
    const Scene open(sheet(8, 0.4f), pointLight({1.5f, 2.0f, 0.5f}), 100);
    const Scene closed(torus(1.0f, 0.35f, 32, 16), pointLight({0.3f, 6.0f, 0.2f}), 300);
    Random random(9);
    bool beyond = false;
    for (int i = 0; i < 2000; ++i) {
        CasterSpans::Cursor cursor;
        const glm::dvec3 p = open.space.local(glm::dvec3(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f))));
        const SpanAnswer answer = open.ask(p, cursor);
        beyond = beyond || answer == SpanAnswer::beyondOpen;
        const bool within = cursor.span && glm::length(p) <= double(cursor.span->farthest);
        if (within) CHECK(answer != SpanAnswer::dark);
    }
    CHECK(beyond);
    const std::vector<std::uint32_t>& index = closed.placed.mesh.indices;
    int lit = 0;
    for (std::size_t t = 0; t < index.size(); t += 3) {
        const glm::dvec3 a = closed.local[index[t]], b = closed.local[index[t + 1]], c = closed.local[index[t + 2]];
        const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a)), middle = (a + b + c) / 3.0;
        const double facing = -glm::dot(normal, glm::normalize(middle));
        // From above only the ring's own terminator is near; no part of it hides another there.
        if (facing < 0.2) continue;
        ++lit;
        CHECK_FALSE(closed.dark(middle + 1e-4 * normal));
    }
    CHECK(lit > 100);
}

TEST_CASE("tables are kept: a caster that moved has its own made again, a light that moved all")
{
    JobSystem jobs(nullptr, nullptr, 2);
    FrameArena arena;
    LightView light = pointLight({0.0f, 6.0f, 0.0f});
    light.id = 1;
    light.revision = 10;
    std::vector<std::unique_ptr<Placed>> placed;
    std::vector<const Caster*> casters;
    for (std::uint32_t i = 0; i < 5; ++i) {
        const glm::vec3 at(2.0f * static_cast<float>(i) - 4.0f, 0.0f, 1.0f);
        placed.push_back(std::make_unique<Placed>(torus(0.5f, 0.2f, 12, 8), glm::mat3(1.0f), at));
        placed.back()->caster.id = 9 - i; // found by id, whatever the order
        placed.back()->caster.revision = 100 + i;
        casters.push_back(&placed.back()->caster);
    }
    LightSpans spans;
    CHECK(spans.stamp() != LightSpans::stampOf(light, casters, 100));
    CHECK(spans.update(light, casters, 100, jobs, arena) == 5);
    CHECK(spans.stamp() == LightSpans::stampOf(light, casters, 100));
    CHECK(spans.update(light, casters, 100, jobs, arena) == 0);

    placed[2]->caster.revision = 200;
    CHECK(spans.stamp() != LightSpans::stampOf(light, casters, 100));
    CHECK(spans.update(light, casters, 100, jobs, arena) == 1);
    CHECK(spans.update(light, casters, 200, jobs, arena) == 5);
    const std::size_t all = spans.memoryBytes();
    light.revision = 11;
    CHECK(spans.stamp() != LightSpans::stampOf(light, casters, 200));
    for (int i = 0; i < 10; ++i) {
        ++light.revision;
        CHECK(spans.update(light, casters, 200, jobs, arena) == 5);
        CHECK(spans.memoryBytes() == all); // memory is used again
    }
    casters.erase(casters.begin() + 1);
    CHECK(spans.update(light, casters, 200, jobs, arena) == 0);
    CHECK(spans.entries().size() == 4);
    const std::size_t withSpare = spans.memoryBytes();
    casters.insert(casters.begin() + 1, &placed[1]->caster);
    CHECK(spans.update(light, casters, 200, jobs, arena) == 1);
    CHECK(spans.memoryBytes() == withSpare); // what comes back has the memory of what left
    casters.resize(1);                       // and of what left, no more is kept than there is
    CHECK(spans.update(light, casters, 200, jobs, arena) == 0);
    CHECK(spans.memoryBytes() < all);
}

TEST_CASE("what is kept for a light stays in place while it is asked for, and is made again once it is forgotten")
{
    LightCache<int> cache;
    int* first = &cache.find(1, 100);
    *first = 7;
    CHECK(&cache.find(2, 100) != first);
    CHECK(&cache.find(1, 200) != first);
    CHECK(&cache.find(1, 100) == first);
    for (int i = 0; i < 5000; ++i) // more than it remembers anything for, and nothing new comes
        cache.find(2, 100);
    CHECK(cache.find(1, 100) == 7);
    for (int i = 0; i < 5000; ++i)
        cache.find(2, 100);
    cache.find(3, 100); // in whose favour it goes
    CHECK(cache.find(1, 100) == 0);
}

TEST_CASE("a table takes 4 bytes a row, 24 a span, 16 a piece and 16 a face, as its page says")
{
    const Scene scene(torus(1.0f, 0.35f, 48, 24), pointLight({0.0f, 5.0f, 0.0f}), 300);
    std::size_t spans = 0, pieces = 0;
    for (std::uint32_t row = 0; row < 300; ++row) {
        spans += scene.table.row(row).size();
        for (const CasterSpans::Span& span : scene.table.row(row))
            pieces += span.pieceCount;
    }
    const std::size_t faces = scene.placed.topology.facePlanes.size() / 2; // about half are turned away
    const std::size_t stated = 4 * 301 + 24 * spans + 16 * pieces + 16 * faces;
    MESSAGE(spans << " spans, " << pieces << " pieces, " << scene.table.memoryBytes() << " bytes, stated " << stated);
    CHECK(scene.table.memoryBytes() >= stated * 4 / 5);
    CHECK(scene.table.memoryBytes() <= stated * 2); // vectors grow by doubling
}
