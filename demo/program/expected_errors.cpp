// gnomon calibrate --errors
#include "demo/program/expected_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "demo/program/checks.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/setting_choices.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kMeasuringFrames = 24; // until receivers and outlines of the lights have been measured twice
constexpr double kFewPixels = 0.02;       // of the picture: of a light that reaches fewer, errors are chance
constexpr double kLeastPercent = 0.003;   // a few pixels: so are these

struct Row {
    std::string light;
    double expected = 0.0, found = 0.0; ///< Percent.
    uint64_t pixels = 0;

    double octaves() const { return std::log2(std::max(found, kLeastPercent) / std::max(expected, kLeastPercent)); }
};

using Expected = std::map<std::pair<std::string, std::string>, double>; ///< Percent, by light and method.

void setMap(Session& session, const std::string& method, uint32_t map)
{
    if (hasSetting(infoOf(session.shadows, method), kResolutionSetting))
        expect(session.shadows.set(method, kResolutionSetting, map));
}

/// By the default rules, which have the runtime measure what it goes by. The scene stands still.
Expected expectedOf(Device& device, const Scene& scene, const std::vector<GnMethodInfo>& methods, uint32_t map,
                    VkExtent2D size)
{
    Session session(device, scene, {.scene = {}, .size = size});
    for (const GnMethodInfo& method : methods)
        setMap(session, method.pName, map);
    const RuleText rules = valueOf(findRules({}));
    expect(session.shadows.loadRules(rules.text, rules.name));
    expect(session.shadows.warmUp());
    for (uint32_t i = 0; i < kMeasuringFrames; ++i)
        drawOnce(session, frameTime(scene, 0), true);
    Expected found;
    for (const uint32_t index : session.renderer.state().present) {
        const GnContext context = session.shadows.context();
        const GnView view = session.shadows.view(0);
        const GnLight light = session.shadows.light(index);
        uint32_t count = 0;
        gnGetCandidates(context, view, light, &count, nullptr);
        std::vector<GnCandidate> candidates(count);
        gnGetCandidates(context, view, light, &count, candidates.data());
        for (const GnCandidate& candidate : candidates) // quality is 1 / (1 + percent)
            found[{scene.lights[index].name, candidate.pMethod}] = 1.0 / double{candidate.quality} - 1.0;
    }
    return found;
}

/// Of the lights that the method serves.
std::vector<Row> rowsOf(Device& device, const Scene& scene, const GnMethodInfo& method, uint32_t map,
                        const Truth& truth, const Expected& expected)
{
    const VkExtent2D size{truth.surfaces.depth.width, truth.surfaces.depth.height};
    const Scene served = onlyServed(scene, method.traits);
    Session session(device, served, {.scene = {}, .size = size});
    setMap(session, method.pName, map);
    expect(session.shadows.pinAll(method.pName));
    settle(session, method.pName, frameTime(scene, 0), false);
    const std::vector<Image8> visibility = session.renderer.readVisibility();
    const std::vector<uint32_t> present = session.renderer.state().present;
    std::vector<Row> rows;
    for (size_t layer = 0; layer < present.size(); ++layer) {
        const std::string& light = served.lights[present[layer]].name;
        const std::vector<uint8_t>* counted = nullptr;
        const Image8* right = truth.find(light, &counted);
        const auto known = expected.find({light, method.pName});
        if (!right || known == expected.end()) continue;
        const ErrorCount errors = compare(visibility[layer], *right, *counted);
        if (double(errors.counted) < kFewPixels * size.width * size.height) continue;
        rows.push_back({light, known->second, errors.percent(errors.wrong()), errors.counted});
    }
    return rows;
}

/// Those that are asked for, of the methods with maps whose side can be set.
std::vector<GnMethodInfo> methodsOf(const Session& session, const std::string& names)
{
    const std::vector<std::string> asked = parseNames(names);
    std::vector<GnMethodInfo> methods;
    for (const GnMethodInfo& method : session.shadows.methods())
        if (!method.pUnavailable && hasSetting(method, kResolutionSetting) &&
            (asked.empty() || std::ranges::find(asked, std::string(method.pName)) != asked.end()))
            methods.push_back(method);
    if (methods.empty()) throw HostError("--methods " + names + ": none of them has maps of a given side");
    return methods;
}

void printSummary(const std::string& method, const std::vector<Row>& rows)
{
    double found = 0.0, expected = 0.0, squares = 0.0;
    for (const Row& row : rows) {
        found += row.found * double(row.pixels), expected += row.expected * double(row.pixels);
        squares += row.octaves() * row.octaves();
    }
    std::printf("%s: %zu lights, wrong pixels %.2f times those expected, a light's off by %.2f octaves (root mean "
                "square)\n",
                method.c_str(), rows.size(), found / std::max(expected, 1e-9),
                std::sqrt(squares / double(rows.size())));
}

} // namespace

int expectedErrors(const CalibrateOptions& options, Device& device)
{
    std::map<std::string, std::vector<Row>> all;
    for (const std::string& name : options.errors) {
        const Scene scene = valueOf(loadScene(name));
        const VkExtent2D size =
            options.size.empty() ? VkExtent2D{scene.width, scene.height} : valueOf(parseSize(options.size));
        const Session any(device, scene, {.scene = {}, .size = {64, 64}}); // names and traits live as long
        const std::vector<GnMethodInfo> methods = methodsOf(any, options.methods);
        const std::optional<Truth> truth = measureTruth(device, scene, size, frameTime(scene, 0));
        if (!truth) throw HostError(std::string("there is no truth: this build lacks the method ") + kTruthMethod);
        const Expected expected = expectedOf(device, scene, methods, options.map, size);
        for (const GnMethodInfo& method : methods) {
            if (!servesOne(scene, method.traits)) continue;
            try {
                for (const Row& row : rowsOf(device, scene, method, options.map, *truth, expected)) {
                    std::printf("%-12s %-16s %-16s expected %8.4f %%, found %8.4f %%\n", scene.name.c_str(),
                                row.light.c_str(), method.pName, row.expected, row.found);
                    all[method.pName].push_back(row);
                }
            } catch (const HostError& error) { // so large maps for all lights take too much memory, say
                noteLeftOut(scene.name, method.pName, error);
            }
        }
    }
    if (all.empty()) throw HostError("no light reaches a fiftieth of the picture: nothing to hold expectations to");
    for (const auto& [method, rows] : all)
        printSummary(method, rows);
    return 0;
}

} // namespace gnomon::demo
