#version 460
// Visibility from the distance to the nearest edge of the hard shadow: a half at the edge, and 0 and 1 half a penumbra
// away from it (Macedo 2018, Eqs 4.3 and 5.3, of a straight ramp). And how wide a mean is taken of it, for screen_blur.frag.
#extension GL_GOOGLE_include_directive : require
#include "distance.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uvec4 rect;
    float width;
    float disc;
    uint show;
    float mean;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 5) uniform sampler2D states;
layout(set = 0, binding = 6) uniform sampler2D seeds;
layout(set = 0, binding = 7, std430) readonly buffer Sites { uint sites[]; };
layout(location = 0) noperspective in vec3 rayWs;
// x: visibility; y: half the mean's width, metres, 0: x is the answer; z: what x is to be multiplied by after that.
layout(location = 0) out vec4 seen;

#include "../shared/map_receiver.glsl"
#include "../shared/horizon.glsl"
#include "distance_seen.glsl"

const float NOWHERE = 1e30;
const float SLOPE = 0.25; // of ways along one surface: 15 degrees, for curved ones

// Pixel coordinates in the image; x < 0: there is none.
ivec2 siteOf(ivec2 pixel)
{
    uvec2 at = uvec2(clamp(pixel - ivec2(rect.xy), ivec2(0), ivec2(rect.zw) - 1));
    uint site = sites[min(at.x * rect.w + at.y, uint(sites.length()) - 1u)];
    return site == NO_SITE ? ivec2(-1) : ivec2(rect.xy + uvec2(site & 0xffffu, site >> 16));
}

// The pixel whose nearest edge is searched for.
struct Query {
    ivec2 pixel;
    Surface seen;
    vec3 across; // unit: distances along it do not count; 0: all do
};

struct Edge {
    ivec2 site;
    float distance; // metres
};

// Keeps the edge beside a seed if it is nearer.
void keepNearer(Query query, ivec2 site, inout Edge best)
{
    if (site.x < 0) return;
    Surface seen = seenAt(site);
    float place = texelFetch(seeds, site, 0).y;
    ivec2 beside = site + stepTo(int(0.5 * place));
    vec3 besideWs = placeWs(constants.view, beside, texelFetch(depthImage, beside, 0).x);
    vec3 way = mix(seen.atWs, besideWs, place - 2.0 * floor(0.5 * place)) - query.seen.atWs;
    if (!goesAlong(query.seen, seen, way, SLOPE)) return;
    float far = length(way - query.across * dot(query.across, way));
    if (far < best.distance) best = Edge(site, far);
}

// To one of eight places around, so many pixels away.
ivec2 wayOf(int i, float stride)
{
    int aside = int(ceil(stride)), slant = int(ceil(0.7071 * stride));
    ivec2 way = i < 4 ? (i < 2 ? ivec2(aside, 0) : ivec2(0, aside)) : ivec2(slant, i < 6 ? slant : -slant);
    return (i & 1) == 0 ? way : -way;
}

// The edge that is nearest in the world, from the one nearest on the screen: along the edge, in ever smaller steps.
Edge nearestEdge(Query query, ivec2 first)
{
    Edge best = Edge(first, NOWHERE);
    keepNearer(query, first, best);
    float stride = max(length(vec2(first - query.pixel)), 1.0);
    for (int level = 0; level < 4; ++level) {
        ivec2 middle = best.site;
        for (int i = 0; i < 8; ++i) keepNearer(query, siteOf(middle + wayOf(i, stride)), best);
        stride = level == 2 ? 1.0 : max(0.5 * stride, 1.0);
    }
    return best;
}

// Share of the light that is seen at a distance from an edge, in widths of the penumbra, towards the light. A fixed ramp
// is straight; of a light's disc a straight edge leaves a part cut off by a chord.
float shareSeen(float widths)
{
    float x = clamp(2.0 * widths, -1.0, 1.0);
    return width > 0.0 ? 0.5 + 0.5 * x : 0.5 + (x * sqrt(1.0 - x * x) + asin(x)) / 3.14159265;
}

// Width of the penumbra at a seed, metres.
float widthAt(ivec2 site) { return texelFetch(seeds, site, 0).x; }

// x and y of `seen`. A mean is taken as far as it reaches the ramp. first: the nearest seed on the screen.
vec2 rampAt(PlaneReceiver r, ivec2 pixel, bool lit, ivec2 first)
{
    float ends = 0.5 + 0.5 * mean; // of what the ramp changes, widths from the edge
    vec3 along = normalize(constants.map.positional != 0.0 ? r.fromLight : constants.map.axisWs.xyz);
    Query query = Query(pixel, seenAt(pixel), width > 0.0 ? vec3(0.0) : along);
    // So far away is what is seen so many pixels away, at least, with a margin of two for slanted views.
    float least = 0.5 * (length(vec2(first - pixel)) - 1.0) * min(query.seen.pixelWs, seenAt(first).pixelWs) *
                  (width > 0.0 ? 1.0 : abs(dot(query.seen.normalWs, along)));
    if (least > ends * widthAt(first)) return vec2(lit ? 1.0 : 0.0, 0.0);
    Edge edge = nearestEdge(query, first);
    float full = max(widthAt(edge.site), 1e-6);
    float widths = min(edge.distance / full, 0.5);
    return vec2(shareSeen(lit ? widths : -widths), edge.distance < ends * full ? 0.5 * mean * full : 0.0);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float state = stateAt(pixel);
    bool lit = isLit(state);
    ivec2 first = siteOf(pixel);
    seen = vec4(lit ? 1.0 : 0.0, 0.0, 1.0, 0.0);
    if (isAsked(state)) {
        PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
        if (first.x >= 0) seen.xy = rampAt(r, pixel, lit, first);
        if (HAS_NORMALS) seen.z = shareAbove(constants.map, r, disc);
    }
    if (mean <= 0.0) seen.x *= seen.z; // nothing comes after
    ivec2 place = first - ivec2(rect.xy) + 1;
    if (show == SHOW_SEEDS) seen.x = texelFetch(seeds, pixel, 0).x > 0.0 ? 1.0 : 0.0;
    if (show == SHOW_COLUMNS) seen.x = first.x < 0 ? 0.0 : float(place.x) / 255.0;
    if (show == SHOW_ROWS) seen.x = first.x < 0 ? 0.0 : float(place.y) / 255.0;
}
