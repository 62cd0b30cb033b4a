#include "runtime/allocation_count.hpp"

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "sanitized.hpp"

namespace {
std::atomic<std::size_t> allocations{0};
std::atomic<std::size_t> returned{0};

constexpr std::size_t kAll = SIZE_MAX;
thread_local std::size_t toSucceed = kAll; // of NoMemory; kAll: none lives
thread_local bool anyFailed = false;
} // namespace

std::size_t gnomon::test::allocationCount() noexcept
{
    return allocations.load();
}

std::int64_t gnomon::test::liveAllocationCount() noexcept
{
    return static_cast<std::int64_t>(allocations.load()) - static_cast<std::int64_t>(returned.load());
}

bool gnomon::test::countsOnlyOurs() noexcept
{
    return !kSanitized;
}

gnomon::test::NoMemory::NoMemory(std::size_t first) noexcept
{
    toSucceed = first;
    anyFailed = false;
}

gnomon::test::NoMemory::~NoMemory()
{
    toSucceed = kAll;
}

bool gnomon::test::NoMemory::struck() const noexcept
{
    return anyFailed;
}

#if defined(GN_TEST_SANITIZED)

// A sanitizer brings its own operator new, linked statically by clang; its hooks see every allocation instead.
#include <sanitizer/allocator_interface.h>

namespace {
[[maybe_unused]] const int hooksInstalled =
    __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { ++allocations; },
                                              [](const volatile void* memory) { returned += memory != nullptr; });
}

#else

void* operator new(std::size_t size)
{
    ++allocations;
    if (toSucceed == 0) {
        anyFailed = true;
        throw std::bad_alloc();
    }
    if (toSucceed != kAll) --toSucceed;
    if (void* memory = std::malloc(size ? size : 1)) return memory;
    throw std::bad_alloc();
}

void operator delete(void* memory) noexcept
{
    returned += memory != nullptr;
    std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept
{
    returned += memory != nullptr;
    std::free(memory);
}

#endif
