#include "demo/compare/contest.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "demo/compare/standing.hpp"
#include "demo/host/pin_thread.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/progress.hpp"
#include "demo/program/rule_support.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {

using Clock = std::chrono::steady_clock;

/// The same small frame without shadows, over and over: what it takes says how fast the machine is just now.
class Sentinel {
public:
    Sentinel(Device& device, const Scene& scene)
        : geometry_(device, scene),
          renderer_(device, scene, geometry_, {.maxLights = lightsOf(scene), .extent = kSize}),
          camera_(cameraAt(scene, 0.0))
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
    static uint32_t lightsOf(const Scene& scene)
    {
        return std::max<uint32_t>(1, static_cast<uint32_t>(scene.lights.size()));
    }

    static constexpr VkExtent2D kSize{64, 48};
    SceneGeometry geometry_;
    Renderer renderer_;
    CameraState camera_;
};

namespace {

/// A fixed choice that takes longer in its first run cannot become the best one by the noise of any machine that is
/// worth measuring on.
constexpr double kRepeated = 1.5;

/// \param lights 0: the scene's.
Scene sceneOf(const std::string& name, uint32_t lights)
{
    Scene scene = valueOf(loadScene(name));
    if (lights > 0) limitLights(scene, lights);
    return scene;
}

Stage stageOf(Device& device, const Scene& scene, const CompareOptions& options)
{
    const VkExtent2D size =
        options.size.empty() ? VkExtent2D{scene.width, scene.height} : valueOf(parseSize(options.size));
    return {.device = device,
            .scene = scene,
            .size = size,
            .path = {scene, options.seconds, options.stride},
            .recorded = options.entry == "recorded"};
}

/// Those that the device can use.
std::vector<TriedMethod> methodsOf(const Session& session)
{
    std::vector<TriedMethod> methods;
    for (const GnMethodInfo& info : session.shadows.methods()) {
        if (info.pUnavailable) continue;
        TriedMethod& method = methods.emplace_back();
        method = {
            .name = info.pName, .algorithm = info.pAlgorithm, .traits = info.traits, .roundTrips = info.roundTrips};
        for (uint32_t i = 0; i < info.settingCount; ++i)
            if (std::string_view(info.pSettings[i].pName) == kResolutionSetting) method.resolution = info.pSettings[i];
    }
    return methods;
}

} // namespace

std::vector<uint32_t> mapSides(const CompareOptions& options)
{
    return valueOf(parseCounts(options.maps, 16, 16384)); // as `bench` takes them
}

Contest::Contest(const CompareOptions& options, const std::string& scene)
    : options_(options), scene_(sceneOf(scene, options.lights)), device_(Device::create({})),
      stage_(stageOf(*device_, scene_, options))
{
    if (!options.budget.empty()) budget_ = valueOf(parseBudgets(options.budget)).front();
    addAdaptive();
}

Contest::~Contest() = default;

void Contest::addAdaptive()
{
    for (const std::string& name : parseNames(options_.rules.empty() ? "default" : options_.rules)) {
        const rules::RuleBase base = parseRules(name);
        if (contestants_.empty()) {
            quality_.nearPercent = wrongPercentOf(base.policy.floor.minimumQuality);
            stage_.rules = valueOf(findRules(name));
        }
        addContestant({.rules = valueOf(findRules(name))}, name + " rules");
    }
}

void Contest::addContestant(Contestant contestant, const std::string& name)
{
    contestant.row = rows_.size();
    const bool adaptive = !contestant.rules.name.empty(), cut = contestant.choice.overBest > 0.0;
    rows_.push_back({.name = name, .adaptive = adaptive, .overBest = contestant.choice.overBest});
    if (options_.warm && !cut) rows_.push_back({.name = name, .adaptive = adaptive, .warm = true});
    contestants_.push_back(std::move(contestant));
}

/// The truths, and the methods to be tried.
void Contest::prepare()
{
    Session session(*device_, scene_, {.scene = {}, .size = stage_.size});
    std::vector<TriedMethod> methods = methodsOf(session);
    if (!options_.methods.empty()) {
        std::vector<TriedMethod> wanted;
        for (const std::string& name : parseNames(options_.methods)) {
            const auto found = std::find_if(methods.begin(), methods.end(),
                                            [&](const TriedMethod& method) { return method.name == name; });
            if (found == methods.end()) throw HostError(name + " cannot be used on this device");
            if (!servesOne(scene_, found->traits)) throw HostError(name + " serves no light of " + scene_.name);
            wanted.push_back(*found);
        }
        methods = std::move(wanted);
    }
    std::erase_if(methods, [&](const TriedMethod& method) { return !servesOne(scene_, method.traits); });
    methods_ = withSides(methods, mapSides(options_));
    truths_ = measureTruths(session, stage_, truthFrames(stage_.path));
}

void Contest::addFixed()
{
    std::array<bool, kLightKinds> present{};
    for (const Light& light : scene_.lights)
        present[size_t(light.kind)] = true;
    const std::vector<MethodTrial> trials = tryMethods(stage_, truths_, quality_, methods_, notes_);
    for (FixedChoice& choice : fixedChoices(trials, present, quality_)) {
        const std::string name = choice.name;
        addContestant({.choice = std::move(choice)}, name);
    }
}

void Contest::run()
{
    pinThread(0); // a worker on the same processor, the other idle, was what most frames over a budget came from
    prepare();
    addFixed();
    sentinel_ = std::make_unique<Sentinel>(*device_, scene_);
    Progress progress(options_.alternations * static_cast<uint32_t>(contestants_.size()));
    uint32_t done = 0;
    std::vector<const Contestant*> turn;
    for (const Contestant& contestant : contestants_)
        if (contestant.choice.overBest == 0.0) turn.push_back(&contestant);
    // What a budget is relative to is measured first.
    if (budgetFactor() > 0.0)
        std::stable_partition(turn.begin(), turn.end(), [](const Contestant* c) { return c->rules.name.empty(); });
    for (uint32_t i = 0; i < options_.alternations; ++i) {
        for (const Contestant* contestant : turn) {
            if (!contestant->rules.name.empty() && budget_ && hostBudgetMs_[0].empty()) setBudgets();
            runOnce(*contestant);
            progress.show(++done, rows_[contestant->row].name);
        }
        if (i == 0) std::erase_if(turn, [&](const Contestant* contestant) { return !worthRepeating(*contestant); });
        std::reverse(turn.begin(), turn.end()); // so that a machine that slows down is not slow for the same ones
        done = (i + 1) * static_cast<uint32_t>(contestants_.size());
        progress.show(done, "alternation " + std::to_string(i + 1));
    }
}

/// Before the first adaptive run.
void Contest::setBudgets()
{
    for (const bool warm : {false, true}) {
        if (!budget_->relative)
            hostBudgetMs_[warm].assign(stage_.path.frames, budget_->value);
        else
            hostBudgetMs_[warm] = budgetsOver(standingOf(rows_, warm, quality_, {}, 0).equal, budget_->value);
    }
    if (!hostBudgetMs_[0].empty()) return;
    notes_.push_back("the budget of " + options_.budget + ": no fixed choice is of equal quality");
    budget_.reset();
}

/// Whether its further runs can change who is the best fixed choice of equal quality.
bool Contest::worthRepeating(const Contestant& contestant) const
{
    const auto mayBeBest = [&](const Row& row) {
        return !row.adaptive && !row.runs.empty() && quality_.holds(row.errors);
    };
    for (size_t i = contestant.row; i < rows_.size() && i <= contestant.row + (options_.warm ? 1 : 0); ++i) {
        const Row& mine = rows_[i];
        if (mine.adaptive) return true;
        if (!mayBeBest(mine)) continue;
        double best = totalMs(mine.runs.front());
        for (const Row& row : rows_)
            if (mayBeBest(row) && row.warm == mine.warm) best = std::min(best, totalMs(row.runs.front()));
        if (totalMs(mine.runs.front()) <= kRepeated * best) return true;
    }
    return false;
}

std::unique_ptr<Session> Contest::begin(const Contestant& contestant)
{
    auto session = std::make_unique<Session>(
        *device_, scene_,
        SessionOptions{.scene = {}, .size = stage_.size, .pinnedThreads = true, .knowledge = options_.knowledge});
    if (!contestant.rules.name.empty()) {
        expect(session->shadows.loadRules(contestant.rules.text, contestant.rules.name, contestant.rules.preset));
        expect(session->shadows.warmUp());
        return session;
    }
    const auto& chosen = contestant.choice.methods;
    for (const TriedMethod& method : methods_)
        if (std::ranges::find(chosen, method.name) != chosen.end()) prepareMethod(*session, stage_, method);
    for (uint32_t light = 0; light < scene_.lights.size(); ++light)
        expect(session->shadows.pin(light, chosen[size_t(scene_.lights[light].kind)]));
    return session;
}

void Contest::runOnce(const Contestant& contestant)
{
    const std::unique_ptr<Session> session = begin(contestant);
    session->wakeDevice(stage_.path.time(0));
    ShadowTimes shadows;
    std::vector<std::pair<Row*, std::vector<uint64_t>>> passes;
    for (Row* row = &rows_[contestant.row]; row <= &rows_[contestant.row] + (options_.warm ? 1 : 0); ++row)
        passes.emplace_back(row, pass(*session, *row, shadows));
    for (const auto& [row, numbers] : passes) // what a frame took is known some frames later
        for (const uint64_t number : numbers)
            row->runs.back().shadowMs.push_back(shadows.ms(number));
}

/// What the host gives a frame; 0: nothing.
float Contest::budgetMs(const Row& row, uint32_t frame) const
{
    const std::span<const double> budgets = hostBudgetMs(row.warm);
    return row.adaptive && frame < budgets.size() && budgets[frame] > 0.0 ? static_cast<float>(budgets[frame]) : 0.0f;
}

/// \return numbers of its frames, by the runtime's count
std::vector<uint64_t> Contest::pass(Session& session, Row& row, ShadowTimes& shadows)
{
    // Decisions may differ from run to run, and what they show with them.
    const bool counts = row.adaptive || row.runs.empty();
    RunRecord run;
    std::vector<uint64_t> numbers;
    for (uint32_t frame = 0; frame < stage_.path.frames; ++frame) {
        run.sentinelMs.push_back(sentinel_->run());
        (void)others_.look();
        const Clock::time_point start = Clock::now();
        drawFrame(session, stage_, frame, budgetMs(row, frame));
        run.frameMs.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
        run.othersMs.push_back(others_.look());
        const GnFrameStats stats = session.shadows.stats();
        numbers.push_back(stats.frame);
        run.budgetMs.push_back(double(stats.budgetMs));
        run.predictedMs.push_back(double(stats.predictedMs) + double(stats.sharedMs));
        run.switches += stats.switches;
        shadows.note(session.shadows);
        if (row.adaptive && row.name == rows_.front().name) noteServices(session);
        if (const auto truth = truths_.find(frame); counts && truth != truths_.end())
            for (const NearFar& errors : countErrors(session, truth->second))
                row.errors += errors;
    }
    row.runs.push_back(std::move(run));
    return numbers;
}

void Contest::noteServices(const Session& session)
{
    for (const uint32_t light : session.renderer.state().present) {
        GnDecision decision{};
        gnGetDecision(session.shadows.context(), session.shadows.view(0), session.shadows.light(light), &decision);
        if (!decision.pMethod) continue;
        std::string served = decision.pMethod;
        if (decision.mapSide > 0) served += " at " + std::to_string(decision.mapSide);
        Service& service = services_[served];
        ++service.lightFrames;
        if (!std::isfinite(decision.viewerDistance)) continue;
        service.nearestMetres = std::min(service.nearestMetres, decision.viewerDistance);
        service.farthestMetres = std::max(service.farthestMetres, decision.viewerDistance);
    }
}

} // namespace gnomon::demo
