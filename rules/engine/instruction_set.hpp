#pragma once

/// Which copy of a kernel runs here: whatever is compiled once per instruction set asks this.

#include <cstdint>

namespace gnomon::rules {

enum class InstructionSet : uint8_t { Baseline, Avx2, Avx512 };

/// Whether this build has kernels for it and this processor runs them.
bool isSupported(InstructionSet set) noexcept;
InstructionSet bestInstructionSet() noexcept;

} // namespace gnomon::rules
