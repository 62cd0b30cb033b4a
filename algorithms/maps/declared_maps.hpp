#pragma once
// What a method of maps answers to gnGetLightMap().
#include <cstdint>
#include <unordered_map>

#include "runtime/algorithm.hpp"

namespace gnomon {

/// The maps of the lights of the current frame, for ShadowAlgorithm::lightMap. Lights come and go: those of frames long
/// past are forgotten.
class DeclaredMaps {
public:
    /// A frame sets one a view and light, far fewer than this; what was not among this many newest is forgotten.
    static constexpr std::uint64_t kRemembered = 16384;

    void set(std::uint32_t light, const ShadowAlgorithm::Map& map)
    {
        entries_[light] = {map, ++sets_};
        if (sets_ % kRemembered == 0)
            std::erase_if(entries_, [this](const auto& entry) { return entry.second.setAt + kRemembered <= sets_; });
    }
    /// False: none was set for the light.
    bool get(std::uint32_t light, ShadowAlgorithm::Map& map) const
    {
        const auto entry = entries_.find(light);
        if (entry == entries_.end()) return false;
        map = entry->second.map;
        return true;
    }
    std::size_t size() const noexcept { return entries_.size(); }

private:
    struct Entry {
        ShadowAlgorithm::Map map;
        std::uint64_t setAt = 0; ///< Counted in calls of set().
    };
    std::unordered_map<std::uint32_t, Entry> entries_; // by light id
    std::uint64_t sets_ = 0;
};

} // namespace gnomon
