// Skipped (exit code 77) where there is no Vulkan device that gnomon can run on.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>

#include "vulkan_device.hpp"

int main(int argc, char** argv)
{
    if (!stranger::Device().present()) {
        std::puts("skipped: no Vulkan device");
        return 77;
    }
    return doctest::Context(argc, argv).run();
}
