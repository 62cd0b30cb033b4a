#version 460
// What rays found in tiles of pixels: where there is a penumbra, and how wide.
#extension GL_GOOGLE_include_directive : require
#include "ray_soft.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    RaySoftConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D seenImage;
layout(location = 0) out vec4 tile; // x, y: least and most that a pixel sees; z: mean half width, 0 where nothing is blocked

const int TILE_PIXELS = SOFT_TILE * SOFT_TILE;

void main()
{
    ivec2 first = ivec2(gl_FragCoord.xy) * SOFT_TILE;
    vec4 area = constants.base.area;
    float least = 1.0, most = 0.0, sum = 0.0, blocked = 0.0;
    for (int i = 0; i < TILE_PIXELS; ++i) {
        ivec2 pixel = first + ivec2(i % SOFT_TILE, i / SOFT_TILE);
        if (any(lessThan(vec2(pixel), area.xy)) || any(greaterThanEqual(vec2(pixel), area.xy + area.zw))) continue;
        vec3 seen = texelFetch(seenImage, pixel, 0).xyz;
        if (!(seen.y >= 0.0) || !(seen.z > 0.0)) continue; // not asked, or points below the horizon
        least = min(least, seen.x);
        most = max(most, seen.x);
        if (seen.y == 0.0) continue;
        sum += (1.0 - seen.x) * seen.y;
        blocked += 1.0 - seen.x;
    }
    tile = vec4(least, most, blocked > 0.0 ? sum / blocked : 0.0, 0.0);
}
