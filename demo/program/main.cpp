// gnomon: runs scenes, measures methods, checks rules. See demo/README.md.
#include <array>

#include "demo/program/command_line.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/session.hpp"
#include "demo/replay/budget.hpp"
#include "runtime/base/instruction_set.hpp"

namespace {

using namespace gnomon::demo;

std::string rulesHelp()
{
    return "rule base: a path, or one of " + shippedRuleNames() + "; `:PRESET` behind it picks a preset";
}

std::string typedCommand(int argc, char** argv)
{
    std::string text = "gnomon";
    for (int i = 1; i < argc; ++i)
        text.append(" ").append(shellQuoted(argv[i]));
    return text;
}

/// One budget as parseBudgets() reads it, also above 0 as a float: 0 would be none.
CLI::Validator oneBudget()
{
    return {[](const std::string& text) -> std::string {
                const Outcome<std::vector<BudgetPart>> parts = parseBudgets(text);
                if (!parts) return parts.error();
                if (parts->size() == 1 && static_cast<float>(parts->front().value) > 0.0f) return {};
                return text + ": no single budget above 0";
            },
            ""};
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

void addSettings(CLI::App& command, std::string& settings)
{
    command.add_option("--set", settings, "SETTING=NUMBER,... for methods that have the setting");
}

/// What a picture of a scene takes, in a window or without.
void addDrawing(CLI::App& command, RunOptions& options)
{
    command.add_option("SCENE", options.scene, kSceneHelp)->required();
    auto* rules = command.add_option("--rules", options.rules, rulesHelp());
    command.add_option("--method", options.method, "this method for every light it serves, instead of rules")
        ->excludes(rules);
    addSettings(command, options.settings);
    command.add_option("--knowledge", options.knowledge,
                       "what the cost model starts from: a path, `lavapipe` or `h100`; default: the shipped one "
                       "nearest to the device");
    command.add_option("--size", options.size, "picture size, such as 1280x720; default: the scene's");
    command.add_option("--frames", options.frames, "number of frames; default: the scene's, of a window no end")
        ->check(CLI::Range(1, 1000000));
    command.add_option("--lights", options.lights, "number of lights; default: the scene's")->check(CLI::Range(1, 256));
    command
        .add_option("--budget,--budget-ms", options.budgetMs,
                    "for all shadows of a frame, GPU and CPU; default: that of the rules, or none")
        ->check(numberAbove0To(kMostBudget));
    command.add_option("--plugin", options.plugins, "load this plug-in: its methods serve too; may be repeated");
    command.add_option("--why", options.why, "FRAME:LIGHT[:METHOD]: print why (not) at the end; may be repeated");
    command.add_flag("--recorded", options.recorded, "use gnCmdRenderShadows instead of gnSubmitShadows");
    command.add_option("--in-flight", options.framesInFlight, "frames in flight")->check(CLI::Range(1, 8));
    command.add_flag("--validate", options.validation, "run under the validation layer; a message is a failure");
}

/// What a window alone takes.
std::array<CLI::Option*, 2> addWindowTests(CLI::App& command, RunOptions& options)
{
    return {
        command.add_option("--screenshot", options.screenshot, "in a window: save its last picture here"),
        command.add_option("--resize-test", options.resizeTest, "in a window: resize it that many times, then end")};
}

void addRun(CLI::App& app, RunOptions& options, int& exitCode)
{
    CLI::App* run = app.add_subcommand("run", "draw a scene and log what was decided and what it cost");
    addDrawing(*run, options);
    auto* out = run->add_option("--out", options.out, "folder for tables and pictures")->capture_default_str();
    auto* dump = run->add_option("--dump", options.dump, "folder for the last frame's data, for independent checks");
    run->add_option("--film", options.film,
                    "N: every N frames a picture with lights in their methods' colours, frame_*_film.png; others are "
                    "left out")
        ->check(CLI::Range(1, 1000));
    auto* window = run->add_flag("--window", options.window, "as `gnomon window`")->excludes(dump)->excludes(out);
    for (CLI::Option* option : addWindowTests(*run, options))
        option->needs(window);
    run->callback([&] { exitCode = options.window ? windowCommand(options) : runCommand(options); });
}

void addWindow(CLI::App& app, RunOptions& options, int& exitCode)
{
    CLI::App* window = app.add_subcommand("window", "a scene in a window, with a fly camera and a panel that explains");
    addDrawing(*window, options);
    addWindowTests(*window, options);
    window->callback([&] {
        options.window = true;
        exitCode = windowCommand(options);
    });
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
    bench->add_option("SCENE", options.scenes, kSceneHelp)->required();
    bench->add_option("--methods", options.methods,
                      "a,b,... default: all; `none` is the base row, `bare_shadow_map` a baseline without gnomon");
    bench->add_option("--lights", options.lights, "1,2,4,... default: the scene's");
    bench->add_option("--light", options.light, "NAME,... only these of the lights; default: all");
    bench->add_option("--map", options.maps, "512,1024,... for methods with a resolution; default: theirs");
    addSettings(*bench, options.settings);
    addSources(*bench, options.sources);
    bench->add_flag("--merged", options.merged, "what stands still is one mesh, as exporters write buildings");
    bench->add_option("--size", options.size, "picture size; default: the scene's");
    bench->add_option("--repeat", options.repeat, "interleaved pairs of frames")->check(CLI::Range(3, 10000));
    bench->add_option("--memory", options.memory, "MiB that gnomon may take of the device; default: half of the heap")
        ->check(CLI::Range(1, 1 << 20));
    bench->add_option("--plugin", options.plugins, "measure the methods of this plug-in too; may be repeated");
    bench->add_option("--csv", options.csv, "write the table here instead of printing it");
    bench->add_option("--plot", options.plot, "draw error against time of each scene into this SVG file");
    bench->add_flag("--recorded", options.recorded, "use gnCmdRenderShadows; methods with round trips are skipped");
    bench->add_flag("--passes", options.passes, "print the fastest time of every pass, from frames with full barriers");
    bench->add_option("--aliasing", options.aliasing, "write pictures of each map's aliasing into this folder");
    bench->add_flag("--validate", options.validation, "run under the validation layer (times are then meaningless)");
    bench->callback([&] { exitCode = benchCommand(options); });
}

void addPublish(CLI::App& app, PublishOptions& options, int& exitCode)
{
    CLI::App* publish =
        app.add_subcommand("publish", "a page of every method by scene and kind of light: milliseconds, memory, error");
    auto* scenes = publish->add_option("SCENE", options.scenes, "scenes; default: all shipped ones");
    auto* methods = publish->add_option("--methods", options.methods, "a,b,... default: all");
    auto* size = publish->add_option("--size", options.size, "picture size")->capture_default_str();
    auto* repeat = publish->add_option("--repeat", options.repeat, "interleaved pairs of frames")
                       ->check(CLI::Range(3, 10000))
                       ->capture_default_str();
    publish->add_option("--out", options.out, "the page; its table stands beside it, as .csv")->capture_default_str();
    publish
        ->add_option("--from", options.from,
                     "a table of another `publish`, of another device, say, in place of measuring; may be repeated")
        ->excludes(scenes)
        ->excludes(methods)
        ->excludes(size)
        ->excludes(repeat);
    publish->callback([&] { exitCode = publishCommand(options); });
}

void addContact(CLI::App& app, ContactOptions& options, int& exitCode)
{
    CLI::App* contact = app.add_subcommand("contact", "contact sheet: methods by scenes, with the largest errors");
    contact->add_option("SCENE", options.scenes, "scenes; default: all shipped ones");
    contact->add_option("--methods", options.methods, "a,b,... default: all");
    addSettings(*contact, options.settings);
    addSources(*contact, options.sources);
    contact->add_option("--size", options.size, "picture size; default: the scene's");
    contact->add_option("--out", options.out, "PNG file")->capture_default_str();
    contact->callback([&] { exitCode = contactCommand(options); });
}

void addCompare(CLI::App& app, CompareOptions& options, int& exitCode)
{
    CLI::App* compare = app.add_subcommand("compare", "whole runs by the rules against the same by fixed methods");
    compare->add_option("SCENE", options.scenes, kSceneHelp)->required();
    compare->add_option("--rules", options.rules,
                        "a,b,... rule bases of adaptive runs; the first one's floor says what equal quality is; "
                        "default: `default`");
    compare->add_option("--methods", options.methods, "a,b,... of which fixed choices are made; default: all");
    compare->add_option("--map", options.maps, "512,2048,... fixed choices also with maps of these sides")
        ->capture_default_str();
    compare->add_option("--entry", options.entry, "`submitted` (gnSubmitShadows) or `recorded` (gnCmdRenderShadows)")
        ->check(CLI::IsMember({"submitted", "recorded"}))
        ->capture_default_str();
    compare->add_option("--knowledge", options.knowledge,
                        "what the cost model starts from: a path, `lavapipe` or `h100`; default: the shipped one "
                        "nearest to the device");
    compare->add_option("--size", options.size, "picture size; default: the scene's");
    compare->add_option("--lights", options.lights, "number of lights; default: the scene's")
        ->check(CLI::Range(1, 256));
    compare->add_option("--seconds", options.seconds, "of the scene's path; default: all of it")
        ->check(numberAbove0To(86400.0));
    compare->add_option("--stride", options.stride, "draw every so many of the scene's frames")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    compare->add_option("--alternations", options.alternations, "runs of each")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    compare->add_flag("--warm", options.warm, "each run goes over the path once more, in rows of its own");
    compare
        ->add_option("--budget,--budget-ms", options.budget,
                     "for all shadows of a frame, GPU and CPU: milliseconds, or times the cheapest fixed choice of "
                     "equal quality in each frame (1.3x); default: 1.3x is counted, and none given to the runtime")
        ->check(oneBudget());
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
    calibrate->add_option("--samples", options.samples, "write every measurement here");
    auto* fit = calibrate->add_option("--fit", options.fit, "a file of --samples, instead of measuring");
    calibrate->add_option("--kind", options.kind, "with --fit: the device's")
        ->needs(fit)
        ->check(CLI::IsMember({"software", "integrated", "discrete"}))
        ->capture_default_str();
    auto* seconds = calibrate->add_option("--seconds-per-method", options.secondsPerMethod, "as many points as fit")
                        ->check(numberIn(1.0, 3600.0))
                        ->capture_default_str();
    auto* check =
        calibrate->add_option("--check", options.check, "scenes to predict and measure, instead of calibrating")
            ->excludes(seconds)
            ->excludes(fit);
    calibrate->add_option("--knowledge", options.knowledge, "with --check: a path, or the name of a shipped one")
        ->needs(check);
    auto* errors = calibrate
                       ->add_option("--errors", options.errors,
                                    "scenes whose wrong pixels are held against what is expected, light by light, "
                                    "instead of calibrating")
                       ->excludes(seconds)
                       ->excludes(fit)
                       ->excludes(check)
                       ->excludes("--samples")
                       ->excludes("--out");
    calibrate->add_option("--map", options.map, "with --errors: side of maps")
        ->needs(errors)
        ->check(CLI::Range(16, 8192))
        ->capture_default_str();
    calibrate->add_option("--size", options.size, "with --check or --errors: picture size; default: the scene's");
    calibrate->add_flag("--verbose", options.verbose, "with --check: a line per light, method and pass")->needs(check);
    calibrate->callback([&] {
        if (!options.size.empty() && options.check.empty() && options.errors.empty())
            throw CLI::RequiresError("--size", "--check or --errors");
        exitCode = calibrateCommand(options);
    });
}

void addReport(CLI::App& app, ReportOptions& options, int& exitCode)
{
    CLI::App* report = app.add_subcommand("report", "one HTML page about a run, and measurements beside it");
    report->add_option("RUN", options.run,
                       "a folder that `gnomon run` has filled; default: out/run, or none with tables");
    report->add_option("--to", options.to, "file to write; default: report.html in that folder, or beside the table");
    report->add_option("--compare", options.compare, "a table of `gnomon compare --csv`; may be repeated");
    report->add_option("--bench", options.bench, "a table of `gnomon bench --csv`; may be repeated");
    report->callback([&] { exitCode = reportCommand(options); });
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
    trace->add_option("--lights", options.lights, "number of lights; default: the scene's")->check(CLI::Range(1, 256));
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
                       "rule base to ask again; default: what `trace` asked; policy and allocation as `default` says");
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
    PublishOptions publish;
    ContactOptions contact;
    std::string rules, facts;
    addRun(app, run, exitCode);
    RunOptions window;
    addWindow(app, window, exitCode);
    WhyOptions why;
    addWhy(app, why, exitCode);
    addBench(app, bench, exitCode);
    addPublish(app, publish, exitCode);
    addContact(app, contact, exitCode);
    CompareOptions compare;
    bench.command = compare.command = typedCommand(argc, argv);
    addCompare(app, compare, exitCode);
    CalibrateOptions calibrate;
    addCalibrate(app, calibrate, exitCode);
    ReportOptions report;
    addReport(app, report, exitCode);
    TraceOptions trace;
    addTrace(app, trace, exitCode);
    ReplayCommandOptions replay;
    addReplay(app, replay, exitCode);
    bool markdown = false;
    CLI::App* methods = app.add_subcommand("methods", "list the methods of this build and device");
    methods->add_flag("--markdown", markdown, "as the table of docs/methods.md");
    methods->callback([&] { exitCode = methodsCommand(markdown); });
    app.add_subcommand("scenes", "list the shipped scenes")->callback([&] { exitCode = scenesCommand(); });
    CLI::App* lint = app.add_subcommand("lint", "check a rule base");
    LintOptions lintOptions;
    lint->add_option("RULES", lintOptions.rules, rulesHelp())->required();
    lint->add_option("--trace", lintOptions.trace,
                     "a recorded trace: also report decisions that its noise overturns (L08)");
    lint->add_flag("--strict", lintOptions.strict, "warnings fail as errors do");
    lint->add_flag("--json", lintOptions.json, "findings as a JSON array, for editors and scripts");
    lint->callback([&] { exitCode = lintCommand(lintOptions); });
    CLI::App* plot = app.add_subcommand("plot", "draw the terms of a rule base, and who is best suited where");
    PlotOptions plotOptions;
    plot->add_option("RULES", plotOptions.rules, rulesHelp())->required();
    auto* over = plot->add_option("--over", plotOptions.over, "A,B: two facts over which the best suited is drawn");
    plot->add_option("--facts", plotOptions.facts, "name=value,... of the other facts; what is not given is unknown")
        ->needs(over);
    plot->add_option("--only", plotOptions.only, "a,b,... draw these variables and kinds of lights; default: all");
    plot->add_option("--out", plotOptions.out, "HTML file, or SVG where it is called so")->capture_default_str();
    plot->callback([&] { exitCode = plotCommand(plotOptions); });
    CLI::App* explain = app.add_subcommand("explain", "say what a rule base thinks of given facts, and why");
    explain->add_option("RULES", rules, rulesHelp())->required();
    explain->add_option("--facts", facts, "name=value,...; what is not given is unknown")->required();
    explain->callback([&] { exitCode = explainCommand(rules, facts); });

    CLI::App* presets = app.add_subcommand("presets", "list the presets of a rule base");
    presets->add_option("RULES", rules, rulesHelp() + "; default: `default`");
    presets->callback([&] { exitCode = presetsCommand(rules); });
    CLI::App* fll = app.add_subcommand("export-fll", "write a rule base in fuzzylite's language (FLL 6)");
    ExportOptions exportOptions;
    fll->add_option("RULES", exportOptions.rules, rulesHelp())->required();
    fll->add_option("--out", exportOptions.out, "file; default: the standard output");
    fll->add_option("--resolution", exportOptions.resolution, "samples of the centroid")
        ->check(CLI::Range(2, 100000))
        ->capture_default_str();
    fll->callback([&] { exitCode = exportFllCommand(exportOptions); });
    CLI::App* schema = app.add_subcommand("schema", "print the JSON Schema of a kind of file, for editors");
    std::string schemaOf;
    schema->add_option("FILE", schemaOf, "`rules`, `scene` or `knowledge`")
        ->required()
        ->check(CLI::IsMember({"rules", "scene", "knowledge"}));
    schema->callback([&] { exitCode = schemaCommand(schemaOf); });

    return runCommandLine(app, argc, argv, exitCode);
}
