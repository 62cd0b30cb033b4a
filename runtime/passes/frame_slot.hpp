#pragma once
// What one frame in flight owns: command buffers, sets, uniform memory, queries. Internal to the executor.
#include <vector>

#include "runtime/passes/pass_executor.hpp"
#include "runtime/vk/progress_marks.hpp"

namespace gnomon {

// Queries come in pools; timed frames take two a pass, however many there are.
constexpr std::uint32_t kQueriesPerPool = 2048;
// Uniform memory comes in chunks; a pass needs a few hundred bytes.
constexpr VkDeviceSize kConstantsChunk = 64 << 10;

struct PassExecutor::Slot {
    struct Entry {
        PassTiming timing;
        std::uint32_t startQuery = UINT32_MAX; ///< CPU passes have none.
        std::uint32_t endQuery = UINT32_MAX;
    };
    struct Span {
        std::uint32_t startQuery, endQuery;
    };

    explicit Slot(const DeviceTable& vk) : descriptors(vk) {}

    std::uint64_t frame = 0;
    bool timed = false;
    bool timingsPending = false;
    UniqueCommandPool pool;
    std::vector<VkCommandBuffer> cmds; ///< One a round.
    DescriptorRing descriptors;
    std::vector<GpuBuffer> constants;
    std::size_t chunk = 0;
    VkDeviceSize chunkUsed = 0;
    GpuBuffer transforms;
    std::uint64_t transformsRevision = 0;
    std::vector<UniqueQueryPool> queries; ///< Query i lies in pool i / kQueriesPerPool.
    std::uint32_t queriesUsed = 0;
    std::vector<Entry> entries;
    ProgressMarks marks; ///< By index into `entries`.
    std::vector<Span> rounds;
    std::vector<std::uint64_t> results;
};

} // namespace gnomon
