#pragma once
// A light's maps that are warped by tables, one or a point light's six: what rectilinear and non-orthogonal warps
// share. Tables are made on the GPU from where the view's receivers lie; casters are drawn by edge functions at each
// texel's source place, so that edges are where they belong however coarse triangles are; the look-up compares at the
// same place.
#include <array>
#include <cstdint>
#include <span>

#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "runtime/algorithm.hpp"
#include "runtime/scene/light_fit.hpp"
#include "shaders/warped/warp.h"

namespace gnomon {

/// One kind of warp: names of its passes, and shaders that know how to read its tables.
struct TableMapInfo {
    const char *importance = "", *clear = "", *casters = "", *resolve = "";
    const char *importanceBuffer = "", *tables = "", *places = "", *map = "";
    std::span<const std::uint32_t> importanceCode, vertexCode, fragmentCode, resolveCode;
};

/// What the maps of a light show.
enum class WarpShape : std::uint8_t {
    plain, ///< One map of a directional or spot light.
    cube,  ///< Six faces around a point light.
    discs, ///< Two paraboloids.
};

/// Whether a point light has paraboloids.
inline constexpr SettingSpec kParaboloidsSetting = {
    "paraboloids", "Maps of a point light. 1: two paraboloids; 0: the six faces of a cube.", 0, 1, 0};

struct TableSettings {
    std::uint32_t resolution;
    double paraboloids; ///< kParaboloidsSetting
    double blur;        ///< gpu::WarpConstants
    double even, power;
};

/// Maps that a light has by that setting.
std::uint32_t warpMaps(GnLightType type, double paraboloids);

/// The warp of a task: the passes that need it take it by pointer, it lives as long as the frame.
struct WarpTask {
    WarpShape shape = WarpShape::plain;
    std::uint32_t maps = 1, resolution = 0;
    std::span<const LightFit> fits; ///< Of each map; none of paraboloids.
    gpu::WarpConstants constants{};
    std::array<std::span<const Plane>, gpu::WARP_MAPS> volumes{};         ///< Around all that each map shows.
    std::array<std::span<const Caster* const>, gpu::WARP_MAPS> casters{}; ///< In it.
    ImageId map;
    ImageId places; ///< Of texels, copied from the tables: images are read faster by some.
    BufferId tables;

    bool drawn(std::uint32_t layer) const { return (constants.maps >> layer & 1) != 0; }
};

/// What the tables of a map are.
struct WarpTables {
    std::uint32_t floats;    ///< Of each map, even.
    std::uint32_t places;    ///< Before the places of texels.
    std::uint32_t functions; ///< Along rows, and along columns.

    VkDeviceSize bytes() const { return sizeof(float) * VkDeviceSize{floats}; }
    VkDeviceSize placesBytes(std::uint32_t side) const
    {
        return 2 * storedImageSize({functions, side}, 2 * sizeof(float));
    }
};

/// What of a light's maps has to be made in a frame. Maps in which the tables' frame has no receiver are left empty in
/// it. They are drawn one frame later, where nothing has moved: from then on receivers that cast no shadow may come.
enum class WarpDue : std::uint8_t { nothing, unseen, all };

class TableMap {
public:
    TableMap(const AlgorithmServices& services, const TableMapInfo& info);

    /// Projection and constants.
    static WarpTask* fit(PassBuilder& passes, const ShadowTask& task, const TableSettings& settings);

    /// What has to be made: nothing while view, light, casters and the warp's constants stand still. What the view's
    /// receivers do meanwhile is no matter of right and wrong, but of where texels are dense.
    WarpDue due(PassBuilder& passes, const ShadowTask& task, WarpTask& warp, const WarpTables& tables) const;

    /// Passes that count receivers in the maps (shaders/warped/importance.comp); the buffer has `bytes` for each.
    BufferId declareImportance(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp,
                               VkDeviceSize bytes) const;
    /// Draws the casters, once the tables are made: into maps that receivers were counted in, or into the others.
    void declareCasters(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp, const WarpTables& tables,
                        WarpDue due) const;
    /// Writes the task's layer of visibility. @param contact kContactSetting
    void declareLookup(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp, double contact) const;

private:
    TableMapInfo info_;
    PipelineId importance_[2][3]; ///< [has normals][shape]
    PipelineId casters_[2][2];    ///< [discs][open]
    PipelineId resolve_[2][3];    ///< [has normals][shape]
    ContactShadows contact_;
};

/// Why a warp cannot serve a light: its casters' meshes are pulled from buffers, which have a largest size.
const char* warpRefuses(const DeviceTable& vk, const ShadowTask& task);

} // namespace gnomon
