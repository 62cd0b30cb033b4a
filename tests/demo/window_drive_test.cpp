// The window as somebody uses it: keys and mouse by xdotool, and what the X server then shows, at the scale that
// GNOMON_WINDOW_TEST says.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "demo/io/png.hpp"
#include "demo/program/session.hpp"
#include "own_folder.hpp"
#include "screen.hpp" // X11's macros come last
#include "x_server.hpp"

namespace gnomon::demo {
namespace {

using namespace std::chrono_literals;

uint32_t displayScale()
{
    return std::string_view(serverPurpose()) == "2" ? 2 : 1;
}

size_t colours(const Image8& picture)
{
    std::set<uint32_t> found;
    for (size_t i = 0; i < picture.texels.size(); i += 3)
        found.insert(uint32_t(picture.texels[i]) << 16 | picture.texels[i + 1] << 8 | picture.texels[i + 2]);
    return found.size();
}

/// The title of ImGui's window with the focus and without, and the arrow of a combo box over that window: the dark
/// style's colours, of which the last lets the scene shine through.
bool isTitle(const uint8_t* p)
{
    return (p[0] == 41 && p[1] == 74 && p[2] == 122) || (p[0] == 10 && p[1] == 10 && p[2] == 10);
}
bool isArrowButton(const uint8_t* p)
{
    return p[0] >= 34 && p[0] <= 50 && p[1] >= 66 && p[1] <= 82 && p[2] >= 106 && p[2] <= 120;
}

template <typename Is>
size_t count(const Image8& picture, Is&& is)
{
    size_t found = 0;
    for (size_t i = 0; i < picture.texels.size(); i += 3)
        found += is(&picture.texels[i]);
    return found;
}

/// The uppermost run of pixels as wide as a button in gnomon's panel, at the left; nothing: there is none.
std::optional<Rect> firstButton(const Image8& picture, uint32_t side)
{
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0, run = 0; x < 860; ++x) {
            run = isArrowButton(picture.at(x, y)) ? run + 1 : 0;
            if (run == side * 3 / 4) return Rect{int32_t(x + 1 - run), int32_t(y), side, side};
        }
    return std::nullopt;
}

/// The height of letters in the panel's title: rows of it that have bright pixels.
uint32_t letterRows(const Image8& picture)
{
    uint32_t rows = 0;
    for (uint32_t y = 0; y < picture.height; ++y) {
        uint32_t first = picture.width, last = 0;
        for (uint32_t x = 0; x < picture.width; ++x)
            if (isTitle(picture.at(x, y))) {
                first = std::min(first, x);
                last = x;
            }
        if (first >= last || last - first < 200) continue;
        bool bright = false;
        for (uint32_t x = first; x < last && !bright; ++x)
            bright = picture.at(x, y)[0] > 180 && picture.at(x, y)[1] > 180;
        rows += bright;
    }
    return rows;
}

/// The room with its second light absent, as a file in a folder.
fs::path withoutSecondLight(const fs::path& folder)
{
    std::ostringstream text;
    text << std::ifstream(GNOMON_SHIPPED_SCENES "/room.yaml").rdbuf();
    std::string scene = text.str();
    const size_t light = scene.find("name: point2, ");
    REQUIRE(light != std::string::npos);
    scene.insert(light, "appear: 100, "); // seconds, of four
    std::ofstream(folder / "room.yaml") << scene;
    return folder / "room.yaml";
}

/// The first method in the panel's list that the first light may be given and does not have, and its place there.
std::pair<uint32_t, std::string> otherMethod(const fs::path& scene, uint32_t lights)
{
    Session session({.scene = scene.string(), .size = {64, 48}, .lights = lights});
    const RuleText rules = valueOf(findRules("default"));
    expect(session.shadows.loadRules(rules.text, rules.name));
    expect(session.shadows.warmUp());
    const CameraState camera = session.camera(0.0);
    session.renderer.draw({.cameras = {&camera, 1}, .shadows = &session.shadows});
    session.renderer.waitForFrame(1);
    REQUIRE(session.renderer.state().present == std::vector<uint32_t>{0, 2});
    uint32_t size = 0;
    const auto ask = [&](GnCandidate* into) {
        return gnGetCandidates(session.shadows.context(), session.shadows.view(0), session.shadows.light(0), &size,
                               into);
    };
    REQUIRE(ask(nullptr) >= 0);
    std::vector<GnCandidate> candidates(size);
    REQUIRE(ask(candidates.data()) >= 0);
    for (uint32_t i = 0; i < size; ++i)
        if (candidates[i].elimination != GN_ELIMINATION_UNABLE && candidates[i].elimination != GN_ELIMINATION_NONE)
            return {i, candidates[i].pMethod};
    FAIL("one method is all there is");
    return {};
}

constexpr uint32_t kWidth = 1280, kHeight = 720;

/// The program at work, and somebody before it.
struct Driven {
    Driven()
    {
        scene = withoutSecondLight(folder);
        other = otherMethod(scene, 3);
        screen.setDotsPerInch(96 * scale);
        program.emplace("window room.yaml --lights 3 --size " + std::to_string(kWidth) + "x" + std::to_string(kHeight),
                        folder);
        window = xdotool("search --sync --onlyvisible --name '^gnomon  room'");
        REQUIRE(!window.empty());
        xdotool("windowmove --sync " + window + " 0 0 windowfocus --sync " + window);
    }
    Image8 shown() { return screen.picture(kWidth, kHeight); }
    void keep(const char* name) { REQUIRE(writePng(folder / name, shown())); }
    static void press(const std::string& key) { xdotool("key " + key); }
    std::string title() const { return xdotool("getwindowname " + window); }
    bool titleSays(const std::string& text) const
    {
        return eventually([&] { return title().find(text) != std::string::npos; });
    }
    /// As slowly as a software device sees it. \param between what happens while the button is down.
    static void mouse(int32_t x, int32_t y, int button, const std::string& between = "")
    {
        const std::string number = std::to_string(button);
        xdotool("mousemove --sync " + std::to_string(x) + " " + std::to_string(y) + " sleep 1 mousedown " + number +
                " sleep 1 " + between + " mouseup " + number + " sleep 1");
    }
    /// The milliseconds that the title gives to shadows; 0: no budget.
    double budget() const
    {
        const std::string text = title();
        const size_t of = text.find(" of ");
        return of == std::string::npos ? 0.0 : std::atof(text.c_str() + of + 4);
    }

    const uint32_t scale = displayScale();
    const Folder own{"window_drive"}; // its pictures and what the program says
    const fs::path& folder = own.path;
    fs::path scene;
    std::pair<uint32_t, std::string> other;
    Screen screen;
    std::optional<Program> program;
    std::string window;
};

/// The share of pixels in columns [left, right) and rows from `top` on that are clearly different.
double differing(const Image8& a, const Image8& b, uint32_t left, uint32_t right, uint32_t top = 0)
{
    size_t found = 0;
    for (uint32_t y = top; y < a.height; ++y)
        for (uint32_t x = left; x < right; ++x) {
            int most = 0;
            for (int channel = 0; channel < 3; ++channel)
                most = std::max(most, std::abs(int(a.at(x, y)[channel]) - int(b.at(x, y)[channel])));
            found += most > 8;
        }
    return double(found) / (double(right - left) * (a.height - top));
}
double differing(const Image8& a, const Image8& b)
{
    return differing(a, b, 0, a.width);
}

/// Letters of 9 pixels and more at 96 dots an inch, and in proportion.
void seeReadablePanel(Driven& it)
{
    const uint32_t scale = it.scale;
    CHECK(eventually([&] { return colours(it.shown()) > 1000 && count(it.shown(), isTitle) > 4000 * scale * scale; }));
    const uint32_t rows = letterRows(it.shown());
    CHECK(rows >= 9 * scale);
    CHECK(rows <= 20 * scale);
    it.keep("panel.png");
}

/// Moves the mouse with a button down, until that has come to something: a slow frame sees nothing of what is over.
template <typename Condition>
bool dragged(int32_t x, int32_t y, int button, const std::string& move, Condition&& condition)
{
    for (int attempt = 0; attempt < 3; ++attempt) {
        Driven::mouse(x, y, button, move + " sleep 1");
        if (eventually(condition)) return true;
    }
    return false;
}

/// Opens the first combo box and clicks the line. A frame that takes longer than a button is down sees no click.
void clickLine(Driven& it, int32_t line)
{
    const int32_t side = 20;   // of a combo box: letters of 14 and ImGui's 3 above and below
    std::optional<Rect> arrow; // once a frame has lights
    REQUIRE(eventually([&] { return (arrow = firstButton(it.shown(), uint32_t(side))).has_value(); }));
    Driven::mouse(arrow->x + side / 2, arrow->y + side / 2, 1);
    it.keep("open.png");
    // Letters of 14, 4 between, a padding of 8.
    Driven::mouse(arrow->x, arrow->y + side + 8 + 18 * line + 8, 1);
}

/// A method by the panel's combo box, or by its key, and back.
void pinMethod(Driven& it)
{
    const uint32_t place = it.other.first;
    const std::string& method = it.other.second;
    CHECK(it.title().find("[spot1: " + method + "]") == std::string::npos);
    bool pinned = false;
    for (int attempt = 0; attempt < 3 && !pinned; ++attempt) {
        if (it.scale == 1) {
            if (attempt > 0) Driven::mouse(int32_t(kWidth) - 40, int32_t(kHeight) - 40, 1); // closes an open list
            clickLine(it, int32_t(1 + place));                                              // behind "by the rules"
        } else {
            Driven::press(std::to_string(place + 1)); // the list that the window prints is in the same order
        }
        pinned = it.titleSays("[spot1: " + method + "]");
    }
    CHECK_MESSAGE(pinned, it.title() << ", line " << place << " for " << method);
    Driven::press("0"); // back to the rules
    CHECK(eventually([&] { return it.title().find("[spot1: " + method + "]") == std::string::npos; }));
    it.keep("switched.png");
}

/// The budget's slider stands at the top right. Digits that are typed there pin no method.
void moveBudget(Driven& it)
{
    const int32_t x = 1036, y = 48; // the middle of the slider
    CHECK(it.budget() == 0.0);
    xdotool("keydown ctrl");
    Driven::mouse(x, y, 1);
    const std::string typed = std::to_string(it.other.first + 1) + "5"; // the key of a method that it does not have
    xdotool("keyup ctrl sleep 0.5 type --delay 500 " + typed);
    xdotool("sleep 1 keydown Return sleep 1 keyup Return sleep 1"); // ImGui sees what is down while it draws
    CHECK_MESSAGE(it.titleSays(" of " + typed + ".0 ms"), it.title());
    CHECK(it.title().find("[spot1: " + it.other.second + "]") == std::string::npos);
    it.keep("budget.png");
    CHECK_MESSAGE(dragged(x, y, 1, "mousemove_relative 80 0", [&] { return it.budget() > 150.0; }), it.title());
    it.keep("more.png");
}

/// The right mouse button looks around over the picture, not over the panel.
void lookAround(Driven& it, const Image8& still)
{
    const auto turned = [&] { return differing(it.shown(), still) > 0.2; };
    CHECK(dragged(640, 400, 3, "mousemove_relative 100 0", turned));
    Driven::press("c");
    CHECK(eventually([&] { return differing(it.shown(), still) < 0.02; }));
    Driven::press("F1");
    CHECK(eventually([&] { return count(it.shown(), isTitle) > 4000 * it.scale * it.scale; }));
    Driven::mouse(300, 300, 3, "mousemove_relative 100 0 sleep 1");
    CHECK(differing(it.shown(), still, 0, kWidth, kHeight - 40) < 0.02); // under the panel
    Driven::press("F1");
    CHECK(eventually([&] { return differing(it.shown(), still) < 0.02; }));
}

/// Colours by method, and the picture by `ray_traced`, which has none, right of a line that the mouse moves.
void tintAndSplit(Driven& it, const Image8& still)
{
    Driven::press("t");
    CHECK(eventually([&] { return differing(it.shown(), still) > 0.2; }));
    const Image8 tinted = it.shown();
    Driven::press("v");
    CHECK(eventually([&] { return differing(it.shown(), still, kWidth / 2, kWidth) < 0.03; }));
    CHECK(differing(it.shown(), tinted, 0, kWidth / 2) < 0.02);
    it.keep("split.png");
    const auto moved = [&] { return differing(it.shown(), still, kWidth / 4 + 4, kWidth) < 0.03; };
    CHECK(dragged(960, 400, 1, "mousemove_relative -- -640 0", moved));
    CHECK(differing(it.shown(), tinted, 0, kWidth / 4 - 4) < 0.02);
    Driven::press("v");
    Driven::press("t");
    CHECK(eventually([&] { return differing(it.shown(), tinted, 0, kWidth / 4) > 0.2; })); // by cadence: other colours
    Driven::press("t");
    CHECK(eventually([&] { return differing(it.shown(), still) < 0.02; }));
}

/// The share of pixels in columns from `left` on.
template <typename Is>
double share(const Image8& picture, uint32_t left, Is&& is)
{
    size_t found = 0;
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = left; x < picture.width; ++x)
            found += is(picture.at(x, y));
    return double(found) / (double(picture.width - left) * picture.height);
}

/// Errors against `ray_traced` right of the line, and the texels of a map, of a light that has one.
void errorsAndTexels(Driven& it, const Image8& still)
{
    const auto isGrey = [](const uint8_t* p) { return std::abs(p[0] - p[1]) <= 1 && std::abs(p[1] - p[2]) <= 1; };
    const auto isMarked = [](const uint8_t* p) {
        return (p[0] > p[1] + 60 && std::abs(p[1] - p[2]) < 20) || (p[2] > p[1] + 60 && p[1] > p[0]);
    };
    constexpr uint32_t right = kWidth / 2 + 4; // of the line, in its first place too
    Driven::press("1");
    CHECK_MESSAGE(it.titleSays("[spot1: shadow_map]"), it.title());
    Driven::press("f");
    CHECK(eventually([&] {
        const Image8 shown = it.shown();
        const double marked = share(shown, right, isMarked);
        return share(shown, right, isGrey) > 0.9 && marked > 1e-4 && marked < 0.05;
    }));
    CHECK(differing(it.shown(), still, 0, kWidth / 4 - 4) < 0.05); // left of the line the picture as it is
    it.keep("errors.png");
    Driven::press("f");
    CHECK(eventually([&] { return differing(it.shown(), still, right, kWidth) < 0.03; }));
    Driven::press("v");

    Driven::press("m"); // red, white or blue where the map is looked up
    const auto isWidth = [](const uint8_t* p) { return std::max(p[0], p[2]) == 255 && p[1] <= std::min(p[0], p[2]); };
    CHECK(share(still, 0, isWidth) < 0.05);
    CHECK(eventually([&] { return share(it.shown(), 0, isWidth) > 0.1; }));
    it.keep("texels.png");
    Driven::press("m");
    Driven::press("0");
    CHECK(eventually([&] { return differing(it.shown(), still) < 0.02; }));
}

void record(Driven& it)
{
    Driven::press("r");
    CHECK(eventually([&] { return isWholePng(it.folder / "recording_1" / "frame_00001.png"); }));
    Driven::press("r");
    const Outcome<Image8> first = readPng(it.folder / "recording_1" / "frame_00000.png", 3);
    REQUIRE_MESSAGE(first, first.error());
    CHECK(differing(*first, it.shown()) < 0.02); // it stands still; the rules may try a method on a light meanwhile
}

} // namespace

TEST_CASE("the window shows the scene and a readable panel, and does what keys and mouse ask for")
{
    Driven it;
    seeReadablePanel(it);
    pinMethod(it);
    if (it.scale == 1) moveBudget(it);
    Driven::press("Tab"); // the second light is not there
    CHECK_MESSAGE(it.titleSays("[spot3: "), it.title());
    Driven::press("Tab");
    CHECK_MESSAGE(it.titleSays("[spot1: "), it.title());
    CHECK(it.title().find("point2") == std::string::npos);

    // Paused and without the panel the picture stands still, and the file is what the screen shows.
    Driven::press("p");
    Driven::press("F1");
    CHECK(eventually([&] { return count(it.shown(), isTitle) < 200 * it.scale * it.scale; }));
    CHECK(eventually([&] {
        const Image8 before = it.shown();
        std::this_thread::sleep_for(1s);
        return it.shown().texels == before.texels; // fades are over
    }));
    Driven::press("F12");
    const fs::path file = it.folder / "screenshot.png";
    CHECK(eventually([&] { return isWholePng(file); }));
    const Outcome<Image8> saved = readPng(file, 3);
    REQUIRE_MESSAGE(saved, saved.error());
    CHECK(saved->width == kWidth);
    const Image8 still = it.shown();
    CHECK(differing(*saved, still) < 0.02); // as in record()
    if (it.scale == 1) {
        record(it);
        tintAndSplit(it, still);
        errorsAndTexels(it, still);
        lookAround(it, still);
    }

    // It flies forwards, and comes back; the rules may have changed a light's method on the way.
    xdotool("keydown w");
    CHECK(eventually([&] { return differing(it.shown(), still) > 0.2; }));
    xdotool("keyup w");
    Driven::press("c");
    CHECK(eventually([&] { return differing(it.shown(), still) < 0.02; }));
    Driven::press("Escape");
    std::ostringstream said;
    CHECK(it.program->wait() == 0);
    said << std::ifstream(it.folder / "said.txt").rdbuf();
    CHECK_MESSAGE(said.str().find("switches") != std::string::npos, said.str()); // its summary
}

} // namespace gnomon::demo

int main(int argc, char** argv)
{
    using namespace gnomon::demo;
    if (serverPurpose()) return doctest::Context(argc, argv).run();
    if (!canRun("xdotool") || Device::nonePresent()) return 77;
    const int plain = runUnderServer("1280x720", "1", argc, argv);
    return plain != 0 ? plain : runUnderServer("1280x720", "2", argc, argv);
}
