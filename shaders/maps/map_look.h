// How a resolve pass looks at a map: constants of the view, the light and the map's projection.
#ifndef GNOMON_MAPS_MAP_LOOK_H
#define GNOMON_MAPS_MAP_LOOK_H
#include "../shared/receiver.h"

GN_SHARED_BEGIN

// std140 and std430 alike. "Clip" is the map's clip space with x and y in texels: texel = clip.xy / clip.w. w is the
// linear depth of a perspective map (1 metre along its axis is 1) and 1 for a directional light.
struct MapLook {
    mat4 clipFromRay;  // clip = clipOfEye + w * clipFromRay * (view ray, 0), w the receiver's linear depth
    vec4 clipOfEye;
    vec4 texelDx;      // xyz: world change of a texel's ray (directional: of its origin) per texel to the right, at w = 1
    vec4 texelDy;      // xyz: and per texel down
    vec4 axisWs;       // xyz directional: world change per unit of map depth; otherwise 0
    vec4 offset;       // offset of the receiver towards the light, metres: x + w (y + w z)
    vec4 area;         // pixels drawn: x, y, width, height
    float depthConstant; // perspective: map depth = depthConstant + depthScale / clip.w; directional: 0 and -1
    float depthScale;
    float positional;    // 1 spot and point, 0 directional
    float side;          // texels
    float filterSide;    // texels, odd
    float slope;         // cube: half width of a face at depth 1; paraboloid: texels per unit of the disc's radius
    float farWs;         // paraboloid: distance of depth 1, metres
    float padding;
};
GN_SHARED_OFFSET(MapLook, depthConstant, 160)
GN_SHARED_SIZE(MapLook, 192)

struct MapConstants {
    ViewConstants view;
    LightConstants light;
    MapLook map;
};
GN_SHARED_SIZE(MapConstants, 400)

// Share of a texel's own slope by which a receiver is moved towards the light: rasterisers snap vertices to 1/256 texel,
// which shifts a face by up to 1/512 in x and in y; eight times that also covers interpolated depths.
GN_SHARED_CONST float SNAP_TEXELS = 1.0f / 64.0f;
// Rounding of a depth near 1 through two matrices: eight units in the last place of a 32-bit float.
GN_SHARED_CONST float DEPTH_ROUNDING = 1.0f / 1048576.0f;

GN_SHARED_END
#endif
