#pragma once
// What the last failed call of each thread said: mesh and instance calls come from any thread, and one must neither
// write over the other's sentence nor read it.
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace gnomon {

/// Safe from several threads. An entry stays for every thread that ever failed.
class LastErrors {
public:
    void set(std::string text)
    {
        const std::lock_guard lock(mutex_);
        texts_[std::this_thread::get_id()] = std::move(text);
    }
    /// Of the calling thread; its own until it fails again.
    const char* get() const
    {
        const std::lock_guard lock(mutex_);
        const auto found = texts_.find(std::this_thread::get_id());
        return found == texts_.end() ? "" : found->second.c_str();
    }

private:
    mutable std::mutex mutex_;
    std::map<std::thread::id, std::string> texts_;
};

} // namespace gnomon
