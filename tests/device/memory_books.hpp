#pragma once
// What gnomon holds on the device, buffer by buffer and image by image, under the names it gives them. Names need
// VK_EXT_debug_utils, which the device of the tests has where validation is on.
#include <string>

#include "device/fixture.hpp"

namespace gnomon::test {

/// One at a time. Contexts made with options() are booked while it lives.
class MemoryBooks {
public:
    struct Entry {
        VkDeviceSize bytes = 0;
        uint32_t count = 0;
    };

    MemoryBooks();
    ~MemoryBooks();
    MemoryBooks(const MemoryBooks&) = delete;
    MemoryBooks& operator=(const MemoryBooks&) = delete;

    HostOptions options(HostOptions base = {}) const;

    /// Of live objects whose name starts so: buffers by the size they were made with, images by what the device asks.
    Entry held(const std::string& prefix) const;
    /// Every name that is held, with its bytes.
    std::string list() const;
};

} // namespace gnomon::test
