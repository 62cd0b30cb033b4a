#pragma once
// Which layer of a pool each page lies in.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "algorithms/maps/page_grid.hpp"

namespace gnomon {

/// A page that is asked, and its layer.
struct PlacedPage {
    PageKey key = 0;
    std::uint32_t slot = 0;
    bool evicts = false; ///< Another page had the layer before.
};

/// Remembers where pages were put last. That is a guess: what a layer really holds is what its stamp says, so a frame
/// that was dropped costs pages drawn again, and never shows wrong ones.
class PageSlots {
public:
    explicit PageSlots(std::uint32_t capacity) : slots_(capacity) {}

    std::size_t capacity() const { return slots_.size(); }

    /// Pages that have a layer keep it. Others get one that is free, or that of the page that has been asked least
    /// recently; the first of these where there are several.
    /// @param pages  ascending, at most `capacity`
    /// @param frame  above 0, not below that of the call before
    /// @return       in the order of `pages`, until the next call
    std::span<const PlacedPage> place(std::span<const PageKey> pages, std::uint64_t frame);

private:
    struct Slot {
        PageKey key = 0;         ///< 0: free. No page is 0.
        std::uint64_t asked = 0; ///< Frame.
    };
    std::vector<Slot> slots_;
    std::vector<std::pair<PageKey, std::uint32_t>> known_;       ///< Pages that have a slot, ascending.
    std::vector<std::pair<std::uint64_t, std::uint32_t>> spare_; ///< Slots by the frame in which they were asked last.
    std::vector<PlacedPage> placed_;
};

} // namespace gnomon
