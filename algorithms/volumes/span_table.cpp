#include "algorithms/volumes/span_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>

#include "algorithms/volumes/silhouette.hpp"

namespace gnomon {

namespace {

constexpr double kPi = std::numbers::pi, kTurn = 2.0 * std::numbers::pi;
constexpr float kTurnFloat = static_cast<float>(kTurn);
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A unit vector across `axis`, at odd angles to the world's axes: edges of buildings then cross rows at a slant.
glm::dvec3 across(const glm::dvec3& axis)
{
    const glm::dvec3 one(0.36, 0.48, 0.8), other(0.8, -0.6, 0.0);
    return glm::normalize(glm::cross(axis, std::abs(glm::dot(axis, one)) < 0.8 ? one : other));
}

/// A face as the light sees it.
struct Face {
    std::uint32_t corner[3]; ///< Vertices.
    double first, last;      ///< Theta, relative to the middle of the caster.
    float nearest, farthest; ///< Bounds of r.
};

/// What a row cuts out of a face.
struct Cut {
    std::uint32_t row, face;
    float first, last;
};

/// The half plane (directional: plane) of a row.
struct RowPlane {
    bool round = true;
    double theta = 0.0, cosine = 1.0, sine = 0.0;

    RowPlane() = default;

    RowPlane(bool isRound, double at)
        : round(isRound), theta(at), cosine(isRound ? std::cos(at) : 1.0), sine(isRound ? std::sin(at) : 0.0)
    {
    }
    double side(const glm::dvec3& p) const { return round ? cosine * p.y - sine * p.x : p.x - theta; }
};

/// A point of a row: how far from the pole's axis, how far along it.
struct RowPoint {
    double out, along;
};

/// Where an edge meets a row; both faces of an edge get the same bits, for they give its vertices in the same order.
RowPoint edgeMeets(const RowPlane& plane, const glm::dvec3& a, const glm::dvec3& b, double sideA, double sideB)
{
    const glm::dvec3 p = a + (b - a) * (sideA / (sideA - sideB));
    return plane.round ? RowPoint{plane.cosine * p.x + plane.sine * p.y, p.z} : RowPoint{1.0, p.y};
}

float slope(const RowPoint& p)
{
    return static_cast<float>(p.along / p.out);
}

/// The part of a face in a row, if any.
bool cutFace(const RowPlane& plane, std::span<const glm::dvec3> vertices, const Face& face, Cut& cut)
{
    RowPoint ends[2];
    int found = 0;
    for (int i = 0; i < 3 && found < 2; ++i) {
        const std::uint32_t a = std::min(face.corner[i], face.corner[(i + 1) % 3]);
        const std::uint32_t b = std::max(face.corner[i], face.corner[(i + 1) % 3]);
        const double sideA = plane.side(vertices[a]), sideB = plane.side(vertices[b]);
        if ((sideA >= 0.0) == (sideB >= 0.0)) continue;
        ends[found++] = edgeMeets(plane, vertices[a], vertices[b], sideA, sideB);
    }
    if (found < 2) return false;
    const bool within0 = ends[0].out > 0.0, within1 = ends[1].out > 0.0;
    if (!within0 && !within1) return false; // on the other side of the axis
    if (within0 && within1) {
        cut.first = std::min(slope(ends[0]), slope(ends[1]));
        cut.last = std::max(slope(ends[0]), slope(ends[1]));
        return true;
    }
    // Across the axis: up to the pole that lies there.
    const RowPoint& inside = within0 ? ends[0] : ends[1];
    const RowPoint& outside = within0 ? ends[1] : ends[0];
    const double along = inside.along + (outside.along - inside.along) * inside.out / (inside.out - outside.out);
    cut.first = along > 0.0 ? slope(inside) : -kInfinity;
    cut.last = along > 0.0 ? kInfinity : slope(inside);
    return true;
}

/// Whether the pole's axis meets the face.
bool meetsAxis(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
{
    const auto turn = [](const glm::dvec3& p, const glm::dvec3& q) { return p.x * q.y - p.y * q.x; };
    const double ab = turn(a, b), bc = turn(b, c), ca = turn(c, a);
    return (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
}

/// Theta of the face's corners relative to `middle`. @return false: it lies all round.
bool findTheta(bool round, std::span<const glm::dvec3> vertices, double middle, Face& face)
{
    const glm::dvec3& a = vertices[face.corner[0]];
    const glm::dvec3& b = vertices[face.corner[1]];
    const glm::dvec3& c = vertices[face.corner[2]];
    if (!round) {
        face.first = std::min({a.x, b.x, c.x});
        face.last = std::max({a.x, b.x, c.x});
        return true;
    }
    if (meetsAxis(a, b, c)) return false;
    const double at = std::remainder(std::atan2(a.y, a.x) - middle, kTurn);
    const auto from = [&](const glm::dvec3& p) { // less than half a turn, as the axis is outside
        return at + std::atan2(a.x * p.y - a.y * p.x, a.x * p.x + a.y * p.y);
    };
    face.first = std::min({at, from(b), from(c)});
    face.last = std::max({at, from(b), from(c)});
    return face.first > -kPi && face.last < kPi;
}

/// Rows over what the caster covers, in theta.
struct Rows {
    bool round = true, allRound = false;
    double middle = 0.0; ///< Zero of the faces' theta.
    double first = 0.0, last = 0.0;
    double height = 0.0;
    std::uint32_t count = 0;

    double centre(std::uint32_t row) const { return middle + first + (row + 0.5) * height; }
};

/// The faces that block light, their planes, and the theta they cover.
void findFaces(const SpanSpace& space, const LightView& light, const Caster& caster,
               std::span<const glm::dvec3> vertices, Rows& rows, std::span<Face>& faces, std::vector<glm::vec4>& planes,
               FrameArena& arena)
{
    const Topology& topology = *caster.mesh->topology;
    const std::span<std::uint8_t> facing = arena.array<std::uint8_t>(topology.facePlanes.size());
    faces = arena.array<Face>(facing.size());
    findFacing(topology, lightInObjectSpace(light, caster), 0, facing);
    rows.first = std::numeric_limits<double>::max();
    rows.last = -rows.first;
    for (std::uint32_t i = 0; i < facing.size(); ++i) {
        if (!blocksLight(topology.closed, facing[i], caster.mirrored)) continue;
        Face face{};
        std::copy_n(&topology.faceVerts[3 * std::size_t{i}], 3, face.corner);
        const glm::dvec3 a = vertices[face.corner[0]], b = vertices[face.corner[1]], c = vertices[face.corner[2]];
        glm::dvec3 normal = glm::cross(b - a, c - a);
        const double size = glm::length(normal);
        if (!(size > 0.0)) continue;
        normal /= size;
        // The light is at zero, or infinitely far against z: on the side of the smaller values.
        const double distance = glm::dot(normal, a);
        const double towards = space.round() ? distance : normal.z;
        if (towards == 0.0) continue; // seen from its edge
        const double sign = towards > 0.0 ? 1.0 : -1.0;
        if (!findTheta(rows.round, vertices, rows.middle, face)) rows.allRound = true;
        rows.first = std::min(rows.first, face.first);
        rows.last = std::max(rows.last, face.last);
        const bool round = space.round();
        face.nearest = static_cast<float>(round ? std::abs(distance) : std::min({a.z, b.z, c.z}));
        face.farthest = static_cast<float>(round ? std::max({glm::length(a), glm::length(b), glm::length(c)})
                                                 : std::max({a.z, b.z, c.z}));
        faces[planes.size()] = face;
        planes.emplace_back(glm::vec4(glm::dvec4(sign * normal, sign * distance)));
    }
    faces = faces.first(planes.size());
}

void layRows(const SpanSpace& space, std::uint32_t count, std::size_t faceCount, Rows& rows)
{
    if (rows.allRound) {
        rows.middle = 0.0;
        rows.first = -kPi;
        rows.last = kPi;
    }
    const double lower = rows.middle + rows.first, upper = rows.middle + rows.last;
    if (rows.round && lower >= -kPi && upper <= kPi) {
        rows.first = std::max(lower, -space.thetaLimit()) - rows.middle;
        rows.last = std::min(upper, space.thetaLimit()) - rows.middle;
    }
    rows.count = faceCount > 0 && rows.last > rows.first ? count : 0;
    rows.height = (rows.last - rows.first) / count;
}

/// The rows that a face may touch; their planes decide.
struct RowRange {
    std::uint32_t first, last;
};

RowRange rowsOf(const Rows& rows, const Face& face)
{
    if (rows.allRound) return {0, rows.count - 1};
    const auto rowAt = [&](double theta, double slack) { // one more on each side, for rounding
        const double row = std::floor((theta - rows.first) / rows.height + slack);
        return static_cast<std::uint32_t>(std::clamp(row, 0.0, double(rows.count - 1)));
    };
    return {rowAt(face.first, -1.0), rowAt(face.last, 1.0)};
}

/// All cuts of all faces, row by row and rising in each.
std::span<const Cut> cutFaces(const Rows& rows, std::span<const glm::dvec3> vertices, std::span<const Face> faces,
                              FrameArena& arena)
{
    const std::span<RowPlane> planes = arena.array<RowPlane>(rows.count);
    for (std::uint32_t row = 0; row < rows.count; ++row)
        planes[row] = RowPlane(rows.round, rows.centre(row));
    std::size_t most = 0;
    for (const Face& face : faces)
        most += rowsOf(rows, face).last - rowsOf(rows, face).first + 1;
    const std::span<Cut> cuts = arena.array<Cut>(most);
    const std::span<std::uint32_t> next = arena.array<std::uint32_t>(std::size_t{rows.count} + 1);
    std::fill(next.begin(), next.end(), 0u);
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
        const RowRange range = rowsOf(rows, faces[i]);
        for (std::uint32_t row = range.first; row <= range.last; ++row) {
            Cut cut{.row = row, .face = i, .first = 0.0f, .last = 0.0f};
            if (!cutFace(planes[row], vertices, faces[i], cut)) continue;
            cuts[count++] = cut;
            ++next[row + 1];
        }
    }
    // By row with the counts, then each row's few by themselves: cheaper than one sort of all.
    std::partial_sum(next.begin(), next.end(), next.begin());
    const std::span<Cut> sorted = arena.array<Cut>(count);
    for (const Cut& cut : cuts.first(count))
        sorted[next[cut.row]++] = cut;
    for (std::uint32_t row = 0, begin = 0; row < rows.count; begin = next[row++])
        std::sort(sorted.begin() + begin, sorted.begin() + next[row],
                  [](const Cut& a, const Cut& b) { return a.first != b.first ? a.first < b.first : a.face < b.face; });
    return sorted;
}

} // namespace

SpanSpace::SpanSpace(const LightView& light) : round_(light.type != GN_LIGHT_TYPE_DIRECTIONAL)
{
    glm::dvec3 pole(0.8, 0.1, 0.59), zero(0.0, -1.0, 0.0); // lamps: what casts stands below or around
    thetaLimit_ = kPi;
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        pole = glm::dvec3(light.direction());
        zero = across(pole);
    } else if (light.type == GN_LIGHT_TYPE_SPOT) {
        zero = glm::dvec3(light.direction());
        pole = across(zero);
        if (light.coneAngle < 0.5 * kPi) thetaLimit_ = light.coneAngle;
    }
    pole = glm::normalize(pole);
    zero = glm::normalize(zero - pole * glm::dot(pole, zero));
    axes_ = glm::dmat3(zero, glm::cross(pole, zero), pole);
    origin_ = round_ ? glm::dvec3(light.position()) : glm::dvec3(0.0);
    axesFloat_ = glm::mat3(axes_);
    originFloat_ = glm::vec3(origin_);
}

SpanPoint SpanSpace::at(const glm::vec3& p) const
{
    if (!round_) return {p.x, p.y, p.z};
    const float out = p.x * p.x + p.y * p.y;
    return {std::atan2(p.y, p.x), p.z / std::sqrt(std::max(out, 1e-30f)), std::sqrt(out + p.z * p.z)};
}

void CasterSpans::build(const SpanSpace& space, const LightView& light, const Caster& caster, std::uint32_t rowCount,
                        FrameArena& arena)
{
    rowStart_.clear();
    spans_.clear();
    pieces_.clear();
    planes_.clear();
    extent_ = {};
    round_ = space.round();
    open_ = !caster.mesh->topology->closed;

    const std::span<const glm::vec3> positions = caster.mesh->positions;
    const std::span<glm::dvec3> vertices = arena.array<glm::dvec3>(positions.size());
    const glm::dmat3 basis(caster.basis);
    for (std::size_t i = 0; i < positions.size(); ++i)
        vertices[i] = space.local(basis * glm::dvec3(positions[i]) + glm::dvec3(caster.translation));
    Rows rows{.round = round_};
    const glm::dvec3 middle = space.local(glm::dvec3(caster.bounds.center()));
    if (round_) rows.middle = std::atan2(middle.y, middle.x);
    std::span<Face> faces;
    findFaces(space, light, caster, vertices, rows, faces, planes_, arena);
    layRows(space, rowCount, faces.size(), rows);
    rows_ = rows.count;
    if (rows_ == 0) return;

    const std::span<const Cut> cuts = cutFaces(rows, vertices, faces, arena);
    pieces_.reserve(cuts.size());
    rowStart_.reserve(std::size_t{rows_} + 1);
    extent_ = {.thetaFirst = static_cast<float>(rows.middle + rows.first),
               .thetaWidth = static_cast<float>(rows.last - rows.first),
               .phiFirst = kInfinity,
               .phiLast = -kInfinity,
               .nearest = kInfinity};
    rowsPerTheta_ = static_cast<float>(1.0 / rows.height);
    auto cut = cuts.begin();
    for (std::uint32_t row = 0; row < rows_; ++row) {
        rowStart_.push_back(static_cast<std::uint32_t>(spans_.size()));
        for (; cut != cuts.end() && cut->row == row; ++cut) {
            const Face& face = faces[cut->face];
            // Faces that share an edge meet in the same bits: ends inside of the caster vanish, its ridges stay.
            if (spans_.size() == rowStart_.back() || cut->first > spans_.back().last)
                spans_.push_back({cut->first, cut->last, face.nearest, face.farthest,
                                  static_cast<std::uint32_t>(pieces_.size()), 0});
            Span& span = spans_.back();
            span.last = std::max(span.last, cut->last);
            span.nearest = std::min(span.nearest, face.nearest);
            span.farthest = std::max(span.farthest, face.farthest);
            ++span.pieceCount;
            pieces_.push_back({cut->first, cut->last, span.last, cut->face});
            extent_.phiFirst = std::min(extent_.phiFirst, cut->first);
            extent_.phiLast = std::max(extent_.phiLast, cut->last);
            extent_.nearest = std::min(extent_.nearest, face.nearest);
        }
    }
    rowStart_.push_back(static_cast<std::uint32_t>(spans_.size()));
    if (spans_.empty()) extent_.thetaWidth = -1.0f;
}

void CasterSpans::find(std::uint32_t row, float phi, Cursor& cursor) const
{
    const std::span<const Span> spans = this->row(row);
    const auto next =
        std::upper_bound(spans.begin(), spans.end(), phi, [](float at, const Span& span) { return at < span.first; });
    cursor = {.row = row, .first = -kInfinity, .last = next != spans.end() ? next->first : kInfinity, .span = nullptr};
    if (next == spans.begin()) return;
    const Span& before = *(next - 1);
    if (phi <= before.last) {
        cursor = {.row = row, .first = before.first, .last = before.last, .span = &before};
    } else {
        cursor.first = before.last;
    }
}

SpanAnswer CasterSpans::ask(const glm::vec3& p, const SpanPoint& at, Cursor& cursor) const
{
    float theta = at.theta - extent_.thetaFirst;
    if (round_) {
        if (theta < 0.0f) theta += kTurnFloat;
        if (theta >= kTurnFloat) theta -= kTurnFloat;
    }
    if (!(theta >= 0.0f && theta <= extent_.thetaWidth)) return SpanAnswer::lit;
    const std::uint32_t row = std::min(static_cast<std::uint32_t>(theta * rowsPerTheta_), rows_ - 1);
    if (row != cursor.row || !(at.phi >= cursor.first && at.phi <= cursor.last)) find(row, at.phi, cursor);
    if (!cursor.span || at.r < cursor.span->nearest) return SpanAnswer::lit;
    if (at.r > cursor.span->farthest) return SpanAnswer::dark;

    const Piece* begin = pieces_.data() + cursor.span->piece;
    const Piece* piece = std::upper_bound(begin, begin + cursor.span->pieceCount, at.phi,
                                          [](float phi, const Piece& each) { return phi < each.first; });
    while (piece != begin) {
        --piece;
        if (piece->reach < at.phi) break;
        if (piece->last < at.phi) continue;
        const glm::vec4& plane = planes_[piece->plane];
        if (plane.x * p.x + plane.y * p.y + plane.z * p.z > plane.w)
            return open_ ? SpanAnswer::beyondOpen : SpanAnswer::dark;
    }
    return SpanAnswer::lit;
}

std::size_t CasterSpans::memoryBytes() const
{
    return rowStart_.capacity() * sizeof(std::uint32_t) + spans_.capacity() * sizeof(Span) +
           pieces_.capacity() * sizeof(Piece) + planes_.capacity() * sizeof(glm::vec4);
}

} // namespace gnomon
