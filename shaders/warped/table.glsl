// Reading tables.
#ifndef GNOMON_WARPED_TABLE_GLSL
#define GNOMON_WARPED_TABLE_GLSL
#include "warp.h"

layout(set = 0, binding = 5, std430) readonly buffer Tables { float tables[]; };

float tableAt(uint at) { return tables[min(at, uint(tables.length()) - 1u)]; }
#endif
