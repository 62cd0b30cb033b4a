#pragma once
// The host pass of contour_chain on hand-made buffers, and every pixel's answer asked by itself.
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "algorithms/host_frame.hpp"
#include "algorithms/hybrid/bit_rows.hpp"
#include "algorithms/hybrid/chain_pass.hpp"
#include "algorithms/hybrid_map_fixture.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon::test {

constexpr std::uint32_t kMapSide = 96;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

struct World {
    RayScene rays;
    TracedMesh mesh;
    Topology topology;
    std::vector<Caster> casters;
    std::vector<const Caster*> pointers;
    Seen seen;

    World() : mesh(makeScene(rays)), topology(buildTopology(mesh.view.positions, mesh.view.indices))
    {
        mesh.view.id = 1;
        mesh.view.topology = &topology;
        casters = {casterOf(mesh, 0)};
        casters[0].bounds = {glm::vec3(-18.0f), glm::vec3(18.0f)};
        pointers = {&casters[0]};
        rays.update(casters);
        seen = look({}, brute::trianglesOf(casters));
    }
};
inline const World& world()
{
    static const World one;
    return one;
}

struct Lamp {
    LightView view;
    DrawnMap map;
    gpu::HybridConstants constants{};

    explicit Lamp(const LightView& light) : view(light), map(drawMap(light, world().pointers, kMapSide))
    {
        ShadowTask task;
        task.view = &world().seen.view;
        task.light = &view;
        constants.base = mapConstants(task, kMapSide, 1);
        addLightProjection(constants.base, map.fits, task);
    }
    bool cube() const { return view.type == GN_LIGHT_TYPE_POINT; }
};
inline const Lamp& lamp(bool cube)
{
    static const Lamp spot(makeLight(GN_LIGHT_TYPE_SPOT, {2, 12, 6}, {-0.2, -1, -0.5}, 40, 0.6).view);
    static const Lamp point(makeLight(GN_LIGHT_TYPE_POINT, {1, 3.2, 3}, {0, -1, 0}, 25, 0.0).view);
    return cube ? point : spot;
}

struct Asking {
    const Lamp& lamp;
    ChainStages stages = stagesOf(ChainMode::chain);
    std::uint32_t contour = 0;
    ChainDebugOutput tells = ChainDebugOutput::visibility;
    bool normals = true;
    VkRect2D area{{0, 0}, {kWidth, kHeight}};
    std::uint32_t flipped = 0; ///< Every so many pixels the map's word is turned round; 0: none.
    std::uint32_t threads = 2;
    bool settled = false;     ///< What is told without triangles and rays is left out, as CPUs that ask the map do.
    std::uint32_t unsure = 0; ///< Every so many rows those that the map calls lit are MAP_UNSURE; 0: none.
    bool foreign = false;     ///< In stripes of the map, what the host draws is nearest: no triangle of ours.

    /// Of the picture, from a place in the area.
    std::size_t pixel(std::uint32_t x, std::uint32_t y) const
    {
        return (static_cast<std::uint32_t>(area.offset.y) + y) * kWidth + static_cast<std::uint32_t>(area.offset.x) + x;
    }
    std::span<const std::byte> normalBytes() const
    {
        return normals ? world().seen.normalBytes() : std::span<const std::byte>();
    }
};

inline NumberedTriangles numbered(RingsCache& rings, FrameArena& arena)
{
    NumberedTriangles triangles(world().pointers, &rings, arena);
    for (const NumberedTriangles::Entry& entry : triangles.entries()) {
        entry.rings->rings.build(*entry.caster->mesh->topology);
        entry.rings->built = true;
    }
    return triangles;
}

/// A pixel of the picture, asked by itself.
struct Expected {
    bool lit = true; ///< By the map.
    std::uint32_t reason = gpu::REASON_OUTSIDE, votes = gpu::VOTES_OUTSIDE;
    std::uint32_t texelTriangles = 0, ringTriangles = 0;
    bool traced = false;

    std::uint32_t told(ChainDebugOutput tells) const
    {
        if (tells == ChainDebugOutput::texelCandidates) return texelTriangles;
        if (tells == ChainDebugOutput::ringCandidates) return ringTriangles;
        return tells == ChainDebugOutput::votes ? votes : reason;
    }
};

/// Candidates, counted by a list of those that are asked.
inline std::pair<std::uint32_t, std::uint32_t> candidates(const NumberedTriangles& triangles, const MapTexels& texels)
{
    std::set<std::uint32_t> four, nine, edges, vertices;
    texels.anyTriangle(TexelBlock::four, [&](std::uint32_t number) { return four.insert(number), false; });
    texels.anyTriangle(TexelBlock::nine, [&](std::uint32_t number) { return nine.insert(number), false; });
    const std::uint32_t own = texels.ownTriangle();
    if (own != kNoTriangle) {
        edges.insert(own), vertices.insert(own);
        const NumberedTriangles::Entry& entry = triangles.of(own);
        const MeshView& mesh = *entry.caster->mesh;
        const auto corner = [&mesh](std::uint32_t triangle, int i) {
            return mesh.positions[mesh.indices[3 * triangle + static_cast<std::uint32_t>(i)]];
        };
        for (std::uint32_t other = 0; other < mesh.triangleCount(); ++other) {
            int shared = 0;
            for (int i = 0; i < 9; ++i)
                shared += corner(own - entry.first, i / 3) == corner(other, i % 3);
            if (shared >= 2) edges.insert(entry.first + other);
            if (shared >= 1) vertices.insert(entry.first + other);
        }
    }
    const auto count = [](const std::set<std::uint32_t>& set) { return static_cast<std::uint32_t>(set.size()); };
    return {count(four) + 5 * count(nine), count(edges) + 5 * count(vertices)};
}

inline DrawnMap mapOf(const Asking& asking)
{
    DrawnMap map = asking.lamp.map;
    for (std::vector<std::uint32_t>& numbers : map.numbers)
        for (std::size_t i = 0; asking.foreign && i < numbers.size(); ++i)
            if (i / map.side % 16 < 8) numbers[i] = kNoTriangle;
    return map;
}

inline std::vector<Expected> expect(const Asking& asking)
{
    FrameArena arena;
    RingsCache rings;
    const NumberedTriangles triangles = numbered(rings, arena);
    CandidateOccluders occluders(triangles);
    const DrawnMap drawn = mapOf(asking);
    const HostMap map = drawn.view();
    const ChainScene scene{map, asking.lamp.constants.base, asking.lamp.cube(), occluders};
    const Receivers receivers(world().seen.view, asking.lamp.view, world().seen.depth, asking.normalBytes());
    std::vector<Expected> pixels(kPixels);
    for (std::uint32_t i = 0; i < kPixels; ++i) {
        Expected& pixel = pixels[i];
        ShadowRay ray;
        Receiver receiver;
        const Asked asked = receivers.at(i % kWidth, i / kWidth, ray, receiver);
        const bool flip = asking.flipped != 0 && i % asking.flipped == 0;
        if (asked == Asked::dark) pixel = {false, gpu::REASON_BACKFACING, gpu::VOTES_BACKFACING};
        if (asked != Asked::ray) {
            pixel.lit = pixel.lit != flip;
            continue;
        }
        const MapTexels texels(map, scene.constants, scene.cube, receiver);
        pixel.lit = texels.agree(true, TexelBlock::own) != flip;
        pixel.reason = chainReason(scene, asking.stages, pixel.lit, asking.normals, texels, ray);
        pixel.votes = chainVotes(scene, pixel.lit, asking.normals, texels, ray);
        std::tie(pixel.texelTriangles, pixel.ringTriangles) = candidates(triangles, texels);
        pixel.traced = pixel.reason == gpu::REASON_RT_LIT;
        std::uint8_t occluded = 0;
        world().rays.occluded({&ray, 1}, 1u, {&occluded, 1});
        if (pixel.traced && occluded) pixel.reason = gpu::REASON_RT_SHADOW;
    }
    return pixels;
}

/// What nearestPixels() says of a pixel.
inline std::uint8_t statusOf(const Asking& asking, const Expected& pixel)
{
    if (asking.tells != ChainDebugOutput::reason) return pixel.lit ? 255 : 0;
    if (pixel.reason == gpu::REASON_OUTSIDE || pixel.reason == gpu::REASON_BACKFACING)
        return static_cast<std::uint8_t>(pixel.reason);
    return static_cast<std::uint8_t>(pixel.lit ? gpu::REASON_MAP_LIT : gpu::REASON_MAP_SHADOW);
}

/// Its bits, of the area.
inline std::vector<std::uint64_t> settledRows(const Asking& asking, const std::vector<Expected>& expected)
{
    const VkExtent2D extent = asking.area.extent;
    const std::size_t words = BitRows::wordsPerRow(extent.width);
    std::vector<std::uint64_t> rows(words * extent.height, 0);
    for (std::uint32_t y = 0; y < extent.height; ++y)
        for (std::uint32_t x = 0; x < extent.width; ++x)
            switch (expected[asking.pixel(x, y)].reason) {
            case gpu::REASON_OUTSIDE:
            case gpu::REASON_BACKFACING:
            case gpu::REASON_TC_LIT:
            case gpu::REASON_TC_SHADOW:
                rows[y * words + x / 64] |= std::uint64_t{1} << x % 64;
            }
    return rows;
}

struct Outcome {
    std::vector<std::uint8_t> status, rows; ///< Of the area.
    std::uint64_t rays = 0;
};

inline Outcome run(const Asking& asking, const std::vector<Expected>& expected)
{
    HostFrame frame(const_cast<RayScene&>(world().rays), asking.threads);
    RingsCache rings;
    const NumberedTriangles triangles = numbered(rings, frame.arena());
    CameraView view = world().seen.view;
    view.area = asking.area;
    std::vector<std::uint8_t> status;
    for (std::uint32_t y = 0; y < view.area.extent.height; ++y)
        for (std::uint32_t x = 0; x < view.area.extent.width; ++x) {
            const bool lit = expected[asking.pixel(x, y)].lit;
            auto byte = static_cast<std::uint8_t>((x * 37 + y) << 1 | (lit ? 1 : 0)); // only bit 0 counts, but for one
            if (byte == gpu::MAP_UNSURE) byte = 1;
            if (asking.settled) byte = statusOf(asking, expected[asking.pixel(x, y)]);
            if (lit && asking.unsure != 0 && y % asking.unsure == 0) byte = gpu::MAP_UNSURE;
            status.push_back(byte);
        }
    const DrawnMap drawn = mapOf(asking);
    IdMap map{.depth = {},
              .fits = drawn.fits,
              .needed = (1u << drawn.fits.size()) - 1,
              .side = drawn.side,
              .depths = {},
              .numbers = {}};
    static constexpr const char* kNames[] = {"d0", "d1", "d2", "d3", "d4", "d5", "n0", "n1", "n2", "n3", "n4", "n5"};
    for (std::size_t i = 0; i < drawn.fits.size(); ++i) {
        map.depths[i] = frame.holding<float>(kNames[i], drawn.depth[i]);
        map.numbers[i] = frame.holding<std::uint32_t>(kNames[6 + i], drawn.numbers[i]);
    }
    Outcome outcome;
    ChainStages stages = asking.stages;
    if (asking.settled) stages.hintLit = stages.hintShadow = false;
    const std::vector<std::uint64_t> settled = settledRows(asking, expected);
    const ChainJob job{.view = &view,
                       .light = &asking.lamp.view,
                       .constants = &asking.lamp.constants,
                       .triangles = &triangles,
                       .map = map,
                       .depth = frame.holding<float>("depth", world().seen.depth),
                       .normals = asking.normals ? frame.holding("normals", asking.normalBytes()) : BufferId{},
                       .status = frame.holding<std::uint8_t>("status", status),
                       .settled = asking.settled ? frame.holding<std::uint64_t>("settled", settled) : BufferId{},
                       .rows = frame.buffer("rows", status.size()),
                       .stages = stages,
                       .contour = asking.contour,
                       .tells = asking.tells};
    outcome.rays = frame.run([&](const HostContext& host) { runChain(job, host); });
    const auto rows = frame.content<std::uint8_t>(job.rows);
    outcome.rows.assign(rows.begin(), rows.begin() + std::ptrdiff_t(status.size()));
    outcome.status = status;
    return outcome;
}

/// Whether each pixel of the picture is one of the area's contour.
inline std::vector<bool> contourOf(const Asking& asking, const std::vector<Expected>& expected)
{
    const VkExtent2D extent = asking.area.extent;
    std::vector<bool> inside(kPixels, false);
    const std::size_t words = BitRows::wordsPerRow(extent.width);
    std::vector<std::uint64_t> memory(words * extent.height, 0), row(words, ~std::uint64_t{0});
    const BitRows lit{extent.width, extent.height, memory};
    for (std::uint32_t y = 0; y < extent.height; ++y)
        for (std::uint32_t x = 0; x < extent.width; ++x)
            if (expected[asking.pixel(x, y)].lit) lit.row(y)[x / 64] |= std::uint64_t{1} << x % 64;
    for (std::uint32_t y = 0; y < extent.height; ++y) {
        if (asking.contour != 0) contourRow(lit, y, (asking.contour - 1) / 2, row);
        for (std::uint32_t x = 0; x < extent.width; ++x)
            inside[asking.pixel(x, y)] = (row[x / 64] >> x % 64 & 1) != 0;
    }
    return inside;
}

} // namespace gnomon::test
