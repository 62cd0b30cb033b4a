#version 460
#extension GL_GOOGLE_include_directive : require
// Visibility from the stencil's count and what the wedges add to it.
#include "wedge.h"
#include "../shared/plane_receiver.glsl"
#include "../shared/horizon.glsl"

layout(set = 0, binding = 0, std140) uniform Constants { WedgeResolve wedges; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(set = 0, binding = 3) uniform usampler2D stencilImage;
layout(set = 0, binding = 4) uniform sampler2D coverageImage; // sharesOf(), doubtful()
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out vec4 visibility;

// Covered discs at a pixel. Counts are kept modulo 256, negative in a view that mirrors; rounding along borders may
// leave a few of the other sign.
float coveredAt(ivec2 pixel)
{
    int count = int(texelFetch(stencilImage, pixel, 0).x);
    count = (wedges.entered * count) & 255;
    if (count >= 248) count -= 256;
    return float(count) + sharesOf(texelFetch(coverageImage, pixel, 0).x);
}

// Where stencil and wedges may disagree about the side of an edge, the count that fits the neighbours on the same
// surface. Along such a border coverage is continuous: neighbours differ by less than the half that is at stake.
// inDoubt: whether they may. Few pixels are; a loop of no rounds costs the others nothing on any device, where a branch
// around it costs a software device all eight rounds at every pixel.
const int NEIGHBOURS = 8;
//   distance, reach  of the receiver along the view, and by how much that of its surface differs around it, metres
float settled(VolumeResolve resolve, ivec2 pixel, float covered, float distance, float reach, bool inDoubt)
{
    float sum = 0.0, neighbours = 0.0;
    int rounds = inDoubt ? NEIGHBOURS : 0;
    for (int i = 0; i < rounds; ++i) { // bound: NEIGHBOURS
        int place = i < 4 ? i : i + 1;
        ivec2 at = pixel + ivec2(place % 3 - 1, place / 3 - 1);
        vec2 inside = vec2(at) + 0.5 - resolve.area.xy;
        bool usable = all(greaterThan(inside, vec2(0.0))) && all(lessThan(inside, resolve.area.zw));
        at = usable ? at : pixel;
        float depth = texelFetch(depthImage, at, 0).x;
        usable = usable && !doubtful(texelFetch(coverageImage, at, 0).x) && depth != resolve.view.skyDepth &&
                 abs(viewDistance(resolve.view, depth) - distance) < reach;
        sum += usable ? coveredAt(at) : 0.0;
        neighbours += usable ? 1.0 : 0.0;
    }
    float settled = neighbours > 0.0 ? covered + clamp(round(sum / neighbours - covered), -1.0, 1.0) : covered;
    // Less than nothing is covered nowhere, whatever neighbours say of a penumbra a pixel wide.
    return inDoubt && settled < -0.25 ? settled + 1.0 : settled;
}

void main()
{
    VolumeResolve resolve = wedges.volumes;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    float w = linearDepth(resolve.view, depth);
    vec3 toLight = resolve.lightEs.xyz - w * receiverRayWs(resolve.view, rayWs, depth);
    bool reached = depth != resolve.view.skyDepth && reaches(-toLight, resolve.cone, resolve.rangeSquared);
    bool hasNormals = resolve.view.hasNormals != 0u;
    float facing = hasNormals ? dot(texelFetch(normalImage, pixel, 0).xyz, toLight) : 1.0;
    float distance = max(length(toLight), 1e-30);
    float above = hasNormals ? shareAbove(facing, distance, wedges.radius / distance) : 1.0;
    float reach = isOrthographic(resolve.view) ? 16.0 * resolve.view.pixelSize : 0.02 * w;
    float covered = settled(resolve, pixel, coveredAt(pixel), viewDistance(resolve.view, depth), reach,
                            doubtful(texelFetch(coverageImage, pixel, 0).x));
    visibility = vec4(!reached ? 1.0 : facing > 0.0 ? clamp(above - covered, 0.0, above) : 0.0, 0.0, 0.0, 1.0);
}
