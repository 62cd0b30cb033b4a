// `gnomon calibrate`: measures every method on generated scenes and writes a knowledge base; with --check it measures
// shipped scenes instead and says how well a knowledge base predicts them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "demo/calibrate/sweep.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/measure.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kCheckMoments = 3; // of a scene's length
// A check begins with so many points of the sweep a method, to learn how fast the device is today. Ten timings show a
// device factor (runtime/cost/README.md); fewer say nothing.
constexpr uint32_t kSpeedPoints = 5;
constexpr double kSpeedSeconds = 2.0; // a method
constexpr size_t kFewestTimings = 10;

/// What one light took by one method, update and resolve together, and what was foretold.
struct Foretold {
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

int calibrate(const CalibrateOptions& options, Device& device, const std::vector<SweepMethod>& methods)
{
    Sweeper sweeper(device);
    std::vector<cost::KnowledgeRow> rows;
    for (const SweepMethod& method : methods) {
        const SweepRun run = sweeper.run(method, options.secondsPerMethod);
        std::printf("%-20s %3u points, %4zu rows, %5.1f s\n", method.name.c_str(), run.points, run.rows.size(),
                    run.seconds);
        std::fflush(stdout);
        rows.insert(rows.end(), run.rows.begin(), run.rows.end());
    }
    const std::string out = options.out.empty() ? "knowledge.csv" : options.out;
    expect(writeText(out, cost::writeKnowledge(rows)));
    std::printf("%zu rows to %s\n", rows.size(), out.c_str());
    return 0;
}

/// The device factor of this hour: by how much longer the sweep's own points take than the knowledge base says, in the
/// median. The scenes that are to be foretold have no part in it.
double presentFactor(Device& device, const std::vector<SweepMethod>& methods, const cost::CostModel& model)
{
    Sweeper sweeper(device);
    std::vector<double> ratios;
    for (uint32_t m = 0; m < methods.size(); ++m)
        for (const cost::KnowledgeRow& row : sweeper.run(methods[m], kSpeedSeconds, kSpeedPoints).rows) {
            const double predicted = model.predict(UINT32_MAX, m, row.pass, row.workload).ms;
            const double measured = row.gpuMsMin + row.cpuMsMin;
            if (predicted > 0.0 && measured > 0.0) ratios.push_back(measured / predicted);
        }
    return ratios.size() < kFewestTimings ? 1.0 : percentile(std::move(ratios), 0.5);
}

int check(const CalibrateOptions& options, Device& device, const std::vector<SweepMethod>& methods)
{
    const std::filesystem::path file =
        valueOf(findKnowledge(options.knowledge.empty() ? "lavapipe" : options.knowledge));
    const cost::KnowledgeResult knowledge = cost::parseKnowledge(valueOf(readText(file)));
    if (!knowledge.base) throw HostError(file.string() + ": " + knowledge.error);
    std::vector<std::string> algorithms;
    for (const SweepMethod& method : methods)
        algorithms.push_back(method.algorithm);
    cost::CostModel model;
    model.setSharedCores(device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU);
    model.resize(static_cast<uint32_t>(methods.size()), 1);
    cost::learn(model, *knowledge.base, algorithms, device.properties.deviceName);

    const double factor = presentFactor(device, methods, model);
    std::printf("device factor %.2f, from the sweep\n", factor);
    std::vector<cost::KnowledgeRow> all;
    std::vector<double> percents, cold;
    std::map<std::string, std::vector<double>> byMethod, byScene;
    for (const std::string& name : options.check) {
        const Scene scene = valueOf(loadScene(name));
        const VkExtent2D size =
            options.size.empty() ? VkExtent2D{scene.width, scene.height} : valueOf(parseSize(options.size));
        for (uint32_t m = 0; m < methods.size(); ++m) {
            const std::vector<cost::KnowledgeRow> rows = measureScene(device, scene, methods[m], size, kCheckMoments);
            double updateMs = 0.0, foretoldMs = 0.0;
            for (const cost::KnowledgeRow& row : rows) {
                all.push_back(row);
                const double measured = row.gpuMsMin + row.cpuMsMin; // as undisturbed as what it is compared with
                const double predicted = factor * model.predict(UINT32_MAX, m, row.pass, row.workload).ms;
                if (options.verbose)
                    std::printf("  %-10s %-16s %-7s %8.0f px %7.0f tri %7.0f drawn %4.0f casters %8.0f texels%s%s: "
                                "%7.3f ms (gpu %.3f cpu %.3f), foretold %7.3f\n",
                                name.c_str(), methods[m].name.c_str(),
                                row.pass == cost::Pass::update ? "update" : "resolve", row.workload.pixels,
                                row.workload.casterTriangles, row.workload.drawnTriangles, row.workload.casters,
                                row.workload.mapTexels, row.workload.still ? " still" : "",
                                row.workload.directional ? " directional" : "", measured, row.gpuMsMin, row.cpuMsMin,
                                predicted);
                if (row.pass == cost::Pass::update) { // its resolve is the next row
                    updateMs = measured;
                    foretoldMs = predicted;
                    continue;
                }
                const Foretold one{name, methods[m].name, updateMs + measured, foretoldMs + predicted};
                updateMs = foretoldMs = 0.0;
                percents.push_back(one.percent());
                cold.push_back(Foretold{name, methods[m].name, one.measuredMs, one.predictedMs / factor}.percent());
                byMethod[one.algorithm].push_back(one.percent());
                byScene[name].push_back(one.percent());
            }
        }
    }
    for (const auto& entry : byScene)
        printErrors(("scene " + entry.first).c_str(), entry.second);
    for (const auto& entry : byMethod)
        printErrors(entry.first.c_str(), entry.second);
    printErrors("all lights and methods", percents);
    printErrors("the same without the device factor", cold);
    if (!options.out.empty()) expect(writeText(options.out, cost::writeKnowledge(all)));
    return 0;
}

} // namespace

int calibrateCommand(const CalibrateOptions& options)
{
    const std::unique_ptr<Device> device = Device::create({});
    const std::vector<SweepMethod> methods = valueOf(sweepMethods(*device, parseNames(options.methods)));
    const int result = options.check.empty() ? calibrate(options, *device, methods) : check(options, *device, methods);
    requireSilence(*device);
    return result;
}

} // namespace gnomon::demo
