#pragma once
// The six depth maps around a point light: one layer per face in the order of fitCubeFace (+X -X +Y -Y +Z -Z), shared
// by cube_map and pcf_hybrid.
#include <cstdint>

#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/frusta.hpp"

namespace gnomon {

/// The faces as declared in this frame. Depth and casters as in DepthMap.
struct CubeMap {
    ImageId image;                   ///< kMapFormat, six layers, resolution x resolution each.
    const LightFit* faces = nullptr; ///< Six; they live as long as the frame.
    std::uint32_t resolution = 0;
    std::uint32_t needed = 0; ///< Bit f: a receiver of task.view can lie in face f. Other layers may be undefined.
    const std::uint64_t* stamps = nullptr; ///< Six, of the content of the faces needed.
    const KeptParts* parts = nullptr;      ///< Six, DepthMap's.
};

/// The projections of the six faces; memory from the arena.
/// @param borderTexels by which faces reach past their 90 degrees, at most a quarter of the side; the standard is
///                     enough for 8 x 8 texels around any receiver of the face
std::span<LightFit> fitCubeFaces(Clamped clamped, const ShadowTask& task, std::uint32_t resolution, FrameArena& arena,
                                 std::uint32_t borderTexels = kMapBorderTexels);
/// Bit f: a receiver in the task's view can lie in face f.
std::uint32_t neededCubeFaces(const ShadowTask& task);

/// Declares the faces that a receiver in the task's view can need and whose casters or light changed. Several views
/// share the map: a face is drawn if any of them needs it. With MapCulling::shadows each has its own. The light is a
/// point light.
CubeMap declareCubeMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                       std::uint32_t resolution, std::uint32_t borderTexels = kMapBorderTexels,
                       MapCulling culling = MapCulling::parts);

} // namespace gnomon
