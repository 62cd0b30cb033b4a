#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "runtime/allocation_count.hpp"
#include "runtime/base/jobs.hpp"

using namespace gnomon;

namespace {

/// A host's job system: two threads and a queue; it can hold its work back.
class HostJobs {
public:
    explicit HostJobs(std::size_t threadCount = 2)
    {
        for (std::size_t i = 0; i < threadCount; ++i)
            threads_.emplace_back([this] { loop(); });
    }
    ~HostJobs()
    {
        {
            const std::lock_guard lock(mutex_);
            stop_ = true;
        }
        change_.notify_all();
        for (std::thread& thread : threads_)
            thread.join();
    }
    static void GN_CALL schedule(PFN_gnJob job, void* data, void* self)
    {
        HostJobs& host = *static_cast<HostJobs*>(self);
        {
            const std::lock_guard lock(host.mutex_);
            host.queue_.push_back({job, data});
            ++host.scheduled_;
        }
        host.change_.notify_one();
    }
    void hold(bool held)
    {
        {
            const std::lock_guard lock(mutex_);
            held_ = held;
        }
        change_.notify_all();
    }
    std::size_t scheduled()
    {
        const std::lock_guard lock(mutex_);
        return scheduled_;
    }

private:
    void loop()
    {
        std::unique_lock lock(mutex_);
        while (true) {
            change_.wait(lock, [this] { return (!queue_.empty() && !held_) || stop_; });
            if (queue_.empty() || held_) return;
            const auto [job, data] = queue_.front();
            queue_.pop_front();
            lock.unlock();
            job(data);
            lock.lock();
        }
    }
    std::mutex mutex_;
    std::condition_variable change_;
    std::deque<std::pair<PFN_gnJob, void*>> queue_;
    std::size_t scheduled_ = 0;
    bool held_ = false;
    bool stop_ = false;
    std::vector<std::thread> threads_;
};

struct Counted {
    std::atomic<int> runs{0};
    JobSystem::Job job;
    Counted()
    {
        job.run = [](void* self) { ++static_cast<Counted*>(self)->runs; };
        job.data = this;
    }
};

void checkCoverage(JobSystem& jobs, std::size_t count, std::size_t grain)
{
    std::vector<std::atomic<int>> visits(count);
    std::vector<std::atomic<int>> busy(jobs.threadCount());
    std::atomic<int> faults{0};
    jobs.parallelFor(count, grain, [&](std::size_t begin, std::size_t end, std::uint32_t thread) {
        if (thread >= jobs.threadCount() || ++busy[thread] != 1) ++faults; // shared by two concurrent calls
        if (begin >= end || end > count || end - begin > std::max<std::size_t>(grain, 1)) ++faults;
        for (std::size_t i = begin; i < end; ++i)
            ++visits[i];
        --busy[thread];
    });
    CHECK(faults == 0);
    for (std::size_t i = 0; i < count; ++i)
        REQUIRE(visits[i] == 1);
}

} // namespace

TEST_CASE("parallelFor visits each index exactly once, in pieces of at most the grain, on threads of distinct number")
{
    for (std::uint32_t threads : {1u, 2u, 5u}) {
        JobSystem jobs(nullptr, nullptr, threads);
        CHECK(jobs.threadCount() == threads);
        for (std::size_t count : {0u, 1u, 7u, 1000u, 20011u})
            for (std::size_t grain : {0u, 1u, 16u, 100000u})
                checkCoverage(jobs, count, grain);
    }
}

TEST_CASE("parallelFor within parallelFor and from several threads ends and loses nothing")
{
    JobSystem jobs(nullptr, nullptr, 3);
    std::atomic<std::size_t> sum{0};
    const auto work = [&jobs, &sum] {
        jobs.parallelFor(40, 1, [&](std::size_t, std::size_t, std::uint32_t) {
            jobs.parallelFor(100, 3, [&](std::size_t begin, std::size_t end, std::uint32_t) { sum += end - begin; });
        });
    };
    std::array<std::thread, 4> callers;
    for (std::thread& caller : callers)
        caller = std::thread(work);
    for (std::thread& caller : callers)
        caller.join();
    CHECK(sum == 4 * 40 * 100);
}

namespace {

/// False once ten seconds have passed without it.
template <typename Condition>
bool comesTrue(Condition condition)
{
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!condition())
        if (std::chrono::steady_clock::now() > until) return false;
    return true;
}

/// Two pieces that each want to see the other one under way.
bool takesTwoThreads(JobSystem& jobs)
{
    std::atomic<int> inside{0};
    std::atomic<bool> met{true};
    jobs.parallelFor(2, 1, [&](std::size_t, std::size_t, std::uint32_t) {
        ++inside;
        if (!comesTrue([&] { return inside == 2; })) met = false;
    });
    return met;
}

} // namespace

TEST_CASE("who waits for a range or a job helps with the ranges that are part of it")
{
    JobSystem jobs(nullptr, nullptr, 2); // one worker: only the waiter is left to help it
    std::atomic<bool> begun{false};
    bool met = false;
    jobs.parallelFor(2, 1, [&](std::size_t, std::size_t, std::uint32_t thread) {
        if (thread == 0) {
            CHECK(comesTrue([&] { return begun.load(); }));
            return;
        }
        begun = true;
        met = takesTwoThreads(jobs);
    });
    CHECK(met);

    struct Ranged {
        JobSystem* jobs;
        std::atomic<bool> begun{false};
        bool met = false;
        JobSystem::Job job;
    } ranged;
    ranged.jobs = &jobs;
    ranged.job.data = &ranged;
    ranged.job.run = [](void* data) {
        Ranged& self = *static_cast<Ranged*>(data);
        self.begun = true;
        self.met = takesTwoThreads(*self.jobs);
    };
    jobs.submit(ranged.job);
    CHECK(comesTrue([&] { return ranged.begun.load(); }));
    jobs.wait(ranged.job);
    CHECK(ranged.met);
}

TEST_CASE("who waits for a range leaves the ranges of others alone")
{
    JobSystem jobs(nullptr, nullptr, 3);
    std::atomic<int> foreign{0};
    std::atomic<bool> helped{false}, released{false}, held{false};
    std::thread other;
    jobs.parallelFor(2, 1, [&](std::size_t, std::size_t, std::uint32_t thread) {
        if (thread == 0) {
            CHECK(comesTrue([&] { return helped.load(); }));
            // Three pieces, of which the thread and the second worker take one each; the third is left for any helper.
            other = std::thread([&] {
                jobs.parallelFor(3, 1, [&](std::size_t, std::size_t, std::uint32_t) {
                    ++foreign;
                    if (!comesTrue([&] { return released.load(); })) held = true;
                });
            });
            CHECK(comesTrue([&] { return foreign == 2; }));
            return;
        }
        helped = true;
        CHECK(comesTrue([&] { return foreign == 2; }));
        std::this_thread::sleep_for(std::chrono::milliseconds(50)); // the caller is waiting by now
    });
    released = true;
    other.join();
    CHECK_FALSE(held);
    CHECK(foreign == 3);
}

TEST_CASE("jobs of a pool run once each, and jobs may wait for jobs")
{
    JobSystem jobs(nullptr, nullptr, 2); // a single worker: waiting must not starve it
    std::array<Counted, 50> counted;
    for (Counted& each : counted)
        jobs.submit(each.job);
    struct Outer {
        JobSystem* jobs;
        Counted inner;
        JobSystem::Job job;
    } outer;
    outer.jobs = &jobs;
    outer.job.data = &outer;
    outer.job.run = [](void* data) {
        Outer& self = *static_cast<Outer*>(data);
        self.jobs->submit(self.inner.job);
        self.jobs->wait(self.inner.job);
    };
    jobs.submit(outer.job);
    jobs.wait(outer.job);
    CHECK(outer.inner.runs == 1);
    for (Counted& each : counted) {
        jobs.wait(each.job);
        CHECK(each.job.done());
        CHECK(each.runs == 1);
    }
    jobs.submit(counted[0].job); // a job may be used again
    jobs.wait(counted[0].job);
    CHECK(counted[0].runs == 2);
}

TEST_CASE("what the body throws reaches the caller of parallelFor, from whatever thread")
{
    JobSystem jobs(nullptr, nullptr, 4);
    for (int round = 0; round < 50; ++round) {
        std::atomic<int> calls{0};
        CHECK_THROWS_AS(jobs.parallelFor(1000, 1,
                                         [&calls](std::size_t begin, std::size_t, std::uint32_t) {
                                             ++calls;
                                             if (begin == 500) throw std::runtime_error("expected");
                                         }),
                        std::runtime_error);
        CHECK(calls >= 1);
    }
    checkCoverage(jobs, 1000, 7); // and the pool works on
}

TEST_CASE("the host's threads run jobs and help with ranges")
{
    HostJobs host;
    JobSystem jobs(&HostJobs::schedule, &host, 3);
    CHECK(jobs.threadCount() == 3);
    checkCoverage(jobs, 5000, 3);
    std::array<Counted, 20> counted;
    for (Counted& each : counted)
        jobs.submit(each.job);
    for (Counted& each : counted)
        jobs.wait(each.job);
    for (Counted& each : counted)
        CHECK(each.runs == 1);
}

TEST_CASE("a host that is slow to start jobs delays nobody, and its late calls find nothing to do")
{
    HostJobs host;
    host.hold(true);
    {
        JobSystem jobs(&HostJobs::schedule, &host, 3);
        {
            Counted counted;
            jobs.submit(counted.job);
            jobs.wait(counted.job); // run here
            CHECK(counted.runs == 1);
        } // the job is gone before the host comes to it
        checkCoverage(jobs, 100, 1);
        CHECK(host.scheduled() == 3);
        host.hold(false); // destruction waits for the three calls
    }
    CHECK(host.scheduled() == 3);
}

TEST_CASE("destruction runs what is still queued")
{
    std::array<Counted, 100> counted;
    {
        JobSystem jobs(nullptr, nullptr, 2);
        for (Counted& each : counted)
            jobs.submit(each.job);
    }
    for (Counted& each : counted) {
        CHECK(each.job.done());
        CHECK(each.runs == 1);
    }
}

TEST_CASE("each thread of the pool says once that it starts, on itself and before it works")
{
    struct Started {
        std::mutex mutex;
        std::vector<std::pair<std::uint32_t, std::thread::id>> threads;
    } started;
    const auto note = [](std::uint32_t index, void* data) {
        Started& self = *static_cast<Started*>(data);
        const std::lock_guard lock(self.mutex);
        self.threads.emplace_back(index, std::this_thread::get_id());
    };
    {
        JobSystem jobs(nullptr, &started, 4, note);
        std::atomic<int> strangers{0};
        jobs.parallelFor(1000, 1, [&](std::size_t, std::size_t, std::uint32_t thread) {
            if (thread == 0) return;
            const std::lock_guard lock(started.mutex);
            const auto self = std::this_thread::get_id();
            strangers +=
                std::ranges::none_of(started.threads, [self](const auto& each) { return each.second == self; });
        });
        CHECK(strangers == 0);
    }
    std::ranges::sort(started.threads);
    REQUIRE(started.threads.size() == 3);
    for (std::uint32_t i = 0; i < 3; ++i) {
        CHECK(started.threads[i].first == i);
        CHECK(started.threads[i].second != std::this_thread::get_id());
    }
}

TEST_CASE("one thread is the calling one: no other is started or asked for, and who waits for a job runs it")
{
    struct Seen {
        std::atomic<int> started{0}, scheduled{0};
        std::thread::id ranOn;
    } seen;
    const auto started = [](std::uint32_t, void* data) { ++static_cast<Seen*>(data)->started; };
    const auto schedule = [](PFN_gnJob job, void* data, void* host) {
        ++static_cast<Seen*>(host)->scheduled;
        std::thread(job, data).join();
    };
    for (const PFN_gnScheduleJob given : {PFN_gnScheduleJob{nullptr}, PFN_gnScheduleJob{schedule}}) {
        JobSystem jobs(given, &seen, 1, started);
        JobSystem::Job job;
        job.data = &seen;
        job.run = [](void* data) { static_cast<Seen*>(data)->ranOn = std::this_thread::get_id(); };
        seen.ranOn = {};
        jobs.submit(job);
        checkCoverage(jobs, 100, 1);
        jobs.wait(job);
        CHECK(seen.ranOn == std::this_thread::get_id());
    }
    CHECK(seen.started == 0);
    CHECK(seen.scheduled == 0);
}

TEST_CASE("running jobs and ranges allocates nothing")
{
    JobSystem jobs(nullptr, nullptr, 3);
    std::array<Counted, 16> counted;
    std::atomic<std::size_t> sum{0};
    const auto round = [&] {
        for (Counted& each : counted)
            jobs.submit(each.job);
        jobs.parallelFor(1000, 10, [&](std::size_t begin, std::size_t end, std::uint32_t) {
            jobs.parallelFor(4, 1, [&](std::size_t, std::size_t, std::uint32_t) { sum += end - begin; });
        });
        for (Counted& each : counted)
            jobs.wait(each.job);
    };
    round();
    const std::size_t before = test::allocationCount();
    for (int i = 0; i < 100; ++i)
        round();
    if (test::countsOnlyOurs()) CHECK(test::allocationCount() == before);
    CHECK(sum == 101 * 4 * 1000);
}
