// The window as somebody uses it: keys and mouse by xdotool, and what the X server then shows, at the scale that
// GNOMON_WINDOW_TEST says.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "demo/io/png.hpp"
#include "demo/program/session.hpp"
#include "x_server.hpp"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace gnomon::demo {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

uint32_t displayScale()
{
    return std::string_view(serverPurpose()) == "2" ? 2 : 1;
}

/// What the server shows.
class Screen {
public:
    Screen() : display_(XOpenDisplay(nullptr), &XCloseDisplay) { REQUIRE(display_); }

    /// As desktops say it, before a program starts.
    void setDotsPerInch(uint32_t dots)
    {
        const std::string resource = "Xft.dpi: " + std::to_string(dots) + "\n";
        XChangeProperty(display_.get(), root(), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(resource.data()), int(resource.size()));
        XSync(display_.get(), False);
    }

    Image8 picture(uint32_t width, uint32_t height)
    {
        using UniqueImage = std::unique_ptr<XImage, int (*)(XImage*)>;
        const UniqueImage image(XGetImage(display_.get(), root(), 0, 0, width, height, AllPlanes, ZPixmap),
                                [](XImage* it) { return XDestroyImage(it); });
        REQUIRE(image);
        Image8 out(width, height, 3);
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const unsigned long pixel = XGetPixel(image.get(), int(x), int(y));
                for (int channel = 0; channel < 3; ++channel)
                    out.at(x, y)[channel] = uint8_t(pixel >> (16 - 8 * channel));
            }
        return out;
    }

private:
    ::Window root() const { return DefaultRootWindow(display_.get()); }
    std::unique_ptr<::Display, int (*)(::Display*)> display_;
};

/// A program in a folder of its own, told to end when this goes.
class Program {
public:
    Program(const std::string& arguments, const fs::path& folder)
    {
        const std::string command =
            "cd '" + folder.string() + "' && exec '" GNOMON_PROGRAM "' " + arguments + " >said.txt 2>&1";
        pid_ = fork();
        if (pid_ == 0) {
            execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            _exit(127);
        }
    }
    ~Program()
    {
        if (pid_ <= 0) return;
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    /// Its exit code once it has ended by itself.
    int wait()
    {
        int status = 0;
        waitpid(std::exchange(pid_, -1), &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

private:
    pid_t pid_ = -1;
};

std::string xdotool(const std::string& arguments)
{
    FILE* const pipe = popen(("xdotool " + arguments).c_str(), "r");
    REQUIRE(pipe != nullptr);
    std::string out;
    char text[4096];
    while (fgets(text, sizeof text, pipe))
        out += text;
    pclose(pipe);
    while (!out.empty() && out.back() == '\n')
        out.pop_back();
    return out;
}

/// A software device draws some frames a second; a minute is for a machine that does other things.
template <typename Condition>
bool eventually(Condition&& condition)
{
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (std::chrono::steady_clock::now() < end) {
        if (condition()) return true;
        std::this_thread::sleep_for(100ms);
    }
    return false;
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

/// The share of pixels that are clearly different.
double differing(const Image8& a, const Image8& b)
{
    size_t found = 0;
    for (size_t i = 0; i < a.texels.size(); i += 3)
        found += std::abs(int(a.texels[i]) - int(b.texels[i])) > 8;
    return 3.0 * double(found) / double(a.texels.size());
}

/// The uppermost run of pixels as wide as a button; nothing: there is none.
std::optional<Rect> firstButton(const Image8& picture, uint32_t side)
{
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0, run = 0; x < picture.width; ++x) {
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

/// The first method in the panel's list that the light may be given and does not have, and its place there.
std::pair<uint32_t, std::string> otherMethod(uint32_t lights)
{
    Session session({.scene = "room", .size = {64, 48}, .lights = lights});
    const RuleText rules = valueOf(findRules("default"));
    expect(session.shadows.loadRules(rules.text, rules.name));
    expect(session.shadows.warmUp());
    const CameraState camera = session.camera(0.0);
    session.renderer.draw({.cameras = {&camera, 1}, .shadows = &session.shadows});
    session.renderer.waitForFrame(1);
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

} // namespace

TEST_CASE("the window shows the scene and a readable panel, and does what keys and mouse ask for")
{
    constexpr uint32_t lights = 3;
    const uint32_t scale = displayScale(), width = 1280, height = 720;
    const std::pair<uint32_t, std::string> other = otherMethod(lights);
    const uint32_t place = other.first;
    const std::string& method = other.second;
    const fs::path folder = fs::temp_directory_path() / ("gnomon_window_drive_" + std::to_string(scale));
    fs::remove_all(folder);
    fs::create_directories(folder);
    Screen screen;
    screen.setDotsPerInch(96 * scale);
    Program program("run room --lights 3 --window --size " + std::to_string(width) + "x" + std::to_string(height),
                    folder);
    const auto shown = [&] { return screen.picture(width, height); };
    const auto keep = [&](const char* name) { REQUIRE(writePng(folder / name, shown())); };

    const std::string window = xdotool("search --sync --onlyvisible --name '^gnomon  room'");
    REQUIRE(!window.empty());
    xdotool("windowmove --sync " + window + " 0 0 windowfocus --sync " + window);
    const auto press = [&](const std::string& key) { xdotool("key " + key); };
    CHECK(eventually([&] { return colours(shown()) > 1000 && count(shown(), isTitle) > 4000 * scale * scale; }));

    // Readable: letters of 9 pixels and more at 96 dots an inch, and in proportion.
    const uint32_t rows = letterRows(shown());
    CHECK(rows >= 9 * scale);
    CHECK(rows <= 20 * scale);
    keep("panel.png");

    // The method is another one once it was chosen in the panel, by the window's own title.
    const auto title = [&] { return xdotool("getwindowname " + window); };
    CHECK(title().find("[spot1: " + method + "]") == std::string::npos);
    if (scale == 1) {
        const uint32_t side = 20; // of a combo box: letters of 14 and ImGui's 3 above and below
        std::optional<Rect> arrow; // once a frame has lights
        REQUIRE(eventually([&] { return (arrow = firstButton(shown(), side)).has_value(); }));
        const auto click = [&](int32_t x, int32_t y) {
            xdotool("mousemove --sync " + std::to_string(x) + " " + std::to_string(y) +
                    " sleep 0.5 mousedown 1 sleep 0.5 mouseup 1 sleep 1");
        };
        click(arrow->x + int32_t(side) / 2, arrow->y + int32_t(side) / 2);
        keep("open.png");
        const auto lines = int32_t(1 + place);                          // behind "by the rules"
        click(arrow->x, arrow->y + int32_t(side) + 8 + 18 * lines + 8); // letters of 14, 4 between, a padding of 8
    } else {
        press(std::to_string(place + 1)); // the list that the window prints is in the same order
    }
    CHECK_MESSAGE(eventually([&] { return title().find("[spot1: " + method + "]") != std::string::npos; }), title());
    press("0"); // back to the rules
    CHECK(eventually([&] { return title().find("[spot1: " + method + "]") == std::string::npos; }));
    press("Tab");
    CHECK(eventually([&] { return title().find("[point2: ") != std::string::npos; }));
    keep("pinned.png");

    // Paused and without the panel the picture stands still, and the file is what the screen shows.
    press("p");
    press("F1");
    CHECK(eventually([&] { return count(shown(), isTitle) < 200 * scale * scale; }));
    CHECK(eventually([&] {
        const Image8 before = shown();
        std::this_thread::sleep_for(1s);
        return shown().texels == before.texels; // fades are over
    }));
    press("F12");
    const fs::path file = folder / "screenshot.png";
    CHECK(eventually([&] { return isWholePng(file); }));
    const Outcome<Image8> saved = readPng(file, 3);
    REQUIRE_MESSAGE(saved, saved.error());
    CHECK(saved->width == width);
    CHECK(saved->texels == shown().texels);

    // It flies forwards, and comes back; the rules may have changed a light's method on the way.
    const Image8 still = shown();
    xdotool("keydown w");
    CHECK(eventually([&] { return differing(shown(), still) > 0.2; }));
    xdotool("keyup w");
    press("c");
    CHECK(eventually([&] { return differing(shown(), still) < 0.02; }));
    press("Escape");
    std::ostringstream said;
    CHECK(program.wait() == 0);
    said << std::ifstream(folder / "said.txt").rdbuf();
    CHECK_MESSAGE(said.str().find("switches") != std::string::npos, said.str()); // its summary
    if (!std::getenv("GNOMON_KEEP_PICTURES")) fs::remove_all(folder);
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
