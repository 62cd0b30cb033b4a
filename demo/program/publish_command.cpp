// `gnomon publish`: measures every method on one light of each kind in each scene, and writes a page of it.
#include <algorithm>
#include <cstdio>
#include <ctime>

#include "demo/host/pin_thread.hpp"
#include "demo/io/file.hpp"
#include "demo/program/bench_scene.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/progress.hpp"
#include "demo/report/comparison.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

/// "2026-11-28", of the day in UTC.
std::string today()
{
    const std::time_t now = std::time(nullptr);
    std::tm day{};
    gmtime_r(&now, &day);
    char text[16];
    return {text, std::strftime(text, sizeof text, "%F", &day)};
}

/// The scene with one light: the first of the kind that is there in all frames that are measured. Nothing: it has none.
std::optional<Scene> withOneLight(const Scene& scene, LightKind kind, uint32_t repeat)
{
    for (const Light& light : scene.lights) {
        const auto isThere = [&](uint32_t frame) { return lightAt(light, frameTime(scene, frame)).present; };
        if (light.kind != kind || !isThere(0) || !isThere(kWarmFrames + repeat - 1))
            continue; // one comes and goes once
        Scene one = scene;
        keepLights(one, {light.name});
        return one;
    }
    return std::nullopt;
}

/// The table of a measurement, which grows row by row.
class Table {
public:
    Table(const Device& device, std::filesystem::path file)
        : device_(device), file_(std::move(file)), date_(today()), csv_(columns())
    {
    }
    void add(const BenchRow& row, LightKind kind)
    {
        printRow(row);
        addCells(csv_, row, device_);
        csv_.cell(nameOf(kind)).cell(date_).endRow();
        ++rows_;
        expect(csv_.save(file_)); // what ends the command later shall not take it along
    }
    uint32_t rows() const { return rows_; }

private:
    static std::vector<std::string> columns()
    {
        std::vector<std::string> all = benchColumns();
        all.emplace_back(kLightKindColumn);
        all.emplace_back(kDateColumn);
        return all;
    }
    const Device& device_;
    std::filesystem::path file_;
    std::string date_;
    CsvWriter csv_;
    uint32_t rows_ = 0;
};

void measureLight(Device& device, const Scene& scene, LightKind kind, const BenchOptions& options, Table& table)
{
    static const std::vector<SettingChoice> none;
    const std::vector<std::string> wanted = parseNames(options.methods);
    // To list methods; draws nothing.
    Session session(device, scene, {.scene = {}, .size = {16, 16}});
    SceneBench bench(device, scene, options, none);
    for (const GnMethodInfo& info : session.shadows.methods()) {
        if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), info.pName) == wanted.end()) continue;
        if (reasonAgainst(info, scene, false)) continue;
        try {
            table.add(bench.method(info.pName, info.traits, std::nullopt), kind);
        } catch (const HostError& error) { // one method shall not end hours of measuring
            std::fprintf(stderr, "note: %s: %s is left out: %s\n", scene.name.c_str(), info.pName, error.what());
        }
    }
}

void measure(const PublishOptions& options, const std::vector<std::string>& names, const std::filesystem::path& file)
{
    BenchOptions bench;
    bench.methods = options.methods;
    bench.size = options.size;
    bench.repeat = options.repeat;
    std::vector<Scene> scenes;
    for (const std::string& name : names)
        scenes.push_back(valueOf(loadScene(name)));
    const std::unique_ptr<Device> device = Device::create({});
    pinThread(0);
    Table table(*device, file);
    Progress progress(static_cast<uint32_t>(scenes.size()));
    for (size_t i = 0; i < scenes.size(); ++i) {
        for (const LightKind kind : {LightKind::Directional, LightKind::Spot, LightKind::Point})
            if (const std::optional<Scene> one = withOneLight(scenes[i], kind, options.repeat))
                measureLight(*device, *one, kind, bench, table);
        progress.show(static_cast<uint32_t>(i + 1), names[i]);
    }
    if (table.rows() == 0) throw HostError("none of the methods serves a light of these scenes: nothing is written");
    requireSilence(*device);
}

std::string commandOf(const PublishOptions& options)
{
    std::string text = "gnomon publish";
    for (const std::string& scene : options.scenes)
        text += " " + shellQuoted(scene);
    if (!options.methods.empty()) text += " --methods " + shellQuoted(options.methods);
    for (const std::string& table : options.from)
        text += " --from " + shellQuoted(table);
    if (options.from.empty())
        text += " --size " + shellQuoted(options.size) + " --repeat " + std::to_string(options.repeat);
    return text + " --out " + shellQuoted(options.out);
}

} // namespace

int publishCommand(const PublishOptions& options)
{
    namespace fs = std::filesystem;
    requireScenes(options.scenes);
    requireMethods(parseNames(options.methods));
    (void)valueOf(parseSize(options.size));
    requireWritable(options.out);
    std::vector<fs::path> tables(options.from.begin(), options.from.end());
    if (tables.empty()) {
        std::vector<std::string> scenes = options.scenes;
        if (scenes.empty())
            for (const ShippedScene& shipped : shippedScenes())
                scenes.push_back(shipped.name);
        tables.push_back(fs::path(options.out).replace_extension(".csv"));
        requireWritable(tables.front());
        measure(options, scenes, tables.front());
    }
    Compilation all;
    std::vector<std::string> links;
    const fs::path folder = fs::absolute(options.out).parent_path();
    for (const fs::path& table : tables) {
        expect(readCompilation(table, all));
        links.push_back(fs::absolute(table).lexically_relative(folder).generic_string());
    }
    for (const std::string& note : all.notes)
        std::fprintf(stderr, "note: %s\n", note.c_str());
    if (all.rows.empty()) throw HostError("no table has a whole row: no page is written");
    expect(writeFile(options.out, comparisonPage(all, commandOf(options), links)));
    std::printf("%s: %zu measurements\n", options.out.c_str(), all.rows.size());
    return 0;
}

} // namespace gnomon::demo
