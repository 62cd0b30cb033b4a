#pragma once
// What the last failed call of each thread said: mesh and instance calls come from any thread, and one must neither
// write over the other's sentence nor read it.
#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace gnomon {

/// Safe from several threads. An entry stays for every thread that ever failed.
class LastErrors {
public:
    void set(std::string text)
    {
        const std::lock_guard lock(mutex_);
        texts_[thisThread()] = std::move(text);
    }
    /// Of the calling thread; its own until it fails again.
    const char* get() const
    {
        const std::lock_guard lock(mutex_);
        const auto found = texts_.find(thisThread());
        return found == texts_.end() ? "" : found->second.c_str();
    }

private:
    /// A number that no other thread ever has; ids of threads that ended are used again.
    static std::uint64_t thisThread() noexcept
    {
        static std::atomic<std::uint64_t> newest{0};
        thread_local const std::uint64_t own = ++newest;
        return own;
    }

    mutable std::mutex mutex_;
    std::map<std::uint64_t, std::string> texts_;
};

} // namespace gnomon
