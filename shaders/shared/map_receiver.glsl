// The receiver behind this fragment, for look-ups in a map.
// The includer declares `MapConstants constants` (binding 0), and depthImage and normalImage as map_inputs.glsl does.
#ifndef GNOMON_MAPS_MAP_RECEIVER_GLSL
#define GNOMON_MAPS_MAP_RECEIVER_GLSL
#include "map_lookup.h"
#include "plane_receiver.glsl"
#include "seen_normal.glsl"

layout(constant_id = 0) const bool HAS_NORMALS = true;

// viewRay: through the pixel's centre.
PlaneReceiver fetchPlaneReceiver(ViewConstants view, MapLookup look, vec3 viewRay)
{
    PlaneReceiver r;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    r.depth = texelFetch(depthImage, pixel, 0).x;
    bool exists = r.depth != view.skyDepth;
    r.w = exists ? linearDepth(view, r.depth) : 1.0;
    r.ray = receiverRayWs(view, viewRay, r.depth);
    r.fromLight = look.eyeFromLight.xyz + r.w * r.ray;
    r.normalWs = HAS_NORMALS ? texelFetch(normalImage, pixel, 0).xyz : seenNormal(view, look.area, pixel, r.depth, r.ray);
    return seenByLight(look, r, exists);
}
#endif
