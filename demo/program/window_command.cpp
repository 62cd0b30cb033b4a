// `gnomon window SCENE`, and `gnomon run SCENE --window`.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
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
#include "demo/program/fly_camera.hpp"
#include "demo/program/frame_log.hpp"
#include "demo/program/picture_views.hpp"
#include "demo/program/pictures.hpp"
#include "demo/program/session.hpp"
#include "demo/program/window_rules.hpp"
#include "demo/program/window_settings.hpp"
#include "demo/program/window_split.hpp"
#if GNOMON_WITH_IMGUI
#include "demo/program/window_panel.hpp"
#endif

namespace gnomon::demo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kHelp =
    "keys: W A S D Q E move (shift: fast), right mouse button looks around, C scripted camera,\n"
    "      Tab next light, 1-9 pin a method on it, 0 hand it back to the rules, Y why it has its method,\n"
    "      X what would change that, P pause, T lights in the colours of their methods or cadences,\n"
    "      V splits the picture, right by ray_traced (the left mouse button moves the line),\n"
    "      F shows there what is wrong, M how many pixels wide texels of the selected light's map are,\n"
    "      R records, F1 panel (where this build has one), F12 screenshot.png, Esc quits\n";

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
    title += " fps  ";
    const GnFrameStats stats = session.shadows.stats();
    appendFixed(title, double(stats.gpuMs + stats.gpuFrameCpuMs), 1);
    if (stats.budgetMs > 0.0f) {
        title += " of ";
        appendFixed(title, double(stats.budgetMs), 1);
    }
    title += " ms ";
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
    WindowRun(const RunOptions& options, Session& session, WindowRules& rules, DecisionCollector& decisions)
        : options_(options), session_(session), rules_(rules), decisions_(decisions),
          window_(session.device, session.renderer.extent(), "gnomon", options.framesInFlight),
#if GNOMON_WITH_IMGUI
          panel_(session, window_, options.framesInFlight, settings_, rules),
#endif
          keys_(session), log_(session.scene), duration_(frameTime(session.scene, session.scene.frames))
    {
        settings_.budgetMs = options.budgetMs;
        if (options.frames > 0)
            lastFrame_ = options.frames;
        else if (options.resizeTest > 0)
            lastFrame_ = options.resizeTest * 3 + 12;
    }

    void untilClosed()
    {
        while (!window_.closed()) {
            window_.pollEvents();
            rules_.poll();
            const Clock::time_point now = Clock::now();
            const double seconds = std::chrono::duration<double>(now - last_).count();
            last_ = now;
            takeKeys();
            takeMouse();
            prepareViews();
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
            if (!keysAreOurs()) continue;
            keys_.press(key);
            if (key == GLFW_KEY_ESCAPE) window_.close();
            if (key == GLFW_KEY_P) paused_ = !paused_;
            if (key == GLFW_KEY_F12) screenshot_ = true;
            if (key == GLFW_KEY_F1) hasPanel_ = !hasPanel_;
            if (key == GLFW_KEY_C) fly_.followScript();
            if (key == GLFW_KEY_T) settings_.tint = Tint((int(settings_.tint) + 1) % kTints);
            if (key == GLFW_KEY_V) settings_.split = !settings_.split;
            if (key == GLFW_KEY_F) toggleErrors();
            if (key == GLFW_KEY_M) settings_.texels = !settings_.texels;
            if (key == GLFW_KEY_R) settings_.recording = !settings_.recording;
        }
    }

    /// Where the picture is not split, it is then.
    void toggleErrors()
    {
        settings_.errors = !settings_.split || !settings_.errors;
        settings_.split = true;
    }

    /// Not the panel's.
    bool keysAreOurs() const
    {
#if GNOMON_WITH_IMGUI
        return !hasPanel_ || !panel_.wantsKeys();
#else
        return true;
#endif
    }
    bool mouseIsOurs() const
    {
#if GNOMON_WITH_IMGUI
        return !hasPanel_ || !panel_.wantsMouse();
#else
        return true;
#endif
    }

    void takeMouse()
    {
        if (const auto x = window_.pressedAt(); x && settings_.split && mouseIsOurs()) settings_.divider = *x;
    }

    /// Made when they are first asked for: the split has a context of its own.
    void prepareViews()
    {
        if (settings_.texels && !texels_) texels_.emplace(session_.device, session_.renderer);
        if (!settings_.split) return;
        try {
            if (!split_) split_.emplace(session_, options_);
            if (settings_.errors) split_->prepareErrors();
        } catch (const HostError& error) {
            settings_.split = settings_.errors = false;
            say(std::string("no split picture: ") + error.what());
        }
    }

    void say(const std::string& notice)
    {
        std::fprintf(stderr, "gnomon: %s\n", notice.c_str());
        settings_.notice = notice;
    }

    /// False: the window has nothing to draw to.
    bool draw(double seconds)
    {
        const double before = time_;
        if (!paused_) time_ = std::fmod(time_ + seconds, duration_);
        const CameraState camera = fly_.update(window_, session_.camera(time_), seconds, keysAreOurs(), mouseIsOurs());
        const bool cut = !fly_.flying() && (time_ < before || cameraCutsBetween(session_.scene, before, time_));
        return window_.frame([&](const PresentTarget& target) {
            session_.renderer.resize(target.extent);
            if (settings_.split) split_->draw(time_, camera, target.extent);
            session_.renderer.draw({.time = time_,
                                    .cameras = {&camera, 1},
                                    .shadows = &session_.shadows,
                                    .recorded = options_.recorded,
                                    .budgetMs = settings_.budgetMs,
                                    .cameraCut = cut,
                                    .lightColours = tints_,
                                    .present = &target,
                                    .overlay = overlay()});
        });
    }

    std::function<void(VkCommandBuffer, const Image&)> overlay()
    {
        return [this](VkCommandBuffer cmd, const Image& picture) {
            if (settings_.texels) drawTexels(cmd);
            if (settings_.split && settings_.errors)
                split_->showErrors(cmd, settings_.divider);
            else if (settings_.split)
                split_->show(cmd, picture, settings_.divider);
#if GNOMON_WITH_IMGUI
            if (hasPanel_) panel_.draw(cmd, picture);
#endif
        };
    }

    /// Of the selected light, where it is there and its method has a map.
    void drawTexels(VkCommandBuffer cmd)
    {
        const std::vector<uint32_t>& present = session_.renderer.state().present;
        const auto place = std::find(present.begin(), present.end(), keys_.light());
        GnLightMap map{GN_INIT(GnLightMap)};
        noMap_.clear();
        if (place == present.end())
            noMap_ = "the selected light is not there";
        else if (gnGetLightMap(session_.shadows.context(), session_.shadows.light(*place), &map) < 0)
            noMap_ = gnGetLastError(session_.shadows.context());
        else
            texels_->record(cmd, session_.renderer, map, static_cast<uint32_t>(place - present.begin()));
    }

    /// What the colours say that are no lights'.
    void addLegend()
    {
        std::vector<WindowSettings::LegendLine>& legend = settings_.legend;
        if (settings_.texels && !noMap_.empty()) {
            legend.push_back({noMap_, {}});
        } else if (settings_.texels) {
            legend.push_back({"texels are 8 pixels wide, or more", {255, 0, 0}});
            legend.push_back({"as wide as a pixel", {255, 255, 255}});
            legend.push_back({"an eighth of that, or less", {0, 0, 255}});
            legend.push_back({"no map is looked up", {40, 40, 40}});
        }
        settings_.wrongPercent.reset();
        if (!settings_.split || !settings_.errors) return;
        settings_.wrongPercent = split_->wrongPercent();
        legend.push_back({"lit by mistake", kFalseLit});
        legend.push_back({"dark by mistake", kFalseShadow});
    }

    /// Of the next frame's lights: what serves them is known when a frame is recorded.
    void tint()
    {
        tints_.clear();
        settings_.legend.clear();
        if (settings_.tint == Tint::none) return;
        const SceneState& state = session_.renderer.state();
        tintByMethod(session_.scene, state, log_.newest(), tints_);
        for (size_t i = 0; i < state.present.size() && i < log_.newest().size(); ++i) {
            WindowSettings::LegendLine line{log_.newest()[i].method, methodColour(log_.newest()[i].method)};
            if (settings_.tint == Tint::cadence) {
                line = cadenceOf(state.present[i]);
                tints_[state.present[i]] = lightTint(line.colour, session_.scene.lights[state.present[i]]);
            }
            const auto same = [&](const WindowSettings::LegendLine& known) { return known.text == line.text; };
            if (std::none_of(settings_.legend.begin(), settings_.legend.end(), same))
                settings_.legend.push_back(std::move(line));
        }
    }

    WindowSettings::LegendLine cadenceOf(uint32_t light) const
    {
        GnDecision decision{};
        gnGetDecision(session_.shadows.context(), session_.shadows.view(0), session_.shadows.light(light), &decision);
        const uint32_t every = decision.redrawEvery;
        if (every == 0) return {"no map, or drawn when something moves", {160, 160, 160}};
        return {every == 1 ? "drawn every frame" : "drawn every " + std::to_string(every) + " frames",
                seriesColour(size_t(std::bit_width(every)) - 1)};
    }

    /// Each frame as the window shows it, numbered, in a folder that was not there before.
    void record()
    {
        namespace fs = std::filesystem;
        if (!settings_.recording) {
            recording_.clear();
            return;
        }
        std::error_code error;
        if (recording_.empty()) {
            recorded_ = 0;
            for (uint32_t number = 1; recording_.empty() || fs::exists(recording_, error); ++number)
                recording_ = "recording_" + std::to_string(number);
            fs::create_directory(recording_, error);
            say("recording to " + fs::absolute(recording_, error).string());
        }
        char name[32];
        std::snprintf(name, sizeof name, "frame_%05u.png", recorded_++);
        if (const Status saved = writePng(recording_ / name, session_.renderer.readColour()); !saved) {
            settings_.recording = false;
            say(saved.error());
        }
    }

    void afterFrame(double seconds)
    {
        log_.add(frame_, time_, session_.renderer.state(), session_.shadows);
        decisions_.frame(session_.shadows, session_.shadows.stats().frame);
        log_.finish(seconds * 1000.0);
        smoothedMs_ = frame_ < 2 ? seconds * 1000.0 : 0.9 * smoothedMs_ + 0.1 * seconds * 1000.0; // some ten frames
        if (frame_++ % 10 == 0)
            window_.setTitle(titleFor(session_, log_, smoothedMs_ > 0.0 ? 1000.0 / smoothedMs_ : 0.0, keys_.light()));
        tint();
        addLegend();
        record();
        if (std::exchange(screenshot_, false)) takeScreenshot();
        for (const std::string& message : session_.shadows.takeMessages())
            if (noMap_.empty() || message.find(noMap_) == std::string::npos) // which the legend says
                std::fprintf(stderr, "gnomon: %s\n", message.c_str());
        if (options_.resizeTest > 0 && frame_ % 3 == 0 && resizes_++ < options_.resizeTest)
            window_.setSize(resizes_ < options_.resizeTest ? testSize(resizes_) : VkExtent2D{640, 360});
        if (lastFrame_ > 0 && frame_ >= lastFrame_) window_.close();
    }

    /// A folder that cannot be written ends no run.
    void takeScreenshot()
    {
        if (const Status saved = writePng("screenshot.png", session_.renderer.readColour()); !saved) say(saved.error());
    }

    const RunOptions& options_;
    Session& session_;
    WindowRules& rules_;
    DecisionCollector& decisions_;
    WindowSettings settings_;
    // These go after the window, whose end is the end of all commands.
    std::optional<SplitView> split_;
    std::optional<TexelView> texels_;
    Window window_;
#if GNOMON_WITH_IMGUI
    WindowPanel panel_;
#endif
    bool hasPanel_ = true;
    MethodKeys keys_;
    FlyCamera fly_;
    FrameLog log_;
    std::vector<glm::vec3> tints_; ///< By light of the scene; empty: their own.
    std::string noMap_;            ///< Why there are no texels to see; empty: there are.
    std::filesystem::path recording_;
    uint32_t recorded_ = 0;                           ///< Pictures.
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
    const std::vector<SettingChoice> choices = requireChoices(options);
    const std::vector<WhyQuestion> questions = parseQuestions(options.why);
    requireAnswers(questions, options);
    requireWritable(options.screenshot);
    const WindowSystem system;
    SessionOptions sessionOptions = demo::sessionOptions(options);
    sessionOptions.instanceExtensions = system.instanceExtensions();
    Session session(sessionOptions);
    requireOwners(choices, session.shadows.methods()); // plug-ins' too
    setChoices(session.shadows, options.method, choices);
    DecisionCollector decisions;
    WindowRules rules(session.shadows, options.rules,
                      [&] { decisions.collect(session.shadows); }); // under those that made them
    if (!options.method.empty()) expect(session.shadows.pinAll(options.method));
    expect(session.shadows.warmUp());

    std::printf("%s", kHelp);
    WindowRun run(options, session, rules, decisions);
    run.untilClosed();
    requireSilence(session.device);
    run.print(questions);
    return 0;
}

} // namespace gnomon::demo
