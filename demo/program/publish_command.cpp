// `gnomon publish`: measures every method on one light of each kind in each scene, and writes a page of it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <map>

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

/// Scenes of views/ whose lights have an extent, beside the shipped ones, whose lights are points.
constexpr const char* kSoftScenes[] = {"views/leaf_shade", "views/soft_table", "views/still_life"};

constexpr uint8_t kHalfLit = 128; ///< Of 255.

/// "spot", "soft spot" of a source with a radius, or "rectangle".
std::string kindOf(const Light& light)
{
    if (light.rectangle != glm::vec2(0.0f)) return "rectangle";
    return (light.radius > 0.0f ? "soft " : "") + std::string(nameOf(light.kind));
}

/// Of each kind the light with the largest shadow in the picture, of those that are there in all frames that are
/// measured. A kind whose lights throw none is left out: nothing could be wrong there. By kind.
std::map<std::string, std::string> lightsToMeasure(Device& device, const Scene& scene, const PublishOptions& options)
{
    Scene hard = scene; // the truth of soft lights takes a thousand rays a pixel, and says no more here
    for (Light& light : hard.lights)
        light.radius = 0.0f, light.rectangle = glm::vec2(0.0f);
    const std::optional<Truth> truth =
        measureTruth(device, hard, valueOf(parseSize(options.size)), frameTime(scene, options.repeat));
    if (!truth) throw HostError("this build has no ray tracing to hold methods against");
    std::map<std::string, std::pair<size_t, std::string>> best; // pixels of shadow, and whose they are
    for (const Light& light : scene.lights) {
        const auto isThere = [&](uint32_t frame) { return lightAt(light, frameTime(scene, frame)).present; };
        if (!isThere(0) || !isThere(kWarmFrames + options.repeat - 1)) continue; // one comes and goes once
        auto& [most, name] = best[kindOf(light)];
        const std::vector<uint8_t>* counted = nullptr;
        const Image8* visibility = truth->find(light.name, &counted);
        size_t dark = 0;
        for (size_t i = 0; visibility && i < counted->size(); ++i)
            dark += (*counted)[i] != 0 && visibility->texels[i * visibility->channels] < kHalfLit;
        if (dark > most) most = dark, name = light.name;
    }
    std::map<std::string, std::string> chosen;
    for (const auto& [kind, light] : best)
        if (!light.second.empty())
            chosen.emplace(kind, light.second);
        else
            std::fprintf(stderr, "note: %s: no %s light throws a shadow into the picture\n", scene.name.c_str(),
                         kind.c_str());
    return chosen;
}

/// The table of a measurement, which grows row by row.
class Table {
public:
    Table(const Device& device, std::filesystem::path file)
        : device_(device), file_(std::move(file)), date_(today()), csv_(columns())
    {
    }
    void add(const BenchRow& row, const std::string& kind)
    {
        printRow(row);
        addCells(csv_, row, device_);
        csv_.cell(kind).cell(date_).endRow();
        ++rows_;
        expect(csv_.save(file_)); // what ends the command later must not take it along
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

void measureLight(Device& device, const Scene& scene, const std::string& kind, const BenchOptions& options,
                  Table& table)
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
        } catch (const HostError& error) { // one method must not end hours of measuring
            noteLeftOut(scene.name, info.pName, error);
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
        for (const auto& [kind, light] : lightsToMeasure(*device, scenes[i], options)) {
            std::printf("%s: %s: %s\n", scenes[i].name.c_str(), kind.c_str(), light.c_str());
            Scene one = scenes[i];
            keepLights(one, {light});
            measureLight(*device, one, kind, bench, table);
        }
        progress.show(static_cast<uint32_t>(i + 1), names[i]);
    }
    if (table.rows() == 0) throw HostError("none of the methods serves a light of these scenes: nothing is written");
    requireSilence(*device);
}

std::string commandOf(const PublishOptions& options)
{
    std::string text = "gnomon publish";
    for (const std::string& scene : options.scenes)
        text.append(" ").append(shellQuoted(scene));
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
    const auto start = std::chrono::steady_clock::now();
    requireScenes(options.scenes);
    requireMethods(parseNames(options.methods));
    (void)valueOf(parseSize(options.size));
    requireWritable(options.out);
    std::vector<fs::path> tables(options.from.begin(), options.from.end());
    if (tables.empty()) {
        std::vector<std::string> scenes = options.scenes;
        if (scenes.empty()) {
            for (const ShippedScene& shipped : shippedScenes())
                scenes.push_back(shipped.name);
            scenes.insert(scenes.end(), std::begin(kSoftScenes), std::end(kSoftScenes));
        }
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
    const std::string text = comparisonPage(all, commandOf(options), links);
    expect(writeFile(options.out, text));
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    std::printf("%s: %zu measurements, %zu bytes, in %.0f s\n", options.out.c_str(), all.rows.size(), text.size(),
                taken.count());
    return 0;
}

} // namespace gnomon::demo
