// `gnomon calibrate`: measures every method on generated scenes and fits a knowledge base to that; with --fit it takes
// samples that were measured before; with --check it measures shipped scenes instead and says how well a knowledge base
// predicts them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "demo/calibrate/fit.hpp"
#include "demo/calibrate/sweep.hpp"
#include "demo/host/pin_thread.hpp"
#include "demo/io/file.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/expected_errors.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/progress.hpp"
#include "demo/scene/scene_file.hpp"
#include "runtime/cost/teach.hpp"
#include "runtime/cost/weighted_median.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kCheckMoments = 3; // of a scene's length
// The machine's speed drifts by a third within minutes. Methods take turns, so that none is measured in a fast minute
// only, and what is measured twice is compared by its fastest time.
constexpr uint32_t kTurns = 4;        // of a method's sweep
constexpr uint32_t kAlternations = 3; // of a check
// An alternation begins with so many points of the sweep a method, to learn how fast the device is today. Ten timings
// show a device factor (runtime/cost/README.md); fewer say nothing.
constexpr uint32_t kSpeedPoints = 5;
constexpr double kSpeedSeconds = 2.0; // a method
constexpr size_t kFewestTimings = 10;

using Rows = std::vector<Sample>;

/// What one light took by one method, update and resolve together, and what was predicted.
struct Predicted {
    std::string scene, algorithm;
    double measuredMs = 0.0, predictedMs = 0.0;
    double percent() const { return 100.0 * (std::exp2(std::fabs(std::log2(predictedMs / measuredMs))) - 1.0); }
};

double percentile(std::vector<double> values, double share)
{
    std::sort(values.begin(), values.end());
    return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

void printErrors(const char* title, const std::vector<double>& percents)
{
    if (percents.empty()) return;
    std::printf("%-40s %4zu  median %6.1f %%  p95 %6.1f %%\n", title, percents.size(), percentile(percents, 0.5),
                percentile(percents, 0.95));
}

/// The knowledge base to write; empty: none.
std::string outputOf(const CalibrateOptions& options)
{
    return options.out.empty() && options.check.empty() ? "knowledge.csv" : options.out;
}

const char* kindOf(const Device& device)
{
    switch (device.properties.deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return "software";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return "integrated";
    default:
        return "discrete";
    }
}

void writeFitted(const Samples& samples, const std::string& kind, const std::string& out)
{
    const cost::DeviceKnowledge fitted = fitKnowledge(samples, kind);
    for (const cost::AlgorithmCost& cost : fitted.algorithms) {
        std::printf("%-26s", cost.algorithm.c_str());
        for (uint32_t t = 0; t < cost::kTracks; ++t)
            if (const cost::TrackCost& track = cost.tracks[t]; track.samples > 0)
                std::printf("  %s %s %4u samples, %.2f octaves", t < 2 ? "update" : "resolve", t % 2 ? "cpu" : "gpu",
                            track.samples, track.octaves);
        std::printf("\n");
    }
    expect(writeFile(out, cost::writeKnowledge({&fitted, 1})));
    std::printf("%zu algorithms to %s\n", fitted.algorithms.size(), out.c_str());
}

int fit(const CalibrateOptions& options)
{
    const Samples samples = valueOf(parseSamples(valueOf(readText(options.fit))));
    for (const std::string& finding : samples.findings)
        std::fprintf(stderr, "%s: %s\n", options.fit.c_str(), finding.c_str());
    writeFitted(samples, options.kind, outputOf(options));
    return 0;
}

int calibrate(const CalibrateOptions& options, Device& device, const std::vector<SweepMethod>& methods)
{
    Sweeper sweeper(device);
    Progress progress(kTurns * static_cast<uint32_t>(methods.size()));
    std::vector<SweepRun> runs(methods.size());
    for (uint32_t turn = 0, done = 0; turn < kTurns; ++turn)
        for (size_t m = 0; m < methods.size(); ++m) {
            sweeper.proceed(runs[m], methods[m], options.secondsPerMethod * (turn + 1) / kTurns,
                            (kLeastPoints * (turn + 1) + kTurns - 1) / kTurns);
            progress.show(++done, methods[m].name);
        }
    Samples samples;
    for (size_t m = 0; m < methods.size(); ++m) {
        const std::vector<SharedSample> shared = meansOf(runs[m].shared, methods[m].algorithm, device);
        samples.parts.insert(samples.parts.end(), shared.begin(), shared.end());
        std::printf("%-26s %3u points, %4zu rows, %5.1f s\n", methods[m].name.c_str(), runs[m].points,
                    runs[m].rows.size(), runs[m].seconds);
        samples.rows.insert(samples.rows.end(), runs[m].rows.begin(), runs[m].rows.end());
    }
    const std::string text = writeSamples(samples.rows, samples.parts);
    if (!options.samples.empty()) expect(writeFile(options.samples, text));
    writeFitted(valueOf(parseSamples(text)), kindOf(device), outputOf(options)); // rounded, as --fit finds them
    return 0;
}

/// Each row's fastest time of both. Rows end where they are not of the same work.
/// @return whether all of both are
bool keepFastest(Rows& rows, const Rows& more)
{
    if (rows.empty()) rows = more;
    const size_t longest = std::max(rows.size(), more.size());
    const auto differ = std::ranges::mismatch(rows, more, [](const auto& a, const auto& b) {
        return a.pass == b.pass && a.workload.casterTriangles == b.workload.casterTriangles;
    });
    rows.erase(differ.in1, rows.end());
    for (size_t i = 0; i < rows.size(); ++i) {
        rows[i].gpuMsMin = std::min(rows[i].gpuMsMin, more[i].gpuMsMin);
        rows[i].cpuMsMin = std::min(rows[i].cpuMsMin, more[i].cpuMsMin);
    }
    return rows.size() == longest;
}

/// What a check measures: rows of every method, of the sweep's first points and of every scene.
struct CheckRows {
    std::vector<Rows> sweep;               ///< By method.
    std::vector<std::vector<Rows>> scenes; ///< By scene and method.
};

/// One alternation more.
void alternate(CheckRows& rows, const CalibrateOptions& options, Device& device, const std::vector<Scene>& scenes,
               const std::vector<SweepMethod>& methods, Progress& progress, uint32_t& done)
{
    Sweeper sweeper(device);
    for (size_t m = 0; m < methods.size(); ++m) {
        SweepRun run;
        sweeper.proceed(run, methods[m], kSpeedSeconds, kSpeedPoints);
        keepFastest(rows.sweep[m], run.rows); // as many points as there was time for in all alternations
    }
    for (size_t s = 0; s < scenes.size(); ++s) {
        const VkExtent2D size =
            options.size.empty() ? VkExtent2D{scenes[s].width, scenes[s].height} : valueOf(parseSize(options.size));
        for (size_t m = 0; m < methods.size(); ++m) {
            if (!keepFastest(rows.scenes[s][m], measureScene(device, scenes[s], methods[m], size, kCheckMoments)))
                std::printf(
                    "%s by %s: not the same lights and passes in all alternations; those that are not are left out\n",
                    scenes[s].name.c_str(), methods[m].name.c_str());
            progress.show(++done, scenes[s].name + ", " + methods[m].name);
        }
    }
}

/// The device factor of this hour, as a runtime finds it in a frame: by how much longer the sweep's own points take
/// than the knowledge base says, in the median, weighted by the time predicted. The scenes that are to be predicted
/// have no part in it.
double presentFactor(const CheckRows& rows, const cost::CostModel& model)
{
    std::vector<cost::Weighted> votes;
    for (uint32_t m = 0; m < rows.sweep.size(); ++m)
        for (const Sample& row : rows.sweep[m]) {
            const double predicted = model.predict(UINT32_MAX, m, row.pass, row.workload).ms;
            const double measured = row.gpuMsMin + row.cpuMsMin;
            if (predicted > 0.0 && measured > 0.0) votes.push_back({std::log2(measured / predicted), predicted});
        }
    return votes.size() < kFewestTimings ? 1.0 : std::exp2(cost::weightedMedian(votes));
}

cost::CostModel modelOf(const CalibrateOptions& options, const Device& device, const std::vector<SweepMethod>& methods)
{
    cost::KnowledgeBase knowledge;
    if (!options.knowledge.empty()) {
        const std::filesystem::path file = valueOf(findKnowledge(options.knowledge));
        cost::KnowledgeResult read = cost::parseKnowledge(valueOf(readText(file)));
        if (!read.base) throw HostError(file.string() + ": " + read.error);
        knowledge = std::move(*read.base);
    } else {
        knowledge = cost::shippedKnowledge();
    }
    const cost::DeviceKnowledge* nearest = knowledge.nearestTo(device.properties.deviceName, kindOf(device));
    if (nearest == nullptr) throw HostError("the knowledge base knows no device");
    std::vector<cost::TaughtMethod> taught;
    for (const SweepMethod& method : methods)
        taught.push_back({method.algorithm, method.traits});
    cost::CostModel model;
    model.setSharedCores(device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU);
    model.resize(static_cast<uint32_t>(methods.size()), 1);
    cost::teach(model, *nearest, taught);
    return model;
}

void printRow(const Predicted& one, const Sample& row)
{
    const cost::Workload& work = row.workload;
    std::printf("  %-10s %-16s %-7s %8.0f px %7.0f tri %7.0f drawn %4.0f casters %8.0f texels%s%s: "
                "%7.3f ms (gpu %.3f cpu %.3f), predicted %7.3f\n",
                one.scene.c_str(), one.algorithm.c_str(), row.pass == cost::Pass::update ? "update" : "resolve",
                work.pixels, work.casterTriangles, work.drawnTriangles, work.casters, work.mapTexels,
                work.still ? " still" : "", work.directional ? " directional" : "", one.measuredMs, row.gpuMsMin,
                row.cpuMsMin, one.predictedMs);
}

/// A scene's lights by one method, update and resolve together.
std::vector<Predicted> predictLights(const cost::CostModel& model, double factor, uint32_t method,
                                     const Predicted& names, const Rows& rows, bool verbose)
{
    std::vector<Predicted> lights;
    Predicted light = names;
    for (const Sample& row : rows) {
        Predicted pass = names;
        pass.measuredMs = row.gpuMsMin + row.cpuMsMin; // as undisturbed as what it is compared with
        pass.predictedMs = factor * model.predict(UINT32_MAX, method, row.pass, row.workload).ms;
        if (verbose) printRow(pass, row);
        light.measuredMs += pass.measuredMs;
        light.predictedMs += pass.predictedMs;
        if (row.pass == cost::Pass::update) continue; // its resolve is the next row
        lights.push_back(light);
        light = names;
    }
    return lights;
}

/// At one of the moments that measureScene() looks at.
void requireLit(const Scene& scene)
{
    for (uint32_t i = 0; i < kCheckMoments; ++i)
        if (lightCountAt(scene, frameTime(scene, scene.frames * i / kCheckMoments), false) > 0) return;
    throw HostError("scene '" + scene.name + "' has no light at any of the " + std::to_string(kCheckMoments) +
                    " moments that are measured");
}

int check(const CalibrateOptions& options, Device& device, const std::vector<SweepMethod>& methods)
{
    const cost::CostModel model = modelOf(options, device, methods);
    std::vector<Scene> scenes;
    for (const std::string& name : options.check)
        requireLit(scenes.emplace_back(valueOf(loadScene(name))));
    CheckRows measured{std::vector<Rows>(methods.size()),
                       std::vector<std::vector<Rows>>(scenes.size(), std::vector<Rows>(methods.size()))};
    Progress progress(kAlternations * static_cast<uint32_t>(scenes.size() * methods.size()));
    for (uint32_t i = 0, done = 0; i < kAlternations; ++i)
        alternate(measured, options, device, scenes, methods, progress, done);

    const double factor = presentFactor(measured, model);
    std::printf("device factor %.2f, from the sweep\n", factor);
    Rows all;
    std::vector<double> percents, cold;
    std::map<std::string, std::vector<double>> byMethod, byScene;
    for (size_t s = 0; s < scenes.size(); ++s)
        for (uint32_t m = 0; m < methods.size(); ++m) {
            const Rows& rows = measured.scenes[s][m];
            all.insert(all.end(), rows.begin(), rows.end());
            const Predicted names{scenes[s].name, methods[m].name};
            for (Predicted light : predictLights(model, factor, m, names, rows, options.verbose)) {
                percents.push_back(light.percent());
                byMethod[light.algorithm].push_back(percents.back());
                byScene[light.scene].push_back(percents.back());
                light.predictedMs /= factor;
                cold.push_back(light.percent());
            }
        }
    if (percents.empty()) throw HostError("no light that the methods serve was timed: nothing to hold predictions to");
    for (const auto& entry : byScene)
        printErrors(("scene " + entry.first).c_str(), entry.second);
    for (const auto& entry : byMethod)
        printErrors(entry.first.c_str(), entry.second);
    printErrors("all lights and methods", percents);
    printErrors("the same without the device factor", cold);
    if (!options.samples.empty()) expect(writeFile(options.samples, writeSamples(all)));
    return 0;
}

} // namespace

int calibrateCommand(const CalibrateOptions& options)
{
    if (!options.out.empty() || (options.check.empty() && options.errors.empty())) requireWritable(outputOf(options));
    if (!options.fit.empty()) return fit(options);
    requireMethods(parseNames(options.methods));
    const std::unique_ptr<Device> device = Device::create({});
    if (!options.errors.empty()) {
        const int result = expectedErrors(options, *device);
        requireSilence(*device);
        return result;
    }
    pinThread(0);
    const std::vector<SweepMethod> methods = valueOf(sweepMethods(*device, parseNames(options.methods)));
    const int result = options.check.empty() ? calibrate(options, *device, methods) : check(options, *device, methods);
    requireSilence(*device);
    return result;
}

} // namespace gnomon::demo
