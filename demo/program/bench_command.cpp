#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

#include "demo/host/pin_thread.hpp"
#include "demo/io/csv.hpp"
#include "demo/io/number.hpp"
#include "demo/program/ambiguity.hpp"
#include "demo/program/bench_bare.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/progress.hpp"
#include "demo/program/setting_choices.hpp"
#include "demo/program/soft_error.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

const std::vector<std::string> kColumns =
    parseNames("scene,method,lights,width,height,map,triangles,gpu_ms_p50,cpu_ms_p50,wall_ms_min,wall_ms_p50,"
               "increment_ms_min,wrong_pct,rays,memory_mib,device,driver,false_lit_pct,false_shadow_pct,ambiguous_pct,"
               "mean_abs_error,penumbra_pct,penumbra_rmse,penumbra_mean_abs,penumbra_off_pct,outside_rmse,"
               "outside_mean_abs,outside_off_pct");

constexpr uint32_t kDefaultBareMap = 1024;

struct Row {
    std::string scene, method;
    size_t lights = 0;
    VkExtent2D size{};
    uint32_t map = 0; ///< 0: the method has none.
    uint64_t triangles = 0;
    PairTimes times;
    ErrorCount errors;
    double worstLightPercent = 0.0;
    std::string worstLight;
    bool hasErrors = false;
    SoftError soft; ///< Of the lights with a radius.
    uint64_t rays = 0;
    double memoryMib = 0.0;
    std::vector<PassTime> passes;
};

bool hasSetting(const GnMethodInfo& method, std::string_view name)
{
    return std::any_of(method.pSettings, method.pSettings + method.settingCount,
                       [&](const GnSettingInfo& setting) { return setting.pName == name; });
}

/// What makes a method finer: texels of a map's side, rows of a table. Null: nothing does.
const GnSettingInfo* sizeSetting(const GnMethodInfo& method)
{
    for (uint32_t i = 0; i < method.settingCount; ++i) {
        const std::string_view name = method.pSettings[i].pName;
        if (name == kResolutionSetting || name == kRowsSetting) return &method.pSettings[i];
    }
    return nullptr;
}

/// As the context has it now; its pointers live as long.
GnMethodInfo infoOf(const ShadowHost& shadows, const std::string& method)
{
    for (const GnMethodInfo& info : shadows.methods())
        if (method == info.pName) return info;
    throw HostError("no method '" + method + "'");
}

/// One scene with one number of lights at one size: the truth is made once for all rows.
class SceneBench {
public:
    SceneBench(Device& device, const Scene& scene, const BenchOptions& options,
               const std::vector<SettingChoice>& choices)
        : device_(device), scene_(scene), options_(options), choices_(choices)
    {
        size_ = options.size.empty() ? VkExtent2D{scene.width, scene.height} : valueOf(parseSize(options.size));
        // The error is judged in this frame, near the last measured one, where whatever moves has moved.
        truthTime_ = frameTime(scene, options.repeat);
    }

    Row base() const
    {
        Session session(device_, scene_, sessionOptions());
        Row row = rowFor(session, kNoneMethod, 0);
        row.times = timePairs(session, options_.repeat, false, &nothing_);
        row.times.withMs = row.times.withoutMs;
        return row;
    }

    /// \pre reasonAgainstBare() is null.
    Row bare(uint32_t map)
    {
        Scene one = scene_;
        one.lights.resize(1);
        Session session(device_, one, sessionOptions());
        BareShadowMap shadows(device_, one, session.geometry, session.renderer, map);
        Row row = rowFor(session, kBareMethod, map);
        row.times = timePairs(session, options_.repeat, false, &shadows);
        return row;
    }

    /// \param traits of the method; it serves one of the lights at least. \param map empty: as set, or its default.
    Row method(const std::string& name, GnTraits traits, std::optional<uint32_t> map)
    {
        const Scene served = onlyServed(scene_, traits);
        Session session(device_, served, sessionOptions());
        const GnMethodInfo info = infoOf(session.shadows, name);
        if (map) expect(session.shadows.set(name, sizeSetting(info)->pName, *map));
        for (const SettingChoice& choice : choices_)
            if (hasSetting(info, choice.name)) expect(session.shadows.set(name, choice.name, choice.value));
        expect(session.shadows.pinAll(name));
        settle(session, name, frameTime(served, 0), options_.recorded);
        const GnMethodInfo inForce = infoOf(session.shadows, name);
        const GnSettingInfo* size = sizeSetting(inForce);
        Row row = rowFor(session, name, size ? static_cast<uint32_t>(size->value) : 0);
        row.times = timePairs(session, options_.repeat, options_.recorded, nullptr);
        if (row.times.unpinned > 0)
            std::fprintf(stderr,
                         "note: %s: in %u of %u frames %s did not serve all of its lights: the row is not its own\n%s",
                         scene_.name.c_str(), row.times.unpinned, options_.repeat, name.c_str(),
                         session.shadows.whyNot(row.times.unpinnedLight, name, row.times.unpinnedFrame).c_str());
        const GnFrameStats stats = session.shadows.stats();
        row.rays = stats.rays;
        row.memoryMib = double(stats.memory) / (1024.0 * 1024.0);
        if (options_.passes && !options_.recorded) row.passes = timePasses(session, options_.repeat);
        settle(session, name, truthTime_, options_.recorded);
        addErrors(session, row);
        return row;
    }

private:
    /// Leaves the frame alone: visibility stays constant 1.
    class NoShadows final : public OtherShadows {
    public:
        void record(VkCommandBuffer, const ViewInputs&) override {}
        VkImageView visibility() const override { return VK_NULL_HANDLE; }
    };

    SessionOptions sessionOptions() const
    {
        return {.scene = {},
                .size = size_,
                .memoryLimit = VkDeviceSize{options_.memory} << 20,
                .pinnedThreads = true,
                .plugins = options_.plugins};
    }

    Row rowFor(const Session& session, const std::string& method, uint32_t map) const
    {
        Row row;
        row.scene = scene_.name;
        row.method = method;
        row.lights = session.scene.lights.size();
        row.size = session.renderer.extent();
        row.map = map;
        row.triangles = triangleCount(scene_);
        return row;
    }

    void addErrors(Session& session, Row& row)
    {
        if (!truthTried_) {
            truth_ = measureTruth(device_, scene_, size_, truthTime_);
            truthTried_ = true;
            if (truth_) findAmbiguous();
        }
        if (!truth_) return;
        const std::vector<Image8> visibility = session.renderer.readVisibility();
        const SceneState& state = session.renderer.state();
        for (size_t layer = 0; layer < state.present.size(); ++layer) {
            const std::string& light = session.scene.lights[state.present[layer]].name;
            const std::vector<uint8_t>* counted = nullptr;
            const Image8* truth = truth_->find(light, &counted);
            if (!truth) continue;
            const auto index = static_cast<size_t>(counted - truth_->counted.data());
            const ErrorCount errors = compare(visibility[layer], *truth, *counted, ambiguous_[index]);
            row.errors += errors;
            row.hasErrors = true;
            if (const Image8& soft = truth_->soft[index]; soft.width > 0)
                row.soft += compareSoft(visibility[layer], soft, *counted);
            if (errors.percent(errors.wrong()) >= row.worstLightPercent) {
                row.worstLightPercent = errors.percent(errors.wrong());
                row.worstLight = light;
            }
        }
    }

    /// A property of scene, camera and light, the same for every method.
    void findAmbiguous()
    {
        for (size_t layer = 0; layer < truth_->lights.size(); ++layer) {
            const uint32_t light = truth_->state.present[layer];
            ambiguous_.push_back(ambiguousPixels(scene_, truth_->state, truth_->camera, truth_->surfaces,
                                                 scene_.lights[light], truth_->state.lights[light],
                                                 truth_->counted[layer]));
        }
    }

    Device& device_;
    const Scene& scene_;
    const BenchOptions& options_;
    const std::vector<SettingChoice>& choices_;
    VkExtent2D size_{};
    double truthTime_ = 0.0;
    std::optional<Truth> truth_;
    std::vector<std::vector<uint8_t>> ambiguous_; ///< By layer of the truth.
    bool truthTried_ = false;
    mutable NoShadows nothing_;
};

uint64_t softPixels(const Row& row)
{
    return row.soft.penumbra.pixels + row.soft.outside.pixels;
}

double penumbraPercent(const Row& row)
{
    return 100.0 * double(row.soft.penumbra.pixels) / double(softPixels(row));
}

void write(CsvWriter& csv, const Row& row, const Device& device)
{
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN(); // an empty cell
    const bool base = row.method == kNoneMethod;
    csv.cell(row.scene).cell(row.method).cell(row.lights).cell(row.size.width).cell(row.size.height);
    if (row.map > 0)
        csv.cell(row.map);
    else
        csv.empty();
    csv.cell(row.triangles).cell(median(row.times.gpuMs), 3).cell(median(row.times.cpuMs), 3);
    csv.cell(minimum(row.times.withMs), 3).cell(median(row.times.withMs), 3);
    csv.cell(base ? 0.0 : minimum(row.times.withMs) - minimum(row.times.withoutMs), 3);
    const ErrorCount& e = row.errors;
    const auto error = [&](double value, int decimals) { csv.cell(row.hasErrors ? value : nothing, decimals); };
    error(e.percent(e.wrong()), 4);
    csv.cell(row.rays).cell(row.memoryMib, 2).cell(device.properties.deviceName).cell(device.driver);
    error(e.percent(e.falseLit), 4);
    error(e.percent(e.falseShadow), 4);
    error(e.percent(e.ambiguous), 4);
    error(e.meanAbsolute(), 6);
    const auto soft = [&](double value, int decimals) { csv.cell(softPixels(row) > 0 ? value : nothing, decimals); };
    soft(penumbraPercent(row), 4);
    for (const SoftError::Part& part : {row.soft.penumbra, row.soft.outside}) {
        soft(part.rmse(), 6);
        soft(part.mean(), 6);
        soft(part.farPercent(), 4);
    }
    csv.endRow();
}

void print(const char* where, const SoftError::Part& part)
{
    std::printf("; %s RMSE %.4f, mean %.4f, off by > 0.1 %.3f %%", where, part.rmse(), part.mean(), part.farPercent());
}

void print(const Row& row)
{
    std::printf("%-12s %-16s %2zu lights %ux%u map %4u  increment %8.3f ms  frame %8.3f ms", row.scene.c_str(),
                row.method.c_str(), row.lights, row.size.width, row.size.height, row.map,
                row.method == kNoneMethod ? 0.0 : minimum(row.times.withMs) - minimum(row.times.withoutMs),
                minimum(row.times.withMs));
    if (row.hasErrors)
        std::printf("  wrong %.4f %% (worst %s %.4f %%; %llu px clearly, %.3f %% ambiguous)",
                    row.errors.percent(row.errors.wrong()), row.worstLight.c_str(), row.worstLightPercent,
                    static_cast<unsigned long long>(row.errors.wrongClear), row.errors.percent(row.errors.ambiguous));
    std::printf("\n");
    if (softPixels(row) > 0) {
        std::printf("    soft: penumbra %.2f %% of the pixels", penumbraPercent(row));
        print("in it", row.soft.penumbra);
        print("outside", row.soft.outside);
        std::printf("\n");
    }
    for (const PassTime& pass : row.passes)
        std::printf("    %-32s x%-3u GPU %8.3f ms  CPU %8.3f ms\n", pass.name.c_str(), pass.count, pass.gpuMs,
                    pass.cpuMs);
    std::fflush(stdout);
}

/// \param count 0: the scene's own lights.
Scene sceneFor(const BenchOptions& options, const std::string& name, uint32_t count)
{
    Scene scene = valueOf(loadScene(name));
    if (count > 0) limitLights(scene, count);
    if (const std::vector<std::string> named = parseNames(options.light); !named.empty()) keepLights(scene, named);
    setSourceSizes(scene, options.sources);
    if (options.merged) mergeStatics(scene);
    return scene;
}

/// What is measured on a scene beside its base row.
struct Job {
    struct Method {
        std::string name;
        GnTraits traits;
        std::vector<std::optional<uint32_t>> maps; ///< A row for each; empty: as set, or the method's default.
    };
    Scene scene;
    std::vector<uint32_t> bareMaps;
    std::vector<Method> methods;

    bool empty() const { return bareMaps.empty() && methods.empty(); }
};

/// Null: the bare map can be measured.
const char* reasonAgainstBare(const Scene& scene, uint32_t repeat)
{
    if (scene.lights.empty() || scene.lights[0].kind != LightKind::Spot) return "the first light is no spot light";
    for (const uint32_t frame : {0u, kWarmFrames + repeat - 1}) // lights come once and go once
        if (!lightAt(scene.lights[0], frameTime(scene, frame)).present)
            return "the first light is not there in all frames that are measured";
    return nullptr;
}

/// Null: the method can be measured.
const char* reasonAgainst(const GnMethodInfo& method, const Scene& scene, bool recorded)
{
    if (method.pUnavailable) return method.pUnavailable;
    if (recorded && method.roundTrips > 0) return "it cannot be recorded";
    return servesOne(scene, method.traits) ? nullptr : "it serves none of the lights";
}

/// Those of the sizes that the method takes; a note names the others. Empty optional: as set, or its default.
std::vector<std::optional<uint32_t>> mapsOf(const Scene& scene, const GnMethodInfo& method,
                                            const std::vector<uint32_t>& maps)
{
    const GnSettingInfo* size = sizeSetting(method);
    if (!size || maps.empty()) return {std::nullopt};
    std::vector<std::optional<uint32_t>> taken;
    for (const uint32_t map : maps) {
        if (map >= size->minimum && map <= size->maximum)
            taken.emplace_back(map);
        else
            std::fprintf(stderr, "note: %s: %s with map %u is left out: its %s is from %.0f to %.0f\n",
                         scene.name.c_str(), method.pName, map, size->pName, size->minimum, size->maximum);
    }
    return taken;
}

void noteAbsent(const Scene& scene, uint32_t frame)
{
    const std::string absent = absentLights(scene, frameTime(scene, frame));
    if (!absent.empty())
        std::fprintf(stderr, "note: %s: not there in frame %u, in which errors are counted: %s\n", scene.name.c_str(),
                     frame, absent.c_str());
}

/// Notes say why a method that was asked for by name is left out.
Job plan(Device& device, Scene scene, const BenchOptions& options, const std::vector<std::string>& wanted,
         const std::vector<uint32_t>& maps, const std::vector<SettingChoice>& choices)
{
    const auto isWanted = [&wanted](const std::string& name) {
        return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    };
    const auto leaveOut = [&](const std::string& name, const char* reason) {
        if (wanted.empty()) return;
        std::fprintf(stderr, "note: %s: %s is left out: %s\n", scene.name.c_str(), name.c_str(), reason);
    };
    Job job;
    if (isWanted(kBareMethod)) {
        if (const char* reason = reasonAgainstBare(scene, options.repeat))
            leaveOut(kBareMethod, reason);
        else
            job.bareMaps = maps.empty() ? std::vector<uint32_t>{kDefaultBareMap} : maps;
    }
    // To list methods; draws nothing.
    Session session(device, scene, {.scene = {}, .size = {16, 16}, .plugins = options.plugins});
    const std::vector<GnMethodInfo> methods = session.shadows.methods();
    for (const SettingChoice& choice : choices)
        if (std::ranges::none_of(methods, [&](const GnMethodInfo& info) { return hasSetting(info, choice.name); }))
            throw HostError("--set: no method has a setting '" + choice.name + "'");
    for (const GnMethodInfo& info : methods) {
        if (!isWanted(info.pName) && isBuiltIn(info.pName)) continue;
        if (const char* reason = reasonAgainst(info, scene, options.recorded)) {
            leaveOut(info.pName, reason);
            continue;
        }
        Job::Method method{info.pName, info.traits, mapsOf(scene, info, maps)};
        if (!method.maps.empty()) job.methods.push_back(std::move(method));
    }
    for (const Job::Method& method : job.methods)
        requireRanges(choices, {method.name});
    noteAbsent(scene, options.repeat);
    job.scene = std::move(scene);
    return job;
}

/// Refuses what would count, or be called, something else.
void requireMeaning(const std::vector<SettingChoice>& choices, const BenchOptions& options)
{
    requireNoReasons(choices);
    for (const SettingChoice& choice : choices)
        if (!options.maps.empty() && (choice.name == kResolutionSetting || choice.name == kRowsSetting))
            throw HostError("--map sets '" + choice.name + "' already; it cannot be in --set, too");
}

} // namespace

int benchCommand(const BenchOptions& options)
{
    const std::vector<std::string> wanted = parseNames(options.methods);
    const std::vector<SettingChoice> choices = parseChoices(options.settings);
    requireMethods(wanted, std::array{kNoneMethod, kBareMethod});
    if (options.plugins.empty()) requireSettings(choices, wanted); // a plug-in's settings are known when it is loaded
    requireMeaning(choices, options);
    requireScenes(options.scenes);
    requireWritable(options.csv);
    const std::vector<uint32_t> maps = valueOf(parseCounts(options.maps, 16, 16384));
    std::vector<uint32_t> lightCounts = valueOf(parseCounts(options.lights, 1, 32));
    if (lightCounts.empty()) lightCounts.push_back(0); // the scene's
    std::vector<Scene> scenes;
    for (const std::string& name : options.scenes) // a misspelt light ends the command before anything is measured
        for (const uint32_t count : lightCounts)
            scenes.push_back(sceneFor(options, name, count));
    const std::unique_ptr<Device> device = Device::create({.validation = options.validation});
    pinThread(0);
    std::vector<Job> jobs;
    for (Scene& scene : scenes)
        jobs.push_back(plan(*device, std::move(scene), options, wanted, maps, choices));
    const bool onlyBase = std::find(wanted.begin(), wanted.end(), kNoneMethod) != wanted.end();
    if (!wanted.empty() && !onlyBase &&
        std::all_of(jobs.begin(), jobs.end(), [](const Job& job) { return job.empty(); }))
        throw HostError("none of the methods asked for can be measured here");

    CsvWriter csv(kColumns);
    const auto keep = [&](const Row& row) {
        print(row);
        write(csv, row, *device);
        if (!options.csv.empty()) expect(csv.save(options.csv)); // what ends the command later shall not take it along
    };
    for (const Job& job : jobs) {
        SceneBench bench(*device, job.scene, options, choices);
        keep(bench.base());
        for (const uint32_t map : job.bareMaps)
            keep(bench.bare(map));
        for (const Job::Method& method : job.methods)
            for (const std::optional<uint32_t>& map : method.maps)
                keep(bench.method(method.name, method.traits, map));
    }
    if (options.csv.empty()) std::printf("%s", csv.text().c_str());
    requireSilence(*device);
    return 0;
}

} // namespace gnomon::demo
