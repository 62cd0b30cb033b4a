#pragma once

/// Which copy of a kernel runs here: whatever is compiled once per instruction set asks this.

#include <cstdint>
#include <string_view>

namespace gnomon {

/// Each holds those before it. Kernels of gnomon's are compiled for Baseline and Avx2; ray tracers have others.
enum class InstructionSet : uint8_t { Baseline, Sse42, Avx2, Avx512 };

/// Whether this build has kernels for it, this processor runs them and the limit allows them.
bool isSupported(InstructionSet set) noexcept;
InstructionSet bestInstructionSet() noexcept;

/// A limit for the whole process: of kernels from now on, of ray tracers in contexts that are created from now on. For
/// tests and measurements; the library itself sets none.
void limitInstructionSet(InstructionSet most) noexcept;
InstructionSet instructionSetLimit() noexcept; ///< Avx512: none.

/// "sse2" (of Baseline), "sse4.2", "avx2" or "avx512".
const char* nameOf(InstructionSet set) noexcept;
/// @param name as of nameOf() @return false: it is none of them, and nothing is limited
bool limitInstructionSet(std::string_view name) noexcept;

/// For main() of a program, before anything else is called: the limit that the environment variable GNOMON_MAX_ISA
/// names. Without the variable, or where it is empty, there is none.
/// @return false: it is no instruction set, which has been said on stderr
bool limitByEnvironment();

} // namespace gnomon
