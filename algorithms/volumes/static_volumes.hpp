#pragma once
// What is worked out once for a light and casters that both stand still: which volumes others conceal, an octree over
// the rest, and where some of their shadows must be. Plain CPU code without Vulkan.
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/shared/light_cache.hpp"
#include "algorithms/volumes/shadow_region.hpp"
#include "algorithms/volumes/volume_tree.hpp"

namespace gnomon {

struct StaticVolumes {
    std::vector<std::uint32_t> drawn; ///< Indices into all volumes, in their order; the rest is concealed.
    VolumeTree tree;                  ///< Over the bounds of `drawn`, by position there.

    struct Occluder {
        std::uint32_t position = 0; ///< In `drawn`.
        Aabb bounds;
        Umbra umbra;
    };
    std::vector<Occluder> occluders; ///< Those that hide most, at most gpu::UMBRAE.
    std::uint32_t concealed = 0;     ///< Volumes left out.
    std::uint64_t stamp = 0;         ///< Of light and casters; 0: not from a cache.
};

/// Works it out. @param conceal false: every volume is drawn.
void chooseVolumes(const LightView& light, std::span<const VolumeSource> volumes, bool conceal, StaticVolumes& out);

/// Keeps a StaticVolumes per light until the light, its static casters or their topologies change; found again by ids
/// and revisions. One thread.
class StaticVolumesCache {
public:
    /// Valid until a find() for the same light and choice finds it outdated.
    const StaticVolumes& find(const LightView& light, std::span<const VolumeSource> volumes, bool conceal);

    std::uint64_t built() const { return built_; } ///< How often anything was worked out.

private:
    LightCache<StaticVolumes> kept_; ///< By `conceal`.
    std::uint64_t built_ = 0;
};

} // namespace gnomon
