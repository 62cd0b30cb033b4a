// The warp of the map at hand: texelOf(), placeOf(), warpedBox(), isSeen().
#ifdef RECTILINEAR
#include "rectilinear.glsl"
#else
#include "nonorthogonal.glsl"
#endif
