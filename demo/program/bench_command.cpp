#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "demo/host/pin_thread.hpp"
#include "demo/io/file.hpp"
#include "demo/program/bench_scene.hpp"
#include "demo/program/checks.hpp"
#include "demo/report/csv_reader.hpp"
#include "demo/report/sections.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kDefaultBareMap = 1024;

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

/// Empty, with a note, where the method does not serve all of the lights.
std::optional<BenchRow> tryMethod(SceneBench& bench, const Scene& scene, const Job::Method& method,
                                  std::optional<uint32_t> map)
{
    try {
        return bench.method(method.name, method.traits, map);
    } catch (const HostError& error) {
        noteLeftOut(scene.name, method.name, error);
        return std::nullopt;
    }
}

/// Null: the bare map can be measured.
const char* reasonAgainstBare(const Scene& scene, uint32_t repeat)
{
    if (scene.lights.empty() || scene.lights[0].kind != LightKind::Spot) return "the first light is no spot light";
    for (const uint32_t frame : {0u, kWarmFrames + repeat - 1}) // lights come once and go once
        if (!lightAt(scene.lights[0], frameTime(scene, frame)).present)
            return "the first light is not there in all frames that are measured";
    return nullptr;
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
    requireOwners(choices, methods);
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

/// `--map` and `--set` would say different sizes.
void requireOneSize(const std::vector<SettingChoice>& choices, const BenchOptions& options)
{
    for (const SettingChoice& choice : choices)
        if (!options.maps.empty() && (choice.name == kResolutionSetting || choice.name == kRowsSetting))
            throw HostError("--map sets '" + choice.name + "' already; it cannot be in --set, too");
}

Benched::Row plottedRow(const BenchRow& row, const char* device)
{
    const bool soft = row.soft.penumbra.pixels > 0;
    return {.scene = row.scene,
            .method = row.method,
            .map = row.map > 0 ? std::to_string(row.map) : "",
            .device = device,
            .ms = incrementMs(row),
            .error = soft ? row.soft.penumbra.rmse() : row.errors.percent(row.errors.wrong()),
            .memoryMib = row.memoryMib,
            .soft = soft};
}

} // namespace

int benchCommand(const BenchOptions& options)
{
    const std::vector<std::string> wanted = parseNames(options.methods);
    requireMethods(wanted, std::array{kNoneMethod, kBareMethod});
    const std::vector<SettingChoice> choices = requireChoices(options.settings, wanted, !options.plugins.empty());
    requireOneSize(choices, options);
    requireScenes(options.scenes);
    requireWritable(options.csv);
    requireWritable(options.plot);
    if (!options.aliasing.empty()) requireWritableFolder(options.aliasing);
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

    std::vector<std::string> columns = benchColumns();
    columns.emplace_back(kCommandColumn);
    CsvWriter csv(std::move(columns));
    Benched measured;
    std::string command = options.command;
    const auto keep = [&](const BenchRow& row) {
        printRow(row);
        addCells(csv, row, *device);
        csv.cell(std::exchange(command, {})).endRow();
        if (!options.csv.empty()) expect(csv.save(options.csv)); // what ends the command later must not take it along
        if (row.hasErrors) measured.rows.push_back(plottedRow(row, device->properties.deviceName));
    };
    size_t asked = 0, served = 0;
    for (const Job& job : jobs) {
        SceneBench bench(*device, job.scene, options, choices);
        keep(bench.base());
        for (const uint32_t map : job.bareMaps)
            keep(bench.bare(map));
        for (const Job::Method& method : job.methods)
            for (const std::optional<uint32_t>& map : method.maps) {
                const auto row = tryMethod(bench, job.scene, method, map);
                ++asked;
                served += row.has_value();
                if (row) keep(*row);
            }
    }
    if (asked > 0 && served == 0) throw HostError("none of the methods asked for serves all of its lights");
    if (options.csv.empty()) std::printf("%s", csv.text().c_str());
    if (!options.plot.empty()) expect(writeFile(options.plot, errorPicture(measured)));
    requireSilence(*device);
    return 0;
}

} // namespace gnomon::demo
