#include "runtime/base/jobs.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "runtime/base/float_mode.hpp"

namespace gnomon {
namespace {

/// What a thread is doing, and as part of what. Who waits for a piece of work helps with all that is part of it, and
/// with nothing else: another frame's work, or a mesh's in the background, would hold it up.
struct Origin {
    const void* work = nullptr; ///< A Range or a Job.
    const Origin* part = nullptr;

    bool isPartOf(const void* whole) const noexcept
    {
        const Origin* at = this;
        while (at && at->work != whole)
            at = at->part;
        return at != nullptr;
    }
};

thread_local const Origin* doing = nullptr; // of this thread

class Doing {
public:
    explicit Doing(const Origin& origin) noexcept : before_(std::exchange(doing, &origin)) {}
    ~Doing() { doing = before_; }
    Doing(const Doing&) = delete;
    Doing& operator=(const Doing&) = delete;

private:
    const Origin* before_;
};

/// A parallelFor in progress; lives on the stack of its caller, who leaves only after every helper has left.
struct Range {
    Origin origin{this, doing};
    void (*fn)(void* self, std::size_t begin, std::size_t end, std::uint32_t thread) = nullptr;
    void* self = nullptr;
    std::size_t count = 0;
    std::size_t grain = 1;
    std::atomic<std::size_t> next{0};

    // Guarded by the pool's mutex.
    std::uint32_t joined = 0; ///< Helpers that ever came; the n-th is thread n.
    std::uint32_t maxHelpers = 0;
    std::uint32_t inside = 0; ///< Helpers working now.
    bool linked = false;
    Range* following = nullptr;
    std::exception_ptr error;

    bool exhausted() const noexcept { return next.load(std::memory_order_relaxed) >= count; }

    void work(std::uint32_t thread)
    {
        const Doing scope(origin);
        while (!exhausted()) {
            const std::size_t begin = next.fetch_add(grain, std::memory_order_relaxed);
            if (begin >= count) return;
            fn(self, begin, std::min(count - begin, grain) + begin, thread);
        }
    }
};

} // namespace

/// One queue for both kinds of threads. A worker of ours loops over serveOne(); a thread of the host gets one *ticket*
/// per job or helper wanted and calls serveOne() once. Tickets name the pool, never a job, because wait() may have run
/// the job, and its owner may have freed it, before the host gets round to the ticket.
struct JobSystem::Pool {
    PFN_gnScheduleJob schedule = nullptr;
    void* userData = nullptr;
    std::uint32_t threadCount = 1;

    std::mutex mutex;
    std::condition_variable work;     ///< Our workers: something was queued, or stop.
    std::condition_variable progress; ///< Waiters: a job finished, a helper left, a ticket came back.
    Job* firstJob = nullptr;
    Job* lastJob = nullptr;
    Range* firstRange = nullptr;
    std::uint32_t waiters = 0;
    std::uint64_t tickets = 0; ///< Handed to the host and not come back.
    bool stopping = false;
    std::vector<std::thread> threads;

    void push(Job& job) noexcept;
    void unlink(Range& range) noexcept;
    bool unlink(Job& job) noexcept;
    Range* joinRange(const void* whole) noexcept;
    bool serveOne(std::unique_lock<std::mutex>& lock);
    void helpWith(Range& range, std::unique_lock<std::mutex>& lock);
    void runJob(Job& job, std::unique_lock<std::mutex>& lock) noexcept;
    void wake(std::uint32_t count);
    void loop();
    static void GN_CALL redeemTicket(void* pool);

    /// Until `condition` holds; meanwhile helps with ranges that are part of `whole`, if any is named.
    template <typename Condition>
    void waitFor(std::unique_lock<std::mutex>& lock, const void* whole, Condition condition)
    {
        while (!condition()) {
            if (Range* range = whole ? joinRange(whole) : nullptr) {
                helpWith(*range, lock);
                continue;
            }
            ++waiters;
            progress.wait(lock);
            --waiters;
        }
    }
};

void JobSystem::Pool::push(Job& job) noexcept
{
    job.next = nullptr;
    (lastJob ? lastJob->next : firstJob) = &job;
    lastJob = &job;
}

/// False: somebody took it already.
bool JobSystem::Pool::unlink(Job& job) noexcept
{
    Job* before = nullptr;
    for (Job* at = firstJob; at; before = at, at = at->next) {
        if (at != &job) continue;
        (before ? before->next : firstJob) = job.next;
        if (lastJob == &job) lastJob = before;
        return true;
    }
    return false;
}

void JobSystem::Pool::unlink(Range& range) noexcept
{
    if (!range.linked) return;
    range.linked = false;
    Range** link = &firstRange;
    while (*link != &range)
        link = &(*link)->following;
    *link = range.following;
}

/// The first range, of those that are part of `whole` if that is named, that still wants a helper, with the caller
/// counted in. Ranges that want no more leave the list.
Range* JobSystem::Pool::joinRange(const void* whole) noexcept
{
    Range* following = nullptr;
    for (Range* range = firstRange; range; range = following) {
        following = range->following;
        if (range->exhausted()) {
            unlink(*range);
            continue;
        }
        if (whole && !range->origin.isPartOf(whole)) continue;
        ++range->inside;
        if (++range->joined == range->maxHelpers) unlink(*range);
        return range;
    }
    return nullptr;
}

/// Ranges come first: somebody on the frame's path waits for them. False: nothing to do.
bool JobSystem::Pool::serveOne(std::unique_lock<std::mutex>& lock)
{
    if (Range* range = joinRange(nullptr)) {
        helpWith(*range, lock);
        return true;
    }
    if (Job* job = firstJob) {
        unlink(*job);
        runJob(*job, lock);
        return true;
    }
    return false;
}

void JobSystem::Pool::helpWith(Range& range, std::unique_lock<std::mutex>& lock)
{
    const std::uint32_t thread = range.joined;
    std::exception_ptr error;
    lock.unlock();
    try {
        const FloatMode mode; // a host's thread may be in any
        range.work(thread);
    } catch (...) {
        error = std::current_exception();
        range.next.store(range.count, std::memory_order_relaxed); // the others stop early
    }
    lock.lock();
    if (error && !range.error) range.error = std::move(error);
    --range.inside; // from here on the range may be gone
    if (waiters) progress.notify_all();
}

void JobSystem::Pool::runJob(Job& job, std::unique_lock<std::mutex>& lock) noexcept
{
    lock.unlock();
    {
        const FloatMode mode;
        const Origin origin{&job, doing};
        const Doing scope(origin);
        job.run(job.data);
    }
    lock.lock();
    job.finished.store(true, std::memory_order_release); // from here on the job may be gone
    if (waiters) progress.notify_all();
}

/// Called without the mutex: a host may run the ticket on the spot, though it promised another thread.
void JobSystem::Pool::wake(std::uint32_t count)
{
    for (std::uint32_t i = 0; i < count; ++i) {
        if (schedule)
            schedule(&redeemTicket, this, userData);
        else
            work.notify_one();
    }
}

void GN_CALL JobSystem::Pool::redeemTicket(void* pool)
{
    Pool& self = *static_cast<Pool*>(pool);
    std::unique_lock lock(self.mutex);
    self.serveOne(lock);
    --self.tickets;
    if (self.waiters) self.progress.notify_all();
}

void JobSystem::Pool::loop()
{
    std::unique_lock lock(mutex);
    while (true) {
        if (serveOne(lock)) continue;
        if (stopping) return;
        work.wait(lock);
    }
}

JobSystem::JobSystem(PFN_gnScheduleJob schedule, void* userData, std::uint32_t threadCount, PFN_gnThreadStarted started)
    : pool_(std::make_unique<Pool>())
{
    pool_->schedule = threadCount == 1 ? nullptr : schedule;
    pool_->userData = userData;
    pool_->threadCount = threadCount ? threadCount : std::max(1u, std::thread::hardware_concurrency());
    if (schedule || threadCount == 1) return;
    const std::uint32_t workers = std::max(1u, pool_->threadCount - 1);
    pool_->threads.reserve(workers);
    try {
        for (std::uint32_t i = 0; i < workers; ++i)
            pool_->threads.emplace_back([pool = pool_.get(), started, i] {
                if (started) started(i, pool->userData);
                pool->loop();
            });
    } catch (...) {                        // no thread, or no memory for one
        if (pool_->threads.empty()) throw; // else fewer will do
    }
}

JobSystem::~JobSystem()
{
    {
        std::unique_lock lock(pool_->mutex);
        pool_->stopping = true;
        while (pool_->serveOne(lock)) {
        }
        pool_->waitFor(lock, nullptr, [this] { return pool_->tickets == 0; });
    }
    pool_->work.notify_all();
    for (std::thread& thread : pool_->threads)
        thread.join();
}

std::uint32_t JobSystem::threadCount() const noexcept
{
    return pool_->threadCount;
}

void JobSystem::submit(Job& job)
{
    job.owner = this;
    job.finished.store(false, std::memory_order_relaxed);
    {
        const std::lock_guard lock(pool_->mutex);
        pool_->push(job);
        if (pool_->schedule) ++pool_->tickets;
    }
    pool_->wake(1);
}

void JobSystem::wait(Job& job)
{
    if (job.done()) return;
    std::unique_lock lock(pool_->mutex);
    if (pool_->unlink(job)) {
        pool_->runJob(job, lock);
        return;
    }
    // Another thread runs it and cannot be waiting for us: a waiter runs what nobody has taken.
    pool_->waitFor(lock, &job, [&job] { return job.done(); });
}

void JobSystem::runParallel(std::size_t count, std::size_t grain, RangeFn fn, void* self)
{
    if (count == 0) return;
    grain = std::clamp<std::size_t>(grain, 1, count);
    const std::size_t pieces = (count - 1) / grain + 1;
    Range range;
    range.fn = fn;
    range.self = self;
    range.count = count;
    range.grain = grain;
    range.maxHelpers = static_cast<std::uint32_t>(std::min<std::size_t>(pool_->threadCount - 1, pieces - 1));
    if (range.maxHelpers == 0) {
        range.work(0);
        return;
    }
    {
        const std::lock_guard lock(pool_->mutex);
        range.following = pool_->firstRange; // the innermost of nested ranges is helped first
        range.linked = true;
        pool_->firstRange = &range;
        if (pool_->schedule) pool_->tickets += range.maxHelpers;
        if (pool_->waiters) pool_->progress.notify_all(); // who waits for what this is part of
    }
    pool_->wake(range.maxHelpers);
    std::exception_ptr error;
    try {
        range.work(0);
    } catch (...) {
        error = std::current_exception();
        range.next.store(count, std::memory_order_relaxed);
    }
    {
        std::unique_lock lock(pool_->mutex);
        pool_->unlink(range);
        pool_->waitFor(lock, &range, [&range] { return range.inside == 0; });
    }
    if (!error) error = range.error;
    if (error) std::rethrow_exception(error);
}

} // namespace gnomon
