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

/// The way of a face that touches the light. @param closed its mesh, or its cluster where clusters count for themselves
inline std::uint32_t touchedWay(bool closed, bool mirrored)
{
    return !closed ? gpu::FACE_TOUCHED : mirrored ? gpu::FACE_AWAY : gpu::FACE_TOWARDS;
}

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

/// What of a caster is drawn, and where, for maps and projections in which a face that the light touches would cover
/// all that lies on its far side.
struct DrawnPart {
    glm::vec3 away{0.0f}; ///< Added to its place, world space.
    std::uint32_t firstFace = 0, faceCount = UINT32_MAX;
};

/// Whether the light is so near to the bounds of a caster with a topology that it may touch a face.
bool mayTouch(const LightView& light, const Caster& caster);

/// How far a closed caster has to move so that no face that the light touches reaches past it: along these faces'
/// normals, some 2^-20 of the coordinates; what it then covers lies within it. Zero where it has no such face, and for
/// open ones.
glm::vec3 awayFromLight(const LightView& light, const Caster& caster);
/// The same for one closed cluster of a mesh. @pre the caster has a topology
glm::vec3 awayFromLight(const LightView& light, const Caster& caster, std::uint32_t cluster);

/// Whether the light lies on a face, and not only in its plane.
bool isAtLight(const LightView& light, const Caster& caster, std::uint32_t face);

/// Calls visit(face) with the faces that the light lies on, in their order. @pre mayTouch()
template <typename Visit>
void forFacesAtLight(const LightView& light, const Caster& caster, const Visit& visit)
{
    const FacePlanes& planes = caster.mesh->topology->facePlanes;
    forTouchedFaces(planes, lightInObjectSpace(light, caster), 0, static_cast<std::uint32_t>(planes.size()),
                    [&](std::uint32_t face) {
                        if (isAtLight(light, caster, face)) visit(face);
                    });
}

/// Calls visit(part) with what is drawn of a caster: all of a closed one, moved away from the light; of an open one,
/// both sides of which are lit, what is left without the faces at the light.
template <typename Visit>
void forDrawnParts(const LightView& light, const Caster& caster, const Visit& visit)
{
    if (!mayTouch(light, caster)) return visit(DrawnPart{});
    if (caster.closed) return visit(DrawnPart{.away = awayFromLight(light, caster)});
    std::uint32_t next = 0;
    forFacesAtLight(light, caster, [&](std::uint32_t face) {
        if (face > next) visit(DrawnPart{.firstFace = next, .faceCount = face - next});
        next = face + 1;
    });
    if (const std::uint32_t all = caster.mesh->triangleCount(); next < all)
        visit(DrawnPart{.firstFace = next, .faceCount = all - next});
}

/// Calls draw(run, part) with the casters in their order, cut where one is drawn in another way: nearly always one run.
template <typename Draw>
void drawInParts(const LightView& light, std::span<const Caster* const> casters, const Draw& draw)
{
    std::size_t begin = 0;
    for (std::size_t i = 0; i < casters.size(); ++i) {
        if (!mayTouch(light, *casters[i])) continue;
        if (i > begin) draw(casters.subspan(begin, i - begin), DrawnPart{});
        forDrawnParts(light, *casters[i], [&](const DrawnPart& part) { draw(casters.subspan(i, 1), part); });
        begin = i + 1;
    }
    if (begin < casters.size()) draw(casters.subspan(begin), DrawnPart{});
}

} // namespace gnomon
