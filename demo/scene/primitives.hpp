#pragma once

#include "demo/scene/scene.hpp"

#include <span>

/// Generated meshes. Every closed one shares its vertices (so it is watertight without any welding), winds outward
/// counter-clockwise and has no zero-area triangle. Lengths in metres, object space.
namespace gnomon::demo {

struct PlaneShape {
    float width = 1.0f, depth = 1.0f; ///< Along x and z, centred; the normal is +y. Open.
    uint32_t columns = 1, rows = 1;
};

struct BoxShape {
    glm::vec3 size{1.0f}; ///< Centred at the origin.
};

struct SphereShape {
    float radius = 0.5f;
    uint32_t slices = 32; ///< Around the y axis, >= 3.
    uint32_t stacks = 16; ///< From pole to pole, >= 2.
};

struct TorusShape {
    float radius = 1.0f;        ///< Of the ring, in the xz plane.
    float tube = 0.35f;         ///< < radius.
    uint32_t ringSegments = 48; ///< >= 3.
    uint32_t tubeSegments = 24; ///< >= 3.
};

/// A (p, q) knot on a torus: p turns about the y axis while q turns about the ring; p and q have no common factor.
struct TorusKnotShape {
    float radius = 1.0f; ///< Of the torus that carries the knot.
    float sweep = 0.45f; ///< Its minor radius, < radius.
    float tube = 0.16f;
    uint32_t p = 2, q = 3;
    uint32_t knotSegments = 160; ///< >= 3.
    uint32_t tubeSegments = 16;  ///< >= 3.
};

struct CylinderShape {
    float radius = 0.5f; ///< At the bottom.
    float topRadius = 0.5f;
    float height = 1.0f; ///< From y = 0 up.
    uint32_t segments = 32;
    uint32_t rings = 1; ///< Rows of quads along the height.
};

/// A plinth, a shaft that tapers by a sixth, a capital: one closed surface of revolution from y = 0 up.
struct ColumnShape {
    float radius = 0.4f; ///< Of the shaft's foot.
    float height = 4.0f;
    uint32_t segments = 32;
    uint32_t rings = 12; ///< Along the shaft.
};

/// A half ring of rectangular section in the xy plane, feet at y = 0, centred in z. Closed.
struct ArchShape {
    float innerRadius = 1.0f, outerRadius = 1.4f;
    float depth = 0.6f;
    uint32_t segments = 24;
};

/// Two octaves of value noise made from integer hashes: the same heights with every compiler and C library.
struct TerrainShape {
    float width = 40.0f, depth = 40.0f; ///< Along x and z, centred.
    float height = 2.0f;                ///< Heights lie in [0, height].
    float featureSize = 10.0f;          ///< Metres between hills.
    float thickness = 0.0f;             ///< 0: open height field. > 0: closed by walls and a flat bottom at -thickness.
    uint32_t columns = 64, rows = 64;
    uint32_t seed = 1;
};

/// An open, single-sided grid in the xy plane facing +z, hanging down from y = 0, with folds in z.
struct ClothShape {
    float width = 2.0f, height = 2.0f;
    float amplitude = 0.15f; ///< Of the folds, growing from 0.3 of it at the top to all of it at the bottom.
    float folds = 3.0f;      ///< Over the width.
    uint32_t columns = 32, rows = 32;
};

/// One open quad in the xy plane facing +z, centred.
struct CardShape {
    float width = 1.0f, height = 1.0f;
};

/// Leaves strewn evenly in an ellipsoid around the origin, turned every way: what sub-texel and thin casters are made
/// of.
struct LeavesShape {
    glm::vec3 size{4.0f};              ///< Of the ellipsoid, axis to axis.
    float length = 0.4f, width = 0.2f; ///< Of a leaf, a rhombus.
    uint32_t count = 500;
    uint32_t seed = 1;
    bool closed = false; ///< Eight triangles around a body a quarter as thick as wide, instead of two of a sheet.
    uint32_t blades =
        1; ///< Sheets that share a leaf's axis, which is an edge of two triangles of each; 1 where closed.
};

/// A house of rows of windows that are set back, flat roof and parapet, from y = 0 up. Closed: boxes of a lattice.
struct BuildingShape {
    float width = 18.0f, depth = 12.0f; ///< Along x and z, centred.
    float storey = 3.2f;                ///< Height of a floor.
    uint32_t floors = 6;
    uint32_t bays = 5, sideBays = 4; ///< Windows of a floor, of the fronts (facing z) and of the sides.
    float recess = 0.3f;             ///< How deep windows are set back, and the thickness of the parapet.
};

Mesh makePlane(const PlaneShape& shape);
Mesh makeBox(const BoxShape& shape);
Mesh makeSphere(const SphereShape& shape);
Mesh makeTorus(const TorusShape& shape);
Mesh makeTorusKnot(const TorusKnotShape& shape);
Mesh makeCylinder(const CylinderShape& shape);
Mesh makeColumn(const ColumnShape& shape);
Mesh makeArch(const ArchShape& shape);
Mesh makeTerrain(const TerrainShape& shape);
Mesh makeCloth(const ClothShape& shape);
Mesh makeCard(const CardShape& shape);
Mesh makeLeaves(const LeavesShape& shape);
Mesh makeBuilding(const BuildingShape& shape);

/// Triangles of makeBuilding().
uint64_t triangleCount(const BuildingShape& shape);

/// Uniform in [0, 1] for a lattice point, the same with every compiler and C library.
float latticeValue(int32_t x, int32_t z, uint32_t seed);

/// Height of the terrain's surface above its y = 0 at any x, z of its rectangle (the formula, not the triangles).
float terrainHeight(const TerrainShape& shape, float x, float z);

/// One corner of a revolved outline.
struct ProfilePoint {
    float radius, y;
};

/// Revolves an outline about the y axis. It must start and end on the axis (radius 0), in between keep off it, and run
/// so that the solid lies to its left when x points right and y up (bottom to top along the outside).
Mesh revolve(std::span<const ProfilePoint> outline, uint32_t segments);

} // namespace gnomon::demo
