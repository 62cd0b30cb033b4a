#include "runtime/select/drawn_map.hpp"

#include <algorithm>
#include <limits>

#include "runtime/scene/light_fit.hpp"

namespace gnomon {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// The farthest that a point of the box goes, metres: of an affine motion, that of a corner.
double farthestMove(const Aabb& box, const glm::mat3& basisBefore, glm::vec3 placeBefore, const Caster& now)
{
    float farthest = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) ? box.upper.x : box.lower.x, (corner & 2) ? box.upper.y : box.lower.y,
                          (corner & 4) ? box.upper.z : box.lower.z);
        farthest = std::max(farthest, glm::length((now.basis * p + now.translation) - (basisBefore * p + placeBefore)));
    }
    return double{farthest};
}

/// What the two lights differ by besides where they stand and where they look.
bool sameLamp(const LightView& a, const LightView& b)
{
    return a.type == b.type && a.mask == b.mask && a.coneAngle == b.coneAngle && a.isStatic == b.isStatic &&
           a.constants.range == b.constants.range && a.constants.sourceRadius == b.constants.sourceRadius &&
           a.sourceShape == b.sourceShape;
}

/// Texels that a directional light's turn shifts shadows by: at most what it shifts those of the whole scene's depth
/// by.
double texelsOfTurn(double turned, const MapKey& key, const LightCasters& casters)
{
    const Aabb bounds = sceneBounds(casters);
    return turned * double{glm::length(bounds.upper - bounds.lower)} * key.side / key.width;
}

/// Texels by which the light's own motion shifts what the map shows. A shadow goes no farther, in texels, than the
/// caster seems to from the light.
double texelsOfLight(const MapKey& key, const LightView& before, const MapPose& now)
{
    const LightView& light = *now.light;
    if (light.revision == before.revision) return 0.0;
    const double turned = double{glm::length(light.direction() - before.direction())};
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return texelsOfTurn(turned, key, *now.casters);
    const double texel = key.width / key.side; // at 1 m
    const double byTurn = light.type == GN_LIGHT_TYPE_SPOT ? turned / texel : 0.0;
    const double moved = double{glm::length(light.position() - before.position())};
    if (moved == 0.0) return byTurn;
    double nearest = kNever;
    for (const Caster* caster : now.casters->all)
        nearest = std::min(nearest, nearestDistance(caster->bounds, glm::dvec3(light.position())));
    return nearest > moved ? byTurn + moved / (texel * (nearest - moved)) : kNever;
}

} // namespace

double DrawnMap::texelsOff(const MapKey& key, const MapPose& now) const
{
    const LightView& light = *now.light;
    const LightCasters& casters = *now.casters;
    if (drawnAt_ == 0 || !key_.sameMap(key) || !sameLamp(light_, light) || staticStamp_ != casters.staticStamp ||
        moving_.size() != casters.dynamics.size())
        return kNever;
    double off = 0.0;
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        const Placed& before = moving_[i];
        const Caster& caster = *casters.dynamics[i];
        if (before.id != caster.id) return kNever;
        if (before.revision == caster.revision) continue;
        if (!caster.mesh || caster.gpuPlaced || caster.mesh->revision != before.meshRevision) return kNever;
        double nearest = 1.0;
        if (light.type != GN_LIGHT_TYPE_DIRECTIONAL) {
            const glm::dvec3 at(light.position());
            nearest = std::min(nearestDistance(caster.bounds, at), nearestDistance(before.bounds, at));
        }
        if (nearest <= 0.0) return kNever;
        const double moved = farthestMove(caster.mesh->bounds, before.basis, before.translation, caster);
        off = std::max(off, moved * key.side / (key.width * nearest));
    }
    return off + texelsOfLight(key, light_, now);
}

void DrawnMap::draw(std::uint64_t frame, const MapKey& key, const MapPose& now)
{
    drawnAt_ = frame;
    key_ = key;
    light_ = *now.light;
    staticStamp_ = now.casters->staticStamp;
    dynamicStamp_ = now.casters->dynamicStamp;
    moving_.clear();
    for (const Caster* caster : now.casters->dynamics)
        moving_.push_back({.id = caster->id,
                           .basis = caster->basis,
                           .translation = caster->translation,
                           .bounds = caster->bounds,
                           .revision = caster->revision,
                           .meshRevision = caster->mesh ? caster->mesh->revision : 0});
}

/// The casters of now, where and in the revision that the map shows them: its stamp is that of its drawing.
MapPose DrawnMap::asDrawn(const MapPose& now, FrameArena& arena) const
{
    LightCasters casters = *now.casters;
    const std::span<const Caster*> all = arena.array<const Caster*>(casters.all.size());
    std::copy(casters.statics.begin(), casters.statics.end(), all.begin());
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        Caster caster = *casters.dynamics[i];
        caster.bounds = moving_[i].bounds;
        caster.revision = moving_[i].revision;
        all[casters.statics.size() + i] = arena.make(caster);
    }
    casters.all = all;
    casters.statics = casters.all.first(casters.statics.size());
    casters.dynamics = casters.all.subspan(casters.statics.size());
    casters.dynamicStamp = dynamicStamp_;
    LightView light = light_;
    light.name = now.light->name;
    light.importance = now.light->importance;
    return {arena.make(light), arena.make(casters)};
}

MapPose DrawnMap::next(std::uint64_t frame, const MapKey& key, const MapPose& now, FrameArena& arena)
{
    const double off = texelsOff(key, now);
    if (off == 0.0 && light_.revision == now.light->revision && dynamicStamp_ == now.casters->dynamicStamp) {
        age_ = every_ = 0; // nothing moves, and the map stays what it is
        return now;
    }
    age_ = off == kNever ? 0 : static_cast<std::uint32_t>(frame - drawnAt_);
    every_ = 1;
    while (off != kNever && age_ > 0 && every_ < kMostFrames && 2.0 * every_ * off <= kBoundTexels * age_)
        every_ *= 2;
    const bool turn = (frame + now.light->id) % every_ == 0;
    if (off <= kBoundTexels && age_ < every_ && !turn) return asDrawn(now, arena);
    age_ = 0;
    draw(frame, key, now);
    return now;
}

} // namespace gnomon
