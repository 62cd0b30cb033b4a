// gnomon: runs scenes, measures methods, checks rules. See demo/README.md.
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "demo/io/number.hpp"
#include "demo/program/commands.hpp"
#include "demo/replay/budget.hpp"
#include "runtime/base/instruction_set.hpp"

namespace {

using namespace gnomon::demo;

constexpr const char* kRulesHelp = "rule base: a path, or `default`, `quality`, `battery` or `thesis`";
constexpr const char* kSceneHelp = "path of a scene file, or the name of a shipped one (see `gnomon scenes`)";

/// CLI::Range lets NaN pass.
CLI::Validator numberIn(double low, double high)
{
    std::string first, last;
    appendNumber(first, low);
    appendNumber(last, high);
    const auto check = [=](const std::string& text) {
        const std::optional<double> value = parseNumber(text);
        if (value && *value >= low && *value <= high) return std::string();
        return "'" + text + "' is no number from " + first + " to " + last;
    };
    return {check, "in [" + first + " - " + last + "]"};
}

/// CLI11 takes -1 for the largest number of 64 bits.
CLI::Validator notNegative()
{
    return {[](const std::string& text) { return text.starts_with('-') ? "'" + text + "' is below 0" : std::string(); },
            ""};
}

/// Where a name is wanted, blanks and commas alone are none; the default would take their place unsaid.
void refuseNothing(CLI::App& app)
{
    const CLI::Validator hasWord(
        [](const std::string& text) {
            return text.find_first_not_of(" \t,") == std::string::npos ? "'" + text + "' names nothing" : std::string();
        },
        "");
    for (CLI::App* command : app.get_subcommands({}))
        for (CLI::Option* option : command->get_options())
            if (option->get_type_name() == "TEXT") option->check(hasWord);
}

void addSources(CLI::App& command, SourceSizes& sources)
{
    command
        .add_option("--radius", sources.radius,
                    "of the source of every spot and point light, in metres; default: the scene's")
        ->check(numberIn(0.0, 1e6));
    command
        .add_option("--radius-degrees", sources.radiusDegrees,
                    "half angle of the disc of every directional light; default: the scene's")
        ->check(numberIn(0.0, 45.0));
}

void addRun(CLI::App& app, RunOptions& options, int& exitCode)
{
    CLI::App* run = app.add_subcommand("run", "draw a scene and log what was decided and what it cost");
    run->add_option("SCENE", options.scene, kSceneHelp)->required();
    auto* rules = run->add_option("--rules", options.rules, kRulesHelp);
    run->add_option("--method", options.method, "this method for every light it serves, instead of rules")
        ->excludes(rules);
    run->add_option("--knowledge", options.knowledge,
                    "what the cost model starts from: a path, `lavapipe`, `h100`, or `none`; default: by the device");
    run->add_option("--size", options.size, "picture size, such as 1280x720; default: the scene's");
    run->add_option("--frames", options.frames, "number of frames; default: the scene's")
        ->check(CLI::Range(1, 1000000));
    run->add_option("--lights", options.lights, "number of lights; default: the scene's")->check(CLI::Range(1, 32));
    run->add_option("--budget-ms", options.budgetMs,
                    "for all shadows of a frame, GPU and CPU; default: that of the rules, or none")
        ->check(numberIn(0.0, kMostBudget));
    auto* out = run->add_option("--out", options.out, "folder for tables and pictures")->capture_default_str();
    auto* dump = run->add_option("--dump", options.dump, "folder for the last frame's data, for independent checks");
    run->add_option("--why", options.why, "FRAME:LIGHT[:METHOD]: print why (not) at the end; may be repeated");
    auto* window =
        run->add_flag("--window", options.window, "in a window, with a fly camera")->excludes(dump)->excludes(out);
    run->add_flag("--recorded", options.recorded, "use gnCmdRenderShadows instead of gnSubmitShadows");
    run->add_option("--in-flight", options.framesInFlight, "frames in flight")->check(CLI::Range(1, 8));
    run->add_flag("--validate", options.validation, "run under the validation layer; a message is a failure");
    run->add_option("--screenshot", options.screenshot, "with --window: save the window's last picture here")
        ->needs(window);
    run->add_option("--resize-test", options.resizeTest, "with --window: resize that many times, then end")
        ->needs(window);
    run->callback([&] { exitCode = options.window ? windowCommand(options) : runCommand(options); });
}

void addWhy(CLI::App& app, WhyOptions& options, int& exitCode)
{
    CLI::App* why = app.add_subcommand("why", "ask the log of a run why a light had its method");
    why->add_option("LOG", options.log, "decisions.gnlog of a run")->required();
    why->add_option("--frame", options.frame, "as in lights.csv")->required();
    why->add_option("--light", options.light, "its name")->required();
    auto* no = why->add_option("--not", options.method, "why not this method");
    auto* what = why->add_flag("--what-if", options.whatIf, "the smallest change of each fact that flips the choice");
    auto* changed = why->add_flag("--changed", options.changed, "what changed since the frame before");
    auto* since = why->add_flag("--since-switch", options.sinceSwitch, "what changed since another method served");
    no->excludes(what)->excludes(changed)->excludes(since);
    what->excludes(changed)->excludes(since);
    changed->excludes(since);
    why->callback([&] { exitCode = whyCommand(options); });
}

void addBench(CLI::App& app, BenchOptions& options, int& exitCode)
{
    CLI::App* bench = app.add_subcommand("bench", "time and error of methods, one CSV row each");
    auto* scenes = bench->add_option("SCENE", options.scenes, kSceneHelp);
    auto* figure =
        bench->add_option("--figure", options.figure, "a figure of Rautenbach 2008 instead of scenes: 4.6, 4.40, ...");
    figure->excludes(scenes);
    bench->add_option("--out", options.out, "with --figure: PNG file, drawn by gnuplot")->needs(figure);
    bench->add_flag("--still", options.still, "with --figure: the model stands still")->needs(figure);
    bench->add_option("--methods", options.methods,
                      "a,b,... default: all; `none` is the base row, `bare_shadow_map` a baseline without gnomon");
    bench->add_option("--lights", options.lights, "1,2,4,... default: the scene's");
    bench->add_option("--light", options.light, "NAME,... only these of the lights; default: all");
    bench->add_option("--map", options.maps, "512,1024,... for methods with a resolution; default: theirs");
    bench->add_option("--set", options.settings, "SETTING=NUMBER,... for methods that have the setting");
    addSources(*bench, options.sources);
    bench->add_flag("--merged", options.merged, "what stands still is one mesh, as exporters write buildings");
    bench->add_option("--size", options.size, "picture size; default: the scene's");
    bench->add_option("--repeat", options.repeat, "interleaved pairs of frames")->check(CLI::Range(3, 10000));
    bench->add_option("--memory", options.memory, "MiB that gnomon may take of the device; default: half of the heap")
        ->check(CLI::Range(1, 1 << 20));
    bench->add_option("--csv", options.csv, "write the table here instead of printing it");
    bench->add_flag("--recorded", options.recorded, "use gnCmdRenderShadows; methods with round trips are skipped");
    bench->add_flag("--passes", options.passes, "print the fastest time of every pass, from frames with full barriers");
    bench->add_flag("--validate", options.validation, "run under the validation layer (times are then meaningless)");
    for (const char* other : {"--methods", "--lights", "--light", "--map", "--set", "--radius", "--radius-degrees",
                              "--merged", "--memory", "--recorded", "--passes", "--validate"})
        figure->excludes(bench->get_option(other)); // a figure says these itself
    bench->callback([&, scenes] {
        if (options.figure.empty() && options.scenes.empty()) throw CLI::RequiredError(scenes->get_name());
        exitCode = options.figure.empty() ? benchCommand(options) : figureCommand(options);
    });
}

void addContact(CLI::App& app, ContactOptions& options, int& exitCode)
{
    CLI::App* contact = app.add_subcommand("contact", "contact sheet: methods by scenes, with the largest errors");
    contact->add_option("SCENE", options.scenes, "scenes; default: all shipped ones");
    contact->add_option("--methods", options.methods, "a,b,... default: all");
    addSources(*contact, options.sources);
    contact->add_option("--size", options.size, "picture size; default: the scene's");
    contact->add_option("--out", options.out, "PNG file")->capture_default_str();
    contact->callback([&] { exitCode = contactCommand(options); });
}

void addReasons(CLI::App& app, ReasonsOptions& options, int& exitCode)
{
    CLI::App* reasons =
        app.add_subcommand("reasons", "why a hybrid method's pixels are lit or dark, and how often wrongly");
    reasons->add_option("SCENE", options.scene, kSceneHelp)->required();
    reasons->add_option("--method", options.method, "one with the setting `reasons`")->required();
    reasons->add_option("--light", options.light, "its name; default: all lights");
    reasons->add_option("--set", options.settings, "SETTING=NUMBER,... of the method's, but for `reasons`");
    reasons->add_option("--size", options.size, "picture size; default: the scene's");
    reasons->add_option("--frame", options.frame, "of the scene; default: the middle one");
    reasons->add_option("--out", options.out, "PNG file: the reasons as colours over the picture");
    reasons->callback([&] { exitCode = reasonsCommand(options); });
}

void addTables(CLI::App& app, TablesOptions& options, int& exitCode)
{
    CLI::App* tables =
        app.add_subcommand("tables", "a thesis's main tables on the scenes views/..., printed numbers / ours");
    tables->add_option("THESIS", options.thesis, "moderno or morais")
        ->required()
        ->check(CLI::IsMember({"moderno", "morais"}));
    tables->add_option("--csv", options.csv, "write a line per cell here as well");
    tables->add_option("--picture", options.picture, "pixels a side; other sizes than the theses' change all numbers")
        ->check(CLI::Range(64, 4096))
        ->capture_default_str();
    tables->add_flag("--tight", options.tight,
                     "moderno: texels as of a map fitted in width and height to what is seen, not of a square one");
    tables->callback([&] { exitCode = tablesCommand(options); });
}

void addCompare(CLI::App& app, CompareOptions& options, int& exitCode)
{
    CLI::App* compare = app.add_subcommand("compare", "whole runs by the rules against the same by one method each");
    compare->add_option("SCENE", options.scene, kSceneHelp)->required();
    compare->add_option("--rules", options.rules, "a,b,... rule bases of adaptive runs; default: `default`");
    compare->add_option("--methods", options.methods, "a,b,... default: all that serve every light");
    compare->add_option("--size", options.size, "picture size; default: the scene's");
    compare->add_option("--frames", options.frames, "frames of a run; default: the scene's")
        ->check(CLI::Range(2, 1000000));
    compare->add_option("--alternations", options.alternations, "runs of each")->check(CLI::Range(1, 1000));
    compare
        ->add_option("--budget-ms", options.budgetMs,
                     "for all shadows of a frame, GPU and CPU; default: that of the rules, or none")
        ->check(numberIn(0.0, kMostBudget));
    compare->add_option("--plot", options.plot, "PNG file of every frame's time, drawn by gnuplot");
    compare->add_option("--csv", options.csv, "write every frame's time of every run here");
    compare->callback([&] { exitCode = compareCommand(options); });
}

void addCalibrate(CLI::App& app, CalibrateOptions& options, int& exitCode)
{
    CLI::App* calibrate = app.add_subcommand("calibrate", "measure methods, so that the cost model knows this device");
    calibrate->add_option("--out", options.out,
                          "knowledge base to write; default: knowledge.csv, with --check nothing");
    calibrate->add_option("--methods", options.methods, "a,b,... default: all");
    auto* seconds = calibrate->add_option("--seconds-per-method", options.secondsPerMethod, "as many points as fit")
                        ->check(numberIn(1.0, 3600.0))
                        ->capture_default_str();
    auto* check =
        calibrate->add_option("--check", options.check, "scenes to predict and measure, instead of calibrating")
            ->excludes(seconds);
    calibrate->add_option("--knowledge", options.knowledge, "with --check: a path, or the name of a shipped one")
        ->needs(check);
    calibrate->add_option("--size", options.size, "with --check: picture size; default: the scene's")->needs(check);
    calibrate->add_flag("--verbose", options.verbose, "with --check: a line per light, method and pass")->needs(check);
    calibrate->callback([&] { exitCode = calibrateCommand(options); });
}

void addTrace(CLI::App& app, TraceOptions& options, int& exitCode)
{
    CLI::App* trace = app.add_subcommand("trace", "measure every method on every frame of a scene, for `replay`");
    trace->add_option("SCENE", options.scene, kSceneHelp)->required();
    trace->add_option("--out", options.out, "file to write")->capture_default_str();
    trace->add_option("--frames", options.frames, "spread evenly over the scene's length")
        ->check(CLI::Range(2, 65536))
        ->capture_default_str();
    trace->add_option("--sweeps", options.sweeps, "runs of each method; the fastest of each frame counts")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    trace->add_option("--size", options.size, "picture size")->capture_default_str();
    trace->add_option("--lights", options.lights, "number of lights; default: the scene's")->check(CLI::Range(1, 32));
    trace->add_option("--rules", options.rules, "rule base to ask; default: `default`");
    trace->add_option("--methods", options.methods, "a,b,... default: all that serve a light");
    trace
        ->add_option("--budget-ms", options.budget,
                     "a,b,...: equal parts of the trace; each a number, or `1.3x` the cheapest plan, or `auto`")
        ->capture_default_str();
    trace->callback([&] { exitCode = traceCommand(options); });
}

void addReplay(CLI::App& app, ReplayCommandOptions& options, int& exitCode)
{
    CLI::App* replay = app.add_subcommand("replay", "what the plan and others make of a trace");
    replay->add_option("TRACE", options.trace, "a file of `gnomon trace`")->required();
    replay->add_option("--rules", options.rules,
                       "rule base to ask anew; default: what `trace` asked; policy and allocation as `default` says");
    replay->add_option("--budget-ms", options.budget, "as for `trace`; default: as recorded");
    auto* knowledge = replay->add_option("--knowledge", options.knowledge,
                                         "where the cost model starts: a path, or `none`; default: the shipped one");
    replay->add_option("--calibration", options.calibration, "start from another trace instead")->excludes(knowledge);
    replay->add_option("--seed", options.seed, "of the noise")->check(notNegative())->capture_default_str();
    replay->add_option("--rate", options.rate, "frames a second, in between what was recorded; 0: as recorded")
        ->check(numberIn(0.0, 1000.0))
        ->capture_default_str();
    replay->callback([&] { exitCode = replayCommand(options); });
}

/// The first word is no command. CLI11 would say that one is required, not that this is none.
bool isUnknownCommand(const CLI::App& app, int argc, char** argv)
{
    if (argc < 2 || argv[1][0] == '-') return false;
    std::string known;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (command->get_name() == argv[1]) return false;
        known += (known.empty() ? "" : ", ") + command->get_name();
    }
    std::fprintf(stderr, "gnomon: no command '%s'; there are %s\n", argv[1], known.c_str());
    return true;
}

/// The exit code, unless what was printed has not arrived, as on a full disk.
int finish(int exitCode)
{
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return exitCode;
    std::fprintf(stderr, "gnomon: standard output: cannot be written\n");
    return 1;
}

} // namespace

int main(int argc, char** argv)
{
    if (!gnomon::limitByEnvironment()) return 1;
    CLI::App app("Adaptive shadows for Vulkan renderers: the demo of gnomon", "gnomon");
    app.set_version_flag("--version", "gnomon " GNOMON_VERSION);
    app.require_subcommand(1);
    int exitCode = 0;
    RunOptions run;
    BenchOptions bench;
    ContactOptions contact;
    ReasonsOptions reasons;
    std::string rules, facts, lintTrace;
    addRun(app, run, exitCode);
    WhyOptions why;
    addWhy(app, why, exitCode);
    addBench(app, bench, exitCode);
    addContact(app, contact, exitCode);
    addReasons(app, reasons, exitCode);
    TablesOptions tables;
    addTables(app, tables, exitCode);
    CompareOptions compare;
    addCompare(app, compare, exitCode);
    CalibrateOptions calibrate;
    addCalibrate(app, calibrate, exitCode);
    TraceOptions trace;
    addTrace(app, trace, exitCode);
    ReplayCommandOptions replay;
    addReplay(app, replay, exitCode);
    app.add_subcommand("methods", "list the methods of this build and device")->callback([&] {
        exitCode = methodsCommand();
    });
    app.add_subcommand("scenes", "list the shipped scenes")->callback([&] { exitCode = scenesCommand(); });
    CLI::App* lint = app.add_subcommand("lint", "check a rule base");
    lint->add_option("RULES", rules, kRulesHelp)->required();
    lint->add_option("--trace", lintTrace, "a recorded trace: also report decisions that its noise overturns (L08)");
    lint->callback([&] { exitCode = lintCommand(rules, lintTrace); });
    CLI::App* explain = app.add_subcommand("explain", "say what a rule base thinks of given facts, and why");
    explain->add_option("RULES", rules, kRulesHelp)->required();
    explain->add_option("--facts", facts, "name=value,...; what is not given is unknown")->required();
    explain->callback([&] { exitCode = explainCommand(rules, facts); });

    refuseNothing(app);
    if (isUnknownCommand(app, argc, argv)) return 1;
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return finish(app.exit(error));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "gnomon: %s\n", error.what());
        return 1;
    }
    return finish(exitCode);
}
