// What a hard map says of a pixel, and how wide the penumbra is there: what screen_blur.frag filters. With MAP_LAYERS the
// map is the six faces around a point light. The includer defines, after:
//   float hardVisibility(Tap tap)
#include "screen_penumbra.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uvec4 hard;
    DiscCone disc;
};
layout(std430, set = 0, binding = 1) readonly buffer Bounds { vec2 bounds[]; };
#include "map_inputs.glsl"
// x: visibility, or that less NOT_ASKED; y: half the penumbra's width, metres across the light, 0: x is the answer; z: share
// of the light above the receiver's plane.
layout(location = 0) out vec4 seen;

#include "agreement.glsl"
#include "filter.glsl"
#include "blocker_search.glsl"

float hardVisibility(Tap tap);

// No light comes through where all taps are blockers: taps within what the disc covers at their depth, that is, and where
// these are not too few.
bool isUmbra(LightCone cone, float spread, Blockers found)
{
    float within = spreadAt(cone, found.mean);
    return found.open > within && 2.0 * within >= spread;
}

// Where pixels are wider than texels, what a pixel's width shows on average: single texels would be picked at random.
float pixelVisibility(Tap tap, float texelsPerPixel)
{
    float side = 2.0 * floor(0.5 * min(texelsPerPixel, float(MAX_FILTER_SIDE))) + 1.0;
    return side > 1.0 ? boxVisibility(tap, tap.at, side) : hardVisibility(tap);
}

// x and y of `seen`. texelWs, pixelWs: widths of a texel and of a pixel at the receiver.
vec2 hardAndWidth(LightCone cone, uint layer, float texelWs, float pixelWs)
{
    float decided;
    float spread = narrowedCone(cone, uint(constants.map.side), layer, decided);
    if (decided >= 0.0) return vec2(decided, 0.0);
    Blockers found = blockersIn(cone, spread, firstDirection(gl_FragCoord.xy));
    if (found.count == 0.0) return vec2(1.0, 0.0);
    if (isUmbra(cone, spread, found)) return vec2(0.0);
    // Half a texel: the edge of a map is not sharper than that.
    return vec2(pixelVisibility(cone.tap, pixelWs / texelWs), max(spreadAt(cone, found.mean), 0.5) * texelWs);
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    seen = vec4(r.visibility - NOT_ASKED, 0.0, 1.0, 0.0);
    if (r.decided) return;
    LightCone cone = lightCone(constants.map, tap, mapDepth(constants.map, clip));
    float texelWs = disc.texelWs * (constants.map.positional != 0.0 ? clip.w : 1.0);
    seen.xy = hardAndWidth(cone, uint(layer), texelWs, r.w * constants.view.pixelSize);
    if (HAS_NORMALS) seen.z = shareAbove(constants.map, r, disc.radius);
}
