#version 460
// Visibility of a directional or spot light from a depth map whose texels are not of one size.
//
// A spot light's map is then another perspective of the same light. A directional light's has a w of its own too, which
// does not change along its rays: depth is z / w, and the ray through a texel does not start at a place that is linear in
// texels, but its homogeneous place is. texelDx.w and texelDy.w are the last coordinate of its change, about the eye.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/planar_tap.glsl"
#include "../shared/filter.glsl"

void main()
{
    MapLookup look = constants.map;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, look, rayWs);
    vec4 clip = receiverClip(look, r, rayClip);
    float depth = look.positional != 0.0 ? mapDepth(look, clip) : clip.z / clip.w;
    float plane = dot(r.normalWs, r.w * r.ray) + r.offset; // its distance from the eye, along its normal
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz) - look.texelDx.w * plane,
                               dot(r.normalWs, look.texelDy.xyz) - look.texelDy.w * plane);
    PlanarDepth planar = planarDepth(look, depth, 1.0 / clip.w, r.facing, r.offset, normalPerTexel);
    Tap tap = tapAt(look, planar, clip.xy / clip.w, 0.0);
    float lit = FILTERED ? boxVisibility(tap, tap.at, look.filterSide) : nearestVisibility(tap, tap.at);
    // Where w is not above 0 no part of the map is: nothing there is in view, and nothing shades it.
    visibility = r.decided ? r.visibility : clip.w > 0.0 ? lit : 1.0;
}
