#pragma once
// Shows gnomon the device as a discrete GPU whose memory the host does not see: three memory types in two heaps. What
// lies in the GPU's own has to be copied there, which a device with one memory type never does.
#include "device/hooks.hpp"

namespace gnomon::test {

constexpr uint32_t kDeviceType = 0, kUploadType = 1, kReadbackType = 2;

/// Of the contexts made with discrete(), all together. Tests clear it between frames; not while another thread draws.
struct DiscreteBooks {
    uint32_t mapped = 0;      ///< Attempts to map the GPU's own memory; refused.
    uint32_t copies = 0;      ///< Between buffers, recorded.
    uint32_t indexLists = 0;  ///< Index buffers bound,
    uint32_t hostIndexes = 0; ///< of which outside the GPU's own memory.
};
DiscreteBooks& discreteBooks();

/// Whether the device can be shown so: it has one memory type, which stands for all three. One that has memory of its
/// own shows what a discrete GPU shows without this.
bool canShowDiscrete();

/// Options of a host on such a device.
HostOptions discrete(HostOptions base = {});

/// The memory type that gnomon asked for: kDeviceType and so on.
uint32_t memoryTypeOf(VkBuffer buffer);

} // namespace gnomon::test
