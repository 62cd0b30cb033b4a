#include "runtime/store/scene_records.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace gnomon {
namespace {

glm::vec3 relative(const double (&position)[3], const std::array<double, 3>& origin)
{
    return {static_cast<float>(position[0] - origin[0]), static_cast<float>(position[1] - origin[1]),
            static_cast<float>(position[2] - origin[2])};
}

} // namespace

float largestOf(const glm::vec3& v)
{
    return std::max({v.x, v.y, v.z});
}

/// No edge is longer than the box around all edges, turned, nor than the one around the caster.
float longestEdgeOf(const Caster& caster, const MeshView& mesh)
{
    glm::vec3 span(0.0f);
    for (int column = 0; column < 3; ++column)
        span += glm::abs(caster.basis[column]) * mesh.edgeSpan[column];
    return std::min(glm::length(span), glm::distance(caster.bounds.lower, caster.bounds.upper));
}

namespace {

/// What is known of a caster whose transform the GPU alone reads: the host's box around it.
void updatePlaced(Caster& caster, const BufferPlacement& placement, const std::array<double, 3>& origin)
{
    for (int i = 0; i < 3; ++i) {
        const double shift = placement.array.origin[i] - origin[i];
        const double lower = double{placement.bounds.lower[i]} + shift,
                     upper = double{placement.bounds.upper[i]} + shift;
        const auto down = static_cast<float>(lower), up = static_cast<float>(upper);
        caster.bounds.lower[i] = double{down} > lower ? std::nextafter(down, -INFINITY) : down;
        caster.bounds.upper[i] = double{up} < upper ? std::nextafter(up, INFINITY) : up;
    }
    caster.gpuPlaced = true;
    caster.mirrored = placement.array.mirrored;
    caster.basis = glm::mat3(0.0f);
    caster.translation = 0.5f * (caster.bounds.lower + caster.bounds.upper);
    caster.longestEdge = glm::distance(caster.bounds.lower, caster.bounds.upper);
}

/// What follows from a transform that is known.
void updateTransformed(InstanceRecord& record, const MeshView* view, const std::array<double, 3>& origin)
{
    Caster& caster = record.caster;
    const float(&rows)[9] = record.transform.basis;
    caster.translation = relative(record.transform.translation, origin);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            record.rows.rows[4 * row + column] = caster.basis[column][row] = rows[3 * row + column];
        record.rows.rows[4 * row + 3] = caster.translation[row];
    }
    caster.bounds = transformed(view ? view->bounds : record.hostBounds, caster.basis, caster.translation);
    caster.mirrored = glm::determinant(glm::dmat3(caster.basis)) < 0.0;
    caster.longestEdge = view ? longestEdgeOf(caster, *view) : 0.0f;
    // Not from bounds in the world: a small caster far away has them as wide as coordinates there are apart.
    const Aabb aboutZero = view ? transformed(view->bounds, caster.basis, glm::vec3(0.0f)) : Aabb{};
    caster.meshReach = view ? largestOf(glm::max(glm::abs(aboutZero.lower), glm::abs(aboutZero.upper))) : 0.0f;
}

} // namespace

void updateCaster(InstanceRecord& record, const MeshView* view, const std::array<double, 3>& origin,
                  std::uint64_t revision)
{
    Caster& caster = record.caster;
    if (record.placement)
        updatePlaced(caster, *record.placement, origin);
    else
        updateTransformed(record, view, origin);
    caster.mesh = view;
    caster.closed = view && view->closed;
    caster.isStatic = record.isStatic;
    caster.revision = revision;
}

void LightRecord::publish(const std::array<double, 3>& origin)
{
    if (published) current ^= 1u;
    LightView& view = views[current];
    view.id = id;
    view.handle = handle;
    view.type = light.type;
    view.name = name.c_str();
    view.coneAngle = light.coneAngle;
    view.mask = light.mask;
    view.revision = revision;
    view.isStatic = light.isStatic && !moved;
    view.sampled = light.sampled;
    view.importance = light.importance;

    gpu::LightConstants& constants = view.constants;
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const double position[3] = {light.position[0], light.position[1], light.position[2]};
    constants.positionWs = directional ? glm::vec4(0.0f) : glm::vec4(relative(position, origin), 1.0f);
    constants.directionWs = glm::vec4(light.direction[0], light.direction[1], light.direction[2],
                                      light.type == GN_LIGHT_TYPE_SPOT ? std::cos(light.coneAngle) : -2.0f);
    constants.range = light.range;
    constants.type = static_cast<gpu::uint>(light.type);
    constants.sourceRadius = light.sourceRadius;
    view.sourceX = {light.sourceX[0], light.sourceX[1], light.sourceX[2]};
    view.sourceY = {light.sourceY[0], light.sourceY[1], light.sourceY[2]};
    view.sourceShape = light.sourceShape;
    constants.padding = 0;
    dirty = false;
    published = true;
}

void CasterArrays::Copy::write(const InstanceRecord& record)
{
    casters[record.caster.index] = record.caster;
    transforms[record.caster.index] = record.rows;
}

void CasterArrays::Copy::writeAll(const std::vector<InstanceRecord*>& casting)
{
    casters.resize(casting.size());
    transforms.resize(casting.size());
    for (const InstanceRecord* record : casting)
        write(*record);
    behind.clear();
    stale = false;
}

void CasterArrays::makeRoom(std::size_t casterCount)
{
    Copy& next = copies_[current_ ^ 1u];
    next.casters.reserve(casterCount);
    next.transforms.reserve(casterCount);
    for (Copy& copy : copies_)
        copy.behind.reserve(casterCount); // all of them may change at once
}

void CasterArrays::publish(const std::vector<InstanceRecord*>& casting, const std::vector<InstanceRecord*>& changed,
                           bool structural)
{
    Copy& shown = copies_[current_];
    Copy& next = copies_[current_ ^ 1u];
    if (!structural && changed.empty()) {
        // The frame after an addition: grow now, so that later ones need not.
        if (next.stale) next.writeAll(casting);
        return;
    }
    if (structural || next.stale) {
        next.writeAll(casting);
    } else {
        for (const InstanceRecord* record : next.behind)
            next.write(*record);
        for (const InstanceRecord* record : changed)
            next.write(*record);
        next.behind.clear();
    }
    next.snapshot = {next.casters, next.transforms, ++revision_};
    shown.stale = structural;
    shown.behind.clear();
    if (!structural) shown.behind.assign(changed.begin(), changed.end());
    current_ ^= 1u;
}

} // namespace gnomon
