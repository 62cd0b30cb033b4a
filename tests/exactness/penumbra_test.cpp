// Soft shadows against 256 rays a pixel, by the definitions' soft error.
#include <chrono>
#include <cstdlib>

#include "demo/io/png.hpp"
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kWedges = "penumbra_wedges";
constexpr VkExtent2D kSize{160, 120};

struct Setup {
    Caster caster = Caster::box;
    LightKind kind = LightKind::Point;
    double height = 1.0; ///< Of the caster's centre over the floor, metres.
    float radius = 0.3f;
};

const char* nameOf(Caster caster)
{
    switch (caster) {
    case Caster::box:
        return "box";
    case Caster::sphere:
        return "sphere";
    case Caster::cylinder:
        return "cylinder";
    case Caster::torus:
        return "torus";
    }
    return "";
}

SoftError measured(Stage& stage, const char* method = kWedges)
{
    const brute::Scene casters(bruteTriangles(stage));
    const Pictures pictures = stage.draw(method);
    SoftError sum;
    for (size_t layer = 0; layer < pictures.size(); ++layer)
        sum += compareSoft(pictures[layer], softTruth(stage, layer, casters));
    return sum;
}

SoftError measured(const Setup& setup)
{
    Stage stage(softScene(setup.caster, setup.kind, setup.height, setup.radius), kSize);
    const SoftError error = measured(stage);
    const SoftError hard = measured(stage, "ray_traced");
    MESSAGE(nameOf(setup.caster) << ", " << demo::nameOf(setup.kind) << ", " << setup.height << " m high, radius "
                                 << setup.radius << ": " << inWords(error) << "; ray_traced " << inWords(hard));
    return error;
}

} // namespace

TEST_CASE("explore")
{
    const test::DeviceTest silence;
    for (const Caster caster : {Caster::box, Caster::sphere, Caster::cylinder, Caster::torus})
        for (const double height : {0.9, 1.6})
            for (const float radius : {0.05f, 0.25f, 0.6f})
                measured({.caster = caster, .height = height, .radius = radius});
}

} // namespace gnomon::exact
