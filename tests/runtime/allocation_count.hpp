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

/// While it lives, calls of operator new on its thread fail: from the `first`-th on (0: the very next), all of them.
/// Where not only ours are counted, none does. One at a time a thread.
class NoMemory {
public:
    explicit NoMemory(std::size_t first) noexcept;
    ~NoMemory();
    NoMemory(const NoMemory&) = delete;
    NoMemory& operator=(const NoMemory&) = delete;

    bool struck() const noexcept; ///< One has failed.
};

} // namespace gnomon::test
