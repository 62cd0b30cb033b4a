// Casters and receivers close to a lamp whose farthest caster is far away: the near end of its map must not swallow
// them.
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

double wrongPercent(Stage& stage, const std::string& method)
{
    const ErrorCount error = pooled(stage, stage.draw(method, {{"resolution", 1024.0}}));
    MESSAGE(stage.scene().lights[0].name << ": " << method << " wrong " << inWords(error));
    CHECK(error.counted > 10000);
    return error.percent(error.wrong());
}

} // namespace

TEST_CASE("a card just under a lamp casts on a plain that reaches a hundred times as far")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Stage stage(lampOverPlain(kind), {320, 180});
        const bool spot = kind == LightKind::Spot;
        size_t dark = 0;
        for (size_t i = 0; i < stage.truth[0].texels.size(); ++i)
            dark += stage.counted[0][i] != 0 && stage.truth[0].texels[i] == 0;
        CHECK(dark > 2000); // card and crate
        CHECK(wrongPercent(stage, spot ? "shadow_map" : "cube_map") < 1.0);
        CHECK(wrongPercent(stage, "pcf_hybrid") < 0.05);
    }
}

} // namespace gnomon::exact
