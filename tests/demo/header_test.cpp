// The public header is C++20 by itself, and both languages agree on its layout.
#include "gnomon/gnomon.h"

#include <doctest/doctest.h>

extern "C" uint32_t structSizeInC(void);

TEST_CASE("the public header means the same to C11 and to C++20")
{
    CHECK(structSizeInC() == sizeof(GnFrameInfo));
    CHECK(structSizeInC() == GnFrameInfo{}.structSize);
    CHECK(structSizeInC() == GnFrameInfo{.frame = 1}.structSize);
}
