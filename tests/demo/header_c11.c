/* The public header is C11 by itself, without anything included before it. */
#include "gnomon/gnomon.h"

_Static_assert(GN_SUCCESS == 0, "zero is success");
_Static_assert(sizeof(GnMesh) == 8, "handles are 64 bits wide in C too");

/* The size that a host gives in C, which a host in C++ gives without saying so. */
uint32_t structSizeInC(void);
uint32_t structSizeInC(void)
{
    const GnFrameInfo info = {GN_INIT(GnFrameInfo), .frame = 1};
    return info.structSize;
}
