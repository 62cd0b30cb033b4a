#pragma once
// What else the processors did: how a frame that took too long is told from one that was held up.
#include <cstdint>
#include <unordered_map>

namespace gnomon::demo {

/// Processor time that other programs, the kernel's own threads and the hypervisor took, by Linux's own count
/// (/proc/PID/task/TID/schedstat, "steal" of /proc/stat). Elsewhere, and where /proc hides them, nothing is seen.
/// One thread at a time; a look takes a millisecond or two.
class OtherWork {
public:
    /// Milliseconds since the last look, of all processors together; 0 at the first. Threads that ended in between
    /// are missed; stolen time comes in steps of the kernel's clock tick (10 ms, as a rule).
    double look();

private:
    std::unordered_map<int, uint64_t> ran_; ///< Nanoseconds by thread.
    double stolenMs_ = 0.0;
    bool looked_ = false;
};

} // namespace gnomon::demo
