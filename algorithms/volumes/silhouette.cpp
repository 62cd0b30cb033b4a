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

/// How near a light is to the plane of a face that it touches, as a share of the largest coordinate of light or caster:
/// a few units in the last place of positions, and of where transforms put them. As much as the share of coordinates in
/// the offset at which rays end before the light (shaders/shared/receiver.h).
constexpr double kTouch = 0x1p-21;

/// Squared, in units of FaceLight::at per length of a face's normal. 0: the light is out of reach of any face.
float touchOf(const LightView& light, const Caster& caster, const glm::dmat3& inverse, double largest)
{
    const glm::vec3 far = glm::max(glm::abs(caster.bounds.lower), glm::abs(caster.bounds.upper));
    const glm::vec3 sizes = glm::max(far, glm::abs(light.position()));
    const double touch = kTouch * std::max({sizes.x, sizes.y, sizes.z});
    const glm::dvec3 outside =
        glm::max(glm::dvec3(caster.bounds.lower - light.position()), glm::dvec3(light.position() - caster.bounds.upper));
    if (std::max({outside.x, outside.y, outside.z}) > touch) return 0.0f;
    // At most: how far `at` moves along any normal when the light moves that far. Exact, but for a factor of root 3, where
    // the transform scales evenly.
    double square = 0.0;
    for (int column = 0; column < 3; ++column)
        square += glm::dot(inverse[column], inverse[column]);
    return static_cast<float>(square * (touch / largest) * (touch / largest));
}

/// The signed multiplicity: +1 per face that, turned towards the light, runs v0 -> v1, -1 per face that runs v1 -> v0.
int multiplicity(const Topology& topology, const Topology::Edge& edge, const std::uint8_t* facing)
{
    int sum = 0;
    for (std::uint32_t i = 0; i < edge.useCount; ++i) {
        const Topology::EdgeUse& use = topology.uses[edge.firstUse + i];
        sum += gpu::edgeWay(facing[use.face], use.sign > 0.0f);
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

gpu::FaceLight lightInObjectSpace(const LightView& light, const Caster& caster)
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
    if (!(largest > 0.0)) return {};
    gpu::FaceLight result{.at = glm::vec4(os / largest)};
    if (light.type != GN_LIGHT_TYPE_DIRECTIONAL) result.touch = touchOf(light, caster, inverse, largest);
    const bool closed = caster.mesh && caster.mesh->topology && caster.mesh->topology->closed;
    if (closed)
        result.touched = caster.mirrored ? gpu::FACE_AWAY : gpu::FACE_TOWARDS; // where light enters
    else
        result.touched = gpu::FACE_TOUCHED;
    return result;
}

void findFacing(const Topology& topology, const gpu::FaceLight& light, std::uint32_t first,
                std::span<std::uint8_t> facing)
{
    static const FacingWidth widest = widestFacing();
    findFacing(widest, topology.facePlanes, light.at, first, facing);
    if (!(light.touch > 0.0f)) return;
    for (std::uint32_t i = 0; i < facing.size(); ++i)
        if (gpu::touchesLight(topology.facePlanes[first + i], light)) facing[i] = static_cast<std::uint8_t>(light.touched);
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
