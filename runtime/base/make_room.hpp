#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace gnomon {

/// Room for so many more, so that what follows cannot fail half-way through a change.
template <typename T>
void makeRoom(std::vector<T>& list, std::size_t count = 1)
{
    if (list.capacity() - list.size() < count) list.reserve(std::max(2 * list.capacity() + 16, list.size() + count));
}

} // namespace gnomon
