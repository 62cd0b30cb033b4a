// A depth map as a surface: which parts of it are drawn, by which polygons, and where their corners are.
//
// A cell lies between the centres of 2 x 2 texels. Its corners are numbered 0 (0,0), 1 (1,0), 2 (1,1), 3 (0,1), its
// side k runs from corner k to corner k + 1. Along a side depth is linear, or it jumps half-way. Round the cell run its
// four corners and, on every side that jumps, two vertices at the same place: one at the depth of either end. How the
// ring of these 4 to 12 vertices is filled with triangles is a template (algorithms/volumes/depth_surface.hpp).
#ifndef GNOMON_VOLUMES_MCCOOL_H
#define GNOMON_VOLUMES_MCCOOL_H
#include "../shared/map_lookup.h"
#include "volume.h"

GN_SHARED_BEGIN

// One map of a light: where its texels are, and what counts as smooth. std140.
struct DepthSurface {
    vec4 originEs; // xyz directional: texel coordinate (0, 0) at depth 0; otherwise the ray through it, 1 m along the
                   // axis
    vec4 texelDx;  // xyz: change per texel to the right
    vec4 texelDy;  // xyz: and per texel down
    vec4 axis;     // xyz directional: change per unit of depth; otherwise 0
    vec4 reach;    // xyz: of extrusionPlane()
    float depthConstant; // lights with a position: metres along the axis = depthScale / (depth - depthConstant)
    float depthScale;
    float positional;        // 1 spot and point, 0 directional
    float tolerance;         // depth that one texel's width is worth: tolerance ...
    float tolerancePerDepth; // ... + tolerancePerDepth * (depthConstant - depth)
    uint side;               // texels
    uint cellCapacity;       // cells with jumps that the list holds
    uint indexCapacity;      // and indices of their polygons
};
GN_SHARED_OFFSET(DepthSurface, depthConstant, 80)
GN_SHARED_SIZE(DepthSurface, 112)

// Templates: by the sides that jump (bit k: side k) + 16 * the variant where there are several. std140: four in a
// uvec4.
GN_SHARED_CONST uint TEMPLATES = 48u;
GN_SHARED_CONST uint TEMPLATE_TRIANGLES = 10u; // at most: a ring of 12 vertices
GN_SHARED_CONST uint TEMPLATE_BLOCK = 120u;    // uvec4: TEMPLATES * TEMPLATE_TRIANGLES / 4

// Of mccool_polygons.comp. std140.
struct PolygonConstants {
    DepthSurface surface;
    uvec4 templates[120]; // TEMPLATE_BLOCK
};
GN_SHARED_SIZE(PolygonConstants, 2032)

// Most texels about the near rectangle that a vertex shader asks one by one: 0.02 ms on a software device. The near
// plane of a camera that stands beside things meets a few dozen.
GN_SHARED_CONST uint MAX_NEAR_TEXELS = 1024u;

// Of mccool_cap.vert and .frag. std140.
struct CapConstants {
    MapConstants base;
    DepthSurface surface;
    vec4 nearTexels; // texels about the near rectangle: x, y of the first, x, y of the last; first > last: none
    float nearDepth; // greatest map depth on the near rectangle
    float nearWs;    // linear depth of the near plane
    float always;    // 1: the rectangle is not asked texel by texel
    float receivers; // 1: the receivers are asked, not the near plane
    uvec4 templates[120]; // TEMPLATE_BLOCK
};
GN_SHARED_OFFSET(CapConstants, nearTexels, 528)
GN_SHARED_SIZE(CapConstants, 2480)

// The list of one map: VkDrawIndexedIndirectCommand, how many indices were asked for, then, from a round offset on, the
// indices. If they do not fit, the instance count is 0, and the map is looked up instead.
GN_SHARED_CONST uint POLYGON_HEADER = 8u; // words

// Invocations of mccool_polygons.comp; each takes every so-many-th cell.
GN_SHARED_CONST uint POLYGON_GROUPS = 32u;
GN_SHARED_CONST uint POLYGON_GROUP = 64u;

// A listed cell: its left and upper texel, from -1 on, and its jumps.
GN_SHARED_FN uint packCell(int x, int y, uint jumps)
{
    return uint(x + 1) | (uint(y + 1) << 14) | (jumps << 28);
}
GN_SHARED_FN int cellX(uint cell) { return int(cell & 0x3fffu) - 1; }
GN_SHARED_FN int cellY(uint cell) { return int((cell >> 14) & 0x3fffu) - 1; }

// Rows of cells that one invocation of mccool_edges.comp walks through; a workgroup is 64 columns wide.
GN_SHARED_CONST uint EDGE_ROWS = 32u;
GN_SHARED_CONST uint EDGE_COLUMNS = 64u;

// Depth of a texel without casters.
GN_SHARED_CONST float NOTHING = 1.0f;
// Texels of depth per texel beyond which nothing is taken for smooth: 86 degrees from the light's view. Steps of that
// size that happen to be equal need not belong to one face.
GN_SHARED_CONST float SMOOTH_SLOPE = 16.0f;

// Whether depth jumps between texels a and b; `before` and `after` continue their row. It does not if the step is less
// than a texel's width, or continues the slope on either side to within that: the surface is then a face of a caster.
GN_SHARED_FN bool depthJumps(DepthSurface surface, float before, float a, float b, float after)
{
    if (a >= NOTHING || b >= NOTHING) return (a >= NOTHING) != (b >= NOTHING);
    // Several shaders ask, of the same side from either cell; where one said yes and one no the surface had a hole.
    GN_PRECISE float step = b - a, off = abs(step);
    GN_PRECISE float tolerance = surface.tolerance + surface.tolerancePerDepth * (surface.depthConstant - max(a, b));
    if (off > SMOOTH_SLOPE * tolerance) return true;
    if (before < NOTHING) off = min(off, abs(step - (a - before)));
    if (after < NOTHING) off = min(off, abs(step - (after - b)));
    return off > tolerance;
}

GN_SHARED_FN uint jumpCount(uint jumps)
{
    return (jumps & 1u) + ((jumps >> 1) & 1u) + ((jumps >> 2) & 1u) + (jumps >> 3);
}

// Triangles of a template: the ring has 4 + 2 n vertices.
GN_SHARED_FN uint triangleCountOf(uint jumps)
{
    return 2u + 2u * jumpCount(jumps);
}

// "Nothing" is deeper than any two depths together.
GN_SHARED_FN float comparable(float depth)
{
    return depth >= NOTHING ? 4.0f : depth;
}

// The template of a cell. Walls must not end within a cell where one side of them is nothing: of three jumps the least
// ends in the cell, never one from caster to nothing (there are two of those, or none, and they are larger than
// others). Of four, walls part the deeper two corners from the rest, so that thin casters hang together.
GN_SHARED_FN uint templateOf(uint jumps, vec4 depths)
{
    uint count = jumpCount(jumps), variant = 0u, seen = 0u;
    float least = 1e30f;
    for (int k = 0; k < 4; ++k) {
        if (((jumps >> k) & 1u) == 0u) continue;
        float jump = abs(comparable(depths[k]) - comparable(depths[(k + 1) & 3]));
        if (jump < least) {
            least = jump;
            variant = seen;
        }
        ++seen;
    }
    if (count == 4u)
        variant =
            comparable(depths[1]) + comparable(depths[3]) < comparable(depths[0]) + comparable(depths[2]) ? 1u : 0u;
    return jumps + (count >= 3u ? 16u * variant : 0u);
}

// Vertices of a template: 0 to 3 the corners; 4 + 2 k half-way along side k at the depth of corner k, 5 + 2 k there at
// the depth of corner k + 1. Places in half texels from corner 0, two bits a vertex.
GN_SHARED_CONST uint PLACE_X = 0x5a528u;
GN_SHARED_CONST uint PLACE_Y = 0x5a50a0u;
GN_SHARED_CONST uint LATER_TEXEL = 0x5a0u; // bit v: depth of the texel to the right or below; else to the left or above

GN_SHARED_FN vec2 placeOf(uint vertex)
{
    return vec2(float((PLACE_X >> (2u * vertex)) & 3u), float((PLACE_Y >> (2u * vertex)) & 3u));
}

// The corner whose depth a vertex has.
GN_SHARED_FN uint cornerOf(uint vertex)
{
    return vertex < 4u ? vertex : (((vertex - 4u) >> 1) + (vertex & 1u)) & 3u;
}

// A triangle of a template: three vertices of four bits, then the set of corners whose depths they have.
GN_SHARED_FN uint vertexOf(uint triangle, uint i)
{
    return (triangle >> (4u * i)) & 15u;
}
GN_SHARED_FN uint cornersOf(uint triangle)
{
    return triangle >> 12;
}

// Corners on the far side of some jump.
GN_SHARED_FN uint beyondJumps(uint jumps, vec4 depths)
{
    uint corners = 0u;
    for (int k = 0; k < 4; ++k)
        if (((jumps >> k) & 1u) != 0u) corners |= 1u << (depths[k] > depths[(k + 1) & 3] ? k : (k + 1) & 3);
    return corners;
}

// Whether a triangle of a cell is drawn: not if it bounds nothing, nor if it lies at the map's rim on the near side of the
// wall there, for beyond the rim the face that it is on goes on.
GN_SHARED_FN bool isDrawn(uint triangle, uint beyond, uint casters, bool rim)
{
    uint corners = cornersOf(triangle);
    return (corners & casters) != 0u && !(rim && (corners & beyond) == 0u);
}

// A vertex is its index, whichever cell names it: twice its place in half texels, row by row, counted from the centre
// of the texel before the first one, plus its bit of LATER_TEXEL. Cells that meet thus share their vertices.
GN_SHARED_FN uint indexStride(uint side)
{
    return 2u * side + 3u;
}
GN_SHARED_FN uint vertexIndex(uint side, int cellX, int cellY, uint vertex)
{
    uint x = 2u * uint(cellX + 1) + ((PLACE_X >> (2u * vertex)) & 3u);
    uint y = 2u * uint(cellY + 1) + ((PLACE_Y >> (2u * vertex)) & 3u);
    return ((y * indexStride(side) + x) << 1) | ((LATER_TEXEL >> vertex) & 1u);
}

// And back: its place in texels of the map, and the texel (-1 .. side) that has its depth.
GN_SHARED_FN vec2 indexPlace(uint side, uint index)
{
    uint at = index >> 1, stride = indexStride(side);
    return 0.5f * vec2(float(at % stride), float(at / stride)) - vec2(0.5f, 0.5f);
}
GN_SHARED_FN vec2 indexTexel(uint side, uint index)
{
    uint at = index >> 1, stride = indexStride(side), later = index & 1u;
    return vec2(float((at % stride + later) >> 1), float((at / stride + later) >> 1)) - vec2(1.0f, 1.0f);
}

// A point of the map, relative to the eye. light: VolumeConstants::lightEs.
GN_SHARED_FN vec3 surfacePoint(DepthSurface surface, vec4 light, vec2 texel, float depth)
{
    vec3 ray = vec3(surface.originEs) + texel.x * vec3(surface.texelDx) + texel.y * vec3(surface.texelDy);
    if (surface.positional == 0.0f) return ray + depth * vec3(surface.axis);
    return vec3(light) + ray * (surface.depthScale / (depth - surface.depthConstant));
}

GN_SHARED_END
#endif
