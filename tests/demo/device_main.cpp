// Tests that need a device say "skipped" where there is none.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "demo/host/device.hpp"

int main(int argc, char** argv)
{
    if (gnomon::demo::Device::nonePresent()) return 77;
    return doctest::Context(argc, argv).run();
}
