#version 460
#extension GL_GOOGLE_include_directive : require
// A caster flattened onto the plane that receives its shadow.
#include "planar.h"

layout(set = 0, binding = 0, std140) uniform Constants { PlanarConstants constants; };
layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
layout(set = 0, binding = 2, std430) readonly buffer Plane { ReceiverPlane plane; };
layout(push_constant, std430) uniform Push { PlanarPush caster; };

out gl_PerVertex
{
    vec4 gl_Position;
    float gl_ClipDistance[2];
};

void main()
{
    int i = 3 * gl_VertexIndex;
    vec4 os = vec4(positions[i], positions[i + 1], positions[i + 2], 1.0);
    vec3 es = vec3(dot(caster.rows[0], os), dot(caster.rows[1], os), dot(caster.rows[2], os));
    Fallen point = fallen(es, plane.normal.xyz, constants.lightEs);
    bool found = plane.normal.w > 0.0;
    gl_Position = found ? constants.clipFromEye * point.positionEs : vec4(0.0, 0.0, 0.0, 1.0);
    gl_ClipDistance[0] = found ? point.above : -1.0;
    gl_ClipDistance[1] = point.below;
}
