#include "runtime/vk/progress_marks.hpp"

#include <algorithm>
#include <cstring>

namespace gnomon {

Result<void> ProgressMarks::create(DeviceMemory& memory, const char* name)
{
    if (buffer_.buffer) return {};
    Result<GpuBuffer> made = memory.createBuffer(kCount * sizeof(std::uint32_t), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                                 MemoryUse::readback, name);
    if (!made) return made.error();
    buffer_ = *made;
    used_ = kCount;
    clear();
    return {};
}

void ProgressMarks::clear() noexcept
{
    std::memset(buffer_.mapped, 0, used_ * sizeof(std::uint32_t));
    used_ = 0;
}

void ProgressMarks::mark(const DeviceTable& vk, VkCommandBuffer cmd, std::uint32_t index) noexcept
{
    if (index >= kCount) return;
    used_ = std::max(used_, index + 1);
    vk.vkCmdFillBuffer(cmd, buffer_.buffer, index * sizeof(std::uint32_t), sizeof(std::uint32_t), 1);
}

std::uint32_t ProgressMarks::begun() const noexcept
{
    const volatile auto* words = reinterpret_cast<const volatile std::uint32_t*>(buffer_.mapped);
    std::uint32_t count = used_;
    while (count > 0 && words[count - 1] == 0)
        --count;
    return count;
}

} // namespace gnomon
