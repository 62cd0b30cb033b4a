// What a resolve pass is given beside its constants (lookupBindings(), map_resolve.vert): the view's depth and normals, the
// map, which has layers with MAP_LAYERS, and the pixel's ray.
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
#ifdef MAP_LAYERS
layout(set = 0, binding = 4) uniform sampler2DArray map; // border: depth 1, past the map nothing casts
#else
layout(set = 0, binding = 4) uniform sampler2D map; // likewise
#endif
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
