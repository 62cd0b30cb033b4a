#pragma once
// A light's maps that are warped by tables, one or a point light's six: what rectilinear and non-orthogonal warps
// share. Tables are made on the GPU from where the view's receivers lie; casters are drawn by edge functions at each
// texel's source place, so that edges are where they belong however coarse triangles are; the look-up compares at the
// same place.
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
    std::span<const LightFit> fits; ///< One, or those of a point light's six faces.
    std::uint32_t resolution = 0;
    gpu::WarpConstants constants{};

    std::uint32_t maps() const { return static_cast<std::uint32_t>(fits.size()); }
    bool drawn(std::uint32_t map) const { return (constants.maps >> map & 1) != 0; }
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

    /// Passes that count receivers in the maps (shaders/warped/importance.comp); the buffer has `bytes` for each.
    BufferId declareImportance(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp,
                               VkDeviceSize bytes) const;

    /// Draws the casters, and writes the task's layer of visibility.
    void declare(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp, const Warp& made) const;

private:
    TableMapInfo info_;
    PipelineId importance_[2][2]; ///< [has normals][cube]
    PipelineId casters_;
    PipelineId resolve_[2][2]; ///< [has normals][cube]
};

/// Why a warp cannot serve a light: its casters' meshes are pulled from buffers, which have a largest size.
const char* warpRefuses(const DeviceTable& vk, const ShadowTask& task);

} // namespace gnomon
