#version 460
// Casters onto one half. Edges and depths between the vertices are straight, so no edge may span more than
// maxEdgeAngle() (algorithms/omni/tessellation.hpp). WORLD_SPACE: vertices that were subdivided on the CPU.
#extension GL_GOOGLE_include_directive : require
#include "paraboloid.h"
#ifdef WORLD_SPACE
layout(location = 0) in vec3 vertexWs;
vec3 casterWorldPosition() { return vertexWs; }
#else
#include "../shared/casters.glsl"
#endif

layout(push_constant) uniform Push {
    vec4 lightWs;     // xyz; w = 1 / distance of depth 1
    float discRadius; // in clip units: the rest of the square is border for filters
    uint hemi;
};

void main()
{
    vec3 local = inParaboloid(hemi, casterWorldPosition() - lightWs.xyz);
    float distance = max(length(local), 1e-20);
    local /= distance;
    // Behind 120 degrees (disc radius 1.7, outside the square's corners at 1.4) a triangle may fold around the pole: its
    // vertices go past the far end, where it is clipped.
    bool behind = local.z < -0.5;
    vec2 disc = paraboloidDisc(vec3(local.xy, max(local.z, -0.9)));
    gl_Position = vec4(disc * discRadius, behind ? 2.0 : distance * lightWs.w, 1.0);
}
