#include "algorithms/common/face_light.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "runtime/scene/light_fit.hpp"

namespace gnomon {

namespace {

/// Transposed cofactors: adjugate(m) * m = determinant(m) * 1.
glm::dmat3 adjugate(const glm::dmat3& m)
{
    const glm::dvec3 row0 = glm::cross(m[1], m[2]), row1 = glm::cross(m[2], m[0]), row2 = glm::cross(m[0], m[1]);
    return glm::transpose(glm::dmat3(row0, row1, row2));
}

/// touchingDistance() at a caster, metres; 0: the light is out of reach of any of its faces.
double touchAt(const LightView& light, const Caster& caster)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return 0.0;
    const glm::vec3 lower = caster.bounds.lower, upper = caster.bounds.upper;
    const glm::vec3 far = glm::max(glm::abs(lower), glm::abs(upper));
    const double touch = touchingDistance(light, static_cast<double>(std::max({far.x, far.y, far.z})));
    const glm::vec3 outside = glm::max(lower - light.position(), light.position() - upper);
    return static_cast<double>(std::max({outside.x, outside.y, outside.z})) <= touch ? touch : 0.0;
}

/// Whether the light is within the bounds of a face, and a little around them.
bool isBeside(const glm::dvec3& light, const Topology& topology, std::span<const glm::vec3> positions, std::size_t face)
{
    const std::uint32_t* v = &topology.faceVerts[3 * face];
    const glm::vec3 a = positions[v[0]], b = positions[v[1]], c = positions[v[2]];
    const glm::dvec3 lower(glm::min(a, glm::min(b, c))), upper(glm::max(a, glm::max(b, c)));
    const glm::dvec3 outside = glm::max(lower - light, light - upper), size = upper - lower;
    return std::max({outside.x, outside.y, outside.z}) <= 1e-3 * std::max({size.x, size.y, size.z});
}

} // namespace

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
    // How far `at` moves along any normal, at most, when the light moves that far in the world: exact, but for a factor
    // of root 3, where the transform scales evenly.
    double square = 0.0;
    for (int column = 0; column < 3; ++column)
        square += glm::dot(inverse[column], inverse[column]);
    const double touch = touchAt(light, caster) / largest;
    result.touch = static_cast<float>(square * touch * touch);
    const bool closed = caster.mesh && caster.mesh->topology && caster.mesh->topology->closed;
    result.touched = !closed ? gpu::FACE_TOUCHED : caster.mirrored ? gpu::FACE_AWAY : gpu::FACE_TOWARDS;
    return result;
}

bool touchesAny(const FaceBlock& block, const gpu::FaceLight& light)
{
    int touched = 0;
    for (std::uint32_t i = 0; i < kBlockFaces; ++i)
        touched |= gpu::touchesLight(glm::vec4(block.x[i], block.y[i], block.z[i], block.w[i]), light);
    return touched != 0;
}

glm::vec3 awayFromLight(const LightView& light, const Caster& caster)
{
    const double touch = touchAt(light, caster);
    if (touch == 0.0 || caster.hostDrawn || !caster.mesh || !caster.mesh->topology) return glm::vec3(0.0f);
    const Topology& topology = *caster.mesh->topology;
    const gpu::FaceLight inObject = lightInObjectSpace(light, caster);
    if (inObject.at.w == 0.0f) return glm::vec3(0.0f); // flattened: faces have no side
    const glm::dvec3 lightOs = glm::dvec3(inObject.at) / static_cast<double>(inObject.at.w);
    const glm::dmat3 cofactors = glm::transpose(adjugate(glm::dmat3(caster.basis)));
    // The side that light enters by: mirroring turns a closed mesh inside out.
    const double outwards = topology.closed && caster.mirrored ? -1.0 : 1.0;
    const std::span<const glm::vec3> positions = caster.mesh->positions;
    glm::dvec3 away(0.0);
    const auto faces = static_cast<std::uint32_t>(topology.facePlanes.size());
    forTouchedFaces(topology.facePlanes, inObject, 0, faces, [&](std::uint32_t face) {
        if (!isBeside(lightOs, topology, positions, face)) return;
        const glm::dvec3 normal = outwards * cofactors * glm::dvec3(topology.facePlanes[face]);
        const double length = glm::length(normal);
        if (!(length > 0.0)) return;
        const glm::dvec3 n = normal / length;
        const glm::dvec3 corner = glm::dmat3(caster.basis) * glm::dvec3(positions[topology.faceVerts[3 * face]]) +
                                  glm::dvec3(caster.translation);
        const double before =
            glm::dot(n, glm::dvec3(light.position()) - corner - away); // of the light, where it is now
        away -= std::max(2.0 * touch - before, 0.0) * n;
    });
    return glm::vec3(away);
}

} // namespace gnomon
