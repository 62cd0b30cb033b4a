#pragma once
// Small scenes made in code, for truths that are too dear for the shipped ones.

#include "demo/scene/scene.hpp"

namespace gnomon::exact {

/// Adds the mesh and an instance of it.
demo::Instance& place(demo::Scene& scene, const char* name, demo::Mesh mesh, const glm::dvec3& position);

/// About 900 triangles that hold what methods stumble over: closed and open casters, a thin wall, contact edges, a slab
/// at 85 degrees to the sun, a caster behind the eye and one behind each lamp. Layer 0 sun, 1 spot, 2 point.
demo::Scene testbed(demo::DepthConvention convention);

/// A box (closed) or a sheet (open) that hangs over a floor in the light of one lamp of the given kind, which stands to
/// the left; the shadow falls to the right, towards +x. The near plane is half a metre away, so that it is 0.7 m wide.
demo::Scene hangingCaster(demo::LightKind kind, bool closed, demo::DepthConvention convention);

/// The same with closed casters, and one more: a ball that the near plane cuts, or a crate about the eye and the near
/// rectangle.
demo::Scene cutByNearPlane(demo::LightKind kind, bool aboutEye, demo::DepthConvention convention);

/// One closed caster over a floor in the light of one lamp with a surface, four metres above the floor.
enum class Caster : uint8_t { box, sphere, cylinder, torus };
/// \param height Of the caster's centre over the floor; \param radius of the lamp. Metres.
demo::Scene softScene(Caster caster, demo::LightKind kind, double height, float radius);

/// Makes a spot light's source a rectangle whose axis is turned from those of the scenes. \param half Of its sides,
/// metres.
void setRectangle(demo::Light& light, glm::vec2 half);

/// A floor, and over it a level sheet that hides all that lies left of the line x = 0, y = height. One lamp, whose
/// centre is over that line, four metres above the floor.
demo::Scene halfPlane(demo::LightKind kind, double height, float radius);

/// A floor, and over it what is no simple solid: two tori in one mesh that pass through each other, a torus with fins
/// on some of its edges, one whose triangles are all there twice, and one with every seventh triangle turned inside
/// out. Layer 0 sun, 1 spot, 2 point.
demo::Scene oddCasters();

/// In one mesh, which is open: a sheet for a floor, crates, and a chamber whose faces look inwards. Layer 0 sun, 1 a
/// lamp in the chamber. \param inCrate the eye is in a crate, else it looks down from outside.
demo::Scene solidsOfOpenMesh(bool inCrate);

/// A plain of a square kilometre, seen from above, four metres under a lamp that reaches past it all. Just under the
/// lamp hangs a card, and a crate stands on the plain.
demo::Scene lampOverPlain(demo::LightKind kind);

/// Casters on a floor, and a lamp that lies in the plane of a face of what holds it: a box for a ceiling, turned
/// and moved so that its corners are rounded; a sheet for a ceiling, its front side down or up; an upright card of
/// which both sides are seen; a ceiling whose mesh is squashed into shape; the upper corner of a room of one mesh,
/// where three of its faces meet; or the sheet or the box again, all in one mesh with it, the lamp a
/// hair's breadth within the box. A spot looks straight down.
enum class LitFrom : uint8_t {
    solidCeiling,
    squashedCeiling,
    sheetCeiling,
    sheetTurnedUp,
    card,
    roomCorner,
    sheetOfOpenMesh,
    solidOfOpenMesh
};
demo::Scene flushLamp(LitFrom held, demo::LightKind kind);

/// A ground of two triangles, 2 km wide, with a crate on it and `count` lamps that reach 25 m thrown over the part that
/// is seen, half a metre to nine above it.
demo::Scene lampsOverLargeTriangles(demo::LightKind kind, uint32_t count);

/// The instances whose mesh is closed, alone.
demo::Scene onlyClosed(demo::Scene scene);

} // namespace gnomon::exact
