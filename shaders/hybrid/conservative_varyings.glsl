// A triangle on its way from conservative.vert to conservative.frag, which defines VARYING as in.
#ifndef VARYING
#define VARYING out
#endif

layout(location = 0) flat VARYING vec4 edge0;
layout(location = 1) flat VARYING vec4 edge1;
layout(location = 2) flat VARYING vec4 edge2;
layout(location = 3) flat VARYING vec4 plane;
layout(location = 4) flat VARYING vec4 rect;
layout(location = 5) flat VARYING vec4 range;
layout(location = 6) flat VARYING uint triangleNumber;

// What is drawn.
const uint LAYER_NEAR = 0u;        // over-estimated: every texel touched, with the smallest depth in it
const uint LAYER_FAR = 1u;         // under-estimated: every texel covered, with the largest depth in it
const uint LAYER_SLOPE = 2u;       // every texel touched, with the triangle's slope
const uint LAYER_THESIS_NEAR = 3u; // as the thesis has them: depth of the plane at the centre
const uint LAYER_THESIS_FAR = 4u;
const uint LAYER_CENTRE = 5u;      // every texel whose centre is on the triangle, with its depth there
