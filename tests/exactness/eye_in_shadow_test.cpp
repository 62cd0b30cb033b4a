// Where volumes are hard: the eye inside one, the near plane cut by one. The eye walks sideways out of the shadow of a
// caster that hangs in the air, 16 steps through all cases, with a near plane half a metre away.
#include <cmath>
#include <span>

#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{240, 160};

constexpr int kSteps = 16;

/// Whether the caster stands between a point and the lamp of hangingCaster(), by its plane x = -1 alone.
bool inShadow(const Scene& scene, const glm::dvec3& point)
{
    const demo::Light& lamp = scene.lights[0];
    const glm::dvec3 toLight = lamp.kind == LightKind::Directional ? -8.0 * lamp.direction : lamp.position - point;
    const double t = (-1.0 - point.x) / toLight.x;
    const glm::dvec3 crossing = point + t * toLight;
    return t > 0.0 && t < 1.0 && std::abs(crossing.y - 2.5) < 0.8 && std::abs(crossing.z) < 0.8;
}

Scene walkOut(LightKind kind, bool closed, demo::DepthConvention convention)
{
    Scene scene = hangingCaster(kind, closed, convention);
    scene.camera.clear();
    for (int i = 0; i < kSteps; ++i) {
        const double z = 2.4 * i / (kSteps - 1); // the shadow's border lies at 0.8 to 1.2 m
        scene.camera.push_back(
            {.time = double(i), .eye = {1.0, 1.8, z}, .target = {4.0, 0.2, z - 1.5}, .verticalFov = 1.0f});
    }
    return scene;
}

/// One method with one setting.
struct Walker {
    std::string method;
    Setting setting;
};

/// What a method made of all steps.
struct Walked {
    ErrorCount error;
    uint64_t worstStep = 0, worstClear = 0; ///< Pixels of one step: wrong, and wrong with a clear answer.
    int inside = 0, darkSteps = 0;
};

/// What each of them made of all steps. They share the truth.
std::vector<Walked> walk(std::span<const Walker> walkers, LightKind kind, bool closed, demo::DepthConvention convention)
{
    Stage stage(walkOut(kind, closed, convention), kSize);
    std::vector<Walked> all(walkers.size());
    for (int step = 0; step < kSteps; ++step) {
        stage.goTo(step);
        for (size_t i = 0; i < walkers.size(); ++i) {
            Walked& walked = all[i];
            walked.inside += inShadow(stage.scene(), stage.camera.eye);
            const Pictures pictures = stage.draw(walkers[i].method, {walkers[i].setting});
            const ErrorCount now = pooled(stage, pictures);
            walked.worstStep = std::max(walked.worstStep, now.wrong());
            walked.worstClear = std::max(walked.worstClear, clearlyWrong(stage.scene(), stage, pictures[0], 0));
            walked.darkSteps += test::dark(stage.truth[0]) > 100;
            walked.error += now;
        }
    }
    return all;
}

std::string circumstances(LightKind kind, bool closed, demo::DepthConvention convention)
{
    return std::string(nameOf(kind)) + (closed ? ", closed caster, " : ", open caster, ") + nameOf(convention) +
           " depth";
}

void checkWalk(const Walker& walker, const Walked& walked, const std::string& where, demo::DepthConvention convention)
{
    const std::string what =
        walker.method + " " + walker.setting.name + " " + std::to_string(int(walker.setting.value)) + ", " + where;
    CAPTURE(what);
    MESSAGE(what << ": " << walked.inside << " of " << kSteps << " eyes in shadow, wrong " << inWords(walked.error)
                 << ", at most " << walked.worstStep << " pixels a step, clearly " << walked.worstClear);
    CHECK(walked.inside > 2);
    CHECK(walked.inside < kSteps - 2);
    CHECK(walked.darkSteps == kSteps);
    // A miscounted volume turns whole regions; single pixels along edges are what definitions of exactness allow.
    const bool standard = convention == demo::DepthConvention::Standard;
    CHECK(walked.error.percent(walked.error.wrong()) <= (standard ? 0.04 : 0.005));
    CHECK(walked.worstClear <= 2);
}

void checkWalks(demo::DepthConvention convention)
{
    const Walker walkers[] = {{"stencil_volume", {"z_fail", 0.0}},   {"stencil_volume", {"z_fail", 1.0}},
                              {"octree_volume", {"z_fail", 0.0}},    {"octree_volume", {"z_fail", 1.0}},
                              {"all_edges_volume", {"z_fail", 0.0}}, {"all_edges_volume", {"z_fail", 1.0}},
                              {"chan_durand", {"cull", 1.0}}};
    for (const KindOfLight& light : kKinds)
        for (const bool closed : {true, false}) {
            const std::vector<Walked> walked = walk(walkers, light.kind, closed, convention);
            for (size_t i = 0; i < walked.size(); ++i)
                checkWalk(walkers[i], walked[i], circumstances(light.kind, closed, convention), convention);
        }
}

} // namespace

TEST_CASE("volumes are right with the eye inside a shadow, outside it, and the near plane across its border")
{
    const test::DeviceTest silence;
    checkWalks(demo::DepthConvention::ReversedInfinite);
}

TEST_CASE("volumes are right at those places with standard depth as well")
{
    const test::DeviceTest silence;
    checkWalks(demo::DepthConvention::Standard);
}

// Edges are the map's here, so the same map looked up says what is to be expected of them.
TEST_CASE("mccool is as right at those places as its map looked up, with reversed and with standard depth")
{
    const test::DeviceTest silence;
    const Setting fine{"resolution", 1024.0};
    for (const auto convention : {demo::DepthConvention::ReversedInfinite, demo::DepthConvention::Standard}) {
        for (const KindOfLight& light : kKinds) {
            for (const bool closed : {true, false}) {
                const std::string what = circumstances(light.kind, closed, convention);
                CAPTURE(what);
                const char* lookUp = light.kind == LightKind::Point ? "cube_map" : "shadow_map";
                const Walker walkers[] = {{lookUp, fine}, {"mccool", fine}};
                const std::vector<Walked> both = walk(walkers, light.kind, closed, convention);
                const Walked &map = both[0], &volumes = both[1];
                MESSAGE("mccool, " << what << ": wrong " << inWords(volumes.error) << ", at most " << volumes.worstStep
                                   << " pixels a step; looked up " << inWords(map.error) << ", " << map.worstStep);
                CHECK(volumes.inside > 2);
                CHECK(volumes.inside < kSteps - 2);
                CHECK(volumes.darkSteps == kSteps);
                CHECK(10 * volumes.error.wrong() <= 11 * map.error.wrong() + 10 * kSteps);
                CHECK(volumes.worstStep <= map.worstStep + 10);
            }
        }
    }
}

// A ray to the near plane passes then where a closed caster's lit side was left out of the map.
TEST_CASE("mccool is as right as its map looked up with the near plane in a closed caster, and with the eye in one")
{
    const test::DeviceTest silence;
    for (const auto convention : {demo::DepthConvention::ReversedInfinite, demo::DepthConvention::Standard}) {
        for (const KindOfLight& light : kKinds) {
            for (const bool aboutEye : {false, true}) {
                const std::string what = std::string(nameOf(light.kind)) +
                                         (aboutEye ? ", eye in crate, " : ", cut ball, ") + nameOf(convention) +
                                         " depth";
                CAPTURE(what);
                Stage stage(cutByNearPlane(light.kind, aboutEye, convention), kSize);
                const Settings fine{{"resolution", 1024.0}};
                const char* lookUp = light.kind == LightKind::Point ? "cube_map" : "shadow_map";
                const ErrorCount map = pooled(stage, stage.draw(lookUp, fine));
                const ErrorCount volumes = pooled(stage, stage.draw("mccool", fine));
                MESSAGE("mccool, " << what << ": wrong " << inWords(volumes) << "; looked up " << inWords(map));
                CHECK(volumes.counted > 1000);
                CHECK(10 * volumes.wrong() <= 11 * map.wrong() + 100);
            }
        }
    }
}

} // namespace gnomon::exact
