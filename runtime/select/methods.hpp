#pragma once
// The methods of a context: algorithms with settings, and whether they can serve.
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/algorithm.hpp"
#include "runtime/base/messages.hpp"
#include "runtime/base/method_set.hpp"
#include "runtime/registry.hpp"
#include "runtime/select/map_side.hpp"
#include "runtime/vk/pipeline_store.hpp"

namespace gnomon {

/// On the CPU: as such, or what is made of them there. What reads them, or traces, on the device alone does not.
inline bool readsTriangles(GnTraits traits)
{
    constexpr GnTraits onDevice = GN_TRAIT_DEVICE_RAYS_BIT | GN_TRAIT_GPU_POSITIONS_BIT;
    return (traits & (GN_TRAIT_TOPOLOGY_BIT | GN_TRAIT_RAYS_BIT)) != 0 ||
           (traits & (GN_TRAIT_CPU_GEOMETRY_BIT | onDevice)) == GN_TRAIT_CPU_GEOMETRY_BIT;
}

struct Method {
    std::string name;
    const AlgorithmEntry* entry = nullptr;
    const AlgorithmEntry* onCpu = nullptr; ///< What traces on the CPU where `entry` does so on the device; else null.
    std::unique_ptr<ShadowAlgorithm> algorithm;
    std::uint32_t index = 0;
    std::vector<double> settings; ///< As set: a map's side may be 0, by screen coverage.
    std::vector<bool> asked;      ///< By setting: set() has set it.
    std::uint64_t setAt = 0;      ///< The newest frame that ran with other ones.
    std::vector<GnSettingInfo> settingInfos;
    const char* unavailable = nullptr; ///< The device cannot run it.
    bool ready = false;                ///< Its pipelines have been executed once.
    JobSystem::Job warmUp;             ///< Makes the pipelines in the background.
    bool warmUpStarted = false;
    bool saidNotRecordable = false;     ///< warnNotRecordable()
    class MethodTable* table = nullptr; ///< For the background job.

    bool serves(GnLightType type) const
    {
        const GnTraits bit = type == GN_LIGHT_TYPE_DIRECTIONAL ? GN_TRAIT_DIRECTIONAL_BIT
                             : type == GN_LIGHT_TYPE_SPOT      ? GN_TRAIT_SPOT_BIT
                                                               : GN_TRAIT_POINT_BIT;
        return (entry->traits & bit) != 0;
    }
    bool has(GnTraitBits trait) const { return (entry->traits & trait) != 0; }
    /// `entry`, or what traces on the CPU, where the casters ask the host.
    const AlgorithmEntry& entryFor(const LightCasters& casters) const
    {
        return onCpu && casters.opacities > 0 ? *onCpu : *entry;
    }
    bool readsTriangles() const { return gnomon::readsTriangles(entry->traits); }
    /// What the method is run with for a light whose plain maps have so many texels a side, one of kMapSides.
    std::span<const double> settingsAt(std::uint32_t plainSide) const
    {
        return followsCoverage() ? std::span<const double>(atSides_[rungOf(plainSide)]) : settings;
    }
    /// Side of its maps for such a light, texels; 0: it has none.
    double mapSide(std::uint32_t plainSide) const { return sideSetting_ ? settingsAt(plainSide)[*sideSetting_] : 0.0; }
    /// Whether its error grows with the width of a plain map's texels.
    bool coarsens() const { return sideSetting_ && !isExact() && !entry->followsView; }
    bool followsCoverage() const { return sideSetting_ && settings[*sideSetting_] == 0.0; }
    /// Whether the light's pose and the plain map that it is looked up in are all that it goes by.
    bool looksUpMaps() const
    {
        return followsCoverage() && !readsTriangles() && !has(GN_TRAIT_DEVICE_RAYS_BIT) && !entry->followsView;
    }
    /// To be called when `settings` have changed.
    void noteSettings();
    /// What the setting is used as.
    double counted(std::size_t setting) const
    {
        return entry->countsAs ? entry->countsAs(settings, setting) : settings[setting];
    }
    bool isExact() const { return has(GN_TRAIT_EXACT_BIT) && !(entry->approximates && entry->approximates(settings)); }
    bool isSoft() const { return has(GN_TRAIT_SOFT_PENUMBRA_BIT) || (entry->softens && entry->softens(settings)); }

private:
    std::optional<std::size_t> sideSetting_; ///< In `settings`: of the maps' side.
    std::array<std::vector<double>, kMapSides.size()>
        atSides_; ///< `settings` with each side, where it follows coverage.
};

/// What a frame may ask for.
struct MethodDemand {
    MethodSet pinned;   ///< Those that a light is pinned to.
    bool others = true; ///< There is no light yet, or one that is not pinned, or not served by what it is pinned to.
};

class MethodTable {
public:
    MethodTable(const DeviceTable& vk, PipelineStore& pipelines, JobSystem& jobs, const Messages& messages,
                bool background);
    ~MethodTable();

    Result<void> addBuiltins(const AlgorithmRegistry& registry);
    /// Whether add() would take the name.
    Result<void> admits(std::string_view name) const;
    Result<std::uint32_t> add(std::string_view name, const AlgorithmEntry& entry);
    /// An algorithm of the host's or a plug-in's, as a method of its name; outlives the table.
    Result<std::uint32_t> addEntry(const AlgorithmEntry& entry);
    Result<const AlgorithmEntry*> algorithm(std::string_view name) const;
    /// @param frame  the newest begun: it and those before ran with the old value
    Result<void> set(std::string_view method, std::string_view setting, double value, std::uint64_t frame);
    std::uint64_t setAt() const { return setAt_; } ///< The frame of the newest set(); 0: none.

    Method* find(std::string_view name) const;
    /// That no method has the name; where this build lacks it, what it needs.
    Error unknown(std::string_view name) const;
    Method& operator[](std::uint32_t index) { return *methods_[index]; }
    const Method& operator[](std::uint32_t index) const { return *methods_[index]; }
    std::uint32_t size() const { return static_cast<std::uint32_t>(methods_.size()); }

    /// Starts or continues background creation: fallbacks, then what lights are pinned to, then what others may ask
    /// for. Returns a method whose pipelines are created but not yet executed, or UINT32_MAX.
    std::uint32_t nextWarmup(const MethodDemand& demand);
    /// The methods that lights may be given by rules; empty: any. Nothing else becomes ready unasked.
    void offer(const MethodSet& methods) noexcept { offered_ = methods; }
    /// Creates all pipelines of a method now.
    void createNow(Method& method);
    /// Whether one of them could not be created. The method is unavailable then, and a message says why.
    bool failed(Method& method);
    void fail(Method& method, const std::string& why);
    /// Says once that the method, which a light is pinned to, cannot serve recorded frames.
    void warnNotRecordable(std::uint32_t method, std::uint64_t roundTrips);
    void finishBackground();
    bool anyReady() const;
    MethodSet fallbacks() const; ///< What serves while another is not ready.
    /// Grows when a method is added: rules are bound again.
    std::uint64_t revision() const { return revision_; }

private:
    /// Sets it, and says which of the values asked for count as others from now on.
    void change(Method& method, std::size_t setting, double value) const;

    enum class Step : std::uint8_t { done, waits, created };
    Step advance(Method& method); ///< By what one frame may do for it.

    const DeviceTable& vk_;
    PipelineStore& pipelines_;
    JobSystem& jobs_;
    const Messages& messages_;
    bool background_;
    MethodSet offered_;
    std::vector<std::unique_ptr<Method>> methods_;
    std::vector<const AlgorithmEntry*> entries_;
    std::deque<AlgorithmEntry> withDeviceRays_; ///< AlgorithmEntry::withDeviceRays() of those that have it.
    std::span<const AbsentAlgorithm> absent_;
    std::uint64_t setAt_ = 0;
    std::uint64_t revision_ = 1;
};

} // namespace gnomon
