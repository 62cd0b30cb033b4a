// What a receiver is: the surface point behind a pixel, as every method, the ray-traced truth and the dumps see it.
#ifndef GNOMON_SHARED_RECEIVER_H
#define GNOMON_SHARED_RECEIVER_H
#include "conventions.h"

GN_SHARED_BEGIN

// std140 and std430 alike: only vec4 and mat4 before the scalars.
struct ViewConstants {
    mat4 clipFromWorld; // as the host drew its depth, but relative to the origin
    vec4 eyeWs;         // xyz metres; w unused
    vec4 rayCornerWs;   // xyz: view ray of linear depth 1 at pixel coordinate (0, 0)
    vec4 rayDxWs;       // xyz: its change per pixel to the right
    vec4 rayDyWs;       // xyz: and per pixel down
    float depthScale;   // linear depth w = depthScale / (depth * depthMul + depthAdd), metres
    float depthMul;
    float depthAdd;
    float skyDepth;     // the depth value that means: no receiver
    float offsetFactor; // k of the offset: 1 for reversed-Z, 3 for standard depth
    float pixelSize;    // width of a pixel at linear depth 1, metres
    uint hasNormals;    // 0: the host gives no geometric normals
    float corners;      // what coordinates of corners of seen triangles count as in largestCoordinate(), metres
};
GN_SHARED_OFFSET(ViewConstants, eyeWs, 64)
GN_SHARED_OFFSET(ViewConstants, depthScale, 128)
GN_SHARED_SIZE(ViewConstants, 160)

struct LightConstants {
    vec4 positionWs;  // xyz metres; w = 0 directional light, 1 otherwise
    vec4 directionWs; // xyz unit, the way light travels; w = cosine of the cone's half angle (-2 where there is no cone)
    float range;      // metres; a very large number where unlimited
    uint type;        // LIGHT_DIRECTIONAL, LIGHT_SPOT, LIGHT_POINT
    float sourceRadius;
    uint padding;
};
GN_SHARED_SIZE(LightConstants, 48)

// Linear depth (clip w) of a depth value, metres.
GN_SHARED_FN float linearDepth(ViewConstants view, float depth)
{
    return view.depthScale / (depth * view.depthMul + view.depthAdd);
}

// View ray of linear depth 1 through a point given in pixels.
GN_SHARED_FN vec3 viewRayWs(ViewConstants view, vec2 pixel)
{
    return vec3(view.rayCornerWs) + pixel.x * vec3(view.rayDxWs) + pixel.y * vec3(view.rayDyWs);
}

// From the receiver towards the light, unit length.
GN_SHARED_FN vec3 towardsLightWs(LightConstants light, vec3 receiverWs)
{
    vec3 toLight = vec3(light.positionWs) - receiverWs;
    return light.type == LIGHT_DIRECTIONAL ? -vec3(light.directionWs) : toLight / max(length(toLight), 1e-20f);
}

// Whether a light reaches what lies at `fromLight` of it: range and cone. By squares: no root per pixel.
//   cone  xyz: unit axis, the way light travels; w: cosine of the half angle times its absolute value; below -1 every
//         direction passes
GN_SHARED_FN bool reaches(vec3 fromLight, vec4 cone, float rangeSquared)
{
    float square = dot(fromLight, fromLight);
    float along = dot(fromLight, vec3(cone));
    return square <= rangeSquared && along * abs(along) >= cone.w * square;
}

// The same for a point, from a light's constants. Where not, visibility is 1.
GN_SHARED_FN bool lightReaches(LightConstants light, vec3 receiverWs)
{
    vec4 cone = light.directionWs;
    cone.w *= abs(cone.w);
    return light.type == LIGHT_DIRECTIONAL ||
           reaches(receiverWs - vec3(light.positionWs), cone, light.range * light.range);
}

// Distance that one unit in the last place of `depth` spans along the view ray, metres.
GN_SHARED_FN float depthUlpWs(ViewConstants view, float depth, vec3 ray)
{
    float ulp = uintBitsToFloat(floatBitsToUint(depth) + 1u) - depth;
    float w = linearDepth(view, depth);
    return length(ray) * w * w * abs(view.depthMul / view.depthScale) * ulp;
}

// Largest coordinate of receiver or light, relative to the eye and to the frame's origin: in the one the receiver is
// unprojected, in the other rays meet casters; or what the corners of these triangles are rounded by (cornersOf(), scene_view.hpp).
GN_SHARED_FN float largestCoordinate(ViewConstants view, LightConstants light, vec3 receiverWs)
{
    vec3 r = max(abs(receiverWs - vec3(view.eyeWs)), abs(receiverWs));
    vec3 l = max(abs(vec3(light.positionWs) - vec3(view.eyeWs)), abs(vec3(light.positionWs)));
    float c = max(r.x, max(r.y, r.z));
    float cl = light.type == LIGHT_DIRECTIONAL ? 0.0f : max(l.x, max(l.y, l.z));
    return max(max(c, cl), view.corners);
}

// Offset of a ray's start along the geometric normal towards the light, metres:
//   k (u |n.v| + f / 256 + 2^-21 c)
// u: one ulp of the depth value; f: footprint of a pixel; c: largestCoordinate(). Against volumes over 685 000 pixels k = 1
// leaves 13 disagreements with reversed-Z; standard depth needs k = 3.
GN_SHARED_FN float receiverOffset(ViewConstants view, LightConstants light, float depth, vec3 ray, vec3 receiverWs,
                                  vec3 normalWs)
{
    float w = linearDepth(view, depth);
    float ulp = uintBitsToFloat(floatBitsToUint(depth) + 1u) - depth;
    float u = w * w * abs(view.depthMul / view.depthScale) * ulp * abs(dot(normalWs, ray)); // depthUlpWs() |n.v|
    float f = w * view.pixelSize;
    float c = largestCoordinate(view, light, receiverWs);
    return view.offsetFactor * (u + f / 256.0f + c * (1.0f / 2097152.0f));
}

// From a receiver to a light. `along` need not be unit length; `end` is in multiples of it.
struct LightRay {
    vec3 start; // world, metres
    vec3 along;
    float end;
};

// It starts `offset` metres away from the surface and ends as much before the light; below zero where the receiver is closer
// to the light than that: nothing fits between them. Of a directional light it ends at `infinity`, the caller's largest float.
GN_SHARED_FN LightRay lightRay(LightConstants light, vec3 receiverWs, vec3 away, float offset, float infinity)
{
    LightRay ray;
    ray.start = receiverWs + offset * away;
    ray.along = light.type == LIGHT_DIRECTIONAL ? -vec3(light.directionWs) : vec3(light.positionWs) - ray.start;
    ray.end = light.type == LIGHT_DIRECTIONAL ? infinity : 1.0f - offset / max(length(ray.along), 1e-20f);
    return ray;
}

// Where the host gives no normals: along an axis of the image, the step from a receiver to what is seen beside it. Of the
// pixels to either side the closer one counts; where both are behind by more than a pixel's width, the receiver's surface is
// a pole or a ridge and neither is of it: the step is then one across the view.
//   pixel, step    the receiver's centre, and from there to the next pixel
//   back, on       depth values of the pixels before and after it
//   w, ray         the receiver's linear depth and view ray
GN_SHARED_FN vec3 seenStepWs(ViewConstants view, vec2 pixel, vec2 step, float back, float on, float w, vec3 ray)
{
    float backW = min(linearDepth(view, back), 1e15f);
    float onW = min(linearDepth(view, on), 1e15f);
    vec3 onRay = viewRayWs(view, pixel + step);
    vec3 backward = w * ray - backW * viewRayWs(view, pixel - step);
    vec3 onward = onW * onRay - w * ray;
    float nearest = w + w * view.pixelSize;
    if (backW > nearest && onW > nearest) return w * (onRay - ray);
    return dot(backward, backward) < dot(onward, onward) ? backward : onward;
}

// The normal of the plane of two such steps: unit, turned to the eye; wrong at edges, so that it may say where a ray starts and
// how depths slope, but not what faces the light.
GN_SHARED_FN vec3 seenNormalWs(vec3 dx, vec3 dy, vec3 ray)
{
    vec3 normal = cross(dx, dy);
    float scale = 1.0f / max(length(normal), 1e-20f);
    return dot(normal, ray) > 0.0f ? -scale * normal : scale * normal;
}

// Where a ray starts then: between that normal and the eye, which is on the side that is seen whatever the normal. What is
// seen from its dark side is so behind itself, and neither light that falls flat nor a normal of another surface leaves the
// start within what depths are rounded by. Unit; awayFromEye: unit, along the view ray.
GN_SHARED_FN vec3 startDirectionWs(vec3 seenNormal, vec3 awayFromEye)
{
    vec3 between = seenNormal - awayFromEye;
    return between * (1.0f / length(between));
}

GN_SHARED_END
#endif
