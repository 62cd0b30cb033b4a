#include "runtime/accel/compacted_sizes.hpp"

#include <algorithm>
#include <utility>

namespace gnomon {

void CompactedSizes::begin()
{
    if (std::exchange(tried_, true)) return;
    const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                     .queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR,
                                     .queryCount = static_cast<std::uint32_t>(kQueries),
                                     .pipelineStatistics = 0};
    VkQueryPool pool = VK_NULL_HANDLE;
    if (vk_.vkCreateQueryPool(vk_.device, &info, vk_.hostAllocator, &pool) != VK_SUCCESS) return;
    pool_ = UniqueQueryPool(vk_, pool);
}

std::uint64_t CompactedSizes::take(std::uint64_t frame)
{
    if (!pool_.get()) return 0;
    const auto free = std::ranges::find_if(
        taken_, [frame](const Taken& taken) { return taken.query == 0 || taken.frame + kForgotten < frame; });
    if (free == taken_.end()) return 0;
    const auto index = static_cast<std::uint64_t>(free - taken_.begin());
    *free = {.query = ++round_ * kQueries + index, .frame = frame};
    return free->query;
}

VkDeviceSize CompactedSizes::read(std::uint64_t query, std::uint64_t completedFrame)
{
    Taken& taken = taken_[indexOf(query)];
    if (query == 0 || taken.query != query || taken.frame > completedFrame) return 0;
    std::uint64_t bytes = 0;
    const VkResult result = vk_.vkGetQueryPoolResults(vk_.device, pool_.get(), indexOf(query), 1, sizeof(bytes), &bytes,
                                                      sizeof(bytes), VK_QUERY_RESULT_64_BIT);
    if (result == VK_NOT_READY) return 0;
    taken = {};
    return result == VK_SUCCESS ? bytes : 0;
}

} // namespace gnomon
