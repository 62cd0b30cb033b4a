// What the demo's renderer hands to its shaders. Everything is relative to the eye, so that float suffices anywhere.
#ifndef GNOMON_DEMO_FRAME_H
#define GNOMON_DEMO_FRAME_H
#include "../shared/conventions.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MAX_DEMO_LIGHTS = 256u; // as many as a view of gnomon holds
GN_SHARED_CONST uint LIGHT_TILES = 16u;        // of the screen, a side
GN_SHARED_CONST uint LIGHT_TILE_WORDS = 8u;    // a bit for each light
GN_SHARED_CONST uint ERROR_COUNTS = 64u;       // that pixels add to in turn
GN_SHARED_CONST uint MAX_MAP_LAYERS = 6u;      // of GnLightMap
// The normal target carries an instance's number in a half float, by its bits: those of the positive normal numbers.
GN_SHARED_CONST uint FIRST_INSTANCE_HALF = 0x0400u;
GN_SHARED_CONST uint MAX_DEMO_INSTANCES = 0x7c00u - FIRST_INSTANCE_HALF;

struct DemoInstance {
    vec4 worldFromObject[3]; // rows; translation relative to the eye, metres
    vec4 cofactors[3];       // rows of the cofactor matrix, negated where it mirrors: carries normals; w unused
    vec4 albedo;             // linear RGB; w unused
    uint firstTriangle;      // of its mesh, in the table of normals
    uint padding[3];
};
GN_SHARED_SIZE(DemoInstance, 128)

struct DemoLight {
    vec4 positionEye; // xyz relative to the eye; w unused
    vec4 direction;   // xyz unit, the way light travels; w cosine of the cone's half angle
    vec4 colour;      // linear RGB times intensity; w range in metres
    float cosInner;   // spot: cosine of the half angle of full intensity
    uint type;        // LIGHT_DIRECTIONAL, LIGHT_SPOT, LIGHT_POINT
    uint padding[2];
};
GN_SHARED_SIZE(DemoLight, 64)

// std430, in a storage buffer, so that C++ and GLSL agree without any rounding up of arrays.
struct DemoView {
    mat4 clipFromEye; // world axes, origin at the eye
    vec4 rayCorner;   // view ray of linear depth 1 at pixel coordinate (0, 0)
    vec4 rayDx;       // its change per pixel to the right
    vec4 rayDy;       // and per pixel down
    vec4 extent;      // xy pixels, of a tile zw
    float depthScale; // linear depth = depthScale / (depth + depthAdd), metres
    float depthAdd;
    float skyDepth;   // depth where nothing was drawn
    float ambient;    // scales the light from everywhere
    vec4 sky;         // linear RGB; w unused
    DemoLight lights[MAX_DEMO_LIGHTS];
    uint tileLights[LIGHT_TILES * LIGHT_TILES * LIGHT_TILE_WORDS]; // which may reach a pixel of a tile, row by row
};

// A light's map, for the width of its texels.
struct DemoMap {
    mat4 clipFromEye[MAX_MAP_LAYERS]; // world axes, origin at the eye; in the order in which layers are looked up
    vec2 extent;                      // texels
    uint layers;
    uint light;                       // of DemoView
};
GN_SHARED_SIZE(DemoMap, 400)

GN_SHARED_END
#endif
