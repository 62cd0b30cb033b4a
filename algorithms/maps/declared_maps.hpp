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
    static constexpr std::uint64_t kRemembered = 256; ///< Frames.

    /// `map.validLayers` adds to those of the frame's other views.
    void set(std::uint32_t light, const ShadowAlgorithm::Map& map, std::uint64_t frame)
    {
        if (frame >= newest_ + kRemembered) {
            std::erase_if(entries_, [&](const auto& entry) { return entry.second.frame + kRemembered < frame; });
            newest_ = frame;
        }
        Entry& entry = entries_[light];
        const std::uint32_t before = entry.frame == frame ? entry.map.validLayers : 0;
        entry = {map, frame};
        entry.map.validLayers |= before;
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
        std::uint64_t frame = 0; ///< From 1.
    };
    std::unordered_map<std::uint32_t, Entry> entries_; // by light id
    std::uint64_t newest_ = 0;                         // frame in which old ones were last looked for
};

} // namespace gnomon
