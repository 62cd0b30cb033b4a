#pragma once
// A light's map that is warped by tables: what rectilinear and non-orthogonal warps share. Tables are made on the GPU
// from where the view's receivers lie; casters are drawn by edge functions at each texel's source place, so that edges
// are where they belong however coarse triangles are; the look-up compares at the same place.
#include <cstdint>
#include <span>

#include "algorithms/shared/map_resolve.hpp"
#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"
#include "shaders/warped/warp.h"

namespace gnomon {

/// One kind of warp: names of its passes, and shaders that know how to read its tables.
struct TableMapInfo {
    const char *importance = "", *clear = "", *casters = "", *resolve = "";
    const char *importanceBuffer = "", *map = "";
    std::span<const std::uint32_t> importanceCode, vertexCode, fragmentCode, resolveCode;
    bool places = false; ///< Source places of texels are an image, at binding 6; else they are in the table.
};

/// What the tables of a task are made of: the passes that need it take it by pointer, it lives as long as the frame.
struct WarpTask {
    const LightFit* fit = nullptr;
    std::uint32_t resolution = 0;
    gpu::WarpConstants constants{};
};

/// The warp of a task, once its tables are made.
struct Warp {
    BufferId tables;
    ImageId places; ///< TableMapInfo::places.
};

class TableMap {
public:
    TableMap(const AlgorithmServices& services, const TableMapInfo& info);

    /// Projection and constants; those of the warp itself are the caller's to set.
    static WarpTask* fit(PassBuilder& passes, const ShadowTask& task, std::uint32_t resolution);

    /// Passes that count receivers in the map (shaders/warped/importance.comp); the buffer is `bytes` long.
    BufferId declareImportance(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp,
                               VkDeviceSize bytes) const;

    /// Draws the casters, and writes the task's layer of visibility.
    void declare(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp, const Warp& made) const;

private:
    TableMapInfo info_;
    PipelineId importance_[2]; ///< [has normals]
    PipelineId casters_;
    PipelineId resolve_[2]; ///< [has normals]
};

/// Why a warp cannot serve a light: its casters' meshes are pulled from buffers, which have a largest size.
const char* warpRefuses(const DeviceTable& vk, const ShadowTask& task);

} // namespace gnomon
