// How a caster's face lies to a light: one arithmetic for the shaders and the CPU, which must agree.
#ifndef GNOMON_SHARED_FACE_LIGHT_H
#define GNOMON_SHARED_FACE_LIGHT_H
#include "types.h"

GN_SHARED_BEGIN

// Ways of a face, as stored in bytes and compared in shaders.
GN_SHARED_CONST uint FACE_AWAY = 0u;    // its winding, in the world, looks away from the light
GN_SHARED_CONST uint FACE_TOWARDS = 1u; // or towards it
GN_SHARED_CONST uint FACE_TOUCHED = 2u; // of an open mesh: the light lies in its plane, and no side of it is dark

// A light for the faces of one caster, in object space.
struct FaceLight {
    vec4 at;      // a face looks towards the light if dot(plane, at) > 0
    float touch;  // it touches the light if dot(plane, at)^2 <= touch * its normal's length^2; 0: no face does
    uint touched; // the way of those that do
    uint padding0;
    uint padding1;
};
GN_SHARED_SIZE(FaceLight, 32)

// The same operations in the same order everywhere: the three edges of a face, its caps and the kernels of
// algorithms/volumes/facing.hpp find the same ways.
GN_SHARED_FN float faceSide(vec4 plane, vec4 at)
{
    GN_PRECISE float side = plane.x * at.x + plane.y * at.y + plane.z * at.z + plane.w * at.w;
    return side;
}

GN_SHARED_FN bool touchesLight(vec4 plane, FaceLight light)
{
    GN_PRECISE float side = faceSide(plane, light.at);
    GN_PRECISE float square = plane.x * plane.x + plane.y * plane.y + plane.z * plane.z;
    GN_PRECISE float limit = light.touch * square;
    GN_PRECISE float reached = side * side;
    return reached <= limit;
}

GN_SHARED_FN uint faceWay(vec4 plane, FaceLight light)
{
    if (light.touch > 0.0f && touchesLight(plane, light)) return light.touched;
    return faceSide(plane, light.at) > 0.0f ? FACE_TOWARDS : FACE_AWAY;
}

// +1 if the face, turned towards the light, runs the edge as its use says; -1 if the other way; 0 if it is touched.
GN_SHARED_FN int edgeWay(uint way, bool forward)
{
    if (way == FACE_TOUCHED) return 0;
    return (way == FACE_TOWARDS) == forward ? 1 : -1;
}

GN_SHARED_END
#endif
