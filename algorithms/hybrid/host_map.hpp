#pragma once
// A light's depth map on the CPU, where host passes ask it for all pixels: a copy, kept as long as the map.
#include <cstdint>

#include "algorithms/hybrid/simd_kernels.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_cells.hpp"
#include "runtime/passes/pass_context.hpp"

namespace gnomon {

/// The setting that says where a map is asked. With 0 the device's part is a full-screen pass and a picture read back;
/// a CPU needs the map, which is kept where light and casters stand still, and takes less from a device that is the
/// CPU.
inline constexpr SettingSpec kClassifySetting = {
    "classify", "Who asks the map: 0 the device, 1 the CPU in a copy of it, 2 the CPU where it is the device.", 0, 2,
    2};

/// Whether the CPU asks. Without normals from the host it never does: those that shaders guess are not made there.
bool classifiesOnHost(double setting, const DeviceTable& vk, const ShadowTask& task);

/// How receivers are found in a map; its layers are to be set. @param cube six of them
simd::MapLookup mapLookupOf(const gpu::MapConstants& constants, bool cube);

/// Copies an image layer, or cells of it, of four-byte texels to a buffer.
struct LayerCopy {
    const char* name; ///< Of the pass.
    ImageId from;
    std::uint32_t layer = 0;
    BufferId to;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
    std::uint32_t side = 0;
    std::uint32_t variant = 0; ///< Of the pass.
    Cells cells = kAllCells;
    Scope scope = Scope::light; ///< Of the pass.
};
void declareLayerCopy(PassBuilder& passes, const LayerCopy& copy);

/// The layers of a map that receivers may lie in.
struct HostMapCopy {
    std::uint32_t layers = 0; ///< One or six.
    std::uint32_t needed = 0; ///< As LightMap::needed.
    BufferId depth[6];

    void uses(PassRef& host) const; ///< What a host pass reads.
    /// In that pass. @param constants of declareLightMap()
    simd::MapLookup onHost(const HostContext& context, const gpu::MapConstants& constants) const;
};

HostMapCopy declareHostMap(PassBuilder& passes, const LightMap& map, std::uint32_t resolution);
/// Bytes of the copies that are not there yet. They only save time: passes.hasRoomFor() says whether to make them, and
/// AlgorithmEntry::memoryPerLight does not count them.
VkDeviceSize missingHostMap(const PassBuilder& passes, const LightMap& map, std::uint32_t resolution);

} // namespace gnomon
