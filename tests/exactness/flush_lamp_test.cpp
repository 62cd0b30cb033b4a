// A lamp in the plane of a caster's face: set into a ceiling, or against a wall. Which side of the face it is on is then
// decided by rounding, and whoever takes a face that it touches for one that blocks it darkens half of all directions.
#include <cmath>

#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{240, 160};
constexpr int kSteps = 8;

struct Walker {
    std::string method;
    Settings settings;
};

const std::vector<Walker> kExact{{"stencil_volume", {}},
                                 {"stencil_volume", {{"z_fail", 1.0}}},
                                 {"stencil_volume", {{"silhouettes", 1.0}}},
                                 {"stencil_volume", {{"silhouettes", 1.0}, {"z_fail", 1.0}}},
                                 {"octree_volume", {}},
                                 {"octree_volume", {{"z_fail", 1.0}}},
                                 {"all_edges_volume", {}},
                                 {"all_edges_volume", {{"z_fail", 1.0}}}};

/// Those that sample, and how much may be wrong: what rows, texels and volumes of a lamp's surface cost here.
struct Sampled {
    std::string method;
    double percent;
};
const std::vector<Sampled> kSampled{{"chan_durand", 1.0}, {"angular_spans", 1.0}, {"penumbra_wedges", 1.0}};

/// The eye rises, so that coordinates about it are rounded differently in every step.
void checkRise(LitFrom place)
{
    Scene scene = flushLamp(place);
    scene.camera.clear();
    for (int step = 0; step < kSteps; ++step)
        scene.camera.push_back(
            {.time = double(step), .eye = {0.3, 0.31 + 0.07 * step, 5.0}, .target = {0.0, 0.9, 0.0}, .verticalFov = 1.0f});
    Stage stage(scene, kSize);
    for (int step = 0; step < kSteps; ++step) {
        stage.goTo(step);
        for (const Walker& walker : kExact) {
            const std::string first = walker.settings.empty() ? "" : walker.settings[0].name;
            CAPTURE(walker.method);
            CAPTURE(first);
            CAPTURE(step);
            const Pictures pictures = stage.draw(walker.method, walker.settings);
            const ErrorCount error = pooled(stage, pictures);
            MESSAGE(walker.method << " " << first << " " << step << ": " << inWords(error));
            CHECK(clearlyWrong(stage.scene(), stage, pictures[0], 0) <= 2);
        }
        for (const Sampled& sampled : kSampled) {
            const ErrorCount error = pooled(stage, stage.draw(sampled.method));
            MESSAGE(sampled.method << "  " << step << ": " << inWords(error));
            CHECK(error.percent(error.wrong()) <= sampled.percent);
        }
    }
}

} // namespace

TEST_CASE("volumes are right under a lamp in the plane of a solid ceiling's underside")
{
    const test::DeviceTest silence;
    checkRise(LitFrom::solidCeiling);
}

TEST_CASE("volumes are right under a lamp in the plane of a ceiling of one sheet")
{
    const test::DeviceTest silence;
    checkRise(LitFrom::sheetCeiling);
}


TEST_CASE("volumes are right with a lamp in the corner under the ceiling of a room of one mesh")
{
    const test::DeviceTest silence;
    checkRise(LitFrom::roomCorner);
}

} // namespace gnomon::exact
