#pragma once
// The two layers of a conservative map around a light of any kind, and the pass that asks them: what conservative_map
// and conservative_map_adjacency share. Kept for as long as light and casters stand still.
#include <cstdint>
#include <optional>
#include <span>

#include "algorithms/hybrid/conservative_casters.hpp"
#include "algorithms/hybrid/undecided_on_device.hpp"
#include "algorithms/shared/kept_map.hpp"
#include "algorithms/shared/map_resolve.hpp"

namespace gnomon {

/// The projections of a light's map: one, or six around a point light.
struct ConservativeMapView {
    std::span<const LightFit> fits;                      ///< They live as long as the frame.
    std::span<const ConservativeProjection> projections; ///< Of each fit.
    std::uint32_t resolution = 0;
    std::uint32_t needed = 0;                         ///< Bit i: a receiver of task.view can lie in layer i.
    ThesisOffset offset = ThesisOffset::halfDiagonal; ///< Of the thesis's layers; the others need none.
};
ConservativeMapView conservativeView(const ShadowTask& task, std::uint32_t resolution, ThesisOffset offset,
                                     FrameArena& arena);

/// KeptMapInfo's, of its layers.
std::uint32_t formOf(const ConservativeMapView& view);

/// What goes into one of its layers. @param salt whatever else its content depends on.
LayerContent conservativeContent(const ShadowTask& task, const ConservativeMapView& view, std::uint32_t layer,
                                 std::uint64_t salt, FrameArena& arena);

/// Its two depth images, a layer per fit.
class ConservativeMaps {
public:
    explicit ConservativeMaps(const AlgorithmServices& services);

    /// Declares what is missing of the over-estimated layer.
    ImageId declareNearest(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                           bool thesis) const;
    /// And of the under-estimated one, of triangles by themselves.
    ImageId declareCovered(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                           bool thesis) const;
    PipelineId coveredPipeline(bool thesis) const { return layers_[thesis][1]; }

private:
    ImageId declareLayer(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view, bool thesis,
                         bool covered) const;
    PipelineId layers_[2][2]; ///< [thesis][covered]
};

/// What both methods are but for their under-estimated layer.
class ConservativeMethod : public ShadowAlgorithm {
public:
    enum Setting : std::size_t { kResolution, kMode, kReasons, kLambda };
    static constexpr SettingSpec kSettings[] = {
        {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024, true},
        {"mode", "0: guaranteed; 1: as in the thesis.", 0, 1, 0},
        kReasonsSetting,
        kLambdaSetting,
    };
    static constexpr std::uint32_t kTraits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT |
                                             GN_TRAIT_HARD_BIT | GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT |
                                             GN_TRAIT_RAYS_BIT;
    static bool approximates(std::span<const double> settings) { return settings[kMode] != 0.0; }
    /// Of both layers and the picture.
    static VkDeviceSize memory(std::span<const double> settings, VkExtent2D extent, GnLightType type);
    static VkDeviceSize memoryWithDeviceRays(std::span<const double> settings, VkExtent2D extent, GnLightType type);

    ConservativeMethod(const AlgorithmServices& services, const char* classify, const UndecidedNames& names);
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override;

protected:
    virtual ImageId declareCovered(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                                   const ConservativeMaps& maps, bool thesis) const = 0;

private:
    const DeviceTable& vk_;
    ConservativeMaps maps_;
    MapResolve classify_;
    UndecidedNames names_;
    std::optional<UndecidedOnDevice> onDevice_; ///< Where ShadowTask::rays may be given.
};

} // namespace gnomon
