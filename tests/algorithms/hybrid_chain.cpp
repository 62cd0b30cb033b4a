// The chain of contour_chain, stage by stage, over every pixel of small pictures: what Moderno's acceptance criteria of
// his chapter 4 (A1 to A7 here) say exactly, against the tracer's own answers.
#include <doctest/doctest.h>

#include <optional>

#include "algorithms/hybrid/bit_rows.hpp"
#include "algorithms/hybrid/chain.hpp"
#include "algorithms/hybrid_map_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// All that can be said of a pixel.
struct Pixel {
    Asked asked = Asked::lit;
    bool lit = true;      ///< By the map's own texel; away from the light: dark.
    bool blocked = false; ///< By the tracer.
    bool own = false, four = false, nine = false, edges = false,
         vertices = false;               ///< CandidateOccluders: ST, NB4, NB9, AG1, AG2.
    bool agree4 = false, agree9 = false; ///< TC4, TC9 say what the map says.
    std::uint32_t votes = 0;
    std::optional<bool> unfiltered; ///< A bilinear filter of the comparisons gives 0 or 1; none: too close to say.
    std::uint32_t reason[5] = {};   ///< By mode, of those that leave something out.

    bool truthLit() const { return asked == Asked::lit || (asked == Asked::ray && !blocked); }
};
constexpr ChainMode kModes[] = {ChainMode::chain, ChainMode::tcOnly, ChainMode::tcLit, ChainMode::strict,
                                ChainMode::noRay};

/// The scene, with a second caster under a transform that turns, stretches and mirrors.
struct World {
    RayScene rays;
    TracedMesh ground, loose;
    Topology groundTopology, looseTopology;
    std::vector<Caster> casters;
    std::vector<const Caster*> pointers;
    Seen seen;

    World();
};

TracedMesh looseMesh(RayScene& rays)
{
    std::vector<glm::vec3> corners;
    std::vector<std::uint32_t> indices;
    for (int i = 0; i < 3; ++i)
        addBox(corners, indices,
               glm::scale(glm::translate(glm::mat4(1.0f), {1.5f * static_cast<float>(i) - 2.0f, 1.0f, 0.5f}),
                          glm::vec3(0.3f, 0.4f, 0.2f)));
    return TracedMesh(rays, std::move(corners), std::move(indices));
}

World::World() : ground(makeScene(rays)), loose(looseMesh(rays))
{
    ground.view.id = 1;
    loose.view.id = 2;
    groundTopology = buildTopology(ground.view.positions, ground.view.indices);
    looseTopology = buildTopology(loose.view.positions, loose.view.indices);
    ground.view.topology = &groundTopology;
    loose.view.topology = &looseTopology;
    const glm::mat4 turned =
        glm::rotate(glm::mat4(1.0f), 0.4f, {1, 3, 2}) * glm::scale(glm::mat4(1.0f), glm::vec3(1.3f, 0.8f, -1.0f));
    casters = {casterOf(ground, 0), casterOf(loose, 1, glm::mat3(turned), {1.0f, 2.0f, 3.0f})};
    for (Caster& caster : casters) {
        Aabb bounds{glm::vec3(1e9f), glm::vec3(-1e9f)};
        for (const glm::vec3& p : caster.mesh->positions) {
            const glm::vec3 world = caster.basis * p + caster.translation;
            bounds = {glm::min(bounds.lower, world), glm::max(bounds.upper, world)};
        }
        caster.bounds = bounds;
        pointers.push_back(&caster);
    }
    rays.update(casters);
    seen = look({}, brute::trianglesOf(casters));
}

/// Whether a bilinear filter would give 0 or 1, from the texel's rays and the receiver's plane in double precision;
/// none where the receiver is close to a line of texel centres, a comparison close to equal, or the map ends.
std::optional<bool> unfilteredAt(const World& world, const DrawnMap& map, const LightView& light,
                                 const gpu::MapConstants& constants, const Receiver& receiver)
{
    if (light.type == GN_LIGHT_TYPE_POINT) return {};
    const glm::dmat4 clipFromWorld(map.fits[0].clipFromWorld), worldFromClip = glm::inverse(clipFromWorld);
    const glm::dvec3 normal(receiver.normal), eye(world.seen.view.constants.eyeWs);
    const glm::dvec3 at = eye + double(receiver.w) * glm::dvec3(receiver.viewRay);
    const double w = receiver.w;
    const glm::dvec4 polynomial(constants.map.offset);
    const double offset = polynomial.x + w * (polynomial.y + w * polynomial.z);
    const glm::dvec4 clip = clipFromWorld * glm::dvec4(at, 1.0);
    const glm::dvec2 texel = 0.5 * map.side * (glm::dvec2(clip) / clip.w + 1.0);
    const auto depthAt = [&](const glm::dvec2& centre) { // of the moved plane, on the texel's ray
        const glm::dvec2 ndc = 2.0 * centre / double(map.side) - 1.0;
        glm::dvec4 near = worldFromClip * glm::dvec4(ndc, 0.0, 1.0), far = worldFromClip * glm::dvec4(ndc, 0.5, 1.0);
        const glm::dvec3 from = glm::dvec3(near) / near.w, along = glm::dvec3(far) / far.w - from;
        const double t = glm::dot(normal, at + offset * normal - from) / glm::dot(normal, along);
        const glm::dvec4 hit = clipFromWorld * glm::dvec4(from + t * along, 1.0);
        return hit.z / hit.w;
    };
    const glm::dvec2 corner = glm::floor(texel - 0.5) + 1.0, part = texel - corner;
    if (std::abs(std::abs(part.x) - 0.5) < 1e-3 || std::abs(std::abs(part.y) - 0.5) < 1e-3) return {};
    if (corner.x < 1 || corner.y < 1 || corner.x > map.side - 1 || corner.y > map.side - 1) return {};
    const double dx = depthAt(corner + glm::dvec2(0.5, 0.5)) - depthAt(corner + glm::dvec2(-0.5, 0.5));
    const double dy = depthAt(corner + glm::dvec2(0.5, 0.5)) - depthAt(corner + glm::dvec2(0.5, -0.5));
    const double slack = double(gpu::DEPTH_ROUNDING) + double(gpu::SNAP_TEXELS) * (std::abs(dx) + std::abs(dy));
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
        const glm::dvec2 centre = corner + glm::dvec2(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5);
        const double stored = map.depth[0][std::size_t(centre.y) * map.side + std::size_t(centre.x)];
        const double difference = std::min(depthAt(centre) - slack, 1.0) - stored;
        if (difference != 0.0 && std::abs(difference) < 1e-6) return {};
        const glm::dvec2 weight = 1.0 - glm::abs(texel - centre);
        sum += difference <= 0.0 ? weight.x * weight.y : 0.0;
    }
    return sum == 0.0 || sum > 1.0 - 1e-9;
}

struct Asking {
    const World& world;
    const DrawnMap& map;
    const LightView& light;
    const gpu::MapConstants& constants;
    const ChainScene& scene;
    const Receivers& receivers;
};

Pixel pixelAt(const Asking& asking, std::uint32_t x, std::uint32_t y)
{
    Pixel p;
    ShadowRay ray;
    Receiver receiver;
    p.asked = asking.receivers.at(x, y, ray, receiver);
    p.lit = p.asked != Asked::dark;
    if (p.asked != Asked::ray) return p;
    const MapTexels texels(asking.scene.map, asking.constants, asking.scene.cube, receiver);
    p.lit = texels.agree(true, TexelBlock::own);
    p.agree4 = texels.agree(p.lit, TexelBlock::four);
    p.agree9 = texels.agree(p.lit, TexelBlock::nine);
    p.own = blockBlocks(asking.scene, texels, TexelBlock::own, ray);
    p.four = blockBlocks(asking.scene, texels, TexelBlock::four, ray);
    p.nine = blockBlocks(asking.scene, texels, TexelBlock::nine, ray);
    p.edges = ringBlocks(asking.scene, texels, 2, true, ray);
    p.vertices = ringBlocks(asking.scene, texels, 1, true, ray);
    p.votes = chainVotes(asking.scene, p.lit, true, texels, ray);
    for (std::size_t i = 0; i < std::size(kModes); ++i)
        p.reason[i] = chainReason(asking.scene, stagesOf(kModes[i]), p.lit, true, texels, ray);
    p.unfiltered = unfilteredAt(asking.world, asking.map, asking.light, asking.constants, receiver);
    std::uint8_t occluded = 0;
    asking.world.rays.occluded({&ray, 1}, 1u, {&occluded, 1});
    p.blocked = occluded != 0;
    return p;
}

std::vector<Pixel> pixelsOf(const World& world, const LightView& light, std::uint32_t side)
{
    const DrawnMap map = drawMap(light, world.pointers, side);
    ShadowTask task;
    task.view = &world.seen.view;
    task.light = &light;
    gpu::MapConstants constants = mapConstants(task, side, 1);
    addLightProjection(constants, map.fits, task);
    FrameArena arena;
    RingsCache rings;
    const NumberedTriangles triangles(world.pointers, &rings, arena);
    for (const NumberedTriangles::Entry& entry : triangles.entries()) {
        entry.rings->rings.build(*entry.caster->mesh->topology);
        entry.rings->built = true;
    }
    CandidateOccluders candidates(triangles);
    const HostMap host = map.view();
    const ChainScene scene{host, constants, light.type == GN_LIGHT_TYPE_POINT, candidates};
    const Receivers receivers(world.seen.view, light, world.seen.depth, world.seen.normalBytes());
    const Asking asking{world, map, light, constants, scene, receivers};
    std::vector<Pixel> pixels;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x)
            pixels.push_back(pixelAt(asking, x, y));
    return pixels;
}

/// Pixels of a contour of 2, 4 or 6.
std::vector<bool> contourOf(const std::vector<Pixel>& pixels, std::uint32_t width)
{
    std::vector<std::uint64_t> words(BitRows::wordsPerRow(kWidth) * kHeight), row(BitRows::wordsPerRow(kWidth));
    const BitRows lit{kWidth, kHeight, words};
    std::vector<std::uint8_t> bytes(kWidth);
    for (std::uint32_t y = 0; y < kHeight; ++y) {
        for (std::uint32_t x = 0; x < kWidth; ++x)
            bytes[x] = pixels[y * kWidth + x].lit ? 255 : 0;
        packBits(bytes, lit.row(y));
    }
    std::vector<bool> contour;
    for (std::uint32_t y = 0; y < kHeight; ++y) {
        contourRow(lit, y, (width - 1) / 2, row);
        for (std::uint32_t x = 0; x < kWidth; ++x)
            contour.push_back((row[x / 64] >> (x % 64) & 1) != 0);
    }
    return contour;
}

struct Lamp {
    const char* name;
    LightView view;
};
std::vector<Lamp> lamps()
{
    return {{"directional", makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.4, -1.0, -0.3}, 0.0, 0.0).view},
            {"spot", makeLight(GN_LIGHT_TYPE_SPOT, {2, 12, 6}, {-0.2, -1, -0.5}, 40, 0.6).view},
            {"point", makeLight(GN_LIGHT_TYPE_POINT, {1, 3.2, 3}, {0, -1, 0}, 25, 0.0).view}};
}

/// Calls check(pixels) for all lamps and two sizes of map.
template <typename Check>
void forAllMaps(Check&& check)
{
    static const World world;
    static std::vector<std::pair<std::string, std::vector<Pixel>>> all;
    if (all.empty())
        for (const Lamp& lamp : lamps())
            for (const std::uint32_t side : {64u, 192u})
                all.emplace_back(std::string(lamp.name) + " " + std::to_string(side), pixelsOf(world, lamp.view, side));
    for (const auto& entry : all) {
        const std::string& name = entry.first;
        CAPTURE(name);
        check(entry.second);
    }
}

template <typename Holds>
int count(const std::vector<Pixel>& pixels, Holds&& holds)
{
    return static_cast<int>(std::count_if(pixels.begin(), pixels.end(), holds));
}

bool anyCandidate(const Pixel& p)
{
    return p.own || p.four || p.nine || p.edges || p.vertices;
}

} // namespace

TEST_CASE("A1: no pixel that the tracer calls lit has a candidate occluder")
{
    forAllMaps([](const std::vector<Pixel>& pixels) {
        CHECK(count(pixels, [](const Pixel& p) { return anyCandidate(p) && !p.blocked; }) == 0);
        const int dark = count(pixels, [](const Pixel& p) { return p.blocked && !p.lit; });
        const int proved = count(pixels, [](const Pixel& p) { return p.blocked && !p.lit && p.vertices; });
        const int fixed = count(pixels, [](const Pixel& p) { return p.blocked && p.lit && p.nine; });
        MESSAGE("of " << dark << " dark pixels that the map has dark, proved " << proved << "; lit ones put right "
                      << fixed);
        CHECK(dark > 500);
        CHECK(proved > dark * 7 / 10); // Moderno: 86 to 100 % (his table 11), with texels of a tenth the size
        CHECK(fixed > 0);
    });
}

TEST_CASE("A2: more texels and wider rings have all the candidate occluders of fewer")
{
    int four = 0, nine = 0, edges = 0, vertices = 0;
    forAllMaps([&](const std::vector<Pixel>& pixels) {
        CHECK(count(pixels, [](const Pixel& p) { return p.own && !p.four; }) == 0);
        CHECK(count(pixels, [](const Pixel& p) { return p.four && !p.nine; }) == 0);
        CHECK(count(pixels, [](const Pixel& p) { return p.own && !p.edges; }) == 0);
        CHECK(count(pixels, [](const Pixel& p) { return p.edges && !p.vertices; }) == 0);
        four += count(pixels, [](const Pixel& p) { return p.four && !p.own; });
        nine += count(pixels, [](const Pixel& p) { return p.nine && !p.four; });
        edges += count(pixels, [](const Pixel& p) { return p.edges && !p.own; });
        vertices += count(pixels, [](const Pixel& p) { return p.vertices && !p.edges; });
    });
    // And each step finds more.
    CHECK(four > 20);
    CHECK(nine > 20);
    CHECK(edges > 20);
    CHECK(vertices > 0);
}

TEST_CASE("A3: where nine texels agree four do, and are wrong no more often")
{
    forAllMaps([](const std::vector<Pixel>& pixels) {
        const auto wrong = [](const Pixel& p) { return p.asked == Asked::ray && p.lit == p.blocked; };
        CHECK(count(pixels, [](const Pixel& p) { return p.agree9 && !p.agree4; }) == 0);
        CHECK(count(pixels, [&](const Pixel& p) { return p.agree9 && wrong(p) && !(p.agree4 && wrong(p)); }) == 0);
        CHECK(count(pixels, [](const Pixel& p) { return p.agree4 && !p.agree9; }) > 0);
    });
}

TEST_CASE("A4: contours of 2, 4 and 6 pixels lie in each other")
{
    forAllMaps([](const std::vector<Pixel>& pixels) {
        const std::vector<bool> two = contourOf(pixels, 2), four = contourOf(pixels, 4), six = contourOf(pixels, 6);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            CHECK((!two[i] || four[i]));
            CHECK((!four[i] || six[i]));
        }
        const auto size = [](const std::vector<bool>& set) { return std::count(set.begin(), set.end(), true); };
        CHECK(size(two) < size(four));
        CHECK(size(four) < size(six));
    });
}

TEST_CASE("A5: the chain leaves exactly what its stages leave, in every contour")
{
    forAllMaps([](const std::vector<Pixel>& pixels) {
        for (const std::uint32_t width : {2u, 4u, 6u}) {
            const std::vector<bool> contour = contourOf(pixels, width);
            int asked = 0, hinted = 0, corrected = 0, confirmed = 0, left = 0, leftByChain = 0;
            int wrongIfLit = 0, wrongLit = 0, wrongHints = 0, unproved = 0;
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                const Pixel& p = pixels[i];
                if (!contour[i] || p.asked != Asked::ray) continue;
                const bool settled = p.agree4 || p.nine || (!p.lit && p.vertices);
                ++asked;
                hinted += p.agree4;
                corrected += !p.agree4 && p.lit && p.nine;
                confirmed += !p.agree4 && !p.lit && (p.nine || p.vertices);
                left += !settled;
                leftByChain += p.reason[0] == gpu::REASON_RT_LIT;
                // What no rays cost, by the thesis's identity.
                wrongIfLit += isLit(p.reason[4]) != p.truthLit();
                wrongHints += p.agree4 && p.lit != p.truthLit();
                wrongLit += !p.agree4 && p.lit && p.blocked && !p.nine;
                unproved += !p.agree4 && !p.lit && p.blocked && !p.nine && !p.vertices;
            }
            CHECK(left == asked - hinted - corrected - confirmed);
            CHECK(leftByChain == left);
            CHECK(wrongIfLit == wrongHints + wrongLit + unproved);
        }
    });
}

TEST_CASE("A6: with rays the chain is wrong in its contour exactly where agreeing texels are, and strict nowhere")
{
    forAllMaps([](const std::vector<Pixel>& pixels) {
        const std::vector<bool> contour = contourOf(pixels, 4);
        int wrong[5] = {}, hints[5] = {}, anywhere = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const Pixel& p = pixels[i];
            if (p.asked != Asked::ray) continue;
            for (std::size_t mode = 0; mode < 4; ++mode) {
                const std::uint32_t reason = p.reason[mode];
                const bool lit = reason == gpu::REASON_RT_LIT ? !p.blocked : isLit(reason);
                if (mode == 3) anywhere += lit != p.truthLit();
                if (!contour[i]) continue;
                wrong[mode] += lit != p.truthLit();
                hints[mode] += (reason == gpu::REASON_TC_LIT || reason == gpu::REASON_TC_SHADOW) && lit != p.truthLit();
            }
        }
        for (std::size_t mode = 0; mode < 4; ++mode)
            CHECK(wrong[mode] == hints[mode]);
        CHECK(wrong[3] == 0);
        CHECK(anywhere == 0);
        CHECK(wrong[2] <= wrong[0]); // only hints that say lit
    });
}

TEST_CASE("A7: four texels agree exactly where a bilinear filter of their comparisons gives 0 or 1")
{
    forAllMaps([](const std::vector<Pixel>& pixels) {
        const int asked = count(pixels, [](const Pixel& p) { return p.unfiltered.has_value(); });
        const int mixed = count(pixels, [](const Pixel& p) { return p.unfiltered && !*p.unfiltered; });
        const int differ = count(pixels, [](const Pixel& p) { return p.unfiltered && *p.unfiltered != p.agree4; });
        MESSAGE("asked " << asked << ", between 0 and 1 " << mixed << ", differ " << differ);
        CHECK(differ == 0);
        if (asked > 0) CHECK(mixed > 100);
    });
}

TEST_CASE("votes are what each stage says by itself")
{
    forAllMaps([](const std::vector<Pixel>& pixels) {
        int differ = 0;
        for (const Pixel& p : pixels) {
            if (p.asked != Asked::ray) continue;
            const std::pair<std::uint32_t, bool> bits[] = {{gpu::VOTE_LIT, p.lit},    {gpu::VOTE_TC4, p.agree4},
                                                           {gpu::VOTE_TC9, p.agree9}, {gpu::VOTE_ST, p.own},
                                                           {gpu::VOTE_NB4, p.four},   {gpu::VOTE_NB9, p.nine},
                                                           {gpu::VOTE_AG1, p.edges},  {gpu::VOTE_AG2, p.vertices}};
            for (const auto& [bit, said] : bits)
                differ += ((p.votes & bit) != 0) != said;
        }
        CHECK(differ == 0);
    });
}
