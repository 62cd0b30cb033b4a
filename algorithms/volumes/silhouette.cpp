#include "algorithms/volumes/silhouette.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "algorithms/volumes/facing.hpp"

namespace gnomon {

namespace {

/// Transposed cofactors: adjugate(m) * m = determinant(m) * 1.
glm::dmat3 adjugate(const glm::dmat3& m)
{
    const glm::dvec3 row0 = glm::cross(m[1], m[2]), row1 = glm::cross(m[2], m[0]), row2 = glm::cross(m[0], m[1]);
    return glm::transpose(glm::dmat3(row0, row1, row2));
}

/// The signed multiplicity: +1 per face that, turned towards the light, runs v0 -> v1, -1 per face that runs v1 -> v0.
int multiplicity(const Topology& topology, const Topology::Edge& edge, const std::uint8_t* facing)
{
    int sum = 0;
    for (std::uint32_t i = 0; i < edge.useCount; ++i) {
        const Topology::EdgeUse& use = topology.uses[edge.firstUse + i];
        sum += (facing[use.face] != 0) == (use.sign > 0.0f) ? 1 : -1;
    }
    return sum;
}

// Silhouettes found at a time: a few kilobytes beside the edges they come from.
constexpr std::uint32_t kChunk = 512;

std::uint32_t* writeQuad(std::uint32_t a, std::uint32_t b, std::uint32_t* out)
{
    // The face lies left of a -> b seen from the light, the outside to the right.
    const std::uint32_t nearA = 2 * a, farA = 2 * a + 1, nearB = 2 * b, farB = 2 * b + 1;
    const std::uint32_t corners[6] = {nearA, farA, farB, nearA, farB, nearB};
    return std::copy_n(corners, 6, out);
}

} // namespace

bool castsVolume(const Caster& caster)
{
    return caster.mesh && caster.mesh->topology && !caster.hostDrawn && !caster.alphaTested &&
           !caster.mesh->topology->edges.empty();
}

glm::vec4 lightInObjectSpace(const LightView& light, const Caster& caster)
{
    // Inverse transform times determinant: plane tests see its sign only, and the determinant's own sign is what turns
    // the winding of mirrored casters.
    const glm::dmat3 basis(caster.basis);
    const glm::dmat3 inverse = adjugate(basis);
    glm::dvec4 os;
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        os = glm::dvec4(inverse * -glm::dvec3(light.direction()), 0.0);
    } else {
        const glm::dvec3 fromCaster = glm::dvec3(light.position()) - glm::dvec3(caster.translation);
        os = glm::dvec4(inverse * fromCaster, glm::dot(basis[0], glm::cross(basis[1], basis[2])));
    }
    const double largest = std::max({std::abs(os.x), std::abs(os.y), std::abs(os.z), std::abs(os.w)});
    return largest > 0.0 ? glm::vec4(os / largest) : glm::vec4(0.0f);
}

void findFacing(const Topology& topology, const glm::vec4& lightOs, std::uint32_t first, std::span<std::uint8_t> facing)
{
    static const FacingWidth widest = widestFacing();
    findFacing(widest, topology.facePlanes, lightOs, first, facing);
}

std::uint32_t sideCapacity(const Topology& topology, std::uint32_t firstEdge, std::uint32_t count)
{
    if (count == 0) return 0;
    const Topology::Edge& last = topology.edges[firstEdge + count - 1];
    const std::uint32_t uses = last.firstUse + last.useCount - topology.edges[firstEdge].firstUse;
    return 6 * (topology.closed ? uses / 2 : uses);
}

std::uint32_t findSilhouette(const Topology& topology, std::span<const std::uint8_t> facing, std::uint32_t firstEdge,
                             std::uint32_t count, SilhouetteEdge* out)
{
    SilhouetteEdge* end = out;
    for (const Topology::Edge& edge : std::span(topology.edges).subspan(firstEdge, count)) {
        const int sum = multiplicity(topology, edge, facing.data());
        if (sum == 0) continue;
        const auto times = static_cast<std::uint32_t>(std::abs(sum)) / (topology.closed ? 2 : 1); // closed: always even
        *end++ = {sum > 0 ? edge.v0 : edge.v1, sum > 0 ? edge.v1 : edge.v0, times};
    }
    return static_cast<std::uint32_t>(end - out);
}

std::uint32_t writeSides(std::span<const SilhouetteEdge> edges, std::uint32_t* out)
{
    std::uint32_t* end = out;
    for (const SilhouetteEdge& edge : edges)
        for (std::uint32_t i = 0; i < edge.times; ++i)
            end = writeQuad(edge.from, edge.to, end);
    return static_cast<std::uint32_t>(end - out);
}

std::uint32_t writeSides(const Topology& topology, std::span<const std::uint8_t> facing, std::uint32_t firstEdge,
                         std::uint32_t count, std::uint32_t* out)
{
    std::uint32_t written = 0;
    SilhouetteEdge found[kChunk];
    for (std::uint32_t done = 0; done < count; done += kChunk) {
        const std::uint32_t edges =
            findSilhouette(topology, facing, firstEdge + done, std::min(kChunk, count - done), found);
        written += writeSides(std::span(found, edges), out + written);
    }
    return written;
}

std::uint32_t writeCaps(const Topology& topology, std::span<const std::uint8_t> facing, bool mirrored,
                        std::uint32_t firstFace, std::uint32_t count, std::uint32_t* out)
{
    std::uint32_t* end = out;
    for (std::uint32_t face = firstFace; face < firstFace + count; ++face) {
        if (!blocksLight(topology, facing[face], mirrored)) continue;
        const std::uint32_t* corner = &topology.faceVerts[3 * face];
        const std::uint32_t a = 2 * corner[0];
        const std::uint32_t b = 2 * corner[facing[face] ? 1 : 2], c = 2 * corner[facing[face] ? 2 : 1];
        const std::uint32_t corners[6] = {a, b, c, a + 1, c + 1, b + 1};
        end = std::copy_n(corners, 6, end);
    }
    return static_cast<std::uint32_t>(end - out);
}

} // namespace gnomon
