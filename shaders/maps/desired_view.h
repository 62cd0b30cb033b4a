// A light's map cropped to what the view's receivers lie in ("desired view": Navratil 2015, 4.2.5). The crop is made
// and used on the GPU.
#ifndef GNOMON_MAPS_DESIRED_VIEW_H
#define GNOMON_MAPS_DESIRED_VIEW_H
#include "../shared/map_lookup.h"

GN_SHARED_BEGIN

// std140.
struct DesiredViewConstants {
    MapConstants base; // of the whole map
    uvec4 pixels;      // x, y, width, height of those that the light may reach
    float border;      // texels of the cropped map around all receivers
    float padding0;
    float padding1;
    float padding2;
};
GN_SHARED_OFFSET(DesiredViewConstants, pixels, 416)
GN_SHARED_SIZE(DesiredViewConstants, 448)

// std430.
struct DesiredView {
    uvec4 seen; // bits of floats: 1 - the least x and y of receivers, the greatest x and y; parts of the side. 0: none
    vec4 crop;  // texel of the cropped map = xy * texel of the whole one + zw
};
GN_SHARED_SIZE(DesiredView, 32)

// Texels of the whole map that a cropped one spans at least: places are floats, which round by the whole map's side, and
// what a crop enlarges must stay below SNAP_TEXELS.
GN_SHARED_FN float leastCrop(float side) { return max(4.0f, side * side / 32768.0f); }

// One axis of the crop: factor, offset. low, high: what is seen of the side, 0..1; low > high: nothing.
GN_SHARED_FN vec2 cropAxis(float low, float high, float side, float border)
{
    if (!(low <= high)) return vec2(1.0f, 0.0f);
    float inside = 1.0f - min(2.0f * border / side, 0.5f);
    float size = min(max((high - low) * side / inside, leastCrop(side)), side);
    float first = clamp(0.5f * ((low + high) * side - size), 0.0f, side - size);
    float scale = side / size;
    return vec2(scale, -first * scale);
}

GN_SHARED_END
#endif
