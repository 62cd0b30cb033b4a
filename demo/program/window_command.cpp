// `gnomon run SCENE --window`.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "demo/host/window.hpp"
#include "demo/io/number.hpp"
#include "demo/io/png.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/decision_log.hpp"
#include "demo/program/frame_log.hpp"
#include "demo/program/pictures.hpp"
#include "demo/program/rule_watch.hpp"
#include "demo/program/session.hpp"
#if GNOMON_WITH_IMGUI
#include "demo/program/window_panel.hpp"
#endif

namespace gnomon::demo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMetresPerSecond = 4.0, kFastFactor = 4.0;
constexpr double kRadiansPerPixel = 0.004; // half a turn over 800 pixels
constexpr const char* kHelp =
    "keys: W A S D Q E move (shift: fast), right mouse button looks around, C scripted camera,\n"
    "      Tab next light, 1-9 pin a method on it, 0 hand it back to the rules, Y why it has its method,\n"
    "      X what would change that, P pause,\n"
    "      F1 panel (where this build has one), F12 screenshot.png, Esc quits\n";

/// Follows the scene's camera until the first key, then flies.
class FlyCamera {
public:
    CameraState update(Window& window, const CameraState& scripted, double seconds)
    {
        double dx = 0.0, dy = 0.0;
        const bool looked = window.dragging(dx, dy);
        glm::dvec3 move(0.0);
        const auto axis = [&](int plus, int minus) { return double(window.held(plus)) - double(window.held(minus)); };
        move.x = axis(GLFW_KEY_D, GLFW_KEY_A);
        move.y = axis(GLFW_KEY_E, GLFW_KEY_Q);
        move.z = axis(GLFW_KEY_W, GLFW_KEY_S);
        if (!flying_ && (looked || move != glm::dvec3(0.0))) takeOver(scripted);
        if (!flying_) return scripted;
        yaw_ -= dx * kRadiansPerPixel;
        pitch_ = std::clamp(pitch_ - dy * kRadiansPerPixel, -1.5, 1.5); // short of straight up and down
        const glm::dvec3 forward(-std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_),
                                 -std::cos(yaw_) * std::cos(pitch_));
        const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.0, 1.0, 0.0)));
        const double step = seconds * kMetresPerSecond * (window.held(GLFW_KEY_LEFT_SHIFT) ? kFastFactor : 1.0);
        eye_ += step * (move.x * right + move.y * glm::dvec3(0.0, 1.0, 0.0) + move.z * forward);
        CameraState camera = scripted;
        camera.eye = eye_;
        camera.target = eye_ + forward;
        camera.up = glm::cross(right, forward);
        return camera;
    }
    void followScript() { flying_ = false; }
    bool flying() const { return flying_; }

private:
    void takeOver(const CameraState& from)
    {
        flying_ = true;
        eye_ = from.eye;
        const glm::dvec3 forward = from.forward();
        yaw_ = std::atan2(-forward.x, -forward.z);
        pitch_ = std::asin(std::clamp(forward.y, -1.0, 1.0));
    }
    bool flying_ = false;
    glm::dvec3 eye_{0.0};
    double yaw_ = 0.0, pitch_ = 0.0;
};

/// Which light the number keys speak to, and what they do.
class MethodKeys {
public:
    explicit MethodKeys(Session& session) : session_(session)
    {
        for (const GnMethodInfo& method : session.shadows.methods())
            if (!method.pUnavailable) methods_.push_back(method.pName);
        for (size_t i = 0; i < methods_.size() && i < 9; ++i)
            std::printf("  %zu %s\n", i + 1, methods_[i].c_str());
    }
    void press(int key)
    {
        if (session_.scene.lights.empty()) return;
        if (key == GLFW_KEY_TAB)
            selectNext();
        else if (key == GLFW_KEY_Y)
            answer(GN_QUESTION_WHY);
        else if (key == GLFW_KEY_X)
            answer(GN_QUESTION_WHAT_IF);
        else if (key == GLFW_KEY_0)
            show(session_.shadows.pin(light_, ""));
        else if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9 && size_t(key - GLFW_KEY_1) < methods_.size())
            show(session_.shadows.pin(light_, methods_[size_t(key - GLFW_KEY_1)]));
    }
    uint32_t light() const { return light_; }

private:
    /// Of those that are there, in the order of the scene.
    void selectNext()
    {
        const std::vector<uint32_t>& present = session_.renderer.state().present;
        if (present.empty()) return;
        const auto next = std::upper_bound(present.begin(), present.end(), light_);
        light_ = next == present.end() ? present.front() : *next;
    }
    static void show(const Status& status)
    {
        if (!status) std::fprintf(stderr, "%s\n", status.error().c_str());
    }
    /// About the selected light in the newest frame.
    void answer(GnQuestionKind kind) const
    {
        const ShadowHost& shadows = session_.shadows;
        const GnQuestion question{.kind = kind};
        size_t size = 0;
        std::string text;
        GnResult result =
            gnExplain(shadows.context(), shadows.view(0), shadows.light(light_), &question, &size, nullptr);
        if (result >= 0) {
            text.resize(size);
            result =
                gnExplain(shadows.context(), shadows.view(0), shadows.light(light_), &question, &size, text.data());
        }
        if (result >= 0)
            std::printf("%s: %s\n", session_.scene.lights[light_].name.c_str(), text.c_str());
        else
            std::fprintf(stderr, "%s: %s\n", session_.scene.lights[light_].name.c_str(),
                         gnGetLastError(shadows.context()));
    }
    Session& session_;
    std::vector<std::string> methods_;
    uint32_t light_ = 0;
};

std::string titleFor(const Session& session, const FrameLog& log, double fps, uint32_t selected)
{
    std::string title = "gnomon  " + session.scene.name + "  ";
    appendFixed(title, fps, 1);
    title += " fps ";
    for (const FrameLog::LightLine& line : log.newest()) {
        const bool isSelected =
            selected < session.scene.lights.size() && line.light == session.scene.lights[selected].name;
        title += isSelected ? "  [" + line.light + ": " + line.method + "]" : "  " + line.light + ": " + line.method;
    }
    return title;
}

/// Sizes for the test: each differs from the one before in both sides, some larger, some smaller, one a sliver.
VkExtent2D testSize(uint32_t step)
{
    return {160 + step * 53 % 480, step == 7 ? 33 : 120 + step * 37 % 360};
}

/// What the window shows, frame by frame, and what its keys do.
class WindowRun {
public:
    WindowRun(const RunOptions& options, Session& session, RuleWatch& rules)
        : options_(options), session_(session), rules_(rules),
          window_(session.device, session.renderer.extent(), "gnomon", options.framesInFlight),
#if GNOMON_WITH_IMGUI
          panel_(session, window_, options.framesInFlight),
#endif
          keys_(session), log_(session.scene), duration_(frameTime(session.scene, session.scene.frames))
    {
        if (options.frames > 0)
            lastFrame_ = options.frames;
        else if (options.resizeTest > 0)
            lastFrame_ = options.resizeTest * 3 + 12;
    }

    void untilClosed()
    {
        while (!window_.closed()) {
            window_.pollEvents();
            rules_.poll(session_.shadows, [&] { decisions_.collect(session_.shadows); }); // under those that made them
            const Clock::time_point now = Clock::now();
            const double seconds = std::chrono::duration<double>(now - last_).count();
            last_ = now;
            takeKeys();
            if (draw(seconds)) afterFrame(seconds);
        }
        if (!options_.screenshot.empty()) expect(writePng(options_.screenshot, session_.renderer.readColour()));
        window_.finish();
    }

    void print(const std::vector<WhyQuestion>& questions)
    {
        decisions_.collect(session_.shadows);
        std::printf("%s", log_.summaryText().c_str());
        printAnswers(decisions_, questions);
    }

private:
    void takeKeys()
    {
        for (const int key : window_.takePressedKeys()) {
            keys_.press(key);
            if (key == GLFW_KEY_ESCAPE) window_.close();
            if (key == GLFW_KEY_P) paused_ = !paused_;
            if (key == GLFW_KEY_F12) screenshot_ = true;
            if (key == GLFW_KEY_F1) hasPanel_ = !hasPanel_;
            if (key == GLFW_KEY_C) fly_.followScript();
        }
    }

    /// False: the window has nothing to draw to.
    bool draw(double seconds)
    {
        const double before = time_;
        if (!paused_) time_ = std::fmod(time_ + seconds, duration_);
        const CameraState camera = fly_.update(window_, session_.camera(time_), seconds);
        const bool cut = !fly_.flying() && (time_ < before || cameraCutsBetween(session_.scene, before, time_));
        return window_.frame([&](const PresentTarget& target) {
            session_.renderer.resize(target.extent);
            session_.renderer.draw({.time = time_,
                                    .cameras = {&camera, 1},
                                    .shadows = &session_.shadows,
                                    .recorded = options_.recorded,
                                    .budgetMs = options_.budgetMs,
                                    .cameraCut = cut,
                                    .present = &target,
                                    .overlay = overlay()});
        });
    }

    std::function<void(VkCommandBuffer, const Image&)> overlay()
    {
#if GNOMON_WITH_IMGUI
        if (hasPanel_) return [this](VkCommandBuffer cmd, const Image& picture) { panel_.draw(cmd, picture); };
#endif
        return {};
    }

    void afterFrame(double seconds)
    {
        log_.add(frame_, time_, session_.renderer.state(), session_.shadows);
        decisions_.frame(session_.shadows, session_.shadows.stats().frame);
        log_.finish(seconds * 1000.0);
        smoothedMs_ = frame_ < 2 ? seconds * 1000.0 : 0.9 * smoothedMs_ + 0.1 * seconds * 1000.0; // some ten frames
        if (frame_++ % 10 == 0)
            window_.setTitle(titleFor(session_, log_, smoothedMs_ > 0.0 ? 1000.0 / smoothedMs_ : 0.0, keys_.light()));
        if (std::exchange(screenshot_, false)) takeScreenshot();
        for (const std::string& message : session_.shadows.takeMessages())
            std::fprintf(stderr, "gnomon: %s\n", message.c_str());
        if (options_.resizeTest > 0 && frame_ % 3 == 0 && resizes_++ < options_.resizeTest)
            window_.setSize(resizes_ < options_.resizeTest ? testSize(resizes_) : VkExtent2D{640, 360});
        if (lastFrame_ > 0 && frame_ >= lastFrame_) window_.close();
    }

    /// A folder that cannot be written ends no run.
    void takeScreenshot()
    {
        if (const Status saved = writePng("screenshot.png", session_.renderer.readColour()); !saved)
            std::fprintf(stderr, "gnomon: %s\n", saved.error().c_str());
    }

    const RunOptions& options_;
    Session& session_;
    RuleWatch& rules_;
    Window window_;
#if GNOMON_WITH_IMGUI
    WindowPanel panel_;
#endif
    bool hasPanel_ = true;
    MethodKeys keys_;
    FlyCamera fly_;
    FrameLog log_;
    DecisionCollector decisions_;
    double duration_, time_ = 0.0, smoothedMs_ = 0.0; ///< Seconds of the scene, twice.
    bool paused_ = false, screenshot_ = false;
    uint32_t frame_ = 0, resizes_ = 0;
    uint32_t lastFrame_ = 0; ///< 0: none but the user's.
    Clock::time_point last_ = Clock::now();
};

} // namespace

int windowCommand(const RunOptions& options)
{
    if (options.recorded) requireRecordable(options.method);
    const std::vector<WhyQuestion> questions = parseQuestions(options.why);
    requireAnswers(questions, options);
    requireWritable(options.screenshot);
    const WindowSystem system;
    SessionOptions sessionOptions = demo::sessionOptions(options);
    sessionOptions.instanceExtensions = system.instanceExtensions();
    Session session(sessionOptions);
    RuleWatch watch(options.rules); // before they are read: a change from now on is one
    const RuleText rules = valueOf(findRules(options.rules));
    if (!rules.name.empty()) expect(session.shadows.loadRules(rules.text, rules.name, rules.preset));
    if (!options.method.empty()) expect(session.shadows.pinAll(options.method));
    expect(session.shadows.warmUp());

    std::printf("%s", kHelp);
    WindowRun run(options, session, watch);
    run.untilClosed();
    requireSilence(session.device);
    run.print(questions);
    return 0;
}

} // namespace gnomon::demo
