// Where functions and the next have the middles of texels: from the image that the maps' tables are copied to, or
// (PLACES_IN_TABLE) from the tables. Behind the table's own GLSL.
#ifndef GNOMON_WARPED_PLACES_GLSL
#define GNOMON_WARPED_PLACES_GLSL

#ifdef PLACES_IN_TABLE
vec2 placesOf(uint map, uint kind, uint function, uint texel, float side)
{
    uint at = firstPlace(map, side) + 2u * ((kind * uint(side) + texel) * functionCount(side) + function);
    return vec2(tableAt(at), tableAt(at + 1u));
}
#else
layout(set = 0, binding = 6) uniform sampler2DArray places; // two layers a map
vec2 placesOf(uint map, uint kind, uint function, uint texel, float side)
{
    return texelFetch(places, ivec3(function, texel, 2u * map + kind), 0).xy;
}
#endif
#endif
