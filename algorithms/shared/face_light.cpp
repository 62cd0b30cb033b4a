#include "algorithms/shared/face_light.hpp"

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

/// A face in the world, in double precision.
struct WorldFace {
    glm::dvec3 normal{0.0}; ///< Unit, of its winding; zero: it has no area.
    glm::dvec3 corners[3];
};

WorldFace worldFace(const Caster& caster, std::uint32_t face)
{
    const glm::dmat3 basis(caster.basis);
    const std::uint32_t* v = &caster.mesh->topology->faceVerts[3 * std::size_t{face}];
    WorldFace result;
    for (int i = 0; i < 3; ++i)
        result.corners[i] = basis * glm::dvec3(caster.mesh->positions[v[i]]) + glm::dvec3(caster.translation);
    const glm::dvec3 normal = glm::cross(result.corners[1] - result.corners[0], result.corners[2] - result.corners[0]);
    const double length = glm::length(normal);
    if (length > 0.0) result.normal = normal / length;
    return result;
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
    result.touched = touchedWay(closed, caster.mirrored);
    return result;
}

bool touchesAny(const FaceBlock& block, const gpu::FaceLight& light)
{
    int touched = 0;
    for (std::uint32_t i = 0; i < kBlockFaces; ++i)
        touched |= gpu::touchesLight(glm::vec4(block.x[i], block.y[i], block.z[i], block.w[i]), light);
    return touched != 0;
}

bool mayTouch(const LightView& light, const Caster& caster)
{
    return touchAt(light, caster) > 0.0 && !caster.hostDrawn && !caster.gpuPlaced && caster.mesh &&
           caster.mesh->topology;
}

bool isAtLight(const LightView& light, const Caster& caster, std::uint32_t face)
{
    const double touch = touchAt(light, caster);
    const WorldFace at = worldFace(caster, face);
    const glm::dvec3 position(light.position());
    if (at.normal == glm::dvec3(0.0) || std::abs(glm::dot(at.normal, position - at.corners[0])) > touch) return false;
    const glm::dvec3 lower = glm::min(at.corners[0], glm::min(at.corners[1], at.corners[2]));
    const glm::dvec3 upper = glm::max(at.corners[0], glm::max(at.corners[1], at.corners[2]));
    const glm::dvec3 outside = glm::max(lower - position, position - upper), size = upper - lower;
    // A little around it: as seen from a light so near its plane, what begins a thousandth of its size away is a line.
    return std::max({outside.x, outside.y, outside.z}) <= touch + 1e-3 * std::max({size.x, size.y, size.z});
}

namespace {

/// @pre mayTouch(), and the faces that are chosen are those of closed surfaces
template <typename Chosen>
glm::vec3 awayFromFaces(const LightView& light, const Caster& caster, const Chosen& chosen)
{
    glm::dvec3 away(0.0);
    const double touch = touchAt(light, caster);
    forFacesAtLight(light, caster, [&](std::uint32_t face) {
        if (!chosen(face)) return;
        const WorldFace at = worldFace(caster, face);
        // The winding's side is that which light enters by; mirroring turns a closed mesh inside out.
        const glm::dvec3 outwards = caster.mirrored ? -at.normal : at.normal;
        const double before = glm::dot(outwards, glm::dvec3(light.position()) - at.corners[0] - away);
        away -= std::max(2.0 * touch - before, 0.0) * outwards;
    });
    return glm::vec3(away);
}

} // namespace

glm::vec3 awayFromLight(const LightView& light, const Caster& caster)
{
    if (!caster.closed || !mayTouch(light, caster)) return glm::vec3(0.0f);
    return awayFromFaces(light, caster, [](std::uint32_t) { return true; });
}

glm::vec3 awayFromLight(const LightView& light, const Caster& caster, std::uint32_t cluster)
{
    if (!mayTouch(light, caster)) return glm::vec3(0.0f);
    const Topology& topology = *caster.mesh->topology;
    const Topology::Cluster& own = topology.clusters[cluster];
    const Aabb bounds = transformed(own.bounds, caster.basis, caster.translation);
    const glm::vec3 outside = glm::max(bounds.lower - light.position(), light.position() - bounds.upper);
    if (std::max({outside.x, outside.y, outside.z}) > touchAt(light, caster)) return glm::vec3(0.0f); // nearly all
    return awayFromFaces(light, caster, [&](std::uint32_t face) { return &topology.clusterOf(face) == &own; });
}

} // namespace gnomon
