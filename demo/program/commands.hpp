#pragma once
// The commands of the gnomon program. Each returns its exit code; failures are HostErrors.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::demo {

struct RunOptions {
    std::string scene, rules, method, settings, size;
    std::string knowledge; ///< loadKnowledge().
    uint32_t frames = 0;   ///< 0: the scene's.
    float budgetMs = 0.0f;
    std::string out = "out/run";
    std::string dump;
    uint32_t film = 0;            ///< A picture every so many frames, lights in the colours of their methods; 0: none.
    std::vector<std::string> why; ///< FRAME:LIGHT[:METHOD], answered at the end.
    std::vector<std::string> plugins; ///< Paths.
    bool window = false;
    bool recorded = false;
    bool validation = false;
    uint32_t framesInFlight = 2;
    uint32_t lights = 0; ///< 0: the scene's.
    // For the test under a virtual X server; see demo/README.md.
    std::string screenshot;
    uint32_t resizeTest = 0;
};
int runCommand(const RunOptions& options);
int windowCommand(const RunOptions& options);

/// Radii of the sources, in place of what a scene says. Empty: as it says.
struct SourceSizes {
    std::optional<double> radius;        ///< Of spot and point lights, metres.
    std::optional<double> radiusDegrees; ///< Of directional ones, half angle of the disc.
};

struct BenchOptions {
    std::vector<std::string> scenes;
    std::string methods, lights, maps, settings, size, csv, plot;
    std::vector<std::string> plugins; ///< Paths; their methods are measured beside the others.
    std::string light;                ///< Names: only these of the lights; empty: all.
    SourceSizes sources;
    bool merged = false; ///< What stands still is one mesh.
    uint32_t repeat = 15;
    uint32_t memory = 0; ///< MiB; 0: gnomon's default.
    bool validation = false;
    bool recorded = false;
    bool passes = false;  ///< Print what each pass takes.
    std::string aliasing; ///< Folder for pictures of it; empty: none.
    std::string command;  ///< As it was typed; for the table.
};
int benchCommand(const BenchOptions& options);

struct PublishOptions {
    std::vector<std::string> scenes; ///< Empty: all shipped ones.
    std::vector<std::string> from;   ///< Tables of earlier calls, in place of measuring.
    std::string methods, size = "320x180", out = "docs/comparison.md";
    uint32_t repeat = 5;
};
int publishCommand(const PublishOptions& options);

struct ContactOptions {
    std::vector<std::string> scenes;
    std::string methods, settings, size, out = "contact.png";
    SourceSizes sources;
};
int contactCommand(const ContactOptions& options);

struct CompareOptions {
    std::vector<std::string> scenes;
    std::string rules, methods, size, plot, csv;
    std::string maps = "1024";       ///< Sides of further fixed choices.
    std::string knowledge;           ///< loadKnowledge().
    std::string entry = "submitted"; ///< Or "recorded".
    double seconds = 0.0;            ///< Of the scene's path; 0: all.
    uint32_t lights = 0;             ///< 0: the scene's.
    uint32_t stride = 1;             ///< Every so many of the scene's frames.
    uint32_t alternations = 3;
    bool warm = false;   ///< A second time over the path with the same contexts.
    std::string budget;  ///< One part of parseBudgets(); empty: the host gives none.
    std::string command; ///< As it was typed; for the table.
};
int compareCommand(const CompareOptions& options);

struct CalibrateOptions {
    std::string out, samples, methods, knowledge, size;
    std::string fit, kind = "software"; ///< Samples to fit instead of measuring, and of what they are.
    double secondsPerMethod = 12.0;
    std::vector<std::string> check;  ///< Scenes; empty: measure the sweep.
    std::vector<std::string> errors; ///< Scenes whose wrong pixels are held against what is expected, instead.
    uint32_t map = 1024;             ///< For `errors`: side of maps.
    bool verbose = false;
};
int calibrateCommand(const CalibrateOptions& options);

/// A word of a command line as a POSIX shell reads it back.
std::string shellQuoted(const std::string& word);

struct ReportOptions {
    std::string run;                         ///< A folder of `gnomon run`. Empty: tables alone, or without any out/run.
    std::string to;                          ///< Empty: report.html in it, or beside the first table.
    std::vector<std::string> compare, bench; ///< Tables of these commands.
};
int reportCommand(const ReportOptions& options);

struct TraceOptions {
    std::string scene, rules, methods;
    std::string out = "scene.gntrace", size = "160x120", budget = "auto";
    uint32_t frames = 90, sweeps = 5;
    uint32_t lights = 0; ///< 0: the scene's.
};
int traceCommand(const TraceOptions& options);

struct ReplayCommandOptions {
    std::string trace, rules, budget, knowledge, calibration;
    uint64_t seed = 1;
    double rate = 60.0; ///< Frames a second; 0: as recorded.
};
int replayCommand(const ReplayCommandOptions& options);

int methodsCommand(bool markdown); ///< \param markdown as the table of docs/methods.md.
int scenesCommand();
struct LintOptions {
    std::string rules, trace;
    bool strict = false; ///< Warnings fail as well.
    bool json = false;   ///< Findings as a JSON array on stdout, and nothing else there.
};
int lintCommand(const LintOptions& options);
struct WhyOptions {
    std::string log, light, method;
    uint32_t frame = 0;
    bool whatIf = false, changed = false, sinceSwitch = false;
};
int whyCommand(const WhyOptions& options);
struct PlotOptions {
    std::string rules, out = "rules.html";
    std::string over;  ///< Two variables: also draws who is best suited over them.
    std::string facts; ///< The others, as explainCommand()'s.
    std::string only;  ///< Names of variables and kinds of lights to draw. Empty: all.
};
int plotCommand(const PlotOptions& options);
int explainCommand(const std::string& rules, const std::string& facts);
int presetsCommand(const std::string& rules);
struct ExportOptions {
    std::string rules, out; ///< Empty: the standard output.
    uint32_t resolution = 100;
};
int exportFllCommand(const ExportOptions& options);
int schemaCommand(const std::string& file); ///< \param file `rules`, `scene` or `knowledge`.

} // namespace gnomon::demo
