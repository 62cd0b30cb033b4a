// What compare makes of pictures and times: near and far, equal quality, fixed choices, verdicts and their noise.
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "demo/compare/fixed_choice.hpp"
#include "demo/compare/path.hpp"
#include "demo/compare/standing.hpp"

using namespace gnomon::demo;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

NearFar errorsOf(uint64_t near, uint64_t far)
{
    return {.near = {.counted = 100'000, .wrong = near}, .far = {.counted = 100'000, .wrong = far}};
}

/// Each frame takes `frameMs`, half of it for shadows, beside sentinels of 1 ms.
RunRecord steady(double frameMs, size_t frames = 20)
{
    RunRecord run;
    run.frameMs.assign(frames, frameMs);
    run.shadowMs.assign(frames, 0.5 * frameMs);
    run.sentinelMs.assign(frames, 1.0);
    run.othersMs.assign(frames, 0.0);
    run.budgetMs.assign(frames, 0.0);
    run.predictedMs.assign(frames, 0.0);
    return run;
}

Row rowOf(const char* name, std::initializer_list<double> frameMs)
{
    Row row{.name = name, .errors = errorsOf(0, 0)};
    for (const double ms : frameMs)
        row.runs.push_back(steady(ms));
    return row;
}

constexpr EqualQuality kQuality{.nearPercent = 0.2, .farPercent = 1.0};

/// A method of equal quality for the kinds whose time is above 0: directional, spot, point.
MethodTrial trialOf(const char* method, std::array<double, kLightKinds> ms)
{
    MethodTrial trial{.method = method};
    for (size_t kind = 0; kind < kLightKinds; ++kind)
        trial.kinds[kind] = {.served = ms[kind] > 0.0, .ms = ms[kind], .errors = errorsOf(100, 100)};
    return trial;
}

std::vector<std::string> namesOf(const std::vector<FixedChoice>& choices)
{
    std::vector<std::string> names;
    for (const FixedChoice& choice : choices)
        names.push_back(choice.name);
    return names;
}

} // namespace

TEST_CASE("a receiver is near by its distance from the eye, not by its depth")
{
    // Straight ahead 29 m deep, and as deep to the side, where the ray is longer; then 31 m, and the sky.
    CameraMatrices camera;
    camera.depthScale = 1.0f; // linear depth = 1 / depth
    camera.rayCorner = {0.0f, 0.0f, -1.0f};
    camera.rayDx = {0.4f, 0.0f, 0.0f}; // pixel centres at 0.2, 0.6, ...
    ImageF depth(2, 2, 1);
    depth.texels = {1.0f / 29.0f, 1.0f / 29.0f, 1.0f / 31.0f, camera.skyDepth};
    const std::vector<bool> near = nearPixels(camera, depth);
    CHECK(near == std::vector<bool>{true, false, false, false}); // 29.6, 33.8, 31.6 m
}

TEST_CASE("wrong pixels are counted with the near or the far ones, grazing and unlit ones with neither")
{
    Image8 truth(3, 2, 1), seen(3, 2, 1);
    truth.texels = {255, 0, 255, 128, 127, 0};
    seen.texels = {255, 255, 0, 127, 0, 255};
    const std::vector<uint8_t> counted{1, 1, 1, 1, 1, 2};
    const std::vector<bool> near{true, true, false, false, false, true};
    const NearFar errors = countWrong(seen, truthOf(truth, counted), near);
    CHECK(errors.near.counted == 2);
    CHECK(errors.near.wrong == 1);
    CHECK(errors.far.counted == 3);
    CHECK(errors.far.wrong == 2);
    CHECK(errors.far.percent() == doctest::Approx(200.0 / 3.0));
}

TEST_CASE("equal quality is the floor's wrong share near the eye and one per cent far from it")
{
    CHECK(wrongPercentOf(0.875) == doctest::Approx(1.0 / 7.0));
    CHECK(wrongPercentOf(1.0) == 0.0);
    CHECK(std::isinf(wrongPercentOf(0.0)));
    CHECK(kQuality.holds(errorsOf(200, 1000)));
    CHECK_FALSE(kQuality.holds(errorsOf(201, 0)));
    CHECK_FALSE(kQuality.holds(errorsOf(0, 1001)));
    CHECK(kQuality.holds({})); // nothing is seen
}

TEST_CASE(
    "fixed choices are methods for all kinds, specialists with the cheapest partner, and the cheapest of each kind")
{
    const std::vector<MethodTrial> trials{trialOf("rays", {3.0, 0.5, 4.0}), trialOf("map", {1.0, 1.0, 0.0}),
                                          trialOf("cube", {0.0, 0.0, 3.0})};
    CHECK(namesOf(fixedChoices(trials, {true, true, true}, kQuality)) ==
          std::vector<std::string>{"rays", "map (directional, spot) + cube (point)",
                                   "map (directional) + rays (spot) + cube (point)"});
    // Without point lights the map is a choice alone.
    const std::vector<MethodTrial> two(trials.begin(), trials.begin() + 2);
    CHECK(namesOf(fixedChoices(two, {true, true, false}, kQuality)) ==
          std::vector<std::string>{"rays", "map", "map (directional) + rays (spot)"});
}

TEST_CASE("a partner and the cheapest of each kind are of equal quality, a method's own row is there whatever it is")
{
    std::vector<MethodTrial> trials{trialOf("rays", {3.0, 2.0, 4.0}), trialOf("map", {1.0, 1.0, 0.0}),
                                    trialOf("blurred", {2.0, 0.5, 0.5})};
    trials[2].kinds[1].errors = trials[2].kinds[2].errors = errorsOf(5000, 0);
    CHECK(namesOf(fixedChoices(trials, {true, true, true}, kQuality)) ==
          std::vector<std::string>{"rays", "map (directional, spot) + rays (point)", "blurred"});
    trials[0].kinds[2].errors = errorsOf(0, 5000); // nobody is left to serve point lights with the map
    CHECK(namesOf(fixedChoices(trials, {true, true, true}, kQuality)) == std::vector<std::string>{"rays", "blurred"});
}

TEST_CASE("a method is cut by the best of equal quality at the kind it is best at, and never without one")
{
    std::vector<MethodTrial> earlier{trialOf("rays", {3.0, 2.0, 4.0}), trialOf("wrong", {0.1, 0.1, 0.1})};
    for (KindTrial& kind : earlier[1].kinds)
        kind.errors = errorsOf(5000, 5000);
    const MethodTrial slow = trialOf("slow", {0.0, 10.0, 24.0});
    CHECK(overBest(slow, earlier, kQuality) == doctest::Approx(5.0));
    CHECK(overBest(trialOf("spots", {9.0, 1.0, 50.0}), earlier, kQuality) == doctest::Approx(0.5));
    CHECK(overBest(slow, {earlier[1]}, kQuality) == 0.0);
    earlier[0].overBest = 5.0;
    CHECK(overBest(slow, earlier, kQuality) == 0.0);
}

TEST_CASE(
    "a choice over four times the cheapest is not run, though its method may partner others; a cut method does not")
{
    std::vector<MethodTrial> trials{trialOf("cut", {1.0, 0.5, 1.0}), trialOf("spots", {20.0, 1.0, 20.0}),
                                    trialOf("map", {2.0, 2.0, 0.0}), trialOf("rays", {3.0, 3.0, 3.0})};
    trials[0].overBest = 5.0;
    const std::vector<FixedChoice> choices = fixedChoices(trials, {true, true, true}, kQuality);
    CHECK(namesOf(choices) == std::vector<std::string>{"spots", "map (directional, spot) + rays (point)", "rays",
                                                       "map (directional) + spots (spot) + rays (point)", "cut"});
    CHECK(choices[0].overBest == doctest::Approx(41.0 / 6.0));
    for (size_t i = 1; i < 4; ++i)
        CHECK(choices[i].overBest == 0.0);
    CHECK(choices[4].overBest == 5.0);
}

TEST_CASE("a verdict is sure if all alternations say the same, and within the noise if one does not or is alone")
{
    const Quotient clear = quotientOf(std::vector{10.0, 10.2, 10.4}, std::vector{10.0, 10.0, 10.0});
    CHECK(clear.median == doctest::Approx(1.02));
    CHECK(clear.least == doctest::Approx(1.0));
    CHECK(clear.most == doctest::Approx(1.04));
    CHECK(judge(clear, 1.10) == Verdict::Kept);
    CHECK(judge(clear, 0.99) == Verdict::Missed);
    CHECK(judge(clear, 1.03) == Verdict::KeptInNoise);
    CHECK(judge(clear, 1.01) == Verdict::MissedInNoise);
    CHECK(verdictText(clear, 1.03) == "kept, within the noise of the runs");
    const Quotient once = quotientOf(std::vector{1.0}, std::vector{2.0});
    CHECK(judge(once, 1.0) == Verdict::KeptInNoise);
    CHECK(verdictText(once, 0.4) == "missed in one run, whose noise is not known");
}

TEST_CASE("alternations are held against one another pair by pair: a slow one that slowed down both changes nothing")
{
    const Row adaptive = rowOf("rules", {10.0, 20.0, 10.0}), fixed = rowOf("rays", {8.0, 16.0, 8.0});
    const Against raw = against(adaptive, fixed);
    CHECK(raw.total.least == doctest::Approx(1.25));
    CHECK(raw.total.most == doctest::Approx(1.25));
    CHECK(raw.worstFrame.median == doctest::Approx(1.25));
}

TEST_CASE("normalised times undo a machine that slows down, and a single slow sentinel changes none")
{
    RunRecord run = steady(10.0);
    for (size_t i = 0; i < run.frameMs.size(); ++i) {
        run.frameMs[i] *= 2.0;
        run.shadowMs[i] *= 2.0;
        run.sentinelMs[i] *= 2.0;
    }
    run.sentinelMs[7] = 50.0;
    const RunRecord made = normalised(run, 1.0);
    CHECK(totalMs(made) == doctest::Approx(200.0));
    CHECK(worstMs(made) == doctest::Approx(10.0));
    CHECK(made.shadowMs[0] == doctest::Approx(5.0));
}

TEST_CASE("raw and normalised verdicts that disagree are explained by the machine's speed or by what it did not see")
{
    const Row fixed = rowOf("rays", {10.0, 10.0});
    Row slowed = rowOf("rules", {15.0, 15.0});
    for (RunRecord& run : slowed.runs)
        run.sentinelMs.assign(run.sentinelMs.size(), 1.5);
    const Against raw = against(slowed, fixed), normal = againstNormalised(slowed, fixed, 1.0);
    CHECK(raw.total.median == doctest::Approx(1.5));
    CHECK(normal.total.median == doctest::Approx(1.0));
    const std::string why = disagreement(slowed, fixed, raw.total, normal.total, 1.1);
    CHECK_MESSAGE(why.find("50.0 % slower (by the sentinel) in the runs of rules than in those of rays") !=
                      std::string::npos,
                  why);
    const Row equal = rowOf("rules", {10.0, 10.1});
    CHECK(disagreement(equal, fixed, against(equal, fixed).total, againstNormalised(equal, fixed, 1.0).total, 1.1) ==
          "");
    // The same numbers at a bound between them: one keeps it, the other does not.
    CHECK(disagreement(equal, fixed, {1.001, 1.0, 1.002, 2}, {0.999, 0.998, 1.0, 2}, 1.0).find("as fast in the runs") !=
          std::string::npos);
}

TEST_CASE("the best fixed choice is the fastest of equal quality that ran in all alternations")
{
    std::vector<Row> rows{rowOf("rules", {9.0, 9.0}), rowOf("rays", {10.0, 10.0}), rowOf("wrong", {5.0, 5.0}),
                          rowOf("once", {6.0}), rowOf("volume", {9.5, 11.5})};
    rows[0].adaptive = true;
    rows[2].errors = errorsOf(201, 0);
    const Standing standing = standingOf(rows, false, kQuality, {}, 0);
    REQUIRE(standing.adaptive.size() == 1);
    CHECK(standing.fixed.size() == 4);
    CHECK(standing.fixed.front()->name == "wrong");
    REQUIRE(standing.equal.size() == 2);
    CHECK(bestFixed(standing.equal)->name == "rays");
    CHECK(standingOf(rows, true, kQuality, {}, 0).fixed.empty());
    rows[4].runs[1].sentinelMs.assign(20, 2.0); // it was the machine that was slow
    CHECK(bestFixed(standingOf(rows, false, kQuality, {}, 0).equal, 1.0)->name == "volume");
    CHECK(bestFixed({}) == nullptr);
}

TEST_CASE("the budget is 1.3 times the cheapest fixed choice of equal quality in each frame, or the host's")
{
    std::vector<Row> rows{rowOf("rules", {14.0}), rowOf("rays", {10.0}), rowOf("volume", {20.0})};
    rows[0].adaptive = true;
    for (size_t i = 10; i < 20; ++i) { // the volume becomes the cheaper one
        rows[1].runs[0].shadowMs[i] = 50.0;
        rows[2].runs[0].shadowMs[i] = 4.0;
    }
    const Standing standing = standingOf(rows, false, kQuality, {}, 5);
    CHECK(standing.budgetMs.front() == doctest::Approx(1.3 * 5.0));
    CHECK(standing.budgetMs.back() == doctest::Approx(1.3 * 4.0));
    const OverBudget over = overBudget(rows[0], standing); // 7 ms: over both
    CHECK(over.frames.counted == 15);
    CHECK(over.frames.over == 15);
    CHECK(over.frames.worst == doctest::Approx(7.0 / (1.3 * 4.0)));
    CHECK(overBudget(rows[0], standingOf(rows, false, kQuality, std::vector(20, 7.0), 5)).frames.over == 0);
    rows[1].errors = rows[2].errors = errorsOf(9999, 0);
    CHECK(overBudget(rows[0], standingOf(rows, false, kQuality, {}, 5)).percents.empty());
}

TEST_CASE("budgets over the cheapest choice follow it frame by frame, and there are none without a choice")
{
    std::vector<Row> rows{rowOf("rays", {10.0, 14.0, 12.0}), rowOf("volume", {20.0})}; // shadows: 6 ms, 10 ms
    for (size_t i = 10; i < 20; ++i)
        rows[1].runs[0].shadowMs[i] = 2.0;
    const std::array<const Row*, 2> both{&rows[0], &rows[1]};
    const std::vector<double> budgets = budgetsOver(both, 1.5);
    REQUIRE(budgets.size() == 20);
    CHECK(budgets.front() == doctest::Approx(1.5 * 6.0));
    CHECK(budgets.back() == doctest::Approx(1.5 * 2.0));
    CHECK(budgetsOver({}, 1.5).empty());
}

TEST_CASE("frames that were disturbed or whose time is not known count for no budget")
{
    RunRecord run = steady(10.0, 4);
    run.sentinelMs[1] = 1.2;
    run.shadowMs[2] = kNaN;
    run.shadowMs[3] = 30.0;
    const BudgetCount count = countOver(run, std::vector(4, 6.0), 0);
    CHECK(count.counted == 2);
    CHECK(count.over == 1);
    CHECK(count.percent() == doctest::Approx(50.0));
    CHECK(totalShadowMs(run) == doctest::Approx(4.0 * 40.0 / 3.0));
}

TEST_CASE("the runtime's own budget tells frames held up by others and budgets that nothing keeps")
{
    Row row{.name = "rules", .runs = {steady(10.0, 4)}};
    RunRecord& run = row.runs[0];
    run.budgetMs = {0.0, 4.0, 4.0, 6.0};
    run.predictedMs = {1.0, 3.0, 4.5, 3.0};
    run.othersMs = {0.0, 1.5, 0.0, 0.0};
    const OwnBudget own = countOwnBudget(row, 0);
    CHECK(own.frames.counted == 2);
    CHECK(own.frames.over == 1);
    CHECK(own.heldUp == 1);
    CHECK(own.infeasible == 1);
    CHECK(own.leastMs == 4.0);
    CHECK(own.mostMs == 6.0);
}

TEST_CASE("a path is the seconds asked for in steps of the stride, and knows its cuts and its first second")
{
    Scene scene;
    scene.framesPerSecond = 60.0;
    scene.frames = 240;
    scene.camera = {{.time = 0.0}, {.time = 1.0, .cut = true}};
    CHECK(ComparePath(scene, 0.0, 1).frames == 240);
    CHECK(ComparePath(scene, 0.0, 7).frames == 35);
    const ComparePath path(scene, 10.0, 6);
    CHECK(path.frames == 100);
    CHECK(path.time(99) == doctest::Approx(9.9));
    CHECK(path.afterFirstSecond() == 10);
    CHECK(path.cut(0));
    CHECK_FALSE(path.cut(9));
    CHECK(path.cut(10));
    CHECK_FALSE(path.cut(11));
    CHECK(ComparePath(scene, 0.001, 1).frames == 2);
}

TEST_CASE("medians leave out what is not known")
{
    CHECK(medianOf(std::vector{3.0, kNaN, 1.0}) == 2.0);
    CHECK(medianOf(std::vector{5.0, 1.0, 3.0}) == 3.0);
    CHECK(std::isnan(medianOf(std::vector{kNaN})));
    CHECK(runningMedian(std::vector{1.0, 9.0, 2.0, 3.0}, 3) == std::vector{5.0, 2.0, 3.0, 2.5});
}
