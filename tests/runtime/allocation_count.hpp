#pragma once
#include <cstddef>

namespace gnomon::test {

/// Calls of operator new in this program so far, from any thread.
std::size_t allocationCount() noexcept;

} // namespace gnomon::test
