#include "demo/theses/navratil_survey.hpp"

#include <algorithm>
#include <cmath>

#include "demo/program/measure.hpp"
#include "demo/scene/primitives.hpp"

namespace gnomon::demo {
namespace {

constexpr uint32_t kPerSide = 10;          // casters along x and z
constexpr double kSpacing = 4.0;           // metres
constexpr uint32_t kHemisphereLamps = 256; // of his test
constexpr uint32_t kHemisphereVertices = 100'000;
constexpr uint32_t kHemisphereMap = 128; // texels a side: 256 cubes are 100 MiB
constexpr double kWalkSeconds = 8.0;

/// A field of rings over a floor, of so many vertices in all.
Scene field(double vertices)
{
    const double each = vertices / (kPerSide * kPerSide);
    const auto tube = static_cast<uint32_t>(std::max(3.0, std::round(std::sqrt(0.5 * each))));
    Scene scene;
    scene.name = "survey";
    scene.meshes.push_back(makePlane({.width = 60.0f, .depth = 60.0f, .columns = 60, .rows = 60}));
    scene.meshes.push_back(
        makeTorus({.radius = 0.9f, .tube = 0.35f, .ringSegments = std::max(3u, 2 * tube), .tubeSegments = tube}));
    scene.meshes[0].name = "floor";
    scene.meshes[1].name = "ring";
    Instance& floor = scene.instances.emplace_back();
    floor.name = "floor";
    floor.isStatic = true;
    for (uint32_t i = 0; i < kPerSide * kPerSide; ++i) {
        Instance& ring = scene.instances.emplace_back();
        const double half = 0.5 * (kPerSide - 1.0);
        ring.name = "ring";
        ring.mesh = 1;
        ring.pose.position = {kSpacing * (i % kPerSide - half), 1.3, kSpacing * (i / kPerSide - half)};
        ring.pose.rotation = glm::angleAxis(0.7 * i, glm::normalize(glm::dvec3(1.0, 0.3 * (i % 5), 0.2 * (i % 3))));
        ring.isStatic = true;
    }
    return scene;
}

Light lampAt(const glm::dvec3& position, double turnsPerSecond)
{
    Light lamp;
    lamp.name = "lamp";
    lamp.kind = LightKind::Point;
    lamp.position = position;
    lamp.range = 60.0f;
    lamp.orbit = {.center = position - glm::dvec3(0.5, 0.0, 0.0), .radiansPerSecond = turnsPerSecond};
    return lamp;
}

/// The camera walks between the rings and looks down on them: first with the lamp in view, then past it, so that it is
/// behind. The frames that timePairs() counts are spread over the walk; the lamp moves in each.
Scene walk(double vertices, uint32_t pairs)
{
    Scene scene = field(vertices);
    scene.framesPerSecond = pairs / kWalkSeconds;
    scene.lights.push_back(lampAt({0.0, 4.0, 0.0}, 0.4));
    const double start = frameTime(scene, kWarmFrames);
    const auto at = [&](double time, const glm::dvec3& eye, const glm::dvec3& target) {
        return CameraKey{.time = start + time, .eye = eye, .target = target};
    };
    scene.camera = {at(0.0, {2.0, 2.5, 24.0}, {0.0, 2.5, 0.0}), at(2.0, {2.0, 2.5, 14.0}, {0.0, -1.0, 6.0}),
                    at(5.0, {2.0, 2.5, -4.0}, {4.0, -0.5, -10.0}), at(8.0, {6.0, 2.5, -10.0}, {12.0, -0.5, -12.0})};
    return scene;
}

/// The frames of timePairs() again, for what they drew: the numbers of passes do not depend on time.
double meanParts(Session& session, uint32_t pairs)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < pairs; ++i) {
        const double time = frameTime(session.scene, kWarmFrames + i);
        const CameraState camera = session.camera(time);
        session.renderer.draw({.time = time, .cameras = {&camera, 1}, .shadows = &session.shadows});
        sum += casterPasses(session);
    }
    return sum / pairs;
}

SurveyTime measure(Session& session, const SurveyMethod& row, uint32_t map, uint32_t pairs)
{
    expect(session.shadows.set(row.method, "resolution", map));
    expect(session.shadows.set(row.method, "culling", row.culling));
    expect(session.shadows.pinAll(row.method));
    const PairTimes times = timePairs(session, pairs, false, nullptr);
    return {.frameMs = median(times.withMs),
            .shadowsMs = minimum(times.withMs) - minimum(times.withoutMs),
            .parts = meanParts(session, pairs),
            .served = times.unpinned == 0};
}

Session makeSession(Device& device, const Scene& scene, uint32_t picture)
{
    return Session(device, scene,
                   {.scene = {},
                    .size = {picture, picture},
                    .maxLights = static_cast<uint32_t>(scene.lights.size()),
                    .contextFlags = GN_CONTEXT_NO_BACKGROUND_BIT,
                    .pinnedThreads = true});
}

} // namespace

uint32_t casterPasses(const Session& session)
{
    uint32_t count = 0;
    gnGetFramePasses(session.shadows.context(), &count, nullptr);
    std::vector<GnPassTiming> passes(count);
    gnGetFramePasses(session.shadows.context(), &count, passes.data());
    return static_cast<uint32_t>(std::ranges::count_if(passes, [](const GnPassTiming& pass) {
        return std::string_view(pass.pName).find(kCasterPasses) != std::string_view::npos;
    }));
}

Survey measureSurvey(Device& device, const SurveyOptions& options)
{
    Survey survey{};
    for (size_t s = 0; s < kSurveyVertices.size(); ++s) {
        const Scene scene = walk(options.share * kSurveyVertices[s], options.pairs);
        Session session = makeSession(device, scene, options.picture);
        for (const char* method : {"cube_map", "dual_paraboloid"})
            expect(session.shadows.warmUp(method));
        for (size_t m = 0; m < kSurveyMaps.size(); ++m)
            for (size_t row = 0; row < kSurveyMethods; ++row) {
                SurveyTime& time = survey[s][row][m];
                time = measure(session, kSurvey[row], options.maps[m], options.pairs);
                if (options.measured) options.measured(kSurvey[row].printed, options.maps[m], time);
            }
    }
    return survey;
}

HemisphereTimes measureHemisphere(Device& device, const SurveyOptions& options)
{
    HemisphereTimes times;
    times.lamps = std::max(1u, static_cast<uint32_t>(std::lround(options.share * kHemisphereLamps)));
    const double vertices = options.share * kHemisphereVertices;
    times.vertices = static_cast<uint32_t>(std::lround(vertices));
    Scene scene = field(vertices);
    const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(times.lamps)));
    for (uint32_t i = 0; i < times.lamps; ++i) {
        const double step = 2.0, half = 0.5 * (side - 1.0);
        scene.lights.push_back(lampAt({step * (i % side - half), 6.0, step * (i / side - half)}, 0.4));
    }
    // Everything is seen, from under the lamps, and the highest ray of the view falls.
    scene.camera = {{.eye = {0.0, 5.9, 24.0}, .target = {0.0, -8.1, 0.0}, .verticalFov = 1.0f}};
    Session session = makeSession(device, scene, std::min(options.picture, 128u));
    const uint32_t pairs = std::min(options.pairs, 3u); // each takes seconds
    for (const auto& [row, time] : {std::pair{&kSurvey[2], &times.cube}, std::pair{&kSurvey[5], &times.paraboloid}}) {
        expect(session.shadows.warmUp(row->method));
        *time = measure(session, *row, kHemisphereMap, pairs);
        if (options.measured) options.measured(row->printed, kHemisphereMap, *time);
    }
    return times;
}

} // namespace gnomon::demo
