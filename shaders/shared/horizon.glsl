// How much of a disc light a receiver's own plane hides. GLSL and HLSL. The includer includes plane_receiver.glsl.
#ifndef GNOMON_SHARED_HORIZON_GLSL
#define GNOMON_SHARED_HORIZON_GLSL

// Share of the disc above the receiver's own plane, which neither map nor silhouettes know to hide anything.
//   facing  of the plane's unit normal with the way to the disc's centre
//   apart   length of that way
//   radius  of the disc, over that length
float shareAbove(float facing, float apart, float radius)
{
    float cosine = clamp(facing / max(apart, 1e-30), 0.0, 1.0);
    float across = radius * sqrt(1.0 - cosine * cosine);
    float height = min(cosine / max(across, 1e-30), 1.0); // of the centre over the plane, in radii of the disc there
    return 1.0 - (acos(height) - height * sqrt(1.0 - height * height)) / 3.14159265;
}

//   radius  of the disc: metres; directional: tangent of its angle
float shareAbove(MapLookup look, PlaneReceiver r, float radius)
{
    float distance = look.positional != 0.0 ? length(r.fromLight) : length(look.axisWs.xyz);
    return shareAbove(-r.facing, distance, look.positional != 0.0 ? radius / max(distance, 1e-30) : radius);
}
#endif
