#pragma once
// From the pixels that a map could not answer to what their rays say: the second half of every map-and-rays hybrid.
#include <cstdint>

#include "algorithms/hybrid/point_marks.hpp"
#include "runtime/algorithm.hpp"
#include "shaders/hybrid/ray_list.h"

namespace gnomon {

/// The setting that turns visibility into reason codes (REASON_*, shaders/hybrid/ray_list.h), for overlays.
inline constexpr SettingSpec kReasonsSetting = {
    "reasons", "1: the byte in visibility is why a pixel is lit or dark: a REASON of shaders/hybrid/ray_list.h.", 0, 1,
    0};

/// What passes and buffers are called, "algorithm.what".
struct RayListNames {
    const char *list, *clear, *trace, *umbra;
};

/// The list of one task, as declared in this frame.
struct RayList {
    BufferId pixels;         ///< Count, then packed pixels: what shaders/hybrid/ray_list.glsl writes at binding 5.
    BufferId umbra;          ///< Pixels whose ray was blocked.
    BufferId depth, normals; ///< Of the view, read back; normals may be null.
    std::uint32_t capacity = 0;
    bool reasons = false;
};

class RayLists {
public:
    RayLists(const AlgorithmServices& services, const RayListNames& names);

    /// The binding that the deciding shader writes.
    static BindingInfo binding() { return {.binding = 5, .kind = BindingKind::storageBuffer}; }

    /// Declares the list, empty. Whoever fills it calls pass.updates(list.pixels) and binds it.
    RayList open(PassBuilder& passes, const ShadowTask& task, bool reasons) const;
    /// Declares the rays, and the points that darken what they found blocked.
    void close(PassBuilder& passes, const ShadowTask& task, const RayList& list) const;

    /// Device bytes for a view: both lists.
    static VkDeviceSize memory(VkExtent2D extent)
    {
        return 2 * sizeof(std::uint32_t) * VkDeviceSize(extent.width) * extent.height;
    }

private:
    RayListNames names_;
    PointMarks points_;
};

} // namespace gnomon
