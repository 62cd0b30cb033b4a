// Surfaces and states of pixels beside the fragment's. The includer declares `states` (binding 5) and includes
// map_receiver.glsl, before.
#include "../shared/soft_surface.glsl"

bool isAsked(float state) { return state > 0.1 && state < 0.9; }
bool isLit(float state) { return state > 0.5; }
float stateAt(ivec2 pixel) { return texelFetch(states, pixel, 0).x; }

Surface seenAt(ivec2 pixel) { return surfaceAt(constants.view, constants.map.area, pixel); }

// Sides of a pixel, from 0 to 3.
ivec2 stepTo(int side)
{
    int on = (side & 1) == 0 ? -1 : 1;
    return side < 2 ? ivec2(on, 0) : ivec2(0, on);
}

// Whether a way from one point to another goes along both surfaces, within a slope and a pixel: otherwise there may be a
// gap between them, and the shadow's edge on the one is none on the other.
bool goesAlong(Surface from, Surface to, vec3 way, float slope)
{
    float slack = slope * length(way) + max(from.pixelWs, to.pixelWs);
    return max(abs(dot(from.normalWs, way)), abs(dot(to.normalWs, way))) <= slack;
}
