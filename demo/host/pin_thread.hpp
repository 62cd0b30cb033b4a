#pragma once
#include <cstdint>

namespace gnomon::demo {

/// Keeps the calling thread on the index-th processor, counted round, of those the program could use at the first call.
/// Threads that it starts later stay there, too. Does nothing but on Linux.
void pinThread(uint32_t index);

} // namespace gnomon::demo
