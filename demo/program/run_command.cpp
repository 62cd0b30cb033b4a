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

// Switches are worth a picture each, but a rule base that flickers must not fill the disk.
constexpr uint32_t kMaxSwitchPictures = 12;

class PictureTaker {
public:
    PictureTaker(std::filesystem::path folder, uint32_t frames, uint32_t film)
        : folder_(std::move(folder)), frames_(frames), film_(film)
    {
    }

    /// First, last, every quarter, and frames in which a method changed; of a film, every so many but the first, whose
    /// lights have colours of their own.
    bool wants(uint32_t frame, bool switched)
    {
        if (film_ > 0) return frame > 0 && frame % film_ == 0;
        if (frame % std::max(1u, frames_ / 4) == 0 || frame + 1 == frames_) return true;
        return switched && switchPictures_++ < kMaxSwitchPictures;
    }

    void take(uint32_t frame, const Scene& scene, Renderer& renderer, const FrameLog& log)
    {
        std::string number = std::to_string(frame);
        number.insert(0, 5 - std::min<size_t>(5, number.size()), '0');
        const Image8 picture = renderer.readColour();
        if (film_ > 0) {
            counts_.take(log.newest());
            expect(writePng(folder_ / ("frame_" + number + "_film.png"), withLegend(picture, counts_)));
            return;
        }
        expect(writePng(folder_ / ("frame_" + number + ".png"), picture));
        std::string title =
            scene.name + "  frame " + std::to_string(frame) + (log.newestSwitched() ? "  (switch)" : "");
        expect(writePng(folder_ / ("frame_" + number + "_methods.png"),
                        captioned(picture, scene, renderer.state(), renderer.camera(), log.newest(), title)));
    }

private:
    std::filesystem::path folder_;
    uint32_t frames_, film_;
    uint32_t switchPictures_ = 0;
    MethodCounts counts_;
};

/// Returns what chooses, in words.
std::string chooseMethods(ShadowHost& shadows, const RunOptions& options, const std::filesystem::path& out)
{
    if (!options.method.empty()) {
        std::vector<std::string> refused;
        expect(shadows.pinAll(options.method, &refused));
        for (const std::string& reason : refused)
            std::fprintf(stderr, "note: %s\n", reason.c_str());
        if (refused.empty()) return "by " + options.method;
    }
    const RuleText rules = valueOf(findRules(options.rules));
    if (rules.name.empty()) return "without rules";
    expect(shadows.loadRules(rules.text, rules.name, rules.preset));
    expect(writeFile(out / "rules.yaml", rules.text));
    return (options.method.empty() ? "" : "by " + options.method + ", else ") + ("by the rules " + rules.label());
}

/// What PictureTaker::take() calls its pictures.
bool isPictureName(std::string_view name)
{
    constexpr std::string_view head = "frame_", end = ".png";
    if (!name.starts_with(head) || !name.ends_with(end)) return false;
    name = name.substr(head.size(), name.size() - head.size() - end.size());
    for (const std::string_view kind : {"_methods", "_film"})
        if (name.ends_with(kind)) name.remove_suffix(kind.size());
    return name.size() >= 5 && name.find_first_not_of("0123456789") == std::string_view::npos;
}

/// What an earlier run left in the folder would pass for this one's. The rules that this run reads stay.
void removeOldFiles(const std::filesystem::path& folder, const std::string& rules)
{
    constexpr std::string_view tables[] = {"frames.csv", "lights.csv", "run.csv", "decisions.gnlog", "rules.yaml"};
    std::vector<std::filesystem::path> old;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        std::error_code ignored; // a name of a shipped base is no file
        if (std::filesystem::equivalent(entry.path(), rules, ignored)) continue;
        if (isPictureName(name) || std::find(std::begin(tables), std::end(tables), name) != std::end(tables))
            old.push_back(entry.path());
    }
    for (const std::filesystem::path& file : old)
        std::filesystem::remove(file);
}

/// Times turns of the loop from the end of one to the end of the next: their sum is the run's length without pictures.
class FrameClock {
public:
    void endTurn(FrameLog& log)
    {
        const Clock::time_point now = Clock::now();
        lastMs_ = milliseconds(now - last_);
        log.finish(lastMs_);
        last_ = now;
    }
    /// What the work takes counts for no turn.
    template <typename Work>
    void leaveOut(Work&& work)
    {
        const Clock::time_point start = Clock::now();
        work();
        last_ += Clock::now() - start;
    }
    double lastMs() const { return lastMs_; }

private:
    Clock::time_point last_ = Clock::now();
    double lastMs_ = 0.0;
};

void printMessages(ShadowHost& shadows)
{
    for (const std::string& message : shadows.takeMessages())
        std::fprintf(stderr, "gnomon: %s\n", message.c_str());
}

/// The scene from its first frame to its last, and what that leaves in the folder of the run.
class Run {
public:
    Run(const RunOptions& options, Session& session, RuleWatch& rules, uint32_t frames)
        : options_(options), session_(session), rules_(rules), frames_(frames), out_(options.out), log_(session.scene),
          pictures_(out_, frames, options.film), progress_(frames), lastTime_(frameTime(session.scene, 0))
    {
    }

    void frame(uint32_t frame)
    {
        const auto keepLog = [&] { decisions_.collect(session_.shadows); }; // under the rules that made it
        if (const auto text = rules_.poll(session_.shadows, keepLog)) expect(writeFile(out_ / "rules.yaml", *text));
        draw(frame);
        // One frame stays in flight while the next is prepared, except before pictures and at the end.
        session_.renderer.waitForFrame(frame + 1 == frames_ ? frame + 1 : frame);
        clock_.endTurn(log_);
        if (pictures_.wants(frame, log_.newestSwitched())) {
            session_.renderer.waitForFrame(frame + 1); // the next turn would have waited as long
            clock_.leaveOut([&] { pictures_.take(frame, session_.scene, session_.renderer, log_); });
        }
        std::string text;
        appendFixed(text, clock_.lastMs() > 0.0 ? 1000.0 / clock_.lastMs() : 0.0, 1);
        progress_.show(frame + 1, text + " fps");
        printMessages(session_.shadows);
    }

    void save()
    {
        log_.save(out_);
        decisions_.collect(session_.shadows);
        expect(writeFile(out_ / "decisions.gnlog", decisions_.bytes()));
        if (!options_.dump.empty()) dumpFrame(options_.dump, session_.scene, session_.renderer, log_.newest());
    }

    void print(const std::vector<WhyQuestion>& questions) const
    {
        std::printf("%s", log_.summaryText().c_str());
        std::printf("files               %s: frames.csv, lights.csv, run.csv, decisions.gnlog, frame_*.png, "
                    "frame_*_methods.png%s\n",
                    std::filesystem::absolute(out_).lexically_normal().c_str(),
                    std::filesystem::exists(out_ / "rules.yaml") ? ", rules.yaml" : "");
        printAnswers(decisions_, questions); // a number may be no light's, and the rest is said then
    }

private:
    void draw(uint32_t frame)
    {
        const double time = frameTime(session_.scene, frame);
        const CameraState camera = session_.camera(time);
        session_.renderer.draw({.time = time,
                                .cameras = {&camera, 1},
                                .shadows = &session_.shadows,
                                .recorded = options_.recorded,
                                .budgetMs = options_.budgetMs,
                                .cameraCut = frame > 0 && cameraCutsBetween(session_.scene, lastTime_, time),
                                .lightColours = tints_});
        lastTime_ = time;
        log_.add(frame, time, session_.renderer.state(), session_.shadows);
        if (options_.film > 0) // which methods serve is known when a frame is recorded: the next one shows it
            tintByMethod(session_.scene, session_.renderer.state(), log_.newest(), tints_);
        decisions_.frame(session_.shadows, session_.shadows.stats().frame);
    }

    const RunOptions& options_;
    Session& session_;
    RuleWatch& rules_;
    uint32_t frames_;
    std::filesystem::path out_;
    FrameLog log_;
    PictureTaker pictures_;
    Progress progress_;
    double lastTime_;
    FrameClock clock_;
    std::vector<glm::vec3> tints_; ///< By light of the scene; empty: no film, or its first frame.
    DecisionCollector decisions_;
};

/// Before anything is made: a misspelt name must not cost the making.
void check(const RunOptions& options)
{
    requireScenes({options.scene});
    if (!options.method.empty()) requireMethods({options.method});
    if (options.recorded) requireRecordable(options.method);
    requireWritableFolder(options.out);
    if (!options.dump.empty()) requireWritableFolder(options.dump);
}

/// The same run again, as a command.
std::string commandOf(const RunOptions& options)
{
    std::string text = "gnomon run " + shellQuoted(options.scene);
    const auto add = [&](const char* name, const std::string& value) {
        if (!value.empty()) text += std::string(" --") + name + " " + shellQuoted(value);
    };
    add("rules", options.rules);
    add("method", options.method);
    add("set", options.settings);
    add("knowledge", options.knowledge);
    add("size", options.size);
    add("frames", options.frames > 0 ? std::to_string(options.frames) : "");
    add("lights", options.lights > 0 ? std::to_string(options.lights) : "");
    std::string budget;
    if (options.budgetMs > 0.0f) appendNumber(budget, double{options.budgetMs});
    add("budget", budget);
    return text + (options.recorded ? " --recorded" : "");
}

/// run.csv: what ran where.
void saveFacts(const RunOptions& options, const Session& session, const std::string& chooser)
{
    const VkExtent2D extent = session.renderer.extent();
    CsvWriter facts({"what", "value"});
    facts.cell("scene").cell(session.scene.name).endRow();
    facts.cell("size").cell(std::to_string(extent.width) + "x" + std::to_string(extent.height)).endRow();
    facts.cell("lights").cell(session.scene.lights.size()).endRow();
    facts.cell("triangles").cell(triangleCount(session.scene)).endRow();
    facts.cell("chosen").cell(chooser).endRow();
    facts.cell("device").cell(session.device.properties.deviceName).endRow();
    facts.cell("driver").cell(session.device.driver).endRow();
    facts.cell("command").cell(commandOf(options)).endRow();
    expect(facts.save(std::filesystem::path(options.out) / "run.csv"));
}

void printStart(const Session& session, const std::string& chooser, uint32_t frames)
{
    const VkExtent2D extent = session.renderer.extent();
    std::printf("%s: %ux%u, %u frames, %zu lights, %llu triangles, %s, on %s, %s\n", session.scene.name.c_str(),
                extent.width, extent.height, frames, session.scene.lights.size(),
                static_cast<unsigned long long>(triangleCount(session.scene)), chooser.c_str(),
                session.device.properties.deviceName, session.device.driver.c_str());
    std::fflush(stdout);
}

} // namespace

int runCommand(const RunOptions& options)
{
    const std::vector<WhyQuestion> questions = parseQuestions(options.why);
    check(options);
    const std::vector<SettingChoice> choices = requireChoices(options);
    requireAnswers(questions, options);
    const SessionOptions forSession = sessionOptions(options);
    removeOldFiles(options.out, options.rules);
    if (!options.dump.empty()) removeOldDump(options.dump);
    Session session(forSession);
    for (const std::string& note : session.scene.notes)
        std::fprintf(stderr, "note: %s\n", note.c_str());

    requireOwners(choices, session.shadows.methods()); // plug-ins' too
    setChoices(session.shadows, options.method, choices);
    RuleWatch rules(options.rules); // before they are read: a change from now on is one
    const std::string chooser = chooseMethods(session.shadows, options, options.out);
    expect(session.shadows.warmUp(options.method));

    const uint32_t frames = options.frames > 0 ? options.frames : session.scene.frames;
    printStart(session, chooser, frames);
    saveFacts(options, session, chooser);
    Run run(options, session, rules, frames);
    for (uint32_t frame = 0; frame < frames; ++frame)
        run.frame(frame);
    run.save();
    requireSilence(session.device);
    run.print(questions);
    return 0;
}

} // namespace gnomon::demo
