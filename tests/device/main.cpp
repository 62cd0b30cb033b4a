// Skipped (exit code 77) where there is no Vulkan device; without the validation layer the tests prove too little and
// fail.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>

#include "device/fixture.hpp"
#include "runtime/base/instruction_set.hpp"

// Loader, layer and driver keep memory and are unloaded before the leak check could name them.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options()
{
    return "detect_leaks=0";
}

int main(int argc, char** argv)
{
    if (!gnomon::limitByEnvironment()) return 1;
    if (gnomon::demo::Device::nonePresent()) {
        std::puts("skipped: no Vulkan device");
        return 77;
    }
    doctest::Context context(argc, argv);
    const int result = context.run();
    gnomon::test::releaseDevice();
    return result;
}
