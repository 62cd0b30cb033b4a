// Rays on the device against those on the CPU, on every shipped scene: of methods that are exact. On devices without
// ray queries there is nothing to compare.
#include <string>
#include <vector>

#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{640, 360};

std::vector<std::string> tracedOn(const Stage& stage)
{
    constexpr GnTraits wanted = GN_TRAIT_EXACT_BIT | GN_TRAIT_DEVICE_RAYS_BIT;
    std::vector<std::string> names;
    for (const GnMethodInfo& method : stage.methods())
        if ((method.traits & wanted) == wanted) names.emplace_back(method.pName);
    return names;
}

/// Every pixel with a clear answer is right, and of the others nearly all.
void check(Stage& stage, const std::string& method)
{
    CAPTURE(method);
    const Pictures pictures = stage.draw(method);
    const ErrorCount error = pooled(stage, pictures);
    uint64_t clear = 0;
    for (size_t layer = 0; layer < pictures.size(); ++layer)
        clear += clearlyWrong(stage.scene(), stage, pictures[layer], layer);
    MESSAGE(stage.scene().name << ", " << method << ": wrong " << inWords(error) << ", clearly " << clear);
    CHECK(error.counted > 10'000);
    CHECK(error.percent(error.wrong()) <= 0.005);
    CHECK(clear == 0);
}

void check(Stage& stage)
{
    const std::vector<std::string> methods = tracedOn(stage);
    CHECK(!methods.empty());
    for (const std::string& method : methods)
        check(stage, method);
}

} // namespace

TEST_CASE("rays on the device say of every shipped scene what rays on the CPU say")
{
    const test::DeviceTest silence;
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        Stage stage(shippedScene(name), kSize);
        if (!test::tracesRays(stage.session().shadows.context())) return;
        check(stage);
        stage.goTo(3.1); // everything has moved
        check(stage);
    }
}

TEST_CASE("and of a scene that holds what methods stumble over, for both depth conventions")
{
    const test::DeviceTest silence;
    for (const auto convention : {demo::DepthConvention::Standard, demo::DepthConvention::ReversedInfinite}) {
        CAPTURE(static_cast<int>(convention));
        Stage stage(testbed(convention), kSize);
        if (!test::tracesRays(stage.session().shadows.context())) return;
        check(stage);
    }
    Stage odd(oddCasters(), kSize);
    check(odd);
}

} // namespace gnomon::exact
