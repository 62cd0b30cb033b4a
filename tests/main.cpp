#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "rules/engine/instruction_set.hpp"

int main(int argc, char** argv)
{
    if (!gnomon::rules::limitByEnvironment()) return 1;
    return doctest::Context(argc, argv).run();
}
