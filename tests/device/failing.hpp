#pragma once
// Things that fail when they are told to: a queue, memory of several kinds, the ray tracer, a pass.
#include "device/fixture.hpp"
#include "gnomon/algorithm.h"

namespace gnomon::test {

struct WatchedQueue {
    uint32_t failAt = UINT32_MAX; ///< Submits to go until one fails.
    VkResult failure = VK_ERROR_OUT_OF_HOST_MEMORY;
    bool locked = false;
    uint32_t submits = 0, unlocked = 0; ///< gnomon's; those without the lock.
};

/// What fails, of contexts made with watched() and, where it says so, of all.
struct Failing {
    bool grids = false; ///< No buffer is made that is nothing but a storage buffer: depth grids alone are.
    bool constants = false;
    bool pools = false; ///< Of descriptors.
    bool rays = false;  ///< Of all contexts: Embree says that it ran out of memory, and takes in no instance.
};

extern WatchedQueue queue;
extern Failing failing;

/// A host whose queue and memory are those above, which begin to work again.
HostOptions watched();

/// What a host shows that never failed.
std::vector<Image8> fresh(const Scene& scene, const char* method, VkExtent2D extent);

/// A method whose CPU pass can be made to throw.
struct Thrower {
    const GnPluginInterface* abi = nullptr;
    GnPassKind kind = GN_PASS_HOST;
    bool throws = false;
    /// All lights of the host are served by it from now on.
    void join(Host& host);
};

} // namespace gnomon::test
