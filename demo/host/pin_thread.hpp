#pragma once
#include <cstdint>

namespace gnomon::demo {

/// Keeps the calling thread on the index-th processor, counted round, of those the program could use at the first call.
/// Threads that it starts later stay there, too. Does nothing but on Linux. Commands that measure keep their threads
/// apart with it, once the device has started its own: the kernel now and then leaves two of them on one processor for
/// 4 to 16 ms while another idles, which doubles the time of a frame (demo/README.md, compare).
void pinThread(uint32_t index);

} // namespace gnomon::demo
