#pragma once
// How a light lies to the faces of one caster, and which of them it touches.
//
// A lamp set into a ceiling lies in the plane of a face: by the rounding of coordinates it is before or behind it. No
// ray that ends short of the lamp meets that face, but taken for one that blocks it would darken half of all
// directions.
#include <algorithm>
#include <span>

#include <glm/vec3.hpp>

#include "runtime/scene/scene_view.hpp"
#include "runtime/scene/topology.hpp"

#include "shaders/shared/face_light.h"

namespace gnomon {

/// The light for faces in object space: a face's winding in the world looks towards the light if
/// dot(facePlane, result.at) > 0. Homogeneous and without a division, so that flattened (singular) transforms work; for
/// mirrored ones the sign follows the world's winding. Of a closed mesh a face that touches the light counts as one
/// that light enters by; of an open one it counts for nothing.
gpu::FaceLight lightInObjectSpace(const LightView& light, const Caster& caster);

/// How far a caster has to move so that no face that the light touches reaches past it, world space, for maps and
/// projections that can leave no face out: along the touched faces' normals, some 2^-20 of the coordinates. Zero for
/// all but the rare caster that the light touches, and for those without a topology.
glm::vec3 awayFromLight(const LightView& light, const Caster& caster);

/// Whether the light touches any face of a block: all asked at once, in a third of the time.
bool touchesAny(const FaceBlock& block, const gpu::FaceLight& light);

/// Calls visit(face) with the faces from `first` to before `end` that the light touches.
template <typename Visit>
void forTouchedFaces(const FacePlanes& planes, const gpu::FaceLight& light, std::uint32_t first, std::uint32_t end,
                     const Visit& visit)
{
    if (!(light.touch > 0.0f)) return;
    for (std::uint32_t block = first / kBlockFaces; block * kBlockFaces < end; ++block) {
        if (!touchesAny(planes.blocks()[block], light)) continue;
        const std::uint32_t from = std::max(block * kBlockFaces, first), to = std::min((block + 1) * kBlockFaces, end);
        for (std::uint32_t face = from; face < to; ++face)
            if (gpu::touchesLight(planes[face], light)) visit(face);
    }
}

/// Calls draw(run, away) with the casters in their order, cut into runs that are moved alike: nearly always one.
template <typename Draw>
void drawAwayFrom(const LightView& light, std::span<const Caster* const> casters, const Draw& draw)
{
    std::size_t begin = 0;
    glm::vec3 away(0.0f);
    for (std::size_t i = 0; i < casters.size(); ++i) {
        const glm::vec3 own = awayFromLight(light, *casters[i]);
        if (own != away) {
            if (i > begin) draw(casters.subspan(begin, i - begin), away);
            begin = i;
            away = own;
        }
    }
    if (begin < casters.size()) draw(casters.subspan(begin), away);
}

} // namespace gnomon
