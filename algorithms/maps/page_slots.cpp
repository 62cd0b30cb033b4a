#include "algorithms/maps/page_slots.hpp"

#include <algorithm>

namespace gnomon {

std::span<const PlacedPage> PageSlots::place(std::span<const PageKey> pages, std::uint64_t frame)
{
    known_.clear();
    for (std::uint32_t i = 0; i < slots_.size(); ++i)
        if (slots_[i].key != 0) known_.emplace_back(slots_[i].key, i);
    std::sort(known_.begin(), known_.end());

    constexpr std::uint32_t kNone = UINT32_MAX;
    placed_.clear();
    auto next = known_.begin();
    for (const PageKey key : pages) {
        while (next != known_.end() && next->first < key)
            ++next;
        const bool has = next != known_.end() && next->first == key;
        placed_.push_back({key, has ? next->second : kNone});
        if (has) slots_[next->second].asked = frame;
    }

    spare_.clear();
    for (std::uint32_t i = 0; i < slots_.size(); ++i)
        if (slots_[i].key == 0 || slots_[i].asked != frame) spare_.emplace_back(slots_[i].asked, i);
    std::sort(spare_.begin(), spare_.end());
    auto spare = spare_.begin();
    for (PlacedPage& page : placed_) {
        if (page.slot != kNone) continue;
        page.slot = (spare++)->second;
        page.evicts = slots_[page.slot].key != 0;
        slots_[page.slot] = {page.key, frame};
    }
    return placed_;
}

} // namespace gnomon
