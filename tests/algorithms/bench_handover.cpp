/// What it takes to hand pixels from a shadow map to the ray tracer and back: a hybrid's frame, less the same frame
/// with the plain look-up of the same map, less the time inside Embree. One light, everything at rest, maps kept: what
/// drawing them takes is no hand-over. 1280x720; the methods alternate. Then the same rays by the map's side: is their
/// time linear in their number (Morais 2015, AC-22 of demo/theses/measurements/2026-11-hybrid.md)? No test, since
/// machines differ: ninja bench_handover && ./bench_handover [SCENE...]

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "demo/program/measure.hpp"
#include "demo/scene/scene_file.hpp"

using namespace gnomon;
using namespace gnomon::demo;

namespace {

constexpr uint32_t kRounds = 12, kPairs = 4, kMapSide = 2048;
constexpr uint32_t kPassRounds = 3;  // passes are timed in every so many rounds
constexpr uint32_t kTimedFrames = 4; // at a time: what a frame took is known two frames later
constexpr VkExtent2D kSize{1280, 720};
constexpr const char* kPlainMethod = "shadow_map";
constexpr const char* kHybrids[] = {"pcf_hybrid", "contour_chain", "conservative_map", "conservative_map_adjacency"};

// Allowed: 25 ns a ray and 2.5 ms a frame, where the thesis's hand-over took 20 ns a
// ray that no stage accounted for (Morais 2015, 5.3).
constexpr double kNsPerRay = 25.0, kConstantMs = 2.5;

/// The scene with one light, and nothing in it moves.
Scene still(const std::string& name)
{
    Scene scene = valueOf(loadScene(name));
    limitLights(scene, 1);
    scene.framesPerSecond = std::numeric_limits<double>::infinity();
    return scene;
}

/// One method on its own context; minima over the rounds.
struct Lane {
    Lane(Device& device, const Scene& scene, const char* name)
        : method(name), session(std::make_unique<Session>(device, scene, SessionOptions{.scene = {}, .size = kSize}))
    {
        expect(session->shadows.set(method, kResolutionSetting, kMapSide));
        expect(session->shadows.pinAll(method));
        settle(*session, method, 0.0, false);
    }

    void round(bool timed)
    {
        const PairTimes pairs = timePairs(*session, kPairs, false, nullptr);
        withMs = std::min(withMs, minimum(pairs.withMs));
        withoutMs = std::min(withoutMs, minimum(pairs.withoutMs));
        raysMs = std::min(raysMs, minimum(pairs.raysMs));
        if (!timed) return;
        double passes = 0.0;
        for (const PassTime& pass : timePasses(*session, kTimedFrames))
            passes += pass.gpuMs + pass.cpuMs;
        passesMs = std::min(passesMs, passes);
    }

    double incrementMs() const { return withMs - withoutMs; }

    const char* method;
    std::unique_ptr<Session> session;
    double withMs = 1e30, withoutMs = 1e30;
    double raysMs = 1e30;   ///< Inside Embree, all threads.
    double passesMs = 1e30; ///< All passes of a frame.
};

void bench(Device& device, const std::string& name)
{
    const Scene scene = still(name);
    std::vector<Lane> lanes;
    lanes.emplace_back(device, scene, kPlainMethod);
    for (const char* hybrid : kHybrids)
        lanes.emplace_back(device, scene, hybrid);
    for (uint32_t i = 0; i < kRounds; ++i)
        for (Lane& lane : lanes)
            lane.round(i % kPassRounds == 0);
    const double threads = std::max(1u, std::thread::hardware_concurrency());
    for (const Lane& lane : lanes) {
        if (&lane == lanes.data()) continue; // the plain one
        const auto rays = static_cast<double>(lane.session->shadows.stats().rays);
        const double handOver = lane.incrementMs() - lanes.front().incrementMs() - lane.raysMs / threads;
        const double allowed = kConstantMs + 1e-6 * kNsPerRay * rays;
        const double nowhere = std::max(lane.incrementMs() - lane.passesMs, 0.0);
        std::printf("%-16s %-26s frame %7.2f ms  plain %7.2f  Embree %6.2f  rays %8.0f  hand-over %6.2f of %5.2f ms %s"
                    "  in no pass %4.1f %%\n",
                    name.c_str(), lane.method, lane.incrementMs(), lanes.front().incrementMs(), lane.raysMs / threads,
                    rays, handOver, allowed, handOver <= allowed ? "met" : "missed", 100.0 * nowhere / lane.withMs);
    }
}

/// CPU time of the passes that trace, fastest of a few frames.
double traceMs(Session& session)
{
    double sum = 0.0;
    for (const PassTime& pass : timePasses(session, 3 * kTimedFrames))
        if (pass.name.ends_with(".trace")) sum += pass.cpuMs;
    return sum;
}

/// Share of the variance of y that a line through (x, y) explains.
double squaredCorrelation(const std::vector<double>& x, const std::vector<double>& y)
{
    const auto n = static_cast<double>(x.size());
    double sx = 0.0, sy = 0.0, sxx = 0.0, syy = 0.0, sxy = 0.0;
    for (size_t i = 0; i < x.size(); ++i) {
        sx += x[i], sy += y[i];
        sxx += x[i] * x[i], syy += y[i] * y[i], sxy += x[i] * y[i];
    }
    const double covariance = n * sxy - sx * sy;
    return covariance * covariance / ((n * sxx - sx * sx) * (n * syy - sy * sy));
}

/// Every map side of a hybrid with its own number of rays.
void linearity(Device& device, const std::string& name)
{
    const Scene scene = still(name);
    for (const char* hybrid : {"pcf_hybrid", "conservative_map"}) { // their passes named trace do nothing else
        std::vector<double> rays, ms;
        Lane lane(device, scene, hybrid);
        expect(lane.session->shadows.set(hybrid, "classify", 0.0)); // the CPU asks the map in the pass that traces
        for (const double side : {512.0, 1024.0, 2048.0, 4096.0}) {
            expect(lane.session->shadows.set(hybrid, kResolutionSetting, side));
            settle(*lane.session, hybrid, 0.0, false);
            ms.push_back(traceMs(*lane.session));
            rays.push_back(static_cast<double>(lane.session->shadows.stats().rays));
        }
        const auto [fewest, most] = std::minmax_element(rays.begin(), rays.end());
        std::printf("%-18s %-18s trace time against %.0f to %.0f rays: R^2 %.3f\n", name.c_str(), hybrid, *fewest,
                    *most, squaredCorrelation(rays, ms));
        std::fflush(stdout);
    }
}

} // namespace

int main(int count, char** arguments)
try {
    std::vector<std::string> scenes(arguments + 1, arguments + count);
    if (scenes.empty()) scenes = {"views/colonnade", "views/bench", "views/foliage", "views/primitives", "bunny"};
    const std::unique_ptr<Device> device = Device::create({});
    for (const std::string& scene : scenes)
        bench(*device, scene);
    for (const std::string& scene : scenes)
        linearity(*device, scene);
    return 0;
} catch (const std::exception& failure) {
    std::fprintf(stderr, "bench_handover: %s\n", failure.what());
    return 1;
}
