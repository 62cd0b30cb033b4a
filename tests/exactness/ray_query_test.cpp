// Rays on the device against those on the CPU, on every shipped scene. On devices without ray queries there is nothing
// to compare.
#include <algorithm>
#include <string_view>

#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{640, 360};
constexpr const char* kTraced = "ray_query";

bool canTrace(const Stage& stage)
{
    return std::ranges::any_of(stage.methods(),
                               [](const GnMethodInfo& method) { return std::string_view(method.pName) == kTraced; });
}

/// Every pixel with a clear answer is right, and of the others nearly all.
void check(Stage& stage)
{
    const Pictures pictures = stage.draw(kTraced);
    const ErrorCount error = pooled(stage, pictures);
    uint64_t clear = 0;
    for (size_t layer = 0; layer < pictures.size(); ++layer)
        clear += clearlyWrong(stage.scene(), stage, pictures[layer], layer);
    MESSAGE(stage.scene().name << ": wrong " << inWords(error) << ", clearly " << clear);
    CHECK(error.counted > 10'000);
    CHECK(error.percent(error.wrong()) <= 0.005);
    CHECK(clear == 0);
}

} // namespace

TEST_CASE("rays on the device say of every shipped scene what rays on the CPU say")
{
    const test::DeviceTest silence;
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        Stage stage(shippedScene(name), kSize);
        if (!canTrace(stage)) return;
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
        if (!canTrace(stage)) return;
        check(stage);
    }
    Stage odd(oddCasters(), kSize);
    check(odd);
}

} // namespace gnomon::exact
