// Questions about decisions through the C API: the newest frame, an older one, and the log.
#include <algorithm>
#include <cmath>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

std::string ask(Host& host, const GnQuestion& question)
{
    size_t size = 0;
    host.require(gnExplain(host.context, host.views[0], host.lights[0], &question, &size, nullptr));
    std::string text(size, '\0');
    host.require(gnExplain(host.context, host.views[0], host.lights[0], &question, &size, text.data()));
    text.resize(size - 1);
    CHECK(std::count(text.begin(), text.end(), '\n') <= 12);
    CHECK(text.find("light 'lamp', frame ") == 0);
    return text;
}

GnResult askInVain(Host& host, const GnQuestion& question)
{
    size_t size = 0;
    return gnExplain(host.context, host.views[0], host.lights[0], &question, &size, nullptr);
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "why says that a method counts a rectangle as a disc, of a method that shows it nothing")
{
    Scene scene = smallScene();
    demo::Light& lamp = scene.lights[0];
    lamp.rectangle = {0.6f, 0.2f};
    lamp.rectangleAxis = {1.0, 0.0, 0.3};
    lamp.radius = 2.0f * std::sqrt(0.12f / 3.14159265f); // 0.391
    Host host(scene);
    const auto why = [&](const char* method) {
        host.pinAll(method);
        host.require(host.draw());
        return ask(host, {.kind = GN_QUESTION_WHY});
    };
    const std::string text = why("pcss");
    CHECK_MESSAGE(
        contains(text, "pcss counts the light's flat source as a sphere that covers the same area, 0.39 m in radius"),
        text);
    for (const char* method : {"ray_traced", "shadow_map"}) // shows it; has no penumbrae at all
        CHECK_MESSAGE(!contains(why(method), "flat source"), std::string(method));
    lamp.rectangle = {};
    Host disc(scene);
    disc.pinAll("pcss");
    disc.require(disc.draw());
    CHECK(!contains(ask(disc, {.kind = GN_QUESTION_WHY}), "flat source"));
}

TEST_CASE_FIXTURE(DeviceTest, "all four questions are answered, for the newest frame and for one of 256")
{
    Host host(smallScene());
    CHECK(askInVain(host, {}) == GN_ERROR_FRAME_ORDER);
    const std::string rules = shippedRules("thesis");
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "thesis"));
    host.draw(12, {});
    std::string text = ask(host, {.kind = GN_QUESTION_WHY});
    INFO(text);
    CHECK(contains(text, "frame 12: octree_volume"));
    CHECK(contains(text, "rule T1"));
    CHECK(contains(text, "because "));
    CHECK(contains(text, "viewerDistance "));
    text = ask(host, {.kind = GN_QUESTION_WHY_NOT, .pMethod = "cube_map"});
    CHECK(contains(text, "does not serve this kind of light"));
    text = ask(host, {.kind = GN_QUESTION_WHAT_IF});
    CHECK(contains(text, "instead"));
    CHECK(contains(ask(host, {.kind = GN_QUESTION_WHAT_CHANGED}), "still octree_volume"));
    CHECK(contains(ask(host, {.kind = GN_QUESTION_WHY, .frame = 8}), "measured ")); // a timed frame

    // Other rules for what comes; what was decided before is explained by those that decided it.
    const std::string other = shippedRules("quality");
    host.require(gnLoadRules(host.context, other.data(), other.size(), "quality"));
    CHECK(contains(ask(host, {.kind = GN_QUESTION_WHY, .frame = 12}), "rule T1"));
    CHECK(std::string(host.decision(0).pRule) == "T1"); // the newest frame is one of them
    CHECK(contains(host.explanation(0), "T1"));
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "thesis"));

    host.pinAll("shadow_map");
    host.draw(3, {});
    text = ask(host, {.kind = GN_QUESTION_WHAT_CHANGED, .frame = 13});
    CHECK(contains(text, "frame 13 against frame 12: octree_volume -> shadow_map"));
    CHECK(contains(text, "the host pinned shadow_map"));
    text = ask(host, {.kind = GN_QUESTION_WHAT_CHANGED, .flags = GN_QUESTION_SINCE_SWITCH_BIT});
    CHECK(contains(text, "frame 15 against frame 12"));
    CHECK(contains(ask(host, {.kind = GN_QUESTION_WHY_NOT, .pMethod = "ray_traced"}), "the host pinned shadow_map"));
    CHECK(contains(ask(host, {.kind = GN_QUESTION_WHY, .frame = 12}), "octree_volume, highest suitability"));

    host.draw(256, {});
    CHECK(askInVain(host, {.frame = 12}) == GN_ERROR_OUT_OF_RANGE);
    CHECK(contains(host.lastError(), "16 to 271"));
    CHECK(askInVain(host, {.frame = 9999}) == GN_ERROR_OUT_OF_RANGE);
    CHECK(contains(host.lastError(), "9999"));
    CHECK(askInVain(host, {.kind = GN_QUESTION_WHY_NOT, .pMethod = "no_such"}) == GN_ERROR_UNKNOWN_METHOD);
    CHECK(contains(host.lastError(), "'no_such'"));
    CHECK(askInVain(host, {.kind = GN_QUESTION_WHY_NOT}) == GN_ERROR_NULL_ARGUMENT);
    CHECK(askInVain(host, {.kind = static_cast<GnQuestionKind>(9)}) == GN_ERROR_OUT_OF_RANGE);
    CHECK(askInVain(host, {.kind = GN_QUESTION_WHAT_CHANGED, .flags = 0x2}) == GN_ERROR_OUT_OF_RANGE);
    CHECK(contains(host.lastError(), "GnQuestion::flags has the bits 2"));

    size_t size = 0;
    host.require(gnGetDecisionLog(host.context, host.views[0], 0, 1, &size, nullptr));
    std::string log(size, '\0');
    host.require(gnGetDecisionLog(host.context, host.views[0], 0, 1, &size, log.data()));
    CHECK(log.starts_with("GNDECID9"));
    CHECK(contains(log, "lamp"));
    size = 10;
    CHECK(gnGetDecisionLog(host.context, host.views[0], 0, 1, &size, log.data()) == GN_INCOMPLETE);
    CHECK(gnGetDecisionLog(host.context, host.views[0], 272, 1, &size, nullptr) == GN_ERROR_OUT_OF_RANGE);
    CHECK(gnGetDecisionLog(host.context, host.views[0], 0, 100, &size, nullptr) == GN_ERROR_OUT_OF_RANGE);
}
