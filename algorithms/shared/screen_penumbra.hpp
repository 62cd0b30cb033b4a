#pragma once
// Soft shadows that are hard ones, filtered on the screen as widely as the blockers in the light's map ask for.
#include <span>

#include "algorithms/shared/blocker_search.hpp"
#include "algorithms/shared/depth_bounds.hpp"
#include "algorithms/shared/screen_blur.hpp"

namespace gnomon {

/// What the methods differ in, beside declareHard().
struct ScreenPenumbraInfo {
    const char *seen, *rows, *columns;      ///< Passes and pipelines.
    std::span<const std::uint32_t> soft[2]; ///< screen_penumbra.glsl; [point light]
    glm::uvec4 look{0};                     ///< ScreenPenumbraConstants::hard.
};

class ScreenPenumbra : public ShadowAlgorithm {
public:
    ScreenPenumbra(const AlgorithmServices& services, const ScreenPenumbraInfo& info);

    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override;
    const Map* lightMap() const override { return &map_; }

    static VkDeviceSize memory(std::span<const double> settings, VkExtent2D extent, GnLightType type);

private:
    /// The shadow of a light without a radius.
    virtual Map declareHard(PassBuilder& passes, const ShadowTask& task) = 0;
    void declareSoft(PassBuilder& passes, const ShadowTask& task);

    const DeviceTable& vk_;
    glm::uvec4 hard_; ///< ScreenPenumbraConstants::hard
    DepthMapPipelines casters_;
    DepthBounds bounds_;
    ScreenBlur blur_;
    MapResolve seen_;
    Map map_;
};

inline constexpr SettingSpec kScreenPenumbraSettings[] = {
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 8192, 1024, true},
    {"steps", "Taps of the filter to each side of a pixel, in each of two passes.", 3, gpu::MAX_BLUR_STEPS, 15},
};

} // namespace gnomon
