#pragma once

#include <cstddef>

namespace gnomon::rules::test {

/// Calls of operator new in this program so far.
std::size_t allocationCount() noexcept;

} // namespace gnomon::rules::test
