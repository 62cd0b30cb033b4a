#include "runtime/base/instruction_set.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace gnomon {
namespace {

constexpr InstructionSet kSets[] = {InstructionSet::Baseline, InstructionSet::Sse42, InstructionSet::Avx2,
                                    InstructionSet::Avx512};

std::atomic<InstructionSet> limit{InstructionSet::Avx512};

bool runsHere(InstructionSet set) noexcept
{
    switch (set) {
    case InstructionSet::Baseline:
        return true;
#if defined(__x86_64__)
    case InstructionSet::Sse42:
        return __builtin_cpu_supports("sse4.2");
    case InstructionSet::Avx2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case InstructionSet::Avx512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
#endif
    default:
        return false;
    }
}

} // namespace

bool isSupported(InstructionSet set) noexcept
{
    return set <= instructionSetLimit() && runsHere(set);
}

InstructionSet bestInstructionSet() noexcept
{
    InstructionSet best = InstructionSet::Baseline;
    for (const InstructionSet set : kSets)
        if (isSupported(set)) best = set;
    return best;
}

void limitInstructionSet(InstructionSet most) noexcept
{
    limit.store(most, std::memory_order_relaxed);
}

InstructionSet instructionSetLimit() noexcept
{
    return limit.load(std::memory_order_relaxed);
}

const char* nameOf(InstructionSet set) noexcept
{
    constexpr const char* kNames[] = {"sse2", "sse4.2", "avx2", "avx512"};
    return kNames[static_cast<std::size_t>(set)];
}

bool limitInstructionSet(std::string_view name) noexcept
{
    for (const InstructionSet set : kSets) {
        if (name != nameOf(set)) continue;
        limitInstructionSet(set);
        return true;
    }
    return false;
}

bool limitByEnvironment()
{
    const char* name = std::getenv("GNOMON_MAX_ISA");
    if (!name || *name == '\0' || limitInstructionSet(std::string_view(name))) return true;
    std::fprintf(stderr, "GNOMON_MAX_ISA is '%s': sse2, sse4.2, avx2 or avx512 is wanted\n", name);
    return false;
}

} // namespace gnomon
