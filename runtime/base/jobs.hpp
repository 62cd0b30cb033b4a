#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "gnomon/gnomon.h"

namespace gnomon {

/// Threads of the host's job callback, or one pool of ours. Submitting and waiting allocate nothing.
class JobSystem {
public:
    /// A piece of work in memory of its owner; must stay alive until `done()`. `run` must not throw.
    struct Job {
        void (*run)(void* data) = nullptr;
        void* data = nullptr;
        std::atomic<bool> finished{true};
        JobSystem* owner = nullptr;
        Job* next = nullptr;

        bool done() const noexcept { return finished.load(std::memory_order_acquire); }
    };

    /// `threadCount` counts the caller of parallelFor, so that a pool of our own does not crowd the cores; 0: one a
    /// core, and one more where there is a single one, for work in the background. 1: no thread but the callers'; jobs
    /// run where they are waited for, or in the destructor. Each thread of the pool calls `started` first, if given.
    JobSystem(PFN_gnScheduleJob schedule, void* userData, std::uint32_t threadCount,
              PFN_gnThreadStarted started = nullptr);
    ~JobSystem(); ///< Runs what is still queued, then waits for the workers.
    JobSystem(const JobSystem&) = delete;
    JobSystem& operator=(const JobSystem&) = delete;

    /// Threads that may work at the same time, the caller of parallelFor included; at least 1.
    std::uint32_t threadCount() const noexcept;

    void submit(Job& job);
    /// Blocks until the job has run; runs it (or other jobs of the pool) on this thread if none has taken it yet.
    void wait(Job& job);

    /// Calls body(begin, end, thread) over [0, count) in pieces of at most `grain`, on this thread and the workers;
    /// returns when all are done. `thread` is in [0, threadCount()) and unique among the concurrent calls of this body;
    /// the calling thread is 0. May be nested and called from several threads. What the body throws is rethrown here.
    template <typename Body>
    void parallelFor(std::size_t count, std::size_t grain, Body&& body)
    {
        using Plain = std::remove_reference_t<Body>;
        runParallel(
            count, grain,
            [](void* self, std::size_t begin, std::size_t end, std::uint32_t thread) {
                (*static_cast<Plain*>(self))(begin, end, thread);
            },
            &body);
    }

private:
    using RangeFn = void (*)(void* self, std::size_t begin, std::size_t end, std::uint32_t thread);
    void runParallel(std::size_t count, std::size_t grain, RangeFn fn, void* self);

    struct Pool;
    std::unique_ptr<Pool> pool_;
};

} // namespace gnomon
