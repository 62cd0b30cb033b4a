#version 460
#extension GL_GOOGLE_include_directive : require
// Corners of the wedges under silhouette edges, from the sides' own index list: it holds six indices an edge, of which the
// first is its start (near copy) and the third its end (far copy). Drawn without indices, WEDGE_PARTS times.
#include "wedge.h"

layout(set = 0, binding = 0, std140) uniform Constants { VolumeConstants constants; };
layout(set = 0, binding = 1, std430) readonly buffer Positions { float positions[]; };
#include "receiver_plane.glsl"
layout(set = 0, binding = 3, std430) readonly buffer Sides { uint sides[]; };
layout(set = 0, binding = 4, std140) uniform Receivers { WedgeConstants wedges; };
layout(push_constant, std430) uniform Push { WedgePush push; };
layout(location = 0) flat out vec3 fromEs;
layout(location = 1) flat out vec3 toEs;

vec3 vertexEs(uint vertex)
{
    vec4 os = vec4(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2], 1.0);
    return vec3(dot(push.caster.rows[0], os), dot(push.caster.rows[1], os), dot(push.caster.rows[2], os));
}

// All rays of a wedge end on the plane behind the receivers, or all go on to infinity: also where the edge itself lies
// beyond it with an end, whose rays would run back.
vec4 endPlane(Wedge wedge)
{
    vec4 plane = receiverPlane(push.caster.reach.xyz);
    bool ends = max(dot(plane.xyz, fromEs), dot(plane.xyz, toEs)) <= plane.w;
    for (int i = 0; i < 4; ++i)
        ends = ends && dot(plane.xyz, wedge.rays[i]) > 1e-3 * length(wedge.rays[i]);
    return ends ? plane : vec4(0.0);
}

void main()
{
    uint index = uint(gl_VertexIndex);
    uint side = index - index % 6u;
    fromEs = vertexEs(sides[side] >> 1);
    toEs = vertexEs(sides[side + 2u] >> 1);
    Wedge wedge = penumbraWedge(fromEs, toEs, wedges.lightEs.xyz, wedges.lightEs.w);
    bool mirrored = push.mirrored != 0u;
    uint corner = drawnCorner(push.part, index % 6u, mirrored);
    vec3 tip = corner == 0u || corner == 2u || corner == 3u ? fromEs : toEs;
    vec4 position = corner < 2u ? vec4(tip, 1.0) : extruded(tip, vec4(wedge.rays[(corner + 2u) & 3u], 0.0), endPlane(wedge));
    gl_Position = constants.clipFromEye * position;
    if (wedge.whole == 0.0) return;
    // The whole view as one side of a hull: of the depth of the sky and turned away from the eye, or as near as can be
    // and turned towards it.
    bool left = corner == 2u || corner == 3u, first = corner == 2u || corner == 4u;
    bool low = (first == (push.before == 0u)) != mirrored;
    float z = push.before == 0u ? wedges.view.skyDepth : 1.0 - wedges.view.skyDepth;
    gl_Position = push.part == 3u ? vec4(left ? -1.0 : 1.0, low ? -1.0 : 1.0, z, 1.0) : vec4(0.0, 0.0, 0.0, 1.0);
}
