#include <doctest/doctest.h>

#include "runtime/base/instruction_set.hpp"

using namespace gnomon;

TEST_CASE("nothing above the limit is supported, and what is below it still is")
{
    constexpr InstructionSet kSets[] = {InstructionSet::Baseline, InstructionSet::Sse42, InstructionSet::Avx2,
                                        InstructionSet::Avx512};
    const InstructionSet before = instructionSetLimit();
    for (const InstructionSet limit : kSets) {
        CAPTURE(nameOf(limit));
        limitInstructionSet(InstructionSet::Avx512);
        bool runs[4];
        for (const InstructionSet set : kSets)
            runs[static_cast<int>(set)] = isSupported(set);
        REQUIRE(limitInstructionSet(nameOf(limit)));
        CHECK(instructionSetLimit() == limit);
        CHECK(bestInstructionSet() <= limit);
        for (const InstructionSet set : kSets)
            CHECK(isSupported(set) == (runs[static_cast<int>(set)] && set <= limit));
    }
    limitInstructionSet(before);
}

TEST_CASE("a name that is no instruction set limits nothing")
{
    const InstructionSet before = instructionSetLimit();
    for (const char* name : {"", "sse", "sse42", "AVX2", "avx2 ", "avx1024"})
        CHECK_FALSE(limitInstructionSet(std::string_view(name)));
    CHECK(instructionSetLimit() == before);
}
