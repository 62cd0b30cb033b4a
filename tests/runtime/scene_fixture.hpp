#pragma once
// A registry over a Vulkan that keeps books, with jobs that run when the test says so.
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "runtime/base/arena.hpp"
#include "runtime/base/slot_map.hpp"
#include "runtime/scene/topology.hpp"
#include "runtime/store/scene_registry.hpp"
#include "runtime/vk_stub.hpp"

namespace gnomon::test {

constexpr std::array<double, 3> kNoOrigin{};

// What this build can derive from meshes.
#ifdef GNOMON_WITH_OPENMESH
constexpr bool kWithTopology = true;
#else
constexpr bool kWithTopology = false;
#endif
#ifdef GNOMON_WITH_EMBREE
constexpr bool kWithTrees = true;
#else
constexpr bool kWithTrees = false;
#endif

/// Jobs wait here until run().
class JobQueue {
public:
    static void GN_CALL schedule(PFN_gnJob job, void* data, void* queue)
    {
        JobQueue& self = *static_cast<JobQueue*>(queue);
        const std::lock_guard lock(self.mutex_);
        self.jobs_.emplace_back(job, data);
    }
    std::size_t size() const
    {
        const std::lock_guard lock(mutex_);
        return jobs_.size();
    }
    void run()
    {
        std::vector<std::pair<PFN_gnJob, void*>> jobs;
        {
            const std::lock_guard lock(mutex_);
            jobs.swap(jobs_);
        }
        for (const auto& [job, data] : jobs)
            job(data);
    }

private:
    mutable std::mutex mutex_;
    std::vector<std::pair<PFN_gnJob, void*>> jobs_;
};

struct SceneOptions {
    bool discrete = false; ///< Device-local memory is not mapped: meshes are uploaded.
    bool background = false;
    bool manualJobs = false; ///< In a JobQueue instead of the pool.
    bool rays = true;
};

class SceneFixture {
public:
    struct Said {
        GnSeverity severity;
        std::string id, text;
    };

    StubVulkan stub;
    JobQueue queue;

private:
    std::mutex mutex_;
    std::vector<Said> said_;

public:
    Messages messages{&SceneFixture::listen, this};
    std::unique_ptr<JobSystem> jobs;
    std::unique_ptr<DeviceMemory> memory;
    RayScene rays;
    std::unique_ptr<SceneRegistry> registry;
    FrameArena arena;
    std::uint64_t frame = 0;

    explicit SceneFixture(const SceneOptions& options = {})
    {
        if (stub.table.properties.limits.maxStorageBufferRange == 0)
            stub.table.properties.limits.maxStorageBufferRange = 1u << 27;
        if (stub.table.properties.limits.maxDrawIndexedIndexValue == 0)
            stub.table.properties.limits.maxDrawIndexedIndexValue = (1u << 24) - 1;
        constexpr VkMemoryPropertyFlags kHost =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        if (options.discrete)
            stub.setMemoryTypes({VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, kHost}, {1u << 30, 1u << 30}, {0, 1});
        stub.table.vkCmdCopyBuffer2 = &SceneFixture::copyBuffer;
        stub.table.vkBindBufferMemory2 = &SceneFixture::bindBuffer;
        jobs = options.manualJobs ? std::make_unique<JobSystem>(&JobQueue::schedule, &queue, 2)
                                  : std::make_unique<JobSystem>(nullptr, nullptr, 3);
        memory = std::make_unique<DeviceMemory>(stub.table, VkDeviceSize{1} << 30, std::vector<std::uint32_t>{});
        registry = makeRegistry(options);
        current = this;
    }
    ~SceneFixture()
    {
        queue.run(); // tickets of jobs that nobody will run any more
        registry.reset();
        queue.run();
        memory.reset();
        jobs.reset();
        current = nullptr;
    }

    std::unique_ptr<SceneRegistry> makeRegistry(const SceneOptions& options)
    {
        return std::make_unique<SceneRegistry>(stub.table, *memory, *jobs, options.rays ? &rays : nullptr, messages,
                                               options.background);
    }

    const SceneRegistry::Snapshot& begin(const std::array<double, 3>& origin = kNoOrigin)
    {
        arena.reset();
        return registry->begin(++frame, origin);
    }

    /// Everything said since the last call.
    std::vector<Said> said()
    {
        const std::lock_guard lock(mutex_);
        return std::exchange(said_, {});
    }

    bool alive(VkBuffer buffer) const
    {
        const std::lock_guard lock(stub.mutex);
        return stub.objects.contains(bitsOf(buffer));
    }

    /// Bytes of a mapped buffer.
    const std::byte* bytesOf(VkBuffer buffer) const
    {
        const std::lock_guard lock(stub.mutex);
        const StubVulkan::Binding& binding = stub.bindings.at(bitsOf(buffer));
        return static_cast<const std::byte*>(stub.memories.at(binding.memory).bytes) + binding.begin;
    }

    std::map<VkBuffer, std::vector<std::byte>> copied; ///< By vkCmdCopyBuffer2, by target.

private:
    static void GN_CALL listen(const GnMessage* message, void* self)
    {
        SceneFixture& fixture = *static_cast<SceneFixture*>(self);
        const std::lock_guard lock(fixture.mutex_);
        fixture.said_.push_back({message->severity, message->pId, message->pText});
    }

    static void VKAPI_PTR copyBuffer(VkCommandBuffer, const VkCopyBufferInfo2* info)
    {
        const VkBufferCopy2& region = info->pRegions[0];
        const std::byte* from = current->bytesOf(info->srcBuffer) + region.srcOffset;
        current->copied[info->dstBuffer].assign(from, from + region.size);
    }

    /// As the stub's, but safe from several threads.
    static VkResult VKAPI_PTR bindBuffer(VkDevice, std::uint32_t, const VkBindBufferMemoryInfo* info)
    {
        StubVulkan& stub = current->stub;
        if (stub.fails("vkBindBufferMemory2")) return stub.failure;
        const std::uint64_t buffer = bitsOf(info->buffer);
        VkDeviceSize size = 0;
        {
            const std::lock_guard lock(stub.mutex);
            size = stub.sizes.at(buffer);
        }
        stub.bind(buffer, bitsOf(info->memory), info->memoryOffset, size);
        return VK_SUCCESS;
    }

    inline static SceneFixture* current = nullptr;
};

// --- meshes ---

struct Shape {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;

    GnMeshCreateInfo info(const char* name) const
    {
        GnMeshCreateInfo result{};
        result.pName = name;
        result.pPositions = positions.data();
        result.positionCount = static_cast<std::uint32_t>(positions.size() / 3);
        result.pIndices = indices.data();
        result.indexCount = static_cast<std::uint32_t>(indices.size());
        return result;
    }
    Shape scaled(float factor) const
    {
        Shape result = *this;
        for (float& value : result.positions)
            value *= factor;
        return result;
    }
};

/// Corners at +-1, closed, counter-clockwise from outside.
inline Shape cube()
{
    Shape shape;
    for (int i = 0; i < 8; ++i)
        for (int axis = 0; axis < 3; ++axis)
            shape.positions.push_back(i >> axis & 1 ? 1.0f : -1.0f);
    shape.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                     2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return shape;
}

/// One triangle in z = 0.
inline Shape triangle()
{
    return {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}};
}

inline GnTransform at(double x, double y = 0.0, double z = 0.0)
{
    GnTransform transform{};
    transform.translation[0] = x;
    transform.translation[1] = y;
    transform.translation[2] = z;
    return transform;
}

inline GnInstanceCreateInfo instanceOf(GnMesh mesh, const GnTransform& transform = {}, GnInstanceFlags flags = 0,
                                       const char* name = nullptr)
{
    GnInstanceCreateInfo info{};
    info.mesh = mesh;
    info.transform = transform;
    info.flags = flags;
    info.pName = name;
    return info;
}

} // namespace gnomon::test
