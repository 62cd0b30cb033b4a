// The receiver behind this fragment, for resolve shaders. The includer declares the constants block with members
// `ViewConstants view; LightConstants light;` (binding 0) and these samplers at bindings it chooses.
#ifndef GNOMON_SHARED_RESOLVE_GLSL
#define GNOMON_SHARED_RESOLVE_GLSL
#include "receiver.h"

struct Receiver {
    vec3 ws;           // relative to the origin
    vec3 normalWs;     // geometric, unit; from depth differences where the host gives none
    vec3 toLightWs;    // unit
    vec3 rayWs;        // view ray of linear depth 1
    float depth;
    float facing;      // n.l
    bool exists;       // false: sky
    bool reached;      // within the light's range and cone
};

Receiver fetchReceiver(ViewConstants view, LightConstants light, sampler2D depthImage, sampler2D normalImage)
{
    Receiver r;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    r.depth = texelFetch(depthImage, pixel, 0).x;
    r.rayWs = viewRayWs(view, gl_FragCoord.xy);
    r.ws = view.eyeWs.xyz + linearDepth(view, r.depth) * r.rayWs;
    r.exists = r.depth != view.skyDepth;
    r.toLightWs = towardsLightWs(light, r.ws);
    r.reached = lightReaches(light, r.ws);
    if (view.hasNormals != 0u)
        r.normalWs = texelFetch(normalImage, pixel, 0).xyz;
    else
        r.normalWs = vec3(0.0);
    r.facing = dot(r.normalWs, r.toLightWs);
    return r;
}

// What every method answers before it looks at casters: 1 where the light does not reach or nothing is there, 0 where
// the surface faces away. Returns a negative number where the method must decide.
float visibilityWithoutCasters(ViewConstants view, Receiver r)
{
    if (!r.exists || !r.reached) return 1.0;
    if (view.hasNormals != 0u && r.facing <= 0.0) return 0.0;
    return -1.0;
}
#endif
