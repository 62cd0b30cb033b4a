// The four planes around what a triangle shadows: one through the light and each edge, and its own. All four at once,
// in the lanes of one register, relative to the tile, whose size and distance then are what rounding is measured by.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "algorithms/hybrid/float4.hpp"
#include "algorithms/hybrid/shaft.hpp"

namespace gnomon {

namespace {

constexpr double kRoundoff = 0x1p-24;
// Of distances between receiver, triangle and light. Embree's edge functions and ours are sums of products of such
// differences: four roundings each, and as many for the planes in single precision; twice that is allowed.
constexpr double kDistanceRoundings = 16.0 * kRoundoff;

struct Vec4 {
    Float4 x, y, z;
};

Vec4 operator-(const Vec4& a, const Vec4& b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

Float4 dot(const Vec4& a, const Vec4& b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

Vec4 cross(const Vec4& a, const Vec4& b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The sums of the amounts that cross() subtracts: its error is a share of them.
Vec4 crossAmounts(const Vec4& a, const Vec4& b)
{
    const Vec4 p{absolute(a.x), absolute(a.y), absolute(a.z)}, q{absolute(b.x), absolute(b.y), absolute(b.z)};
    return {p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
}

Vec4 columns(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d)
{
    return {Float4{a.x, b.x, c.x, d.x}, Float4{a.y, b.y, c.y, d.y}, Float4{a.z, b.z, c.z, d.z}};
}

Vec4 all(glm::vec3 v)
{
    return columns(v, v, v, v);
}

/// Of the corners, only that they lie between two parallel planes is known; the other two planes pass everything.
void makeSlab(glm::vec3 normal, float distance, float band, float margin, lanes::ShadowPlanes& planes)
{
    const bool known = band < 1e18f; // else wherever the shaft has met it
    constexpr float everywhere = 1e30f;
    const float sign[4] = {1.0f, -1.0f, 0.0f, 0.0f};
    for (int i = 0; i < 4; ++i) {
        const float s = known ? sign[i] : 0.0f;
        planes.x[i] = s * normal.x;
        planes.y[i] = s * normal.y;
        planes.z[i] = s * normal.z;
        planes.f[i] = s == 0.0f ? everywhere : s * distance + band;
        planes.margin[i] = s == 0.0f ? 0.0f : margin;
    }
    planes.certain = 0;
}

} // namespace

ShadowMaker::ShadowMaker(const ShaftLight& light, const Hull& hull, const ShaftCaster& caster)
    : basis_(caster.basis), translation_(caster.translation - hull.centre), directional_(light.directional),
      opaque_(caster.opaque), light_(light.directional ? light.toLight : light.position - hull.centre),
      rounding_(caster.rounding(hull.largest())), relative_(static_cast<float>(kDistanceRoundings * caster.skew())),
      farthest_(0.0f), nearOffset_(static_cast<float>(2.0 * hull.largestOffset))
{
    glm::dvec3 extent(0.0);
    for (int i = 0; i < 3; ++i) {
        axis_[i] = glm::vec3(hull.axis[i] * hull.half[i]);
        extent += glm::abs(hull.axis[i]) * hull.half[i];
    }
    extent_ = glm::vec3(extent);
    rounding_ *= 1.0f + 1e-6f;
    if (!directional_) farthest_ = glm::length(light_) + glm::length(extent_);
}

/// How much wider than at the triangle an error of direction is at the hull.
float ShadowMaker::wideness(const glm::vec3 (&corners)[3]) const
{
    if (directional_) return 1.0f;
    const glm::vec3 lower = glm::min(glm::min(corners[0], corners[1]), corners[2]);
    const glm::vec3 upper = glm::max(glm::max(corners[0], corners[1]), corners[2]);
    const glm::vec3 apart = glm::max(lower - light_, light_ - upper);
    const float distance =
        std::max({apart.x, apart.y, apart.z, 1e-20f}); // of the light from the triangle's box, or less
    return std::max(1.0f, farthest_ / distance);
}

Shadowing ShadowMaker::make(glm::vec3 a, glm::vec3 b, glm::vec3 c, lanes::ShadowPlanes& planes) const
{
    const glm::vec3 at[3] = {glm::vec3(basis_ * glm::dvec3(a) + translation_),
                             glm::vec3(basis_ * glm::dvec3(b) + translation_),
                             glm::vec3(basis_ * glm::dvec3(c) + translation_)};
    // Lanes 0 to 2: a plane holds an edge and the light, and the third corner is inside. Lane 3: the triangle's own,
    // and the light is outside.
    const Vec4 anchor = columns(at[0], at[1], at[2], at[0]);
    const Vec4 edge = columns(at[1], at[2], at[0], at[1]) - anchor;
    const Vec4 light = directional_ ? all(light_) : all(light_) - anchor;
    const glm::vec3 e = at[2] - at[0];
    const Vec4 across = {Float4{light.x[0], light.x[1], light.x[2], e.x},
                         Float4{light.y[0], light.y[1], light.y[2], e.y},
                         Float4{light.z[0], light.z[1], light.z[2], e.z}};
    const Vec4 third = columns(at[2], at[0], at[1], at[0]) - anchor;
    const Vec4 inside = {Float4{third.x[0], third.x[1], third.x[2], -light.x[3]},
                         Float4{third.y[0], third.y[1], third.y[2], -light.y[3]},
                         Float4{third.z[0], third.z[1], third.z[2], -light.z[3]}};
    Vec4 normal = cross(edge, across);
    Float4 height = dot(normal, inside);
    const Float4 sign = height < 0.0f ? Float4{-1.0f, -1.0f, -1.0f, -1.0f} : Float4{1.0f, 1.0f, 1.0f, 1.0f};
    normal = {normal.x * sign, normal.y * sign, normal.z * sign};
    height *= sign;
    const Float4 distance = -dot(normal, anchor);

    const Vec4 amounts = crossAmounts(edge, across);
    const Vec4 apart = {absolute(anchor.x) + extent_.x, absolute(anchor.y) + extent_.y, absolute(anchor.z) + extent_.z};
    const Vec4 off = {absolute(normal.x), absolute(normal.y), absolute(normal.z)};
    const Float4 narrow = dot(off, all(rounding_)) + relative_ * dot(amounts, apart);
    const float wider = wideness(at);
    const Float4 margin = narrow * Float4{wider, wider, wider, 1.0f};

    Float4 radius = margin;
    for (const glm::vec3& v : axis_)
        radius += absolute(normal.x * v.x + normal.y * v.y + normal.z * v.z);
    const std::uint32_t edgeOn = bitsOf(height <= 4.0f * narrow) & 7u; // which side is which is not known
    const std::uint32_t outside = bitsOf(distance + radius < 0.0f);
    if (edgeOn == 0 && outside != 0) return Shadowing::none;

    if (edgeOn != 0) {
        int best = 0;
        float thickness[3];
        for (int i = 0; i < 3; ++i) {
            thickness[i] = 0.0f;
            for (const glm::vec3& corner : at)
                thickness[i] = std::max(thickness[i], std::abs(normal.x[i] * corner.x + normal.y[i] * corner.y +
                                                               normal.z[i] * corner.z + distance[i]));
            // Walls have lengths: of two the one with the thinner triangle between, each by its own.
            const float size = std::abs(normal.x[i]) + std::abs(normal.y[i]) + std::abs(normal.z[i]);
            const float bestSize = std::abs(normal.x[best]) + std::abs(normal.y[best]) + std::abs(normal.z[best]);
            best = thickness[i] * bestSize < thickness[best] * size ? i : best;
        }
        makeSlab({normal.x[best], normal.y[best], normal.z[best]}, distance[best],
                 (thickness[best] + narrow[best]) * wider, margin[best], planes);
        return Shadowing::some;
    }
    store(planes.x, normal.x);
    store(planes.y, normal.y);
    store(planes.z, normal.z);
    store(planes.f, distance);
    store(planes.margin, margin);
    // Rays end an offset before the light: what could lie behind that end proves nothing.
    const float size2 = normal.x[3] * normal.x[3] + normal.y[3] * normal.y[3] + normal.z[3] * normal.z[3];
    const float before = height[3] - 2.0f * margin[3];
    const bool ends = directional_ || (before > 0.0f && before * before > nearOffset_ * nearOffset_ * size2);
    planes.certain = opaque_ && ends ? 1 : 0;
    return planes.certain != 0 && bitsOf(distance - radius > 0.0f) == 15u ? Shadowing::all : Shadowing::some;
}

} // namespace gnomon
