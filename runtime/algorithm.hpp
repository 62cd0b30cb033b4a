#pragma once
// What a shadow algorithm is to the runtime: an entry with traits and settings, and one function, declare().
#include <memory>
#include <span>
#include <type_traits>

#include "runtime/passes/pass_builder.hpp"
#include "runtime/passes/pass_context.hpp"
#include "shaders/shared/shadow_sample.h"

namespace gnomon {

/// One light in one view by one method: what declare() turns into passes.
struct ShadowTask {
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    const LightCasters* casters = nullptr;
    std::span<const double> settings;  ///< In the order of AlgorithmEntry::settings; sides of maps as they are to be.
    std::uint32_t layer = 0;           ///< The light's layer in `visibility`.
    ImageId visibility;                ///< R8_UNORM array of the view. Every pixel of view->area must be written.
    ImageId depth;                     ///< 32-bit floats, the host's or a copy; sampled and copied only.
    ImageId normals;                   ///< Geometric normals, 16-bit or 32-bit floats; null id if there are none.
    ImageId motion;                    ///< Motion vectors, CameraView::motionScale; null id if there are none.
    const TracedScene* rays = nullptr; ///< Where the device traces: holds all of `casters`. Null in refuses().
    bool recorded = false;             ///< gnCmdRenderShadows: no host passes.
};

/// A knob: range and default are shown, checked and documented from here.
struct SettingSpec {
    const char* name;
    const char* description; ///< With unit.
    double minimum, maximum, standard;
    /// The side of maps that may follow screen coverage (select/map_side.hpp): 0 means that, and is the default.
    /// `standard` is then the side where plain maps have kUnmeasuredSide.
    bool byCoverage = false;
};

/// What an algorithm may hold on to from creation on.
struct AlgorithmServices {
    const DeviceTable* vk = nullptr;
    PipelineLibrary* pipelines = nullptr;
};

class ShadowAlgorithm {
public:
    virtual ~ShadowAlgorithm() = default;

    /// Declares the passes that write task.visibility's layer. Called once per task and frame, on the frame's thread.
    virtual void declare(PassBuilder& passes, const ShadowTask& task) = 0;

    /// Why this method cannot serve this task ("cone wider than 170 degrees"), or null. Static storage.
    virtual const char* refuses(const ShadowTask&) const { return nullptr; }

    /// The map of a light.
    struct Map {
        ImageId image;
        glm::mat4 clipFromWorld[6];
        std::uint32_t validLayers = 1; ///< Bit i: layer i holds the casters of the frame.
        gpu::ShadowSample sample{};    ///< For hosts' shaders, but eye and ahead; of kind SAMPLE_NOTHING: not for them.
    };
    /// Of the task declared last, as far as that needs it; null: the method keeps none.
    virtual const Map* lightMap() const { return nullptr; }

    /// Declares the map alone, without what answers pixels. @return it, as lightMap(); null: the method has none that
    /// hosts' shaders could look up.
    virtual const Map* declareMap(PassBuilder&, const ShadowTask&) { return nullptr; }
};

/// One line of the registry.
struct AlgorithmEntry {
    const char* name;
    const char* source; ///< Thesis section or paper.
    GnTraits traits;
    std::uint32_t roundTrips = 0; ///< GPU-CPU-GPU; 0: may be recorded. See memoryWithDeviceRays.
    std::uint32_t maxRounds = 0;  ///< Levels that declareLater may add.
    std::span<const SettingSpec> settings;
    /// Device bytes that a light of the kind needs in a view of this extent.
    VkDeviceSize (*memoryPerLight)(std::span<const double> settings, VkExtent2D extent, GnLightType type) = nullptr;
    /// Null, or why the device cannot run it ("needs depthClamp"). Static storage.
    const char* (*missing)(const DeviceTable& vk) = nullptr;
    std::unique_ptr<ShadowAlgorithm> (*create)(const AlgorithmServices& services) = nullptr;

    // Algorithms registered through the C plug-in interface (runtime/api/plugin.hpp) instead of the three functions
    // above.
    const class PluginAlgorithm* plugin = nullptr;
    std::unique_ptr<ShadowAlgorithm> (*createPlugin)(const PluginAlgorithm& self) = nullptr;
    VkDeviceSize bytesPerPixel = 0;

    /// Wrong light-facing pixels in percent, worst shipped scene, 1280x720, map side 1024, as `gnomon bench` prints it:
    /// the quality the plan counts with until a knowledge base says better.
    float typicalWrongPercent = 0.0f;

    /// Null, or whether these settings give up what GN_TRAIT_EXACT_BIT promises.
    bool (*approximates)(std::span<const double> settings) = nullptr;

    /// Null, or whether with these settings penumbrae follow the source, as GN_TRAIT_SOFT_PENUMBRA_BIT promises of all.
    bool (*softens)(std::span<const double> settings) = nullptr;

    /// Null, or what a setting counts as beside the others, where that is not its value: what cannot be used as it was
    /// asked for is clamped, and MethodTable::set() says so. \param index of the setting.
    double (*countsAs)(std::span<const double> settings, std::size_t index) = nullptr;

    /// Its map is fitted to the view: texels near the eye are finer than those of a plain map of its side, so no bound
    /// in plain texels says how long it may be kept while casters move.
    bool followsView = false;

    /// Null, or memoryPerLight where the method asks rays of the device (DeviceTable::prefersRays): without round
    /// trips, and with GN_TRAIT_DEVICE_RAYS_BIT in place of GN_TRAIT_RAYS_BIT. Lights with casters that ask the host
    /// (LightCasters::opacities) are still traced on the CPU: ShadowTask::rays says who traces.
    VkDeviceSize (*memoryWithDeviceRays)(std::span<const double> settings, VkExtent2D extent,
                                         GnLightType type) = nullptr;

    /// The entry on such a device.
    AlgorithmEntry withDeviceRays() const
    {
        AlgorithmEntry entry = *this;
        entry.traits = (traits & ~GnTraits{GN_TRAIT_RAYS_BIT}) | GN_TRAIT_DEVICE_RAYS_BIT;
        entry.roundTrips = 0;
        entry.memoryPerLight = memoryWithDeviceRays;
        return entry;
    }

    VkDeviceSize memoryFor(std::span<const double> values, VkExtent2D extent, GnLightType type) const
    {
        if (memoryPerLight) return memoryPerLight(values, extent, type);
        return bytesPerPixel * extent.width * extent.height;
    }
};

/// AlgorithmEntry::create of a class that is made of the services, or of nothing.
template <typename Algorithm>
std::unique_ptr<ShadowAlgorithm> makeAlgorithm(const AlgorithmServices& services)
{
    if constexpr (std::is_constructible_v<Algorithm, const AlgorithmServices&>)
        return std::make_unique<Algorithm>(services);
    else
        return std::make_unique<Algorithm>();
}

} // namespace gnomon
