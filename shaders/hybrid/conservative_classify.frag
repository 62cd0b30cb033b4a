#version 460
// Which pixels the two layers of a conservative map can answer: lit where nothing in the texel is nearer to the light,
// dark where something that covers the texel is. All others are traced. What is asked is the point at which the
// pixel's ray would start, so that both say the same.
// Source: Hertel, Hormann and Westermann 2009; Morais 2015, 3.4.2 and 4.
#extension GL_GOOGLE_include_directive : require
#include "conservative_lookup.h"
#ifdef MAP_LAYERS
#include "../shared/cube.h"
#endif

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uint reasons;
    uint padding0;
    uint padding1;
    uint padding2;
    LightConstants light;
    float texelsPerMetre;
    float depthPerMetre;
    float depthSquare;
    uint thesis;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
#ifdef MAP_LAYERS
layout(set = 0, binding = 4) uniform sampler2DArray nearMap;
layout(set = 0, binding = 6) uniform sampler2DArray farMap;
#else
layout(set = 0, binding = 4) uniform sampler2D nearMap;
layout(set = 0, binding = 6) uniform sampler2D farMap;
#endif
layout(location = 0) out float visibility;

layout(constant_id = 0) const bool HAS_NORMALS = true;

#include "decided.glsl"
#include "../shared/seen_normal.glsl"

// The start of a pixel's ray, relative to the eye, as algorithms/shared/receivers.cpp has it.
struct RayStart {
    vec3 fromEye;
    vec3 behind;  // as far away from the light, for where there are no normals
    float offset; // from the receiver
    float errorWs;
    bool reached; // by the light
    bool facing;
};

RayStart rayStart(ViewConstants view, float depth, ivec2 pixel)
{
    vec3 ray = receiverRayWs(view, viewRayWs(view, vec2(pixel) + 0.5), depth);
    vec3 fromEye = linearDepth(view, depth) * ray;
    vec3 receiver = view.eyeWs.xyz + fromEye;
    vec3 normal, away, toLight; // with normals of any length
    RayStart start;
    if (HAS_NORMALS) {
        normal = texelFetch(normalImage, pixel, 0).xyz;
        normal *= 1.0 / max(length(normal), 1e-20); // one division, as on the CPU
        away = normal;
        toLight = light.type == LIGHT_DIRECTIONAL ? -light.directionWs.xyz : light.positionWs.xyz - receiver;
        start.facing = dot(normal, toLight) > 0.0;
    } else {
        vec3 looking = lookingWs(view, ray);
        normal = looking / length(looking);
        toLight = towardsLightWs(light, receiver);
        vec3 seen = seenNormal(view, constants.map.area, pixel, depth, ray);
        away = startDirectionWs(seen, normal);
        start.facing = true;
    }
    start.reached = lightReaches(light, receiver);
    start.offset = receiverOffset(view, light, depth, ray, receiver, normal);
    start.fromEye = fromEye + start.offset * away;
    start.behind = fromEye - start.offset * toLight;
    // What the ray tracer's receiver may differ by: a unit in the last place of the depth, and of coordinates.
    start.errorWs = depthUlpWs(view, depth, ray) + largestCoordinate(view, light, receiver) * ULPS_21;
    return start;
}

vec4 mapClip(vec3 fromEye, out float layer)
{
    MapLookup look = constants.map;
#ifdef MAP_LAYERS
    vec3 fromLight = look.eyeFromLight.xyz + fromEye;
    uint face = cubeFaceOf(fromLight);
    vec3 local = inCubeFace(face, fromLight);
    layer = float(face);
    return vec4((local.xy / look.slope + local.z) * (0.5 * look.side), 0.0, local.z);
#else
    layer = 0.0;
    return look.clipOfEye + look.clipFromRay * vec4(fromEye, 0.0);
#endif
}

MapPoint mapPoint(vec4 clip, float errorWs)
{
    HybridConstants hybrid = HybridConstants(constants, reasons, padding0, padding1, padding2);
    return mapPointOf(ConservativeConstants(hybrid, light, texelsPerMetre, depthPerMetre, depthSquare, thesis), clip,
                      errorWs);
}

// Whether a face that looks away from the light may be the receiver itself. Only a normal says that it is not: without
// one the ray may start inside the solid, whose far side alone is in the map.
bool maybeInside(RayStart start, float nearest)
{
    float layer;
    MapPoint behind = mapPoint(mapClip(start.behind, layer), start.errorWs);
    return min(behind.depth + behind.depthError, 1.0) > nearest;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    bool exists = depth != constants.view.skyDepth;
    RayStart start = rayStart(constants.view, exists ? depth : 0.5, pixel);

    float layer;
    vec4 clip = mapClip(start.fromEye, layer);
    MapPoint at = mapPoint(clip, start.errorWs);
    // The texel's centre, by nearest sampling: on a software device a few percent off the pass.
    vec2 centre = (clamp(floor(at.texel), 0.0, constants.map.side - 1.0) + 0.5) * (1.0 / constants.map.side);
#ifdef MAP_LAYERS
    float nearest = textureLod(nearMap, vec3(centre, layer), 0.0).x;
    float covered = textureLod(farMap, vec3(centre, layer), 0.0).x;
#else
    float nearest = textureLod(nearMap, centre, 0.0).x;
    float covered = textureLod(farMap, centre, 0.0).x;
#endif
    bool blocking = thesis != 0u || withinRays(constants.map, nearest, start.offset);
    float lit = conservativeVerdict(nearest, covered, at.depth, thesis != 0u ? 0.0 : at.depthError, blocking);
    if (!HAS_NORMALS && lit == 1.0 && maybeInside(start, nearest)) lit = 0.5;
    bool known = mapKnows(at, clip.w, constants.map.side);

    if (!exists || !start.reached)
        visibility = decidedAs(1.0, REASON_OUTSIDE);
    else if (!start.facing)
        visibility = decidedAs(0.0, REASON_BACKFACING);
    else if (known && lit != 0.5)
        visibility = decidedAs(lit, lit > 0.5 ? REASON_MAP_LIT : REASON_MAP_SHADOW);
    else
        visibility = undecided();
}
