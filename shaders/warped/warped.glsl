// The warp of the map at hand: warped(), warpedBox(), placeOf(), isSeen().
#ifdef RECTILINEAR
#include "rectilinear.glsl"
#else
#include "nonorthogonal.glsl"
#endif
