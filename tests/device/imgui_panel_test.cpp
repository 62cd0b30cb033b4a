// The panel of gnomon_imgui.h: what it shows is what the C API says, and what is clicked happens.
#include "device/fixture.hpp"
#include "device/imgui_screen.hpp"

#include <algorithm>
#include <limits>

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

    /// What is expected to be wrong of the light's method, in per cent.
    double error(size_t light) const
    {
        uint32_t count = 0;
        host.require(gnGetCandidates(host.context, host.views[0], host.lights[light], &count, nullptr));
        std::vector<GnCandidate> candidates(count);
        host.require(gnGetCandidates(host.context, host.views[0], host.lights[light], &count, candidates.data()));
        const auto chosen = std::find_if(candidates.begin(), candidates.end(), [&](const GnCandidate& candidate) {
            return candidate.pMethod == host.decision(light).pMethod;
        });
        REQUIRE(chosen != candidates.end());
        return (1.0 - double(chosen->quality)) / double(chosen->quality);
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

std::string row(const char* name, const GnDecision& decision, double error, const std::string& reason)
{
    const std::string pinned = decision.reason == GN_REASON_PINNED ? "(pinned)" : "";
    return name + (decision.pMethod + pinned) + number(decision.mapSide != 0, "%.0f", decision.mapSide) +
           number(decision.redrawEvery != 0, "%.0f", decision.redrawEvery) +
           number(true, "%.2f", double(decision.predictedMs)) +
           number(decision.measuredMs > 0.0f, "%.2f", double(decision.measuredMs)) + number(true, "%.2f", error) +
           withoutSpaces(reason);
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
        CHECK(panelled.error(light) > 0.01); // of a map: the column has something to say
        CHECK(panelled.screen.lineWith(name).text ==
              row(name, host.decision(light), panelled.error(light), "pinned by the host"));
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
          row("bulb", host.decision(1), panelled.error(1), "pinned by the host")); // another reason, another row
}

TEST_CASE_FIXTURE(DeviceTest, "a light that changes its method is listed with frame, methods and reason")
{
    Panelled panelled;
    Host& host = panelled.host;
    panelled.frame();
    CHECK(panelled.screen.lineWith("nolighthas").text == "nolighthaschangeditsmethodyet");
    const std::string before = host.decision(0).pMethod, wanted = before == "shadow_map" ? "ray_traced" : "shadow_map";
    host.pin(0, wanted.c_str());
    panelled.frame();
    REQUIRE(host.decision(0).pMethod == wanted);
    const std::string frame = "frame" + std::to_string(host.stats().frame);
    CHECK(panelled.screen.lineWith(frame).text == frame + "lamp:" + before + "->" + wanted + ",pinnedbythehost");
    panelled.frame(); // no change, no line
    host.pin(0, nullptr);
    host.pin(1, "cube_map");
    panelled.frame();
    uint32_t listed = 0;
    for (const ImguiScreen::Line& line : panelled.screen.lines())
        listed += line.text.starts_with("frame");
    CHECK(listed >= 2);
    CHECK(listed <= 3); // the bulb may have had a cube map before
}

TEST_CASE_FIXTURE(DeviceTest, "a fact is drawn with its value and how far it belongs to each term")
{
    Panelled panelled;
    Host& host = panelled.host;
    panelled.frame();
    uint32_t count = 0;
    host.require(gnGetFacts(host.context, host.views[0], host.lights[0], &count, nullptr));
    std::vector<GnFact> facts(count);
    host.require(gnGetFacts(host.context, host.views[0], host.lights[0], &count, facts.data()));
    const auto known = std::find_if(facts.begin(), facts.end(), [](const GnFact& fact) { return fact.value > 0.0; });
    REQUIRE(known != facts.end());
    const std::string name = known->pName;
    const double value = known->value;
    // A flank from half the value to three times it, and the other one falls where it rises: 0.2 and 0.8.
    constexpr double infinite = std::numeric_limits<double>::infinity();
    panelled.panel.setVariables({{name,
                                  0.0,
                                  10.0 * value,
                                  {{"near", -infinite, -infinite, 0.5 * value, 3.0 * value},
                                   {"far", 0.5 * value, 3.0 * value, infinite, infinite}}}});
    if (known != facts.begin()) { // which is shown
        const ImguiScreen::Line line = panelled.screen.lineWith(facts[0].pName);
        panelled.screen.click(line, facts[0].pName);
        panelled.screen.click(panelled.screen.lineWith(name), name);
    }
    panelled.screen.settle();
    char text[64];
    std::snprintf(text, sizeof text, "%.3g%s", value, known->pUnit);
    CHECK(panelled.screen.lineWith(name).text == name + "oflampis" + withoutSpaces(text));
    CHECK(panelled.screen.lineWith("near0").text == "near0.80far0.20");
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
