#pragma once
// Words that the device sets as it begins one piece of work after the other. They are read where it does not end.
#include <cstdint>

#include "runtime/vk/memory.hpp"

namespace gnomon {

class ProgressMarks {
public:
    static constexpr std::uint32_t kCount = 4096; ///< Pieces after these are not marked.

    Result<void> create(DeviceMemory& memory, const char* name);
    void destroy(DeviceMemory& memory) noexcept { memory.destroy(buffer_); }

    /// Nothing has begun. The device must be done with what marked here.
    void clear() noexcept;
    /// Records that piece `index` begins; outside a rendering scope. Each index once between clears.
    void mark(const DeviceTable& vk, VkCommandBuffer cmd, std::uint32_t index) noexcept;
    /// Pieces begun so far: the index of the last one plus 1.
    std::uint32_t begun() const noexcept;

private:
    GpuBuffer buffer_;
    std::uint32_t used_ = 0;
};

} // namespace gnomon
