#version 460
// Casters onto one paraboloid. Edges and depths between the vertices are straight, so no edge may span more than
// maxEdgeAngle() (algorithms/omni/tessellation.hpp). WORLD_SPACE: vertices that were subdivided on the CPU.
#extension GL_GOOGLE_include_directive : require
#include "../shared/paraboloid.h"
#ifdef WORLD_SPACE
layout(location = 0) in vec3 vertexWs;
vec3 casterWorldPosition() { return vertexWs; }
#else
#include "../shared/casters.glsl"
#endif

layout(push_constant) uniform Push {
    vec4 lightWs; // xyz; w = 1 / distance of depth 1
    Paraboloid part;
};

void main()
{
    vec3 fromLight = casterWorldPosition() - lightWs.xyz;
    float distance = max(length(fromLight), 1e-20);
    vec3 direction = fromLight / distance;
    vec3 local = inParaboloid(part, direction);
    // A triangle may fold around the point behind the paraboloid. 30 degrees past the rim it is off the map, however its
    // other vertices lie: they go past the far end, where it is clipped.
    bool behind = dot(direction, part.poleWs.xyz) < -0.5;
    vec2 disc = paraboloidDisc(vec3(local.xy, max(local.z, -0.98)));
    gl_Position = vec4(paraboloidMap(part, disc), behind ? 2.0 : distance * lightWs.w, 1.0);
}
