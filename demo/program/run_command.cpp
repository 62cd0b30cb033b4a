#include <algorithm>
#include <chrono>
#include <cstdio>

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "demo/io/png.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/decision_log.hpp"
#include "demo/program/dump.hpp"
#include "demo/program/pictures.hpp"
#include "demo/program/progress.hpp"
#include "demo/program/rule_watch.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration duration)
{
    return std::chrono::duration<double, std::milli>(duration).count();
}

// Switches are worth a picture each, but a rule base that flickers shall not fill the disk.
constexpr uint32_t kMaxSwitchPictures = 12;

class PictureTaker {
public:
    PictureTaker(std::filesystem::path folder, uint32_t frames) : folder_(std::move(folder)), frames_(frames) {}

    /// First, last, every quarter, and frames in which a method changed.
    bool wants(uint32_t frame, bool switched)
    {
        if (frame % std::max(1u, frames_ / 4) == 0 || frame + 1 == frames_) return true;
        return switched && switchPictures_++ < kMaxSwitchPictures;
    }

    void take(uint32_t frame, const Scene& scene, Renderer& renderer, const FrameLog& log)
    {
        std::string number = std::to_string(frame);
        number.insert(0, 5 - std::min<size_t>(5, number.size()), '0');
        const Image8 picture = renderer.readColour();
        expect(writePng(folder_ / ("frame_" + number + ".png"), picture));
        std::string title =
            scene.name + "  frame " + std::to_string(frame) + (log.newestSwitched() ? "  (switch)" : "");
        expect(writePng(folder_ / ("frame_" + number + "_methods.png"),
                        captioned(picture, scene, renderer.state(), renderer.camera(), log.newest(), title)));
    }

private:
    std::filesystem::path folder_;
    uint32_t frames_;
    uint32_t switchPictures_ = 0;
};

void chooseMethods(ShadowHost& shadows, const RunOptions& options, const std::filesystem::path& out)
{
    if (!options.method.empty()) {
        std::vector<std::string> refused;
        expect(shadows.pinAll(options.method, &refused));
        for (const std::string& reason : refused)
            std::fprintf(stderr, "note: %s\n", reason.c_str());
        if (refused.empty()) return;
    }
    const RuleText rules = valueOf(findRules(options.rules));
    if (rules.name.empty()) return;
    expect(shadows.loadRules(rules.text, rules.name));
    expect(writeFile(out / "rules.yaml", rules.text));
}

// Pictures of an earlier run in the same folder would pass for this one's.
void removeOldPictures(const std::filesystem::path& folder)
{
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".png" && entry.path().filename().string().starts_with("frame_"))
            std::filesystem::remove(entry.path());
}

/// Times frames from the end of one to the end of the next, so that their sum is the run's length without pictures.
class FrameClock {
public:
    /// Waits for all frames up to `count` (counted from 1) and logs the time of each that is new.
    void finish(Renderer& renderer, uint64_t count, FrameLog& log)
    {
        for (; finished_ < count; ++finished_) {
            renderer.waitForFrame(finished_ + 1);
            const Clock::time_point now = Clock::now();
            lastMs_ = milliseconds(now - last_);
            log.finish(lastMs_);
            last_ = now;
        }
    }
    void restart() { last_ = Clock::now(); }
    double lastMs() const { return lastMs_; }

private:
    Clock::time_point last_ = Clock::now();
    uint64_t finished_ = 0;
    double lastMs_ = 0.0;
};

void printMessages(ShadowHost& shadows)
{
    for (const std::string& message : shadows.takeMessages())
        std::fprintf(stderr, "gnomon: %s\n", message.c_str());
}

} // namespace

int runCommand(const RunOptions& options)
{
    requireScenes({options.scene});
    if (!options.method.empty()) requireMethods({options.method});
    if (options.recorded) requireRecordable(options.method);
    const std::vector<WhyQuestion> questions = parseQuestions(options.why);
    requireAnswers(questions, options);
    const std::filesystem::path out = options.out;
    requireWritableFolder(out);
    if (!options.dump.empty()) requireWritableFolder(options.dump);
    SessionOptions sessionOptions{
        .scene = options.scene, .framesInFlight = options.framesInFlight, .validation = options.validation};
    if (!options.size.empty()) sessionOptions.size = valueOf(parseSize(options.size));
    if (options.lights > 0) sessionOptions.lights = options.lights;
    sessionOptions.knowledge = options.knowledge;
    Session session(sessionOptions);
    const Scene& scene = session.scene;
    for (const std::string& note : scene.notes)
        std::fprintf(stderr, "note: %s\n", note.c_str());

    removeOldPictures(out);
    RuleWatch rules(options.rules); // before they are read: a change from now on is one
    chooseMethods(session.shadows, options, out);
    if (gnWarmUp(session.shadows.context()) < 0)
        throw HostError(std::string("gnWarmUp: ") + gnGetLastError(session.shadows.context()));

    const uint32_t frames = options.frames > 0 ? options.frames : scene.frames;
    std::printf("%s: %ux%u, %u frames, %zu lights, %llu triangles, on %s, %s\n", scene.name.c_str(),
                session.renderer.extent().width, session.renderer.extent().height, frames, scene.lights.size(),
                static_cast<unsigned long long>(triangleCount(scene)), session.device.properties.deviceName,
                session.device.driver.c_str());
    std::fflush(stdout);
    FrameLog log(scene);
    PictureTaker pictures(out, frames);
    Progress progress(frames);
    double lastTime = frameTime(scene, 0);
    FrameClock clock;
    DecisionCollector decisions;
    for (uint32_t frame = 0; frame < frames; ++frame) {
        const auto keepLog = [&] { decisions.collect(session.shadows); }; // under the rules that made it
        if (const auto text = rules.poll(session.shadows, keepLog)) expect(writeFile(out / "rules.yaml", *text));
        const double time = frameTime(scene, frame);
        const CameraState camera = session.camera(time);
        session.renderer.draw({.time = time,
                               .cameras = {&camera, 1},
                               .shadows = &session.shadows,
                               .recorded = options.recorded,
                               .budgetMs = options.budgetMs,
                               .cameraCut = frame > 0 && cameraCutsBetween(scene, lastTime, time)});
        lastTime = time;
        log.add(frame, time, session.renderer.state(), session.shadows);
        decisions.frame(session.shadows, session.shadows.stats().frame);
        const bool picture = pictures.wants(frame, log.newestSwitched());
        // One frame stays in flight while the next is prepared, except before pictures and at the end.
        clock.finish(session.renderer, picture || frame + 1 == frames ? frame + 1 : frame, log);
        if (picture) {
            pictures.take(frame, scene, session.renderer, log);
            clock.restart();
        }
        std::string text;
        appendFixed(text, clock.lastMs() > 0.0 ? 1000.0 / clock.lastMs() : 0.0, 1);
        progress.show(frame + 1, text + " fps");
        printMessages(session.shadows);
    }
    log.save(out);
    decisions.collect(session.shadows);
    expect(writeFile(out / "decisions.gnlog", decisions.bytes()));
    if (!options.dump.empty()) dumpFrame(options.dump, scene, session.renderer, log.newest());
    requireSilence(session.device);

    for (const WhyQuestion& question : questions)
        std::printf("%s", valueOf(answerFromLog(decisions.bytes(), question)).c_str());
    std::printf("%s", log.summaryText().c_str());
    std::printf("files               %s: frames.csv, lights.csv, decisions.gnlog, frame_*.png, frame_*_methods.png%s\n",
                std::filesystem::absolute(out).lexically_normal().c_str(),
                std::filesystem::exists(out / "rules.yaml") ? ", rules.yaml" : "");
    return 0;
}

} // namespace gnomon::demo
