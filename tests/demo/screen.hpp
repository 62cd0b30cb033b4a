#pragma once
// Somebody before a screen: sees what an X server shows, starts a program, and uses keys and mouse by xdotool.

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "demo/io/image.hpp"

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace gnomon::demo {

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
        using OwnedImage = std::unique_ptr<XImage, int (*)(XImage*)>;
        const OwnedImage image(XGetImage(display_.get(), root(), 0, 0, width, height, AllPlanes, ZPixmap),
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
    Program(const std::string& arguments, const std::filesystem::path& folder)
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

inline std::string xdotool(const std::string& arguments)
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
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (std::chrono::steady_clock::now() < end) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

} // namespace gnomon::demo
