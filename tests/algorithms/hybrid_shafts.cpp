// tile_shafts without a device: sixteen lanes are the scalar receiver, trees hold their triangles, and whatever a tile
// proves is what rays say.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/hybrid/spread.hpp"
#include "algorithms/hybrid/tile_blocks.hpp"
#include "algorithms/hybrid/tile_search.hpp"
#include "algorithms/shared/receivers.hpp"
#include "runtime/ray_fixture.hpp"

using namespace gnomon;
using test::randomPoint;
using test::TracedMesh;

namespace {

constexpr std::uint32_t kWidth = 37, kHeight = 26; // blocks are cut on both sides

CameraView randomView(std::mt19937& random, VkFormat normals)
{
    CameraView view;
    gpu::ViewConstants& v = view.constants;
    v.eyeWs = glm::vec4(randomPoint(random, 30.0f), 0.0f);
    v.rayCornerWs = glm::vec4(-0.8f, 0.5f, -1.0f, 0.0f);
    v.rayDxWs = glm::vec4(0.045f, 0.002f, 0.0f, 0.0f);
    v.rayDyWs = glm::vec4(0.001f, -0.04f, 0.003f, 0.0f);
    v.depthScale = 0.1f;
    v.depthMul = 1.0f;
    v.depthAdd = 0.0f;
    v.skyDepth = 0.0f;
    v.offsetFactor = 1.0f;
    v.pixelSize = 0.04f;
    v.hasNormals = normals != VK_FORMAT_UNDEFINED;
    view.normalFormat = normals;
    view.extent = {kWidth + 5, kHeight + 3};
    view.area = {{3, 2}, {kWidth, kHeight}};
    return view;
}

LightView lightOf(GnLightType type, glm::vec3 position, glm::vec3 direction)
{
    return test::lightOf(type, position, direction, 60.0f, 0.7f);
}

std::vector<std::byte> randomNormals(std::mt19937& random, VkFormat format, std::size_t pixels)
{
    if (format == VK_FORMAT_UNDEFINED) return {};
    const bool half = format == VK_FORMAT_R16G16B16A16_SFLOAT;
    std::vector<std::byte> bytes(pixels * (half ? 8 : 16));
    for (std::size_t i = 0; i < pixels; ++i) {
        std::uint16_t halves[4];
        for (std::uint16_t& h : halves) // every sign, exponents up to 1, subnormals among them
            h = static_cast<std::uint16_t>((random() & 0x8000u) | random() % 0x3c00u);
        const glm::vec4 floats(randomPoint(random, 1.0f), 0.0f);
        std::memcpy(bytes.data() + i * (half ? 8 : 16), half ? static_cast<const void*>(halves) : &floats,
                    half ? 8 : 16);
    }
    return bytes;
}

/// Lanes that are not what Receivers says, bit by bit.
int wrongLanes(const CameraView& view, const LightView& light, const std::vector<float>& depth,
               const std::vector<std::byte>& normals, const simd::Kernels& kernels, int (&asked)[3])
{
    const Receivers receivers(view, light, depth, normals);
    const BlockReader reader(kernels, view, light, depth, normals);
    int wrong = 0;
    for (std::uint32_t y = 0; y < kHeight; y += 4)
        for (std::uint32_t x = 0; x < kWidth; x += 4) {
            simd::Block block;
            reader.readSummed(x, y, block);
            RayPacket packet;
            reader.pack(block, packet);
            for (std::uint32_t i = 0; i < simd::kLanes; ++i) {
                const std::uint32_t px = x + i % 4, py = y + i / 4;
                if (px >= kWidth || py >= kHeight) {
                    wrong += block.asked[i] == simd::kRay;
                    continue;
                }
                ShadowRay ray;
                const Asked expected = receivers.at(px + 3, py + 2, ray);
                ++asked[static_cast<int>(expected)];
                wrong += block.asked[i] != static_cast<std::uint32_t>(expected);
                wrong += (packet.there[i] != 0) != (expected == Asked::ray && !(ray.tfar < 0.0f));
                if (expected != Asked::ray || block.asked[i] != simd::kRay) continue;
                for (std::uint32_t axis = 0; axis < 3; ++axis)
                    wrong += std::memcmp(&block.origin[axis][i], &ray.origin[int(axis)], sizeof(float)) != 0 ||
                             std::memcmp(&packet.origin[axis][i], &ray.origin[int(axis)], sizeof(float)) != 0 ||
                             std::memcmp(&packet.direction[axis][i], &ray.direction[int(axis)], sizeof(float)) != 0;
                wrong += std::memcmp(&block.tfar[i], &ray.tfar, sizeof(float)) != 0 ||
                         std::memcmp(&packet.tfar[i], &ray.tfar, sizeof(float)) != 0;
            }
        }
    return wrong;
}

} // namespace

TEST_CASE("sixteen lanes give the receivers and rays of the scalar formulas, bit by bit, in every instruction set")
{
    std::mt19937 random(3);
    int asked[3] = {};
    for (const VkFormat format : {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_UNDEFINED}) {
        for (const GnLightType type : {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT, GN_LIGHT_TYPE_POINT}) {
            const CameraView view = randomView(random, format);
            std::vector<float> depth(std::size_t(view.extent.width) * view.extent.height);
            std::uniform_real_distribution<float> value(0.002f, 0.2f);
            for (float& d : depth)
                d = random() % 9 == 0 ? 0.0f : value(random);
            const std::vector<std::byte> normals = randomNormals(random, format, depth.size());
            const glm::vec3 ahead = glm::vec3(view.constants.eyeWs) + glm::vec3(0.0f, 0.0f, -12.0f);
            const LightView light = lightOf(type, ahead + glm::vec3(1.0f, 9.0f, 0.0f), {0.1f, -1.0f, 0.2f});
            for (const simd::Kernels* kernels : kernelsHere())
                CHECK(wrongLanes(view, light, depth, normals, *kernels, asked) == 0);
        }
    }
    for (const int count : asked)
        CHECK(count > 1000);
}

TEST_CASE("sixteen lanes agree with the scalar formulas where a surface turns away from the light by the last bits")
{
    std::mt19937 random(5);
    int asked[3] = {};
    const CameraView view = randomView(random, VK_FORMAT_R32G32B32A32_SFLOAT);
    const std::vector<float> depth(std::size_t(view.extent.width) * view.extent.height, 0.02f);
    const glm::vec3 ahead = glm::vec3(view.constants.eyeWs) + glm::vec3(0.0f, 0.0f, -5.0f);
    const LightView light = lightOf(GN_LIGHT_TYPE_POINT, ahead + glm::vec3(1.0f, 9.0f, 0.0f), {0.1f, -1.0f, 0.2f});
    for (int round = 0; round < 20; ++round) {
        std::vector<glm::vec4> normals;
        for (std::uint32_t i = 0; i < depth.size(); ++i) {
            const glm::vec2 pixel(float(i % view.extent.width) + 0.5f, float(i / view.extent.width) + 0.5f);
            const glm::vec3 at = glm::vec3(view.constants.eyeWs) +
                                 gpu::linearDepth(view.constants, depth[i]) * gpu::viewRayWs(view.constants, pixel);
            const glm::vec3 to = glm::normalize(light.position() - at);
            const glm::vec3 across = glm::normalize(glm::cross(to, randomPoint(random, 1.0f)));
            const float turn = std::ldexp(randomPoint(random, 1.0f).x, -26 + int(random() % 12));
            normals.emplace_back(3.0f * (across + turn * to), 0.0f);
        }
        std::vector<std::byte> bytes(normals.size() * sizeof(glm::vec4));
        std::memcpy(bytes.data(), normals.data(), bytes.size());
        for (const simd::Kernels* kernels : kernelsHere())
            CHECK(wrongLanes(view, light, depth, bytes, *kernels, asked) == 0);
    }
    CHECK(asked[static_cast<int>(Asked::dark)] > 1000);
    CHECK(asked[static_cast<int>(Asked::ray)] > 1000);
}

namespace {

/// Triangles below a node; counts those that stick out of the boxes above them.
void collect(const TriangleTree& tree, std::uint32_t index, const TracedMesh& mesh, std::vector<int>& times, int& out)
{
    const TriangleTree::Node& node = tree.nodes()[index];
    for (std::uint32_t i = 0; i < node.count; ++i) {
        if (!TriangleTree::isLeaf(node.child[i])) {
            CHECK(node.child[i] > index);
            collect(tree, node.child[i], mesh, times, out);
            continue;
        }
        for (const std::uint32_t triangle : tree.leaf(node.child[i])) {
            ++times[triangle];
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const glm::vec3 p = mesh.positions[mesh.indices[3 * std::size_t(triangle) + corner]];
                for (int axis = 0; axis < 3; ++axis)
                    out += p[axis] < node.lower[axis][i] || p[axis] > node.upper[axis][i];
            }
        }
    }
}

void checkTree(const TriangleTree& tree, const TracedMesh& mesh)
{
    std::vector<int> times(mesh.indices.size() / 3);
    int out = 0;
    collect(tree, 0, mesh, times, out);
    CHECK(out == 0);
    CHECK(std::all_of(times.begin(), times.end(), [](int count) { return count == 1; }));
}

} // namespace

TEST_CASE("a triangle tree holds every triangle once, inside of its boxes, also after a refit")
{
    RayScene rays;
    std::mt19937 random(5);
    for (const std::size_t count : {1, 3, 5, 64, 3000}) {
        CAPTURE(count);
        MeshRaysHistory history;
        TracedMesh mesh(rays, test::randomTriangles(random, count, 5.0f, 0.5f));
        REQUIRE(rays.build(mesh.view.positions, mesh.indices, &history));
        REQUIRE(mesh.rays->tree());
        checkTree(*mesh.rays->tree(), mesh);
        const std::shared_ptr<const TriangleTree> before = mesh.rays->tree();
        for (glm::vec3& position : mesh.positions)
            position += randomPoint(random, 0.05f);
        const std::unique_ptr<MeshRays> moved = rays.build(mesh.view.positions, mesh.indices, &history);
        REQUIRE(moved);
        checkTree(*moved->tree(), mesh);
        CHECK(std::ranges::equal(moved->tree()->triangles(), before->triangles()));
        CHECK(moved->memoryBytes() > moved->tree()->memoryBytes());
        MESSAGE(count << " triangles: " << moved->tree()->memoryBytes() << " bytes");
    }
}

namespace {

float halfOpaque(std::uint32_t, float u, float, void*)
{
    return u < 0.5f ? 1.0f : 0.0f;
}

/// A tile of 16x16 receivers on a plane.
std::vector<simd::Block> patch(std::mt19937& random, const LightView& light, float size)
{
    const glm::vec3 centre = randomPoint(random, 6.0f);
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const glm::vec3 toLight =
        glm::normalize(directional ? -glm::vec3(light.constants.directionWs) : light.position() - centre);
    glm::vec3 normal = glm::normalize(toLight + randomPoint(random, 0.8f));
    if (glm::dot(normal, toLight) < 0.0f) normal = -normal;
    const glm::vec3 u = glm::normalize(glm::cross(normal, glm::vec3(0.3f, 0.5f, 0.8f))), v = glm::cross(normal, u);
    std::vector<simd::Block> blocks(16);
    for (std::uint32_t b = 0; b < 16; ++b) {
        simd::Block& block = blocks[b];
        std::memset(static_cast<void*>(&block), 0, sizeof block);
        const std::uint32_t bx = (b & 1) | (b >> 1 & 2), by = (b >> 1 & 1) | (b >> 2 & 2);
        for (std::uint32_t i = 0; i < simd::kLanes; ++i) {
            const float x = size * (float(4 * bx + i % 4) - 7.5f) / 16.0f,
                        y = size * (float(4 * by + i / 4) - 7.5f) / 16.0f;
            const glm::vec3 p = centre + x * u + y * v;
            for (int axis = 0; axis < 3; ++axis)
                block.origin[axis][i] = p[axis];
            block.asked[i] = simd::kRay;
            block.tfar[i] = directional ? std::numeric_limits<float>::infinity() : 1.0f - 1e-5f;
        }
        for (int axis = 0; axis < 3; ++axis)
            block.normalSum[axis] = 16.0f * normal[axis];
        block.largestOffset = 1e-4f;
        block.rays = simd::kLanes;
        block.finite = 1;
    }
    return blocks;
}

struct Collected final : TileAnswers {
    std::array<simd::LaneStates, 16> states{};
    void dark(std::uint32_t first, std::uint32_t count) override
    {
        for (std::uint32_t i = first; i < first + count; ++i)
            states[i] = {.inside = (1u << simd::kLanes) - 1u, .unsure = 0};
    }
    void lanes(std::uint32_t block, simd::LaneStates of) override { states[block] = of; }
};

/// Casters as hosts make them: turned, mirrored, stretched, flat, with holes; one whose mesh rays never see.
std::vector<Caster> castersOf(std::mt19937& random, const std::vector<std::unique_ptr<TracedMesh>>& meshes)
{
    std::vector<Caster> casters;
    for (std::uint32_t i = 0; i < 60; ++i) {
        glm::mat3 basis(
            glm::rotate(glm::mat4(1.0f), float(i), glm::normalize(glm::vec3(1, 2, 0.3f) + randomPoint(random, 0.9f))));
        if (i % 5 == 1) basis[0] = -basis[0];
        if (i % 5 == 2) basis[1] *= 3.0f;
        if (i % 11 == 3) basis[2] = basis[0] * 0.5f; // no inverse
        if (i % 13 == 4) basis = glm::mat3(1.0f);
        Caster caster = test::casterOf(*meshes[i % meshes.size()], i + 1, basis, randomPoint(random, 7.0f));
        caster.bounds = transformed(caster.mesh->bounds, caster.basis, caster.translation);
        caster.mirrored = i % 5 == 1;
        caster.mask = i % 7 == 5 ? 2u : 1u;
        caster.alphaTested = i % 6 == 0;
        caster.opacity = i % 12 == 0 ? halfOpaque : nullptr;
        casters.push_back(caster);
    }
    return casters;
}

/// What all tiles meet.
struct Casters {
    RayScene rays;
    std::vector<std::unique_ptr<TracedMesh>> meshes;
    std::vector<Caster> casters;
    std::vector<const Caster*> seen;

    explicit Casters(std::mt19937& random)
    {
        for (const auto& [count, size] : {std::pair<std::size_t, float>{1, 3.0f}, {2, 2.0f}, {40, 0.6f}, {400, 0.2f}}) {
            meshes.push_back(std::make_unique<TracedMesh>(rays, test::randomTriangles(random, count, 1.5f, size)));
            MeshView& view = meshes.back()->view;
            for (const glm::vec3& p : view.positions) {
                view.bounds.lower = glm::min(view.bounds.lower, p);
                view.bounds.upper = glm::max(view.bounds.upper, p);
            }
        }
        casters = castersOf(random, meshes);
        rays.update(casters);
        for (const Caster& caster : casters)
            if (caster.mask & 1u) seen.push_back(&caster);
    }
};

GnLightType typeOf(int trial)
{
    return trial % 3 == 0 ? GN_LIGHT_TYPE_DIRECTIONAL : trial % 3 == 1 ? GN_LIGHT_TYPE_SPOT : GN_LIGHT_TYPE_POINT;
}

/// A tile whose receivers lie along the border of a triangle's shadow: beside it by 2^-24 to 2^-8 of what is rounded,
/// or with `tip` within it, next to a corner.
std::vector<simd::Block> border(std::mt19937& random, const LightView& light, const Caster& caster, bool tip)
{
    std::vector<simd::Block> blocks = patch(random, light, 0.2f);
    const MeshView& mesh = *caster.mesh;
    const std::size_t triangle = random() % mesh.triangleCount(), edge = random() % 3;
    const auto corner = [&](std::size_t i) {
        const glm::vec3& p = mesh.positions[mesh.indices[3 * triangle + i % 3]];
        return glm::dmat3(caster.basis) * glm::dvec3(p) + glm::dvec3(caster.translation);
    };
    const glm::dvec3 from = corner(edge), along = corner(edge + 1) - from, other = corner(edge + 2) - from;
    std::uniform_real_distribution<double> unit(0.0, 1.0), exponent(-24.0, -8.0);
    const double start = unit(random), behind = 0.5 + 4.0 * unit(random);
    for (simd::Block& block : blocks)
        for (std::uint32_t i = 0; i < simd::kLanes; ++i) {
            const glm::dvec3 at = tip ? from + along * std::exp2(exponent(random)) + other * std::exp2(exponent(random))
                                      : from + along * (0.9 * start + 0.1 * unit(random));
            const glm::dvec3 away = light.type == GN_LIGHT_TYPE_DIRECTIONAL
                                        ? glm::normalize(glm::dvec3(light.constants.directionWs))
                                        : glm::normalize(at - glm::dvec3(light.position()));
            const glm::dvec3 aside = glm::normalize(glm::cross(away, along));
            const double beside = tip ? 0.0 : 10.0 * std::exp2(exponent(random)) * (random() % 2 == 0 ? 1.0 : -1.0);
            const glm::dvec3 p = at + away * (behind + 0.1 * unit(random)) + aside * beside;
            for (int axis = 0; axis < 3; ++axis)
                block.origin[axis][i] = static_cast<float>(p[axis]);
        }
    return blocks;
}

struct Tally {
    std::size_t lit = 0, dark = 0, unsure = 0, wrong = 0;

    void print() const
    {
        MESSAGE("proven lit " << lit << ", dark " << dark << "; left to rays " << unsure << "; wrong " << wrong);
    }
};

/// What the search says of a tile, and what rays say.
void compare(const std::vector<simd::Block>& blocks, const LightView& light, const Casters& world, int trial,
             Tally& tally)
{
    FrameArena arena;
    const auto all = kernelsHere();
    const simd::Kernels& kernels = *all[std::size_t(trial) % all.size()];
    const ShaftScene scene(kernels, light, world.seen, {1, 0, 0}, arena);
    TileSearch search(scene, arena);
    Collected found;
    search.run(blocks, found);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (std::uint32_t i = 0; i < simd::kLanes; ++i) {
            ShadowRay ray;
            ray.origin = {blocks[b].origin[0][i], blocks[b].origin[1][i], blocks[b].origin[2][i]};
            ray.tfar = blocks[b].tfar[i];
            ray.direction = light.type == GN_LIGHT_TYPE_DIRECTIONAL ? -glm::vec3(light.constants.directionWs)
                                                                    : light.position() - ray.origin;
            const bool inside = (found.states[b].inside >> i & 1) != 0;
            if ((found.states[b].unsure >> i & 1) != 0) {
                ++tally.unsure;
                tally.wrong += inside; // one or the other
                continue;
            }
            std::uint8_t occluded = 2;
            world.rays.occluded({&ray, 1}, 1u, {&occluded, 1});
            tally.wrong += inside != (occluded == 1);
            tally.lit += occluded == 0;
            tally.dark += occluded == 1;
        }
}

} // namespace

TEST_CASE("what tiles prove is what rays say, for turned, mirrored, flat and holed casters under every kind of light")
{
    std::mt19937 random(17);
    const Casters world(random);
    Tally tally;
    for (int trial = 0; trial < 3000; ++trial) {
        const LightView light = lightOf(typeOf(trial), randomPoint(random, 9.0f), randomPoint(random, 1.0f));
        compare(patch(random, light, trial % 4 == 0 ? 2.0f : 0.2f), light, world, trial, tally);
    }
    tally.print();
    CHECK(tally.wrong == 0);
    CHECK(tally.lit > 50000);
    CHECK(tally.dark > 50000);
    CHECK(tally.unsure < tally.lit + tally.dark);
}

TEST_CASE("margins hold what a float inverse makes of points, also where casters are squashed aslant")
{
    std::mt19937 random(29);
    const auto turn = [&random] {
        const glm::vec3 axis = glm::normalize(randomPoint(random, 1.0f) + glm::vec3(0.0f, 0.0f, 1e-3f));
        return glm::mat3(glm::rotate(glm::mat4(1.0f), randomPoint(random, 3.0f).x, axis));
    };
    for (const float thin : {1.0f, 0.1f, 0.01f, 0.003f, 0.001f}) {
        CAPTURE(thin);
        double worst = 0.0;
        for (int i = 0; i < 2000; ++i) {
            const glm::mat3 basis = turn() * glm::mat3(1, 0, 0, 0, thin, 0, 0, 0, thin) * turn();
            const glm::vec3 translation = randomPoint(random, 10.0f), p = randomPoint(random, 30.0f);
            CasterReach reach{.translation = translation};
            reach.spread = spreadOf(basis);
            const glm::dvec3 bound = reach.rounding(glm::abs(glm::dvec3(p)));

            // As ray tracers do it: the adjoint by the determinant, and an affine map.
            const glm::vec3 rows[3] = {glm::cross(basis[1], basis[2]), glm::cross(basis[2], basis[0]),
                                       glm::cross(basis[0], basis[1])};
            const float determinant = glm::dot(basis[0], rows[0]);
            const glm::mat3 inverse =
                glm::transpose(glm::mat3(rows[0] / determinant, rows[1] / determinant, rows[2] / determinant));
            const glm::vec3 inMesh = inverse * p - inverse * translation;
            const glm::dvec3 back = glm::dmat3(basis) * glm::dvec3(inMesh) + glm::dvec3(translation);
            const glm::dvec3 off = glm::abs(back - glm::dvec3(p)) / bound;
            worst = std::max({worst, off.x, off.y, off.z});
        }
        MESSAGE(thin << ": " << worst << " of the margin");
        CHECK(worst < 1.0);
        CHECK(worst > 0.02); // and they are no wider than that asks for
    }
}

TEST_CASE("at the very borders of shadows nothing is proven that rays deny")
{
    std::mt19937 random(23);
    const Casters world(random);
    Tally tally;
    for (int trial = 0; trial < 3000; ++trial) {
        const LightView light = lightOf(typeOf(trial), randomPoint(random, 9.0f), randomPoint(random, 1.0f));
        compare(border(random, light, *world.seen[random() % world.seen.size()], trial % 2 != 0), light, world, trial,
                tally);
    }
    tally.print();
    CHECK(tally.wrong == 0);
    CHECK(tally.lit > 50000);
    CHECK(tally.dark > 50000);
    CHECK(tally.unsure > 50000);
}
