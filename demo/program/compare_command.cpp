#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "demo/host/pin_thread.hpp"
#include "demo/io/csv.hpp"
#include "demo/io/number.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/envelope.hpp"
#include "demo/program/gnuplot.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/other_work.hpp"
#include "demo/program/progress.hpp"
#include "demo/program/shadow_times.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr VkExtent2D kSentinelSize{64, 48};
/// Frames whose sentinel took longer than this share of its median were disturbed by something else.
constexpr double kUndisturbed = 1.15;
/// Pictures whose errors are counted, evenly over the run.
constexpr uint32_t kErrorFrames = 12;

/// The same small frame without shadows, over and over: what it takes says how fast the machine is just now.
class Sentinel {
public:
    Sentinel(Device& device, const Scene& scene, const SceneGeometry& geometry)
        : renderer_(device, scene, geometry, {.extent = kSentinelSize}), camera_(cameraAt(scene, 0.0))
    {
    }
    double run()
    {
        const Clock::time_point start = Clock::now();
        renderer_.draw({.time = 0.0, .cameras = {&camera_, 1}});
        renderer_.waitForFrame();
        return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    }

private:
    Renderer renderer_;
    CameraState camera_;
};

struct Contestant {
    std::string name;
    std::unique_ptr<Session> session;
    std::vector<double> ratios; ///< Of each alternation: its frames' time over its sentinels' time.
    double frameMs = 0.0;       ///< Mean of the fastest alternation.
    RunTimes times, sentinels;  ///< Of each alternation.
    ErrorCount errors;
    uint64_t switches = 0;

    double best() const { return *std::min_element(ratios.begin(), ratios.end()); }
};

struct BudgetCount {
    uint32_t undisturbed = 0, within = 0;
    uint32_t heldUp = 0; ///< Of the others, those that would be, but for what others did on the processors meanwhile.
    double worst = 0.0;  ///< Shadow time over budget.
    uint32_t tooLittle = 0; ///< Frames in which the cheapest plan that keeps the near floor was predicted to take more.
    double leastMs = std::numeric_limits<double>::infinity(), mostMs = 0.0;
};

class Comparison {
public:
    explicit Comparison(const CompareOptions& options)
        : options_(options), scene_(valueOf(loadScene(options.scene))), device_(Device::create({}))
    {
        size_ = options.size.empty() ? VkExtent2D{scene_.width, scene_.height} : valueOf(parseSize(options.size));
        frames_ = options.frames > 0 ? options.frames : scene_.frames;
        for (const std::string& rules : parseNames(options.rules.empty() ? "default" : options.rules))
            addAdaptive(rules);
        for (const std::string& method : methodNames())
            addMethod(method);
        sentinel_ = std::make_unique<Sentinel>(*device_, scene_, contestants_[0].session->geometry);
        truth_ = makeSession();
        if (!truth_->shadows.pinAll(kTruthMethod)) truth_.reset();
    }

    void run()
    {
        pinThread(0); // a worker on the same processor, the other idle, was what most frames over a budget came from
        Progress progress((options_.alternations + 1) * static_cast<uint32_t>(contestants_.size()));
        uint32_t done = 0;
        for (Contestant& contestant : contestants_) {
            countErrors(contestant);
            progress.show(++done, "errors");
        }
        if (!contestants_.empty()) contestants_[0].session->wakeDevice(0.0);
        for (uint32_t i = 0; i < options_.alternations; ++i) {
            for (Contestant& contestant : contestants_) {
                alternation(contestant);
                progress.show(++done, contestant.name);
            }
        }
    }

    void print() const;
    void save() const;
    void requireSilentDevice() const { requireSilence(*device_); }

private:
    struct FrameTime {
        uint64_t number; ///< GnFrameStats::frame
        double sentinelMs, frameMs, othersMs, budgetMs, predictedMs;
    };

    std::unique_ptr<Session> makeSession()
    {
        return std::make_unique<Session>(*device_, scene_,
                                         SessionOptions{.scene = {}, .size = size_, .pinnedThreads = true});
    }
    std::vector<std::string> methodNames();
    void addAdaptive(const std::string& rules);
    void addMethod(const std::string& method);
    void drawFrame(Session& session, uint32_t frame);
    void countErrors(Contestant& contestant);
    void alternation(Contestant& contestant);
    void countBudget(const std::vector<FrameTime>& frames, const ShadowTimes& shadows);
    void printAgainst(const Contestant& adaptive) const;
    std::vector<const RunTimes*> asGoodAs(const Contestant& adaptive) const;
    void plot() const;
    void writeCsv() const;

    CompareOptions options_;
    Scene scene_;
    std::unique_ptr<Device> device_;
    VkExtent2D size_{};
    uint32_t frames_ = 0;
    std::vector<Contestant> contestants_; ///< The adaptive runs first.
    size_t adaptives_ = 0;
    std::unique_ptr<Sentinel> sentinel_;
    OtherWork others_;
    std::unique_ptr<Session> truth_;
    BudgetCount budget_;
};

std::vector<std::string> Comparison::methodNames()
{
    if (!options_.methods.empty()) return parseNames(options_.methods);
    std::vector<std::string> names;
    for (const GnMethodInfo& info : contestants_[0].session->shadows.methods())
        if (!info.pUnavailable) names.push_back(info.pName);
    return names;
}

void Comparison::addAdaptive(const std::string& name)
{
    Contestant contestant{.name = name + " rules", .session = makeSession()};
    const RuleText rules = valueOf(findRules(name));
    expect(contestant.session->shadows.loadRules(rules.text, rules.name));
    contestants_.push_back(std::move(contestant));
    ++adaptives_;
}

// Only methods that serve every light of the scene are whole answers.
void Comparison::addMethod(const std::string& method)
{
    Contestant contestant{.name = method, .session = makeSession()};
    std::vector<std::string> refused;
    const Status pinned = contestant.session->shadows.pinAll(method, &refused);
    if (!options_.methods.empty()) {
        expect(pinned);
        for (const std::string& reason : refused)
            std::fprintf(stderr, "note: %s is left out: %s\n", method.c_str(), reason.c_str());
    }
    if (pinned && refused.empty()) contestants_.push_back(std::move(contestant));
}

void Comparison::drawFrame(Session& session, uint32_t frame)
{
    const double time = frameTime(scene_, frame);
    const CameraState camera = cameraAt(scene_, time);
    session.renderer.draw({.time = time,
                           .cameras = {&camera, 1},
                           .shadows = &session.shadows,
                           .budgetMs = options_.budgetMs,
                           .cameraCut = frame == 0 || cameraCutsBetween(scene_, frameTime(scene_, frame - 1), time)});
    session.renderer.waitForFrame();
}

/// One run that is not timed: everything is compiled and learned afterwards, and errors come from decisions as they are
/// made in a run.
void Comparison::countErrors(Contestant& contestant)
{
    Session& session = *contestant.session;
    expect(session.shadows.warmUp());
    const uint32_t step = std::max(1u, frames_ / kErrorFrames);
    for (uint32_t frame = 0; frame < frames_; ++frame) {
        drawFrame(session, frame);
        if (!truth_ || frame % step != step / 2) continue;
        settle(*truth_, frameTime(scene_, frame), false);
        const std::vector<Image8> seen = session.renderer.readVisibility();
        const std::vector<Image8> truth = truth_->renderer.readVisibility();
        const FrameSurfaces surfaces{session.renderer.readDepth(), session.renderer.readNormals()};
        const SceneState& state = session.renderer.state();
        for (size_t layer = 0; layer < state.present.size(); ++layer) {
            const uint32_t light = state.present[layer];
            const std::vector<uint8_t> counted =
                countedPixels(scene_, session.renderer.camera(), surfaces, scene_.lights[light], state.lights[light]);
            contestant.errors += compare(seen[layer], truth[layer], counted);
        }
    }
}

void Comparison::alternation(Contestant& contestant)
{
    std::vector<FrameTime> times;
    times.reserve(frames_);
    contestant.switches = 0;
    ShadowTimes shadows;
    for (uint32_t frame = 0; frame < frames_; ++frame) {
        const double sentinelMs = sentinel_->run();
        (void)others_.look();
        const Clock::time_point start = Clock::now();
        drawFrame(*contestant.session, frame);
        const double frameMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        const double othersMs = others_.look();
        const GnFrameStats stats = contestant.session->shadows.stats();
        times.push_back({stats.frame, sentinelMs, frameMs, othersMs, double(stats.budgetMs),
                         double(stats.predictedMs) + double(stats.sharedMs)});
        shadows.note(contestant.session->shadows);
        contestant.switches += stats.switches;
    }
    double frameMs = 0.0, sentinelMs = 0.0;
    std::vector<double>& taken = contestant.times.emplace_back();
    std::vector<double>& sentinels = contestant.sentinels.emplace_back();
    for (const FrameTime& frame : times) {
        frameMs += taken.emplace_back(frame.frameMs);
        sentinelMs += sentinels.emplace_back(frame.sentinelMs);
    }
    contestant.ratios.push_back(frameMs / sentinelMs);
    const double mean = frameMs / double(times.size());
    if (contestant.frameMs == 0.0 || mean < contestant.frameMs) contestant.frameMs = mean;
    if (&contestant == contestants_.data()) countBudget(times, shadows);
}

void Comparison::countBudget(const std::vector<FrameTime>& frames, const ShadowTimes& shadows)
{
    std::vector<double> sentinels;
    for (const FrameTime& frame : frames)
        sentinels.push_back(frame.sentinelMs);
    const double limit = kUndisturbed * median(sentinels);
    const double first = frameTime(scene_, 0) + 1.0; // the first second is for learning
    for (uint32_t i = 0; i < frames.size(); ++i) {
        const double shadowMs = shadows.ms(frames[i].number);
        if (frameTime(scene_, i) < first || frames[i].sentinelMs > limit || frames[i].budgetMs <= 0.0 ||
            std::isnan(shadowMs))
            continue;
        budget_.leastMs = std::min(budget_.leastMs, frames[i].budgetMs);
        budget_.mostMs = std::max(budget_.mostMs, frames[i].budgetMs);
        if (frames[i].predictedMs > frames[i].budgetMs) {
            ++budget_.tooLittle;
            continue;
        }
        const double share = shadowMs / frames[i].budgetMs;
        ++budget_.undisturbed;
        budget_.within += share <= 1.0;
        budget_.heldUp += share > 1.0 && shadowMs - frames[i].othersMs <= frames[i].budgetMs;
        budget_.worst = std::max(budget_.worst, share);
    }
}

/// Times of the methods whose error over the run is not above that of the adaptive one.
std::vector<const RunTimes*> Comparison::asGoodAs(const Contestant& adaptive) const
{
    std::vector<const RunTimes*> methods;
    for (size_t i = adaptives_; i < contestants_.size(); ++i)
        if (contestants_[i].errors.wrong() <= adaptive.errors.wrong()) methods.push_back(&contestants_[i].times);
    return methods;
}

void Comparison::printAgainst(const Contestant& adaptive) const
{
    const Contestant* rival = nullptr;
    for (size_t i = adaptives_; i < contestants_.size(); ++i) {
        const Contestant& contestant = contestants_[i];
        const bool asGood = contestant.errors.wrong() <= adaptive.errors.wrong();
        if (asGood && (!rival || contestant.best() < rival->best())) rival = &contestant;
    }
    if (!rival) {
        std::printf("%s: no single method that serves every light has an error as low\n", adaptive.name.c_str());
        return;
    }
    const std::vector<const RunTimes*> methods = asGoodAs(adaptive);
    const std::vector<double> taken = fastestFrames(adaptive.times), lowest = envelopeOf(methods);
    std::printf("%s / best single method of equal or lower error (%s): %.3f; / envelope of such methods, frame by "
                "frame: %.3f",
                adaptive.name.c_str(), rival->name.c_str(), adaptive.best() / rival->best(),
                std::accumulate(taken.begin(), taken.end(), 0.0) / std::accumulate(lowest.begin(), lowest.end(), 0.0));
    if (adaptive.times.size() > 1)
        std::printf("; / what was fastest in the other alternations: %.3f",
                    overChosenElsewhere(adaptive.times, methods));
    std::printf("\n");
}

void Comparison::print() const
{
    std::printf("%s, %ux%u, %u frames, fastest of %u alternations\n", scene_.name.c_str(), size_.width, size_.height,
                frames_, options_.alternations);
    std::printf("%-18s %10s %16s %10s %9s\n", "", "frame ms", "over sentinel", "wrong %", "switches");
    for (const Contestant& contestant : contestants_)
        std::printf("%-18s %10.3f %16.3f %10.4f %9llu\n", contestant.name.c_str(), contestant.frameMs,
                    contestant.best(), contestant.errors.percent(contestant.errors.wrong()),
                    static_cast<unsigned long long>(contestant.switches));
    for (size_t i = 0; i < adaptives_; ++i)
        printAgainst(contestants_[i]);
    if (budget_.undisturbed + budget_.tooLittle > 0)
        std::printf("budget %.2f to %.2f ms: kept in %.2f %% of %u undisturbed frames after the first second, worst "
                    "%.2f x; of %u over it, %u but for the processor time that others took meanwhile; in %u more no "
                    "plan keeps it and the near floor\n",
                    budget_.leastMs, budget_.mostMs, 100.0 * budget_.within / std::max(1u, budget_.undisturbed),
                    budget_.undisturbed, budget_.worst, budget_.undisturbed - budget_.within, budget_.heldUp,
                    budget_.tooLittle);
}

/// The table first: drawing may fail.
void Comparison::save() const
{
    if (!options_.csv.empty()) writeCsv();
    if (!options_.plot.empty()) plot();
}

/// A row per run and frame.
void Comparison::writeCsv() const
{
    CsvWriter csv({"run", "alternation", "frame", "frame_ms", "sentinel_ms"});
    for (const Contestant& contestant : contestants_) {
        for (size_t i = 0; i < contestant.times.size(); ++i) {
            for (size_t frame = 0; frame < contestant.times[i].size(); ++frame) {
                csv.cell(contestant.name).cell(i).cell(frame);
                csv.cell(contestant.times[i][frame], 3).cell(contestant.sentinels[i][frame], 3).endRow();
            }
        }
    }
    expect(csv.save(options_.csv));
}

/// Milliseconds of every frame: the methods, what could be had of them, and the adaptive runs.
void Comparison::plot() const
{
    const std::string settings = "set title " + gnuplotText(scene_.name) +
                                 "\nset xlabel 'frame'\nset ylabel 'ms'\nset yrange [0:]\nset grid\n"
                                 "set key outside top center horizontal maxcols 3\n";
    const auto curve = [](const std::string& title, const std::string& style, const std::vector<double>& ms) {
        PlotCurve made{.title = title, .style = style};
        for (size_t frame = 0; frame < ms.size(); ++frame)
            made.points.emplace_back(double(frame), ms[frame]);
        return made;
    };
    std::vector<PlotCurve> curves;
    for (size_t i = adaptives_; i < contestants_.size(); ++i)
        curves.push_back(curve(contestants_[i].name,
                               "lines lw 1 lc rgb '" + hexOf(methodColour(contestants_[i].name)) + "'",
                               fastestFrames(contestants_[i].times)));
    if (const std::vector<const RunTimes*> methods = asGoodAs(contestants_.front()); !methods.empty())
        curves.push_back(curve("envelope of equal error", "lines lw 2 dt 2 lc rgb 'black'", envelopeOf(methods)));
    for (size_t i = 0; i < adaptives_; ++i)
        curves.push_back(curve(contestants_[i].name,
                               i == 0 ? "lines lw 2 lc rgb 'black'" : "lines lw 2 lc rgb 'gray50'",
                               fastestFrames(contestants_[i].times)));
    plotCurves(settings, curves, options_.plot);
}

} // namespace

int compareCommand(const CompareOptions& options)
{
    requireMethods(parseNames(options.methods));
    requireWritable(options.plot);
    requireGnuplot(options.plot);
    requireWritable(options.csv);
    Comparison comparison(options);
    comparison.run();
    comparison.print();
    comparison.save();
    comparison.requireSilentDevice();
    return 0;
}

} // namespace gnomon::demo
