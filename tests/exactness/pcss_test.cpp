// Soft shadows from depth maps: how wide penumbrae are, that no light gets into the umbra, and what the pyramid of
// nearest and farthest depths saves.
#include <algorithm>

#include "demo/scene/primitives.hpp"
#include "exactness/soft_measures.hpp"
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"
#include "shaders/filtered/pcss.h"

namespace gnomon::exact {
namespace {

constexpr const char* kPcss = "pcss";
constexpr const char* kMethods[] = {kPcss, "rbssm"};
constexpr VkExtent2D kSize{160, 120};

} // namespace

TEST_CASE("penumbrae grow in proportion to the gap between caster and receiver, and are as wide as traced ones")
{
    const test::DeviceTest silence;
    checkLinear(kMethods, LightKind::Spot, 0.25f);
    checkLinear(kMethods, LightKind::Point, 0.25f);
    checkLinear(kMethods, LightKind::Directional, 0.1f);
}

TEST_CASE("no light gets into the umbra, and nothing darkens what sees the whole light")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(umbraScene(kind, kind == LightKind::Directional ? 0.08f : 0.25f), kSize);
        const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
        const UmbraCount count = countUmbra(stage.draw(kPcss, {{"resolution", 1024.0}})[0], truths[0]);
        MESSAGE(std::string(demo::nameOf(kind)) << ": " << inWords(count));
        CHECK(count.umbra > 200);
        CHECK(count.light > 2000);
        CHECK(count.leaks == 0);
        CHECK(count.specks * 200 <= count.light);
    }
}

TEST_CASE("the error in the penumbra is a third of a hard shadow's at most")
{
    const test::DeviceTest silence;
    for (const Caster caster : {Caster::box, Caster::torus}) {
        for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
            Stage stage(softScene(caster, kind, 1.2, kind == LightKind::Directional ? 0.08f : 0.3f), kSize);
            const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
            const SoftError hard = compareSoft(stage.truth, truths);
            const SoftError soft = compareSoft(stage.draw(kPcss, {{"resolution", 1024.0}}), truths);
            MESSAGE(std::string(demo::nameOf(kind))
                    << ": RMSE " << soft.penumbra.rmse() << ", hard " << hard.penumbra.rmse() << "; " << inWords(soft));
            CHECK(soft.penumbra.pixels > 300);
            CHECK(3.0 * soft.penumbra.rmse() <= hard.penumbra.rmse());
            CHECK(soft.wrong == 0);
        }
    }
}

TEST_CASE("the pyramid saves half of the searches at least, and no pixel changes by more than a 255th")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(umbraScene(kind, kind == LightKind::Directional ? 0.08f : 0.25f), kSize);
        for (const double side : {1024.0, 999.0}) { // and one that is no power of two
            const Image8 with = stage.draw(kPcss, {{"resolution", side}})[0];
            const Image8 without = stage.draw(kPcss, {{"resolution", side}, {"early", 0.0}})[0];
            const Image8 why = stage.draw(kPcss, {{"resolution", side}, {"reasons", 1.0}})[0];
            int most = 0;
            for (size_t i = 0; i < with.texels.size(); ++i)
                most = std::max(most, std::abs(int(with.texels[i]) - int(without.texels[i])));
            const auto count = [&](uint32_t code) { return std::count(why.texels.begin(), why.texels.end(), code); };
            const auto lit = count(gpu::SOFT_LIT), dark = count(gpu::SOFT_DARK);
            const auto searched = count(gpu::SOFT_EMPTY) + count(gpu::SOFT_FILTERED);
            MESSAGE(std::string(demo::nameOf(kind))
                    << " " << side << ": " << lit << " lit and " << dark << " dark by the pyramid, " << searched
                    << " searched, of which " << count(gpu::SOFT_EMPTY) << " without a blocker");
            CHECK(most <= 1);
            CHECK(lit + dark >= searched);
            CHECK(dark > 0);
            CHECK(searched > 300);
        }
    }
}

TEST_CASE("lights without a radius have the picture of the hard map")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(softScene(Caster::torus, kind, 1.2, 0.0f), kSize);
        const char* hard = kind == LightKind::Point ? "cube_map" : "shadow_map";
        CHECK(test::differences(stage.draw(kPcss, {{"resolution", 512.0}})[0],
                                stage.draw(hard, {{"resolution", 512.0}})[0]) == 0);
    }
}

TEST_CASE("radii larger than the distance to the receiver, and a light inside a blocker, leave every pixel defined")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Scene scene = softScene(Caster::box, kind, 1.2, 6.0f);
        place(scene, "lamp shade", demo::makeBox({.size = glm::vec3(0.3f)}), scene.lights[0].position);
        Stage stage(std::move(scene), kSize);
        const Image8 first = stage.draw(kPcss, {{"resolution", 256.0}})[0];
        CHECK(test::differences(first, stage.draw(kPcss, {{"resolution", 256.0}})[0]) == 0);
        CHECK(std::count(first.texels.begin(), first.texels.end(), uint8_t(255)) > 0); // the sky
    }
}

} // namespace gnomon::exact
