#version 460
// The nearest seed of every pixel from those in the columns: the lower envelope of parabolas, an invocation a row. Each
// step takes back or adds one parabola or none, and their number depends on the width alone. Reads and writes in place:
// entries of the envelope are never more than the columns behind them.
// Source: A. Meijster, J. Roerdink and W. Hesselink, "A general algorithm for computing distance transforms in linear
// time", 2000.
#extension GL_GOOGLE_include_directive : require
#include "distance.h"

layout(local_size_x = 32) in; // DISTANCE_GROUP
layout(set = 0, binding = 1, std430) buffer Sites { uint sites[]; };
layout(push_constant) uniform Push { DistanceRect rect; };

uint indexOf(uint column) { return column * rect.height + gl_GlobalInvocationID.x; }

// Square of a site's distance from this row.
int away(uint site)
{
    int rows = int(site >> 16) - int(gl_GlobalInvocationID.x);
    return rows * rows;
}

// First column, from 0, that is nearer to `right` than to `left`; left's column is less than right's.
int takesOver(uint left, uint right)
{
    int l = int(left & 0xffffu), r = int(right & 0xffffu);
    int balance = r * r - l * l + away(right) - away(left);
    return balance < 0 ? 0 : balance / max(2 * (r - l), 1) + 1;
}

void main()
{
    if (gl_GlobalInvocationID.x >= rect.height) return;
    uint count = 0u, column = 0u, top = NO_SITE, below = NO_SITE;
    int topStart = 0;
    for (uint i = 0u; i < MAX_DISTANCE_STEPS && i < 2u * rect.width; ++i) {
        uint site = column < rect.width ? sites[indexOf(column)] : NO_SITE;
        int start = count > 0u && site != NO_SITE ? takesOver(top, site) : 0;
        if (site != NO_SITE && count > 0u && start <= topStart) { // nothing is nearest to the top
            count -= 1u;
            top = below;
            below = count > 1u ? sites[indexOf(count - 2u)] : NO_SITE;
            topStart = count > 1u ? takesOver(below, top) : 0;
            continue;
        }
        if (site != NO_SITE && start < int(rect.width)) {
            sites[indexOf(count)] = site;
            count += 1u;
            below = top;
            top = site;
            topStart = start;
        }
        column += 1u;
    }
    for (uint i = 0u; i < MAX_DISTANCE_SIDE && i < rect.width; ++i) {
        uint at = rect.width - 1u - i;
        sites[indexOf(at)] = top;
        if (count > 1u && int(at) == topStart) {
            count -= 1u;
            top = below;
            below = count > 1u ? sites[indexOf(count - 2u)] : NO_SITE;
            topStart = count > 1u ? takesOver(below, top) : 0;
        }
    }
}
