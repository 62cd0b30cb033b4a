// The panel of gnomon_imgui.h: what it shows is what the C API says, and what is clicked happens.
#include "device/fixture.hpp"
#include "device/imgui_screen.hpp"

#include <gnomon/gnomon_imgui.h>

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct Panelled {
    explicit Panelled(const HostOptions& options = {}) : host(twoLights(), options), screen([this] { draw(); })
    {
        host.require(gnLoadShippedRules(host.context, "default"));
    }

    static Scene twoLights()
    {
        Scene scene = smallScene(); // its light is a spot light
        scene.lights.push_back(pointLight("bulb", {1.0, 5.0, 2.0}, true));
        return scene;
    }
    void draw()
    {
        const ImguiLight lights[] = {{host.lights[0], "lamp"}, {host.lights[1], "bulb"}};
        panel.draw(host.context, host.views[0], lights, 2);
    }
    /// A frame of gnomon, then what the screen makes of it.
    void frame(float budgetMs = 0.0f)
    {
        host.require(host.draw(
            {.adjust = [budgetMs](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.budgetMs = budgetMs; }}));
        screen.settle();
    }
    std::string answer(size_t light, GnQuestionKind kind, const char* method = nullptr) const
    {
        const GnQuestion question{.kind = kind, .pMethod = method};
        size_t size = 0;
        host.require(gnExplain(host.context, host.views[0], host.lights[light], &question, &size, nullptr));
        std::string text(size, '\0');
        host.require(gnExplain(host.context, host.views[0], host.lights[light], &question, &size, text.data()));
        text.pop_back();
        return text;
    }
    /// Opens the list of methods of a light and takes one.
    void choose(const char* light, const std::string& text)
    {
        const GnDecision decision = host.decision(light == std::string("lamp") ? 0 : 1);
        screen.click(screen.lineWith(light), decision.pMethod);
        screen.click(screen.lineWith(text), text);
    }

    Host host;
    ImguiPanel panel;
    ImguiScreen screen;
};

std::string number(bool known, const char* format, double value)
{
    char text[32] = "-";
    if (known) std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string row(const char* name, const GnDecision& decision, const std::string& reason)
{
    const std::string pinned = decision.reason == GN_REASON_PINNED ? "(pinned)" : "";
    return name + (decision.pMethod + pinned) + number(decision.mapSide != 0, "%.0f", decision.mapSide) +
           number(decision.redrawEvery != 0, "%.0f", decision.redrawEvery) +
           number(true, "%.2f", double(decision.predictedMs)) +
           number(decision.measuredMs > 0.0f, "%.2f", double(decision.measuredMs)) + withoutSpaces(reason);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "the panel's rows are the decisions of the last frame")
{
    Panelled panelled;
    Host& host = panelled.host;
    host.pin(0, "shadow_map");
    host.pin(1, "cube_map");
    for (int i = 0; i < 4; ++i) // timings come a few frames late
        panelled.frame();
    for (size_t light = 0; light < 2; ++light) {
        const char* name = light == 0 ? "lamp" : "bulb";
        CHECK(host.decision(light).mapSide != 0);
        CHECK(panelled.screen.lineWith(name).text == row(name, host.decision(light), "pinned by the host"));
    }
    for (int i = 0; i < 16 && host.decision(1).measuredMs == 0.0f; ++i) // one frame in eight is timed
        panelled.frame();
    const float predicted = host.decision(0).predictedMs + host.decision(1).predictedMs;
    const float measured = host.decision(0).measuredMs + host.decision(1).measuredMs;
    CHECK(host.decision(0).measuredMs > 0.0f);
    CHECK(host.decision(1).measuredMs > 0.0f);
    CHECK(panelled.screen.lineWith("thisview").text ==
          "thisview" + number(true, "%.2f", double(predicted)) + number(true, "%.2f", double(measured)));
    host.pin(1, nullptr);
    panelled.frame();
    CHECK(panelled.screen.lineWith("bulb").text !=
          row("bulb", host.decision(1), "pinned by the host")); // the reason is another one, so the row is
}

TEST_CASE_FIXTURE(DeviceTest, "a method chosen in the panel is pinned, and the rules get the light back")
{
    Panelled panelled;
    Host& host = panelled.host;
    panelled.frame();
    const std::string byRules = host.decision(0).pMethod;
    CHECK(host.decision(0).reason != GN_REASON_PINNED);
    const std::string wanted = byRules == "shadow_map" ? "ray_traced" : "shadow_map"; // no explanation names it

    panelled.choose("lamp", wanted);
    panelled.frame();
    CHECK(host.decision(0).reason == GN_REASON_PINNED);
    CHECK(host.decision(0).pMethod == wanted);
    CHECK(host.decision(1).reason != GN_REASON_PINNED); // the other light is left alone
    CHECK(panelled.screen.lineWith("lamp").text.starts_with("lamp" + wanted + "(pinned)"));

    panelled.choose("lamp", "bytherules");
    panelled.frame();
    CHECK(host.decision(0).reason != GN_REASON_PINNED);
    CHECK(host.decision(0).pMethod == byRules);
}

TEST_CASE_FIXTURE(DeviceTest, "a method that cannot serve the light is refused in words")
{
    Panelled panelled;
    Host& host = panelled.host;
    panelled.frame();
    const std::string before = host.decision(0).pMethod;
    panelled.choose("lamp", "cube_map"); // for point lights
    const std::string said = host.lastError();
    CHECK(said.find("cube_map") != std::string::npos);
    CHECK(panelled.screen.lineWith("lamp:").text == withoutSpaces("lamp: " + said));
    panelled.frame();
    CHECK(host.decision(0).pMethod == before);
    CHECK(host.decision(0).reason != GN_REASON_PINNED);
    panelled.choose("lamp", "bytherules"); // which is no failure
    CHECK(panelled.screen.lineWith("lamp").text.starts_with("lamp" + before));
    for (const ImguiScreen::Line& line : panelled.screen.lines())
        CHECK(!line.text.starts_with("lamp:"));
}

TEST_CASE_FIXTURE(DeviceTest, "a method under the mouse says why it does not serve")
{
    Panelled panelled;
    panelled.frame();
    panelled.screen.click(panelled.screen.lineWith("bulb"), "bulb"); // selects it
    CHECK(panelled.panel.selected() == 1);
    panelled.screen.hover(panelled.screen.lineWith("mccool"), "mccool"); // in the table of methods
    CHECK(panelled.screen.top() == withoutSpaces(panelled.answer(1, GN_QUESTION_WHY_NOT, "mccool")));
}

TEST_CASE_FIXTURE(DeviceTest, "the rules behind a method stand below with their strengths")
{
    Panelled panelled;
    panelled.frame();
    std::string shown;
    bool below = false;
    for (const ImguiScreen::Line& line : panelled.screen.lines()) {
        if (below) shown += line.text;
        below = below || line.text == "rulesforlamp";
    }
    // A bar beside a rule repeats its strength as a share: "100%".
    const std::string why = panelled.answer(0, GN_QUESTION_WHY);
    INFO(shown);
    size_t rules = 0, at = 0;
    for (size_t begin = 0; begin < why.size();) {
        const size_t end = std::min(why.find('\n', begin), why.size());
        const std::string line = why.substr(begin, end - begin);
        if (const size_t arrow = line.find("-> strength "); arrow != std::string::npos) {
            ++rules;
            const std::string bar = std::to_string(std::lround(100.0 * std::stod(line.substr(arrow + 12)))) + "%";
            CHECK(shown.find(bar, at) == at);
            at += bar.size();
        }
        const std::string text = withoutSpaces(line);
        CHECK_MESSAGE(shown.compare(at, text.size(), text) == 0, line);
        at += text.size();
        begin = end + 1;
    }
    CHECK(rules > 0);
    CHECK(at == shown.size());
}

TEST_CASE_FIXTURE(DeviceTest, "the graph of frames says the newest time and the budget")
{
    Panelled panelled;
    Host& host = panelled.host;
    CHECK(panelled.screen.lineWith("allviews:0.00ms").text == "allviews:0.00ms,nobudget"); // before the first frame
    for (int i = 0; i < 4; ++i)
        panelled.frame(50.0f);
    const GnFrameStats stats = host.stats();
    REQUIRE(stats.gpuFrame != 0);
    const std::string time = number(true, "%.2f", double(stats.gpuMs + stats.gpuFrameCpuMs));
    CHECK(panelled.screen.lineWith("allviews:" + time + "ms").text == "allviews:" + time + "msof50.00ms");
    CHECK(panelled.screen.lineWith("allviews:predicted")
              .text.starts_with("allviews:predicted" + number(true, "%.2f", double(stats.predictedMs)) + "ms,"));
}

TEST_CASE_FIXTURE(DeviceTest, "a light that is in no frame of the view is named as such")
{
    Panelled panelled;
    Host& host = panelled.host;
    const std::vector<GnLight> first{host.lights[0]};
    host.require(host.draw({.lights = &first}));
    panelled.screen.settle();
    CHECK(panelled.screen.lineWith("bulb").text == "bulbnotinthelastframe");
    CHECK(panelled.screen.lineWith("lamp").text.starts_with(std::string("lamp") + host.decision(0).pMethod));
}
