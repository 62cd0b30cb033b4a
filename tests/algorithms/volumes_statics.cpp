// What octree_volume works out once: shadows of boxes, umbrae of convex casters, who conceals whom, and the octree;
// against dense samples and slow references in double precision.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <set>

#include "algorithms/volumes/silhouette.hpp"
#include "algorithms/volumes/static_volumes.hpp"
#include "tests/algorithms/volume_meshes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Where light comes from, as seen from p: far away for a directional light.
glm::dvec3 source(const LightView& light, glm::dvec3 p)
{
    return light.type == GN_LIGHT_TYPE_DIRECTIONAL ? p - 1000.0 * glm::dvec3(light.direction())
                                                   : glm::dvec3(light.position());
}

bool meetsBox(const Aabb& box, glm::dvec3 from, glm::dvec3 to)
{
    double enter = 0.0, leave = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = to[axis] - from[axis];
        double t0 = (double(box.lower[axis]) - from[axis]) / d, t1 = (double(box.upper[axis]) - from[axis]) / d;
        if (t0 > t1) std::swap(t0, t1);
        enter = std::max(enter, t0);
        leave = std::min(leave, t1);
    }
    return enter <= leave;
}

bool meetsMesh(const Placed& placed, glm::dvec3 from, glm::dvec3 to)
{
    const std::vector<std::uint32_t>& i = placed.mesh.indices;
    for (std::size_t t = 0; t < i.size(); t += 3)
        if (crossing(from, to, placed.world(i[t]), placed.world(i[t + 1]), placed.world(i[t + 2])) != 0) return true;
    return false;
}

LightView randomLight(Random& random)
{
    return random(0.0f, 1.0f) < 0.4f ? directionalLight(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)))
                                     : pointLight(random.inBox(glm::vec3(-6.0f), glm::vec3(6.0f)));
}

/// How far outside the region of these planes, in metres; below 0: inside.
template <typename Planes>
double outside(const Planes& planes, glm::dvec3 p)
{
    double most = -1e30;
    for (const glm::vec4& plane : planes)
        most = std::max(most, glm::dot(glm::dvec3(plane), p) + double(plane.w));
    return most;
}

glm::mat3 randomBasis(Random& random)
{
    const glm::vec3 x = glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f)));
    const glm::vec3 y = glm::normalize(glm::cross(x, random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f))));
    const float mirror = random(0.0f, 1.0f) < 0.5f ? -1.0f : 1.0f;
    return glm::mat3(x * random(0.3f, 2.0f), y * random(0.3f, 2.0f), glm::cross(x, y) * (mirror * random(0.3f, 2.0f)));
}

/// A light and casters with ids and revisions, as the runtime hands them out.
struct Stage {
    LightView light = pointLight({0.0f, 1.5f, 0.0f});
    std::vector<std::unique_ptr<Placed>> placed;
    std::vector<const Caster*> statics;

    Stage()
    {
        light.id = 1;
        light.revision = 1;
    }
    Placed& add(const Mesh& mesh, glm::vec3 at, const glm::mat3& basis = glm::mat3(1.0f))
    {
        placed.push_back(std::make_unique<Placed>(mesh, basis, at));
        Caster& caster = placed.back()->caster;
        caster.id = static_cast<std::uint32_t>(placed.size());
        caster.revision = 100 + placed.size();
        caster.isStatic = true;
        statics.push_back(&caster);
        return *placed.back();
    }
    /// All are one cluster.
    std::vector<VolumeSource> sources() const
    {
        std::vector<VolumeSource> all;
        for (const Caster* caster : statics)
            if (castsVolume(*caster)) all.push_back({caster});
        return all;
    }
    StaticVolumes choose(bool conceal = true) const
    {
        StaticVolumes volumes;
        chooseVolumes(light, sources(), conceal, volumes);
        return volumes;
    }
};

const Mesh kWall = boxMesh({2.0f, 1.5f, 0.1f}), kCrate = boxMesh(glm::vec3(0.3f));

} // namespace

TEST_CASE("the shadow of a box holds a point exactly if the way to the light meets the box")
{
    Random random(11);
    std::size_t inside = 0;
    for (int trial = 0; trial < 400; ++trial) {
        const glm::vec3 corner = random.inBox(glm::vec3(-4.0f), glm::vec3(4.0f));
        const Aabb box{corner, corner + random.inBox(glm::vec3(0.05f), glm::vec3(3.0f))};
        const LightView light = randomLight(random);
        const BoxShadow shadow = boxShadow(box, light);
        for (int sample = 0; sample < 200; ++sample) {
            const glm::dvec3 p = random.inBox(glm::vec3(-9.0f), glm::vec3(9.0f));
            const double distance = outside(shadow.planes, p);
            if (std::abs(distance) < 1e-4) continue;
            const bool shadowed = meetsBox(box, p, source(light, p));
            CHECK((distance < 0.0) == shadowed);
            inside += shadowed;
        }
    }
    CHECK(inside > 1000);
}

TEST_CASE("lights along an axis, inside the box and on its faces cut nothing off its shadow")
{
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    for (const LightView& light :
         {directionalLight({0, -1, 0}), directionalLight({1, 0, 0}), directionalLight({0, 0.6f, 0.8f}),
          pointLight({0, 0, 0}), pointLight({0, 5, 0}), pointLight({1, 5, 1}), pointLight({1, 0, 0}),
          pointLight({1, 1, 1}), pointLight({0, 1, 3})}) {
        const BoxShadow shadow = boxShadow(box, light);
        Random random(3);
        for (int sample = 0; sample < 2000; ++sample) {
            const glm::dvec3 p = random.inBox(glm::vec3(-6.0f), glm::vec3(6.0f));
            if (meetsBox(box, p, source(light, p))) CHECK(outside(shadow.planes, p) < 1e-5);
        }
    }
}

TEST_CASE("where a side of the box points at the light, its shadow is bounded on the other side, too")
{
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    for (const LightView& light : {directionalLight({0, -1, 0}), directionalLight({1, 0, 0}),
                                   directionalLight({0, 0.6f, 0.8f}), pointLight({1, 5, 1}), pointLight({-1, 5, 3})}) {
        const BoxShadow shadow = boxShadow(box, light);
        Random random(4);
        for (int sample = 0; sample < 2000; ++sample) {
            const glm::dvec3 p = random.inBox(glm::vec3(-6.0f), glm::vec3(6.0f));
            const double distance = outside(shadow.planes, p);
            if (std::abs(distance) > 1e-4) CHECK((distance < 0.0) == meetsBox(box, p, source(light, p)));
        }
    }
}

TEST_CASE("every point of an umbra is shadowed by its caster, and hardly a shadowed point is left out")
{
    Random random(5);
    std::size_t inside = 0, umbrae = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const Placed box(boxMesh(glm::vec3(1.0f)), randomBasis(random),
                         random.inBox(glm::vec3(-3.0f), glm::vec3(3.0f)));
        const LightView light = randomLight(random);
        const std::optional<Umbra> umbra = umbraOf({&box.caster}, light);
        if (!umbra) continue; // the light is inside, or an edge points at it
        ++umbrae;
        CHECK(umbra->planes.size() <= 9);
        for (int sample = 0; sample < 100; ++sample) {
            const glm::dvec3 p = random.inBox(glm::vec3(-9.0f), glm::vec3(9.0f));
            const double distance = outside(umbra->planes, p);
            if (std::abs(distance) < 1e-3) continue;
            const bool beyond = outside(umbra->away, p) > 0.0; // not in the caster itself
            if (distance < 0.0) {
                CHECK((!beyond || meetsMesh(box, p, source(light, p))));
                inside += beyond;
            } else if (beyond) {
                CHECK_FALSE(meetsMesh(box, p, source(light, p)));
            }
        }
    }
    CHECK(umbrae > 200);
    CHECK(inside > 500);
}

TEST_CASE("what is not known to be closed, convex, opaque and before the light has no umbra")
{
    const LightView light = pointLight({0, 4, 0});
    const auto hasUmbra = [](Mesh mesh, const LightView& lamp) {
        const Placed placed(std::move(mesh), glm::mat3(1.0f), glm::vec3(0.0f));
        return umbraOf({&placed.caster}, lamp).has_value();
    };
    CHECK(hasUmbra(kCrate, light));
    CHECK_FALSE(hasUmbra(torus(1.0f, 0.3f, 5, 4), light));
    CHECK_FALSE(hasUmbra(torus(1.0f, 0.3f, 24, 12), light));
    CHECK_FALSE(hasUmbra(sheet(1, 0.0f), light));
    CHECK_FALSE(hasUmbra(holed(kCrate, 12), light));
    CHECK_FALSE(hasUmbra(flipped(kCrate, 5), light));
    CHECK_FALSE(hasUmbra(kCrate, pointLight({0, 0, 0})));

    Placed leaf(kCrate, glm::mat3(1.0f), glm::vec3(0.0f));
    leaf.caster.alphaTested = true;
    CHECK_FALSE(umbraOf({&leaf.caster}, light));
    leaf.caster.alphaTested = false;
    leaf.view.topology = nullptr;
    CHECK_FALSE(umbraOf({&leaf.caster}, light));
    const Placed flat(kCrate, glm::mat3({1, 0, 0}, {0, 0, 0}, {0, 0, 1}), glm::vec3(0.0f));
    CHECK_FALSE(umbraOf({&flat.caster}, light));
}

TEST_CASE("a concealed box and all of its shadow lie in the concealer's umbra")
{
    Random random(17);
    std::size_t concealed = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const Placed wall(boxMesh({2.0f, 2.0f, 0.2f}), randomBasis(random), glm::vec3(0.0f));
        const LightView light = randomLight(random);
        const std::optional<Umbra> umbra = umbraOf({&wall.caster}, light);
        const glm::vec3 corner = random.inBox(glm::vec3(-4.0f), glm::vec3(4.0f));
        const Aabb box{corner, corner + random.inBox(glm::vec3(0.02f), glm::vec3(0.8f))};
        if (!umbra || !conceals(*umbra, box)) continue;
        ++concealed;
        for (int sample = 0; sample < 20; ++sample) {
            const glm::dvec3 inBox = random.inBox(box.lower, box.upper);
            const glm::dvec3 away = light.type == GN_LIGHT_TYPE_DIRECTIONAL ? glm::dvec3(light.direction())
                                                                            : inBox - glm::dvec3(light.position());
            const glm::dvec3 p = inBox + double(random(0.0f, 5.0f)) * away;
            CHECK(meetsMesh(wall, p, source(light, p)));
        }
    }
    CHECK(concealed > 50);
}

TEST_CASE("what stands behind a wall is dropped; what looks out, stands before it or in it is not")
{
    Stage stage;
    stage.add(kWall, {0, 1.5f, 3});                    // 0: 4 x 3 m
    stage.add(kCrate, {0.5f, 1, 4});                   // 1: behind it
    stage.add(kCrate, {-0.4f, 0.5f, 3.4f});            // 2: leaning on it from behind
    stage.add(kCrate, {0, 0.3f, 1});                   // 3: before it
    stage.add(kCrate, {4.4f, 1, 5});                   // 4: beside its umbra
    stage.add(kCrate, {2.9f, 1, 4.2f});                // 5: across the umbra's border
    stage.add(kCrate, {1, 1, 3.2f});                   // 6: stuck in the wall: an eye inside could see it
    stage.add(kWall, {0, 1.5f, 9}, glm::mat3(0.5f));   // 7: a smaller wall far behind
    stage.add(kCrate, {0, 1.5f, 12}, glm::mat3(0.2f)); // 8: behind both
    const StaticVolumes volumes = stage.choose();
    CHECK(volumes.drawn == std::vector<std::uint32_t>{0, 3, 4, 5, 6});
    CHECK(volumes.concealed == 4);
    REQUIRE(!volumes.occluders.empty());
    for (const StaticVolumes::Occluder& occluder : volumes.occluders)
        CHECK(occluder.position < volumes.drawn.size());
    CHECK(stage.choose(false).drawn.size() == 9);
    CHECK(stage.choose(false).occluders.empty());
}

TEST_CASE("of equal casters at one place one stays")
{
    Stage stage;
    for (int i = 0; i < 5; ++i)
        stage.add(kWall, {0, 1.5f, 3});
    CHECK(stage.choose().drawn.size() == 5); // none lies outside of another
    stage.add(kWall, {0, 1.5f, 3.5f}, glm::mat3(0.9f));
    CHECK(stage.choose().drawn.size() == 5);
}

TEST_CASE("the volumes of a light are chosen again exactly when it, its casters or their order changed")
{
    Stage stage;
    stage.add(kWall, {0, 1.5f, 3});
    stage.add(kCrate, {0.5f, 1, 4});
    stage.add(kCrate, {0, 0.3f, 1});
    StaticVolumesCache cache;
    const auto built = [&] {
        const std::uint64_t before = cache.built();
        cache.find(stage.light, stage.sources(), true);
        return cache.built() - before;
    };
    CHECK(built() == 1);
    CHECK(built() == 0);
    ++stage.light.revision;
    CHECK(built() == 1);
    CHECK(built() == 0);
    ++stage.placed[1]->caster.revision;
    CHECK(built() == 1);
    std::swap(stage.statics[0], stage.statics[1]);
    CHECK(built() == 1);
    CHECK(cache.find(stage.light, stage.sources(), true).drawn == std::vector<std::uint32_t>{1, 2});
    stage.statics.pop_back();
    CHECK(built() == 1);
    CHECK(built() == 0);

    // Another address, the same casters: nothing is keyed by where things lie.
    Caster copy = *stage.statics[0];
    stage.statics[0] = &copy;
    CHECK(built() == 0);

    LightView other = stage.light;
    other.id = 2;
    CHECK(&cache.find(other, stage.sources(), true) != &cache.find(stage.light, stage.sources(), true));
    CHECK(cache.find(stage.light, stage.sources(), false).drawn.size() == 2);
    CHECK(built() == 0);
}

TEST_CASE("a topology that comes late is seen")
{
    Stage stage;
    Placed& wall = stage.add(kWall, {0, 1.5f, 3});
    stage.add(sheet(2, 0.1f), {0.2f, 1.5f, 5});
    wall.view.topology = nullptr;
    StaticVolumesCache cache;
    const std::vector<std::uint32_t> first{0};
    CHECK(cache.find(stage.light, stage.sources(), true).drawn == first); // the sheet, alone
    wall.view.topology = &wall.topology;
    CHECK(cache.find(stage.light, stage.sources(), true).drawn == first); // the wall, which conceals it
    CHECK(cache.built() == 2);
}

TEST_CASE("of too many clusters the meshes that the light is in have theirs, then the largest")
{
    Stage stage;
    Mesh row; // 100 boxes side by side
    for (int i = 0; i < 100; ++i)
        row = joined(row, kCrate, {3.0f * static_cast<float>(i), 0, 0});
    const auto scaled = [](float scale) { return glm::mat3(scale); };
    for (int i = 0; i < 12; ++i)
        stage.add(row, {0, 10, 4.0f * static_cast<float>(i)}, scaled(0.1f + 0.01f * static_cast<float>(i)));
    stage.add(kWall, {0, 1, 9});
    stage.add(row, {-1, 1.5f, 0}, scaled(0.05f)); // about the light
    FrameArena arena;
    const auto cutOf = [&] {
        std::vector<std::uint32_t> volumes(stage.statics.size());
        for (const VolumeSource& volume : volumesOf(arena, stage.statics, stage.light)) {
            const auto caster = std::find(stage.statics.begin(), stage.statics.end(), volume.caster);
            ++volumes[static_cast<std::size_t>(caster - stage.statics.begin())];
            CHECK(volume.shape().faceCount == (volume.cluster == VolumeSource::kWhole ? 1200 : 12));
        }
        return volumes;
    };
    REQUIRE(stage.placed[0]->topology.clusters.size() == 100);
    std::vector<std::uint32_t> expected(12, 100);
    expected[0] = expected[1] = expected[2] = 1; // 1 024 are enough for ten rows, one of which is about the light
    expected.insert(expected.end(), {1, 100});
    CHECK(cutOf() == expected);
    CHECK(volumesOf(arena, stage.statics, stage.light).size() <= mostVolumes(stage.statics));
    stage.statics.resize(10);
    expected.assign(10, 100); // all that there are
    CHECK(cutOf() == expected);
}

TEST_CASE("the octree visits every wanted box once, front to back within each node")
{
    Random random(23);
    for (const std::size_t count : {0u, 1u, 7u, 9u, 300u}) {
        std::vector<Aabb> boxes;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 corner = random.inBox(glm::vec3(-20.0f), glm::vec3(20.0f));
            boxes.push_back({corner, corner + random.inBox(glm::vec3(0.0f), glm::vec3(4.0f))});
        }
        VolumeTree tree;
        tree.build(boxes);
        for (const VolumeTree::Node& node : tree.nodes())
            for (const std::uint32_t item : tree.items().subspan(node.first, node.count))
                CHECK((node.bounds.lower == glm::min(node.bounds.lower, boxes[item].lower) &&
                       node.bounds.upper == glm::max(node.bounds.upper, boxes[item].upper)));

        const glm::vec3 eye = random.inBox(glm::vec3(-30.0f), glm::vec3(30.0f));
        const Plane plane{glm::normalize(random.inBox(glm::vec3(-1.0f), glm::vec3(1.0f))), 2.0f};
        std::size_t asked = 0;
        const auto wanted = [&](const Aabb& box) {
            ++asked;
            return touches(box, std::span(&plane, 1));
        };
        std::vector<std::uint32_t> seen;
        tree.visit(eye, wanted, [&](std::uint32_t item) { seen.push_back(item); });
        std::set<std::uint32_t> expected;
        for (std::uint32_t i = 0; i < count; ++i)
            if (touches(boxes[i], std::span(&plane, 1))) expected.insert(i);
        CHECK(std::set<std::uint32_t>(seen.begin(), seen.end()) == expected);
        CHECK(seen.size() == expected.size());
        if (count == 300) {
            // Whole branches are left out when nothing is wanted near them.
            asked = 0;
            tree.visit(
                eye, [&](const Aabb&) { return ++asked == 0; }, [](std::uint32_t) {});
            CHECK(asked == 1);
        }
    }
}

TEST_CASE("boxes in a row are visited in the order of their distance, and a heap at one place completely")
{
    std::vector<Aabb> row;
    for (int i = 0; i < 64; ++i)
        row.push_back({glm::vec3(float(i), 0, 0), glm::vec3(float(i) + 0.5f, 1, 1)});
    VolumeTree tree;
    tree.build(row);
    const auto always = [](const Aabb&) { return true; };
    std::vector<std::uint32_t> seen;
    tree.visit({-10, 0, 0}, always, [&](std::uint32_t item) { seen.push_back(item); });
    CHECK(std::is_sorted(seen.begin(), seen.end()));
    seen.clear();
    tree.visit({100, 0, 0}, always, [&](std::uint32_t item) { seen.push_back(item); });
    CHECK(std::is_sorted(seen.rbegin(), seen.rend()));

    tree.build(std::vector<Aabb>(100, row[3]));
    seen.clear();
    tree.visit({0, 0, 0}, always, [&](std::uint32_t item) { seen.push_back(item); });
    CHECK(std::set<std::uint32_t>(seen.begin(), seen.end()).size() == 100);
    CHECK(seen.size() == 100);
}
