#pragma once
#include <cstddef>
#include <cstdint>

namespace gnomon::test {

/// Calls of operator new in this program so far, from any thread.
std::size_t allocationCount() noexcept;

/// Of these, how many have not been given back.
std::int64_t liveAllocationCount() noexcept;

/// False under a sanitizer: its hooks also see what drivers and the sanitizer itself allocate, so that zero proves
/// nothing and more than zero is no finding.
bool countsOnlyOurs() noexcept;

} // namespace gnomon::test
