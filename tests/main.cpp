#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "runtime/base/instruction_set.hpp"

int main(int argc, char** argv)
{
    if (!gnomon::limitByEnvironment()) return 1;
    return doctest::Context(argc, argv).run();
}
