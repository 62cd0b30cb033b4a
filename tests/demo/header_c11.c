/* The public header is C11 by itself, without anything included before it. */
#include "gnomon/gnomon.h"

_Static_assert(GN_SUCCESS == 0, "zero is success");
_Static_assert(sizeof(GnMesh) == 8, "handles are 64 bits wide in C too");

/* A zeroed structure is a valid start in C, which C++ code below must see as the same bytes. */
size_t sizeOfFrameInfoInC(void);
size_t sizeOfFrameInfoInC(void)
{
    const GnFrameInfo info = {0};
    return sizeof info;
}
