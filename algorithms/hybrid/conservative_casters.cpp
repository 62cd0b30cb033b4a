#include "algorithms/hybrid/conservative_casters.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/hybrid/spread.hpp"
#include "algorithms/shared/box_cells.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "shaders/hybrid_conservative_frag.h"
#include "shaders/hybrid_conservative_vert.h"

namespace gnomon {

namespace {

// Object to world to map, and the ray tracer's way back to object space: eight roundings of the largest coordinate that
// takes part, each 2^-24 of it, and twice that. A rotation's spread (at most 3) is within the sum of coordinates below.
constexpr double kCoordinateError = 0x1p-20;

// Receivers are known to 8 roundings of 2^-24 (conservative_classify.frag), which turned casters need. A spread beyond
// their 3 has 20 more for each, as in tile_shafts: 4 on the ray's way into the caster's space, 16 of distances there
// (shaft.cpp, light_frame.cpp).
constexpr double kPerSkew = 3.0 * 20.0 / 8.0;

double largest(const glm::dvec3& v)
{
    const glm::dvec3 size = glm::abs(v);
    return std::max({size.x, size.y, size.z});
}

/// How far a corner of the caster may be off, metres.
double cornerErrorWs(const ConservativeProjection& projection, const Caster& caster)
{
    const double bounds = std::max(largest(glm::dvec3(caster.bounds.lower)), largest(glm::dvec3(caster.bounds.upper)));
    const double moved = largest(glm::dvec3(caster.translation));
    return kCoordinateError * skewBeyondTurning(caster.basis) *
           (bounds + moved + static_cast<double>(projection.lightCoordinate));
}

glm::dvec3 axis(const ConservativeProjection& projection, int row)
{
    const glm::dmat4& m = projection.texelFromZero;
    return {m[0][row], m[1][row], m[2][row]};
}

/// Texels (times w) that a metre can move a point of the map by, seen from any base within it: about its middle, and
/// half a side of what changes w.
double texelsPerMetre(const ConservativeProjection& projection)
{
    const double half = 0.5 * static_cast<double>(projection.side);
    const glm::dvec3 forward = axis(projection, 3);
    const double aside =
        std::max(glm::length(axis(projection, 0) - half * forward), glm::length(axis(projection, 1) - half * forward));
    return aside + half * glm::length(forward);
}

} // namespace

ConservativeProjection conservativeProjection(const LightFit& fit, const LightView& light, std::uint32_t resolution)
{
    const MapProjection map = mapProjection(fit, light);
    const double side = resolution;
    glm::dmat4 rows = glm::transpose(glm::dmat4(map.clipFromZero));
    rows[0] = 0.5 * side * (rows[0] + rows[3]);
    rows[1] = 0.5 * side * (rows[1] + rows[3]);
    const bool perspective = light.type != GN_LIGHT_TYPE_DIRECTIONAL;
    return {.texelFromZero = glm::transpose(rows),
            .zeroWs = glm::dvec3(map.zeroWs),
            .clipFromZero = map.clipFromZero,
            .side = static_cast<float>(side),
            .depthConstant = map.depthConstant,
            .depthScale = map.depthScale,
            .perspective = perspective,
            .lightCoordinate = perspective ? static_cast<float>(largest(glm::dvec3(light.position()))) : 0.0f};
}

void addRounding(gpu::ConservativeConstants& constants, const ConservativeProjection& projection,
                 std::span<const Caster* const> casters)
{
    double skew = 1.0;
    for (const Caster* caster : casters)
        if (caster->mesh) skew = std::max(skew, skewBeyondTurning(caster->basis));
    const double times = 1.0 + kPerSkew * (skew - 1.0);
    constants.texelsPerMetre = static_cast<float>(times * texelsPerMetre(projection));
    // Depth = constant + scale / w changes by |scale| / w^2 a metre, which is (constant - depth)^2 / |scale|.
    const double scale = std::fabs(static_cast<double>(projection.depthScale));
    constants.depthPerMetre =
        projection.perspective ? 0.0f : static_cast<float>(times * glm::length(axis(projection, 2)));
    constants.depthSquare = projection.perspective ? static_cast<float>(times / scale) : 0.0f;
}

gpu::ConservativePush conservativePush(const ConservativeProjection& projection, const Caster& caster, bool backOnly)
{
    glm::dmat4 zeroFromObject(glm::dmat3(caster.basis));
    zeroFromObject[3] = glm::dvec4(glm::dvec3(caster.translation) - projection.zeroWs, 1.0);
    const double error = cornerErrorWs(projection, caster);
    gpu::ConservativePush push{};
    push.texelFromObject = glm::mat4(projection.texelFromZero * zeroFromObject);
    push.side = projection.side;
    push.depthConstant = projection.depthConstant;
    push.depthScale = projection.depthScale;
    push.texelError = static_cast<float>(error * texelsPerMetre(projection));
    push.wError = static_cast<float>(error * glm::length(axis(projection, 3)));
    const double constant = projection.perspective ? 0.0 : error * glm::length(axis(projection, 2));
    push.depthError = static_cast<float>(constant) + gpu::DEPTH_ROUNDING;
    push.depthErrorSquare =
        projection.perspective ? static_cast<float>(error) / std::fabs(projection.depthScale) : 0.0f;
    push.flags = (projection.perspective ? gpu::CASTER_PERSPECTIVE : 0u) | (backOnly ? gpu::CASTER_BACK_ONLY : 0u) |
                 (caster.mirrored ? gpu::CASTER_MIRRORED : 0u) |
                 (projection.offset == ThesisOffset::tight      ? gpu::CASTER_TIGHT
                  : projection.offset == ThesisOffset::diagonal ? gpu::CASTER_DIAGONAL
                                                                : 0u);
    return push;
}

bool backFacesOnly(const Caster& caster)
{
    return caster.closed && !caster.alphaTested;
}

PipelineId makeConservativePipeline(const AlgorithmServices& services, const char* name, ConservativeLayer layer)
{
    const auto number = static_cast<std::uint32_t>(layer);
    return services.pipelines->graphics({.name = name,
                                         .vertex = {k_hybrid_conservative_vert, 1, {number}},
                                         .fragment = {k_hybrid_conservative_frag, 1, {number}},
                                         .bindings = std::array{bufferAt(1), bufferAt(2), bufferAt(3)},
                                         .pushBytes = sizeof(gpu::ConservativePush),
                                         .depthTest = true,
                                         .depthWrite = true,
                                         .depthCompare = VK_COMPARE_OP_LESS,
                                         .depthFormat = kMapFormat});
}

BufferId ConservativeCasters::keptOf(const Caster& caster) const
{
    for (const KeptEdges& kept : kept_)
        if (kept.caster == &caster) return kept.bits;
    return {};
}

void ConservativeCasters::uses(PassRef& pass) const
{
    for (const KeptEdges& kept : kept_)
        pass.reads(kept.bits);
}

void ConservativeCasters::operator()(PassContext& gpu, std::span<const Caster* const> casters, bool) const
{
    const bool over = layer_ == ConservativeLayer::nearest || layer_ == ConservativeLayer::thesisNearest;
    for (const Caster* caster : casters) {
        const MeshView* mesh = caster->mesh;
        // Light may pass an alpha-tested face anywhere: it may block, and nothing is covered.
        if (!mesh || (caster->alphaTested && !over)) continue;
        const BufferId kept = keptOf(*caster);
        gpu::ConservativePush push = conservativePush(*projection_, *caster, thesis() || backFacesOnly(*caster));
        if (kept) push.flags |= gpu::CASTER_KEEPS;
        gpu.bind(pipeline_, {gpu.storage(1, mesh->vertexBuffer), gpu.storage(2, mesh->indexBuffer),
                             kept ? gpu.storage(3, kept) : gpu.storage(3, mesh->indexBuffer)});
        gpu.push(push);
        gpu.vk->vkCmdDraw(gpu.cmd, 3 * mesh->triangleCount(), 1, 0, 0);
    }
}

// What corners may be off by is four times what the shader allows for, so that a box in front of the light's plane
// holds none that the shader takes for one behind it, and that is more than its texelError lets a rectangle grow by.
// What rounding of w adds (ULPS_22 of the side times greatest over least w, which boxCells() keeps below 1024) and the
// guard are less than a cell.
Cells ConservativeCasters::cells(std::span<const Caster* const> casters) const
{
    Cells covered = 0;
    for (const Caster* caster : casters) {
        if (!caster->mesh) continue;
        const auto error = static_cast<float>(4.0 * cornerErrorWs(*projection_, *caster));
        const Aabb box{caster->bounds.lower - error, caster->bounds.upper + error};
        covered |= boxCells(box, projection_->clipFromZero, glm::vec3(projection_->zeroWs));
    }
    return withNeighbours(covered);
}

void ConservativeCasters::drawEdges(PassContext& gpu, const Caster& caster, BufferId edges) const
{
    gpu.bind(pipeline_, {gpu.storage(1, caster.mesh->vertexBuffer), gpu.storage(2, edges), gpu.storage(3, edges)});
    gpu.push(conservativePush(*projection_, caster, false));
    gpu.vk->vkCmdDrawIndirect(gpu.cmd, gpu.buffer(edges), 0, 1, sizeof(VkDrawIndirectCommand));
}

} // namespace gnomon
