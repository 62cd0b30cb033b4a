#include "algorithms/omni/tessellation.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "algorithms/shared/face_light.hpp"

namespace gnomon {

namespace {

// An edge that runs past the light at hardly any distance spans half a turn however often it is cut: halving ends after
// as many levels as take an edge of a kilometre down to a millimetre.
constexpr int kMaxCuts = 20;
// Pieces of all casters, beyond which none is cut any more: a triangle of 1000 m by 1 cm, 1 cm off the light, would be
// cut into 53 million at 1024 texels.
constexpr std::size_t kMostPieces = std::size_t{1} << 20;

class Cutter {
public:
    Cutter(const LightView& light, float angle, FineMesh& out)
        : source_(light), light_(light.position()), cosine2_(std::cos(angle) * std::cos(angle)), out_(out)
    {
    }

    void caster(const Caster& caster)
    {
        const MeshView& mesh = *caster.mesh;
        const std::uint32_t base = static_cast<std::uint32_t>(out_.vertices.size());
        const glm::vec3 place = caster.translation + awayFromLight(source_, caster);
        for (glm::vec3 p : mesh.positions)
            out_.vertices.push_back(caster.basis * p + place);
        forDrawnParts(source_, caster, [&](const DrawnPart& part) {
            const std::uint32_t end = part.firstFace + std::min(part.faceCount, mesh.triangleCount() - part.firstFace);
            for (std::uint32_t face = part.firstFace; face < end; ++face)
                cut(mesh.indices.subspan(3 * std::size_t{face}, 3), base, caster.mirrored);
        });
    }

private:
    void cut(std::span<const std::uint32_t> corners, std::uint32_t base, bool mirrored)
    {
        triangle(base + corners[0], base + corners[mirrored ? 2 : 1], base + corners[mirrored ? 1 : 2], kMaxCuts);
    }

    bool tooWide(std::uint32_t a, std::uint32_t b) const
    {
        const glm::vec3 u = out_.vertices[a] - light_, v = out_.vertices[b] - light_;
        // Squared to save the roots; the cosine is positive (15 degrees at most). Both neighbours must agree: the
        // product of the lengths is rounded alike whichever end comes first.
        const float uv = glm::dot(u, v);
        return uv <= 0.0f || uv * uv < cosine2_ * (glm::dot(u, u) * glm::dot(v, v));
    }

    std::uint32_t middle(std::uint32_t a, std::uint32_t b)
    {
        out_.vertices.push_back(0.5f * (out_.vertices[a] + out_.vertices[b]));
        return static_cast<std::uint32_t>(out_.vertices.size() - 1);
    }

    /// What is cut no more. Spanning more than a right angle, it would lie over the disc of the half that it is not in,
    /// before everything.
    void last(std::uint32_t a, std::uint32_t b, std::uint32_t c)
    {
        const glm::vec3 u = out_.vertices[a] - light_, v = out_.vertices[b] - light_, w = out_.vertices[c] - light_;
        if (glm::dot(u, v) > 0.0f && glm::dot(v, w) > 0.0f && glm::dot(w, u) > 0.0f)
            out_.indices.insert(out_.indices.end(), {a, b, c});
    }

    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, int cuts)
    {
        if (cuts == 0 || out_.indices.size() >= 3 * kMostPieces) {
            last(a, b, c);
            return;
        }
        const bool ab = tooWide(a, b), bc = tooWide(b, c), ca = tooWide(c, a);
        const int wide = ab + bc + ca;
        if (wide == 0) {
            out_.indices.insert(out_.indices.end(), {a, b, c});
            return;
        }
        if (wide == 3) {
            const std::uint32_t x = middle(a, b), y = middle(b, c), z = middle(c, a);
            triangle(a, x, z, cuts - 1);
            triangle(x, b, y, cuts - 1);
            triangle(z, y, c, cuts - 1);
            triangle(x, y, z, cuts - 1);
            return;
        }
        // Turned so that the first edge is cut, and with two cuts the second one too.
        if (!ab || (wide == 2 && !bc)) {
            triangle(b, c, a, cuts);
            return;
        }
        const std::uint32_t x = middle(a, b);
        if (wide == 1) {
            triangle(a, x, c, cuts - 1);
            triangle(x, b, c, cuts - 1);
            return;
        }
        const std::uint32_t y = middle(b, c);
        triangle(x, b, y, cuts - 1);
        triangle(a, x, y, cuts - 1);
        triangle(a, y, c, cuts - 1);
    }

    const LightView& source_;
    glm::vec3 light_;
    float cosine2_;
    FineMesh& out_;
};

} // namespace

float maxEdgeAngle(std::uint32_t resolution)
{
    return std::fmin(2.0f / std::sqrt(static_cast<float>(resolution)), 0.2617994f); // 15 degrees
}

bool fineEnough(const Caster& caster, glm::vec3 light, float angle)
{
    // A chord of length e whose nearest point is at distance d or more spans at most 2 atan(e / 2d) < e / d.
    return !caster.mesh || !touches(caster.bounds, light, caster.longestEdge / angle);
}

void FineMesh::clear()
{
    vertices.clear();
    indices.clear();
    closedIndices = 0;
}

void cutToAngle(std::span<const Caster* const> casters, const LightView& light, float angle, FineMesh& out)
{
    out.clear();
    Cutter cutter(light, angle, out);
    for (const bool closed : {true, false}) {
        for (const Caster* caster : casters)
            if (caster->mesh && caster->closed == closed) cutter.caster(*caster);
        if (closed) out.closedIndices = static_cast<std::uint32_t>(out.indices.size());
    }
}

} // namespace gnomon
