#pragma once
// One caster as the light sees it, in rows: which stretches of a row it covers, and from which distance on. Thakur's
// angular spans; plain CPU code without Vulkan.
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/arena.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// A place as a light sees it.
struct SpanPoint {
    float theta; ///< Picks the row. Radians round the pole, (-pi, pi]; directional: metres across.
    float phi;   ///< Along the row. Slope towards the pole, -inf to inf; directional: metres across.
    float r;     ///< Metres from the light; directional: metres along it, of either sign.
};

/// Coordinates round a light: its place, and a pole that lies across a spot's axis.
class SpanSpace {
public:
    SpanSpace() = default;
    explicit SpanSpace(const LightView& light);

    bool round() const { return round_; } ///< theta is an angle and comes back to itself.
    /// Rows beyond +-limit of theta are never asked for: the cone of a spot.
    double thetaLimit() const { return thetaLimit_; }

    glm::dvec3 local(const glm::dvec3& world) const { return (world - origin_) * axes_; }
    glm::vec3 local(const glm::vec3& world) const { return (world - originFloat_) * axesFloat_; }
    /// @param p as local() gives it.
    SpanPoint at(const glm::vec3& p) const;

private:
    glm::dvec3 origin_{0.0};
    glm::dmat3 axes_{
        1.0}; ///< Columns: towards theta = 0, theta = 90 degrees, the pole; directional: two across, along.
    glm::vec3 originFloat_{0.0f};
    glm::mat3 axesFloat_{1.0f};
    double thetaLimit_ = 0.0;
    bool round_ = true;
};

/// What a table says of a receiver.
enum class SpanAnswer : std::uint8_t {
    lit,
    dark,
    beyondOpen, ///< Behind the plane of a face of an open mesh: that face, or one beside it, may be the receiver's own.
};

/// A caster's table: `rows` rows over the theta it covers.
class CasterSpans {
public:
    /// A maximal stretch of a row that faces cover.
    struct Span {
        float first, last;       ///< Phi.
        float nearest, farthest; ///< Bounds of r over its faces: in front of the one is lit, behind the other dark.
        std::uint32_t piece, pieceCount;
    };
    /// What a row cuts out of one face.
    struct Piece {
        float first, last; ///< Phi.
        float reach;       ///< Largest `last` of the span's pieces up to here.
        std::uint32_t plane;
    };
    /// Where the last answer of a scan line came from. Holds while row and stretch stay.
    struct Cursor {
        std::uint32_t row = UINT32_MAX;
        float first = 0.0f, last = 0.0f; ///< Phi between which `span` is the answer.
        const Span* span = nullptr;      ///< Null: nothing there.
    };

    /// Makes the table; memory of an earlier one is used again. @param caster with castsVolume(). @param arena for
    /// what is needed meanwhile.
    void build(const SpanSpace& space, const LightView& light, const Caster& caster, std::uint32_t rows,
               FrameArena& arena);

    /// @param p the receiver, local. @param at the same place as SpanSpace::at() says.
    SpanAnswer ask(const glm::vec3& p, const SpanPoint& at, Cursor& cursor) const;

    /// Where its spans can be: theta from thetaFirst, at most thetaWidth on (round the pole); phi; r from nearest on.
    struct Extent {
        float thetaFirst = 0.0f, thetaWidth = -1.0f; ///< Width below 0: casts nothing.
        float phiFirst = 0.0f, phiLast = 0.0f;
        float nearest = 0.0f;
    };
    const Extent& extent() const { return extent_; }

    std::size_t memoryBytes() const;
    std::span<const Span> row(std::uint32_t index) const
    {
        return std::span(spans_).subspan(rowStart_[index], rowStart_[index + 1] - rowStart_[index]);
    }
    std::span<const Piece> pieces(const Span& span) const
    {
        return std::span(pieces_).subspan(span.piece, span.pieceCount);
    }
    std::uint32_t rowCount() const { return rows_; }

private:
    void find(std::uint32_t row, float phi, Cursor& cursor) const;

    Extent extent_;
    bool round_ = true, open_ = false;
    float rowsPerTheta_ = 0.0f;
    std::uint32_t rows_ = 0;
    std::vector<std::uint32_t> rowStart_; ///< rows_ + 1, into spans_.
    std::vector<Span> spans_;             ///< Row by row, rising, disjoint.
    std::vector<Piece> pieces_;           ///< Span by span, by rising `first`.
    std::vector<glm::vec4> planes_;       ///< Local; dot(xyz, p) > w behind the face, seen from the light.
};

} // namespace gnomon
