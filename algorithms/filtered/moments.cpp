// Shadow maps whose depths are filtered once, before they are compared: VSM, ESM, EVSM and MSM.
// Source:    W. Donnelly and A. Lauritzen, "Variance shadow maps", I3D 2006; T. Annen et al., "Exponential shadow
// maps",
//            GI 2008; A. Lauritzen, thesis, Waterloo 2008 (EVSM); C. Peters and R. Klein, "Moment shadow mapping", I3D
//            2015.
// Reads:     casters, host-drawn ones included; receiver depth and normals.     Writes: visibility.
// Strong at: wide even edges at a price that does not depend on their width, and next to none while nothing moves.
// Weak at:   light bleeds where casters overlap along a ray, and along contacts.
#include "algorithms/entries.hpp"

#include <algorithm>

#include "algorithms/filtered/moment_maps.hpp"
#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/filtered_moments_cube_frag.h"
#include "shaders/filtered_moments_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kKind, kFilter, kBoxes, kBits, kExponent, kBleeding, kFit, kContact, kMips };

constexpr SettingSpec kSettings[] = {
    // 2048: the buffers of the filter, 16 bytes a texel, have to fit into a storage buffer, which may have 128 MiB.
    {"resolution", "Texels per side of the map; of a point light, of each of six.", 64, 2048, 1024, true},
    {"kind", "0 VSM, 1 ESM, 2 EVSM with two moments, 3 EVSM with four, 4 MSM.", 0, gpu::MOMENT_KINDS - 1,
     gpu::MOMENTS_EVSM4},
    {"filter", "Texels per side of what depths are averaged over, odd.", 1, gpu::MAX_MOMENT_FILTER, 5},
    {"boxes", "Boxes applied one after another to fill the filter: 1 is a box, 3 nearly a Gaussian.", 1, 3, 1},
    {"bits", "Of a channel: 32, or 16 for half the memory and less precision; less than 24 counts as 16.", 16, 32, 32},
    {"exponent", "Of ESM and EVSM, for depths from -1 to 1; clamped to what 16 bits hold, 5.54, of ESM 11.08.", 1, 42,
     40},
    {"bleeding", "Share of light below which a pixel counts as umbra.", 0, 0.9, 0.1},
    kFitSetting,
    kContactSetting,
    {"mips", "1: pixels wider than the filter look at smaller maps, which take half more memory.", 0, 1, 0},
};

MomentFilter filterOf(std::span<const double> settings)
{
    MomentFilter filter;
    filter.kind = static_cast<std::uint32_t>(settings[kKind]);
    filter.bits = settings[kBits] < 24.0 ? 16 : 32;
    filter.boxes = static_cast<std::uint32_t>(settings[kBoxes]);
    filter.box = ((static_cast<std::uint32_t>(settings[kFilter]) - 1) / filter.boxes + 1) | 1u;
    filter.mips = settings[kMips] != 0.0;
    filter.exponent = gpu::momentExponent(filter.kind, filter.bits, static_cast<float>(settings[kExponent]));
    return filter;
}

/// The exponent, where the kind has one, is clamped to what the format holds.
double countsAs(std::span<const double> settings, std::size_t index)
{
    const MomentFilter filter = filterOf(settings);
    if (index != kExponent || filter.kind == gpu::MOMENTS_VSM || filter.kind == gpu::MOMENTS_MSM)
        return settings[index];
    return std::min(settings[index], double{gpu::mostMomentExponent(filter.kind, filter.bits)});
}

/// Adds what the shader knows of the filter and of what rounding makes of moments.
void addMoments(gpu::MomentsConstants& constants, const MomentFilter& filter, float bleeding)
{
    constants.kind = filter.kind;
    constants.bits = filter.bits;
    constants.exponent = filter.exponent;
    constants.bleeding = bleeding;
    // 2^-14 is twice what fractions of 16 bits are apart, and above a half float's rounding of e^(2 c y) once it is
    // divided by the square of 2 c.
    constants.deviation = filter.bits == 16 ? 0x1p-7f : gpu::MOMENT_DEVIATION;
    constants.momentBias = filter.bits == 16 ? 6e-5f : gpu::MOMENT_BIAS;
    constants.planeTexels = filter.deviation();
    constants.levels = filter.mips ? static_cast<float>(gpu::MOMENT_LEVELS) : 0.0f;
}

/// The maps, and the smaller ones.
constexpr BindingInfo kMomentMaps[] = {momentsAt(5), momentsAt(6)};

class Moments final : public ShadowAlgorithm {
public:
    explicit Moments(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)), maps_(services),
          resolve_(services, {.name = "moments.resolve",
                              .fragment = k_filtered_moments_frag,
                              .cube = k_filtered_moments_cube_frag,
                              .more = kMomentMaps}),
          contact_(services)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const MomentFilter filter = filterOf(task.settings);
        gpu::MomentsConstants constants{};
        constants.base = mapConstants(task, resolution, 1);
        const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base,
                                             std::max(filter.border(), kMapBorderTexels), mapFit(task.settings[kFit]));
        constants.linear = linearDepthOf(map.fits.front(), *task.light); // all layers have the same ends
        addMoments(constants, filter, static_cast<float>(task.settings[kBleeding]));
        const MomentImages moments = maps_.declare(passes, map, task, resolution, filter);
        map_ = handedOut(map.image, map.fits, map.needed, constants.base);
        resolve_.declare(
            passes, task, map.image, constants,
            {.filtered = filter.kind == gpu::MOMENTS_MSM,
             .more = {{{.image = moments.map}, {.image = moments.levels ? moments.levels : moments.map}}}});
        contact_.declare(passes, task, task.settings[kContact]);
    }

    const Map* lightMap() const override { return &map_; }

private:
    DepthMapPipelines casters_;
    MomentMaps maps_;
    MapResolve resolve_; ///< Filtered: MSM.
    ContactShadows contact_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kMoments{
    .name = "moments",
    .source = "Donnelly and Lauritzen 2006; Annen 2008; Lauritzen 2008; Peters and Klein 2015",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType type) {
            const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
            return depthMapMemory(resolution, mapLayers(type)) +
                   MomentMaps::memory(filterOf(settings), resolution, mapLayers(type));
        },
    .create = makeAlgorithm<Moments>,
    .typicalWrongPercent = 1.3f, // moments.md
    .countsAs = countsAs,
};

} // namespace gnomon
