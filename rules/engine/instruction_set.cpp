#include "rules/engine/instruction_set.hpp"

#include <initializer_list>

namespace gnomon::rules {

bool isSupported(InstructionSet set) noexcept
{
    switch (set) {
    case InstructionSet::Baseline:
        return true;
#if GNOMON_BATCH_X86
    case InstructionSet::Avx2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case InstructionSet::Avx512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
#endif
    default:
        return false;
    }
}

InstructionSet bestInstructionSet() noexcept
{
    for (const InstructionSet set : {InstructionSet::Avx512, InstructionSet::Avx2}) {
        if (isSupported(set)) return set;
    }
    return InstructionSet::Baseline;
}

} // namespace gnomon::rules
