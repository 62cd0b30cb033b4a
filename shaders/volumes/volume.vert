#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_spirv_intrinsics : require
// Corners of shadow volumes: index = 2 * vertex + copy; copy 0 is the caster's vertex, copy 1 the same moved away from
// the light.
#include "volume_corner.glsl"

layout(push_constant, std430) uniform Push { VolumePush caster; };

void main()
{
    cornerClip = volumeCorner(caster, uint(gl_VertexIndex) >> 1, (gl_VertexIndex & 1) != 0);
}
