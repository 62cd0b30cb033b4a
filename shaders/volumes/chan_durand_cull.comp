#version 460
// Draw commands of the volumes that hold a silhouette pixel: the others are drawn zero times. A receiver lies in a
// caster's volume only where it lies behind the caster in the light's map; volumes that do not hold it count to 0.
#extension GL_GOOGLE_include_directive : require
#include "chan_durand.h"

layout(local_size_x = 64) in;

// VkDrawIndexedIndirectCommand as words: the index count, the instance count, and three more.
const uint COMMAND_WORDS = 5u, INSTANCE_COUNT = 1u;

layout(set = 0, binding = 0, std430) readonly buffer Items { CullItem items[]; };
layout(set = 0, binding = 1, std430) readonly buffer Cells { uint cells[]; };
layout(set = 0, binding = 2, std430) readonly buffer Statics { uint statics[]; };
layout(set = 0, binding = 3, std430) readonly buffer Dynamics { uint dynamics[]; };
layout(set = 0, binding = 4, std430) readonly buffer StaticCaps { uint staticCaps[]; };
layout(set = 0, binding = 5, std430) readonly buffer DynamicCaps { uint dynamicCaps[]; };
layout(set = 0, binding = 6, std430) writeonly buffer Commands { uint commands[]; };
layout(push_constant, std430) uniform Push { uint count; };

bool holdsReceivers(CellFootprint footprint)
{
    uint lastX = min(footprint.upperX, CELLS - 1u), lastY = min(footprint.upperY, CELLS - 1u);
    for (uint y = footprint.lowerY; y <= lastY; ++y)     // bound: CELLS
        for (uint x = footprint.lowerX; x <= lastX; ++x) // bound: CELLS
            if (cells[(footprint.layer * CELLS + y) * CELLS + x] >= footprint.nearestKey) return true;
    return false;
}

uint commandWord(uint list, uint at)
{
    if (list == 0u) return statics[at];
    if (list == 1u) return dynamics[at];
    return list == 2u ? staticCaps[at] : dynamicCaps[at];
}

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    bool wanted = false;
    uint footprints = min(items[i].footprintCount, MAX_LAYERS);
    for (uint f = 0u; f < footprints && !wanted; ++f) // bound: MAX_LAYERS
        wanted = holdsReceivers(items[i].footprints[f]);
    uint list = items[i].list, from = COMMAND_WORDS * items[i].command, to = COMMAND_WORDS * i;
    for (uint word = 0u; word < COMMAND_WORDS; ++word) {
        uint value = commandWord(list, from + word);
        commands[to + word] = word == INSTANCE_COUNT ? uint(wanted) : value;
    }
}
