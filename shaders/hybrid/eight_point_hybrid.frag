#version 460
// Which pixels eight points of a light agree about. In the depth map from each the four texels around the receiver vote;
// where all eight say the same it is the answer, all other pixels are traced to the eight points.
// Source: Beister, Ernst and Stamminger 2005.
#extension GL_GOOGLE_include_directive : require
#include "eight_point.h"
#define MAP_LAYERS

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uint reasons;
    uint padding0;
    uint padding1;
    uint padding2;
    MapLookup points[8];
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;

#include "../shared/verdict.glsl"
#include "decided.glsl"

// What the map from one point says: 1 lit, 0 in shadow, 0.5 it cannot say. A point that has set behind the receiver's
// plane is left to its ray; what lies beside a spot light's map is not in it.
float voteOf(uint i, PlaneReceiver r)
{
    MapLookup look = points[i];
    r.facing = dot(r.normalWs, (look.eyeFromLight.xyz + r.w * r.ray) * look.positional + look.axisWs.xyz);
    vec4 clip = look.clipOfEye + look.clipFromRay * vec4(r.w * r.ray, 0.0);
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    Tap tap = planarTap(look, r, clip, normalPerTexel, float(i));
    bool beside = clip.w <= 0.0 || any(lessThan(tap.at, vec2(1.0))) || any(greaterThan(tap.at, vec2(look.side - 1.0)));
    return !(r.facing < 0.0) || (beside && look.positional != 0.0) ? 0.5 : verdict(tap, 0);
}

// What all points say; 0.5 where they do not agree, and where there is nothing to say. Decided pixels are skipped and the
// first contradiction ends the loop: 26 ms in place of 38 for all eight on a software device.
float agreed(PlaneReceiver r)
{
    float said = r.decided ? 0.5 : 1.0;
    for (uint i = 0u; i < LIGHT_POINTS && said != 0.5; ++i) {
        float vote = voteOf(i, r);
        said = i == 0u || vote == said ? vote : 0.5;
    }
    return said;
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float lit = agreed(r);
    // A normal guessed from depth is no reason to call a surface turned away.
    if (r.decided && (HAS_NORMALS || r.visibility > 0.0))
        visibility = r.visibility;
    else if (!r.decided && lit != 0.5)
        visibility = lit;
    else
        visibility = undecided();
}
