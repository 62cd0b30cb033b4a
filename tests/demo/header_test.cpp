// The public header is C++20 by itself, and both languages agree on its layout.
#include "gnomon/gnomon.h"

#include <doctest/doctest.h>

extern "C" size_t sizeOfFrameInfoInC(void);

TEST_CASE("the public header means the same to C11 and to C++20")
{
    CHECK(sizeOfFrameInfoInC() == sizeof(GnFrameInfo));
}
