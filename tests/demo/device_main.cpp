// Tests that need a device say "skipped" where there is none.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "host_fixture.hpp"

int main(int argc, char** argv)
{
    if (gnomon::demo::Device::nonePresent()) return 77;
    const int result = doctest::Context(argc, argv).run();
    gnomon::demo::testDeviceOwner.reset();
    return result;
}
