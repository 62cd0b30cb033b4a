#pragma once
// The receivers of a host pass in blocks of sixteen.
#include "algorithms/hybrid/tile_blocks.hpp"
#include "algorithms/shared/host_visibility.hpp"

namespace gnomon {

/// receiversOf(), sixteen at a time.
inline BlockReader blocksOf(const CameraView& view, const LightView& light, const HostVisibility& buffers,
                            const HostContext& host)
{
    return BlockReader(widestKernels(), view, light, host.read<float>(buffers.depth),
                       buffers.normals ? host.read<std::byte>(buffers.normals) : std::span<const std::byte>());
}

} // namespace gnomon
