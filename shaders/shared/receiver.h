// What a receiver is: the surface point behind a pixel, as every method, the ray-traced truth and the dumps see it.
#ifndef GNOMON_SHARED_RECEIVER_H
#define GNOMON_SHARED_RECEIVER_H
#include "conventions.h"
#include "reach.h"

GN_SHARED_BEGIN

// std140 and std430 alike: only vec4 and mat4 before the scalars.
struct ViewConstants {
    mat4 clipFromWorld; // as the host drew its depth, but relative to the origin
    vec4 eyeWs;         // xyz metres; w: what values of a depth image of integers are apart, over offsetFactor; else 0
    vec4 rayCornerWs;   // xyz: view ray of linear depth 1 at pixel coordinate (0, 0); orthographic: the way from the eye to
                        // there at depth value 0, and w: how far that is along the view's axis
    vec4 rayDxWs;       // xyz: its change per pixel to the right
    vec4 rayDyWs;       // xyz: and per pixel down
    vec4 rayDepthWs;    // xyz: and from depth value 0 to 1; w: how far that is along the axis, negative for reversed depth;
                        // 0 with a perspective
    float depthScale;   // linear depth w = depthScale / (depth * depthMul + depthAdd), metres; orthographic: 1
    float depthMul;
    float depthAdd;
    float skyDepth;     // the depth value that means: no receiver
    float offsetFactor; // k of the offset: 1 for reversed-Z, 3 for standard depth
    float pixelSize;    // width of a pixel at linear depth 1, metres; orthographic: of any
    uint hasNormals;    // 0: the host gives no geometric normals
    float corners;      // what coordinates of corners of seen triangles count as in largestCoordinate(), metres
};
GN_SHARED_OFFSET(ViewConstants, eyeWs, 64)
GN_SHARED_OFFSET(ViewConstants, depthScale, 144)
GN_SHARED_SIZE(ViewConstants, 176)

struct LightConstants {
    vec4 positionWs;  // xyz metres; w = 0 directional light, 1 otherwise
    vec4 directionWs; // xyz unit, the way light travels; w = cosine of the cone's half angle (-2 where there is no cone)
    float range;      // metres; a very large number where unlimited
    uint type;        // LIGHT_DIRECTIONAL, LIGHT_SPOT, LIGHT_POINT
    float sourceRadius;
    uint padding;
};
GN_SHARED_SIZE(LightConstants, 48)

// A receiver is at eye + w * (viewRayWs() + depth * rayDepthWs): the inverse of the host's matrix, where w is clip w.
GN_SHARED_FN bool isOrthographic(ViewConstants view) { return view.rayDepthWs.w != 0.0f; }

// Linear depth (clip w) of a depth value, metres; orthographic: 1.
GN_SHARED_FN float linearDepth(ViewConstants view, float depth)
{
    return view.depthScale / (depth * view.depthMul + view.depthAdd);
}

// View ray of linear depth 1 through a point given in pixels; orthographic: from the eye to there at depth value 0.
GN_SHARED_FN vec3 viewRayWs(ViewConstants view, vec2 pixel)
{
    return vec3(view.rayCornerWs) + pixel.x * vec3(view.rayDxWs) + pixel.y * vec3(view.rayDyWs);
}

// What linear depth times makes the way from the eye to a receiver: the view ray; orthographic: that way itself.
GN_SHARED_FN vec3 receiverRayWs(ViewConstants view, vec3 viewRay, float depth)
{
    return viewRay + depth * vec3(view.rayDepthWs);
}

// The way that a view looks along a ray, of any length.
GN_SHARED_FN vec3 lookingWs(ViewConstants view, vec3 ray)
{
    vec3 deeper = vec3(view.rayDepthWs);
    return isOrthographic(view) ? (view.rayDepthWs.w < 0.0f ? -deeper : deeper) : ray;
}

// How far along the view a depth value is, metres: linear depth, or what is that without a perspective.
GN_SHARED_FN float viewDistance(ViewConstants view, float depth)
{
    return isOrthographic(view) ? view.rayCornerWs.w + depth * view.rayDepthWs.w : linearDepth(view, depth);
}

// The way from the eye to what is that far along a view ray.
GN_SHARED_FN vec3 atDistanceWs(ViewConstants view, vec3 viewRay, float distance)
{
    return isOrthographic(view)
               ? receiverRayWs(view, viewRay, (distance - view.rayCornerWs.w) / view.rayDepthWs.w)
               : distance * viewRay;
}

// From the receiver towards the light, unit length.
GN_SHARED_FN vec3 towardsLightWs(LightConstants light, vec3 receiverWs)
{
    vec3 toLight = vec3(light.positionWs) - receiverWs;
    return light.type == LIGHT_DIRECTIONAL ? -vec3(light.directionWs) : toLight / max(length(toLight), 1e-20f);
}

// The same for a point, from a light's constants. Where not, visibility is 1.
GN_SHARED_FN bool lightReaches(LightConstants light, vec3 receiverWs)
{
    vec4 cone = light.directionWs;
    cone.w *= abs(cone.w);
    return light.type == LIGHT_DIRECTIONAL ||
           reaches(receiverWs - vec3(light.positionWs), cone, light.range * light.range);
}

// One unit in the last place of a depth value, of the float or of the integers of its format.
GN_SHARED_FN float depthUlp(ViewConstants view, float depth)
{
    return uintBitsToFloat(floatBitsToUint(depth) + 1u) - depth + view.eyeWs.w;
}

// Distance that it spans along the view ray, metres.
GN_SHARED_FN float depthUlpWs(ViewConstants view, float depth, vec3 ray)
{
    float ulp = depthUlp(view, depth);
    float w = linearDepth(view, depth);
    return length(ray) * w * w * abs(view.depthMul / view.depthScale) * ulp + length(vec3(view.rayDepthWs)) * ulp;
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
    float ulp = depthUlp(view, depth);
    float u = w * w * abs(view.depthMul / view.depthScale) * ulp * abs(dot(normalWs, ray)); // depthUlpWs() |n.v|
    u += ulp * abs(dot(normalWs, vec3(view.rayDepthWs)));
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
//   depth, ray     the receiver's depth value and receiverRayWs()
GN_SHARED_FN vec3 seenStepWs(ViewConstants view, vec2 pixel, vec2 step, float back, float on, float depth, vec3 ray)
{
    float w = linearDepth(view, depth);
    float backW = min(linearDepth(view, back), 1e15f);
    float onW = min(linearDepth(view, on), 1e15f);
    vec3 onRay = viewRayWs(view, pixel + step);
    vec3 backRay = viewRayWs(view, pixel - step);
    vec3 backward = w * ray - backW * receiverRayWs(view, backRay, back);
    vec3 onward = onW * receiverRayWs(view, onRay, on) - w * ray;
    float beyond = view.rayDepthWs.w; // metres of a depth value, without a perspective
    float nearest = w + depth * beyond + w * view.pixelSize;
    if (backW + back * beyond > nearest && onW + on * beyond > nearest)
        return w * (receiverRayWs(view, onRay, depth) - ray);
    return dot(backward, backward) < dot(onward, onward) ? backward : onward;
}

// The normal of the plane of two such steps: unit, turned to the eye; wrong at edges, so that it may say where a ray starts and
// how depths slope, but not what faces the light.
//   looking  lookingWs()
GN_SHARED_FN vec3 seenNormalWs(vec3 dx, vec3 dy, vec3 looking)
{
    vec3 normal = cross(dx, dy);
    float scale = 1.0f / max(length(normal), 1e-20f);
    return dot(normal, looking) > 0.0f ? -scale * normal : scale * normal;
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
