// The map of a resolve pass. The includer declares `map` as map_inputs.glsl does.
#ifndef GNOMON_MAPS_MAP_TEXELS_GLSL
#define GNOMON_MAPS_MAP_TEXELS_GLSL
#ifdef MAP_LAYERS
#define MAP_TEXEL(at, layer) textureLod(map, vec3(at, layer), 0.0).x
#define MAP_GATHER(at, layer) textureGather(map, vec3(at, layer))
#else
#define MAP_TEXEL(at, layer) textureLod(map, at, 0.0).x
#define MAP_GATHER(at, layer) textureGather(map, at)
#endif
#endif
