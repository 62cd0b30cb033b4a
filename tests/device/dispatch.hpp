#pragma once
// Compute shaders on the test's device, one after the other: for tests of what shaders compute.
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "device/fixture.hpp"

namespace gnomon::test {

/// An image for a shader to fetch from: texels row by row.
struct Sampled {
    uint32_t binding;
    VkFormat format;
    VkExtent2D extent;
    const demo::Buffer* texels;
};

struct Dispatch {
    std::span<const uint32_t> code;
    std::vector<std::pair<uint32_t, const demo::Buffer*>> buffers; ///< Binding 0: constants.
    uint32_t x = 1, y = 1, z = 1;
    std::vector<Sampled> images = {};
};

/// One after the other; waits for the last. Buffers are at the bindings 0, 1, 2 and 5 where no dispatch has an image.
void run(const std::vector<Dispatch>& dispatches);

template <typename T>
demo::Buffer bufferOf(const std::vector<T>& values)
{
    demo::Buffer buffer = demo::makeBuffer(device(), values.size() * sizeof(T),
                                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
    std::ranges::copy(values, buffer.as<T>().begin());
    return buffer;
}

} // namespace gnomon::test
