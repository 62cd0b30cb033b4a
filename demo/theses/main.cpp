// gnomon-theses: repeats tables and figures of the theses with gnomon's methods. See demo/theses/README.md.
#include "demo/program/command_line.hpp"
#include "demo/theses/commands.hpp"
#include "runtime/base/instruction_set.hpp"

namespace {

using namespace gnomon::demo;

void addTables(CLI::App& app, TablesOptions& options, int& exitCode)
{
    CLI::App* tables =
        app.add_subcommand("tables", "a thesis's main tables on the scenes views/..., printed numbers / ours");
    tables->add_option("THESIS", options.thesis, "macedo, moderno, morais or navratil")
        ->required()
        ->check(CLI::IsMember({"macedo", "moderno", "morais", "navratil"}));
    tables->add_option("--csv", options.csv, "write a line per cell here as well");
    tables->add_option("--picture", options.picture, "pixels a side; other sizes than the theses' change all numbers")
        ->check(CLI::Range(64, 4096))
        ->capture_default_str();
    tables->add_flag("--tight", options.tight,
                     "moderno: texels as of a map fitted in width and height to what is seen, not of a square one");
    tables->add_option("--repeat", options.repeat, "macedo, navratil: frames that are timed for each number")
        ->check(CLI::Range(3, 10000))
        ->capture_default_str();
    tables
        ->add_option("--share", options.share,
                     "navratil: of the thesis's vertices and lamps; macedo: of the sides of pictures and maps")
        ->check(CLI::Range(0.001, 1.0))
        ->capture_default_str();
    tables->callback([&] { exitCode = tablesCommand(options); });
}

void addFigure(CLI::App& app, FigureOptions& options, int& exitCode)
{
    CLI::App* figure =
        app.add_subcommand("figure", "a figure of Rautenbach 2008, chapter 4: time over lights and faces");
    figure->add_option("FIGURE", options.figure, "its number: 4.6, 4.40, ...")->required();
    figure->add_flag("--still", options.still, "the model stands still");
    figure->add_option("--size", options.size, "picture size; default: the scene's");
    figure->add_option("--repeat", options.repeat, "interleaved pairs of frames")
        ->check(CLI::Range(3, 10000))
        ->capture_default_str();
    figure->add_option("--csv", options.csv, "write the table here instead of printing it");
    figure->add_option("--out", options.out, "PNG file, drawn by gnuplot");
    figure->callback([&] { exitCode = figureCommand(options); });
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

} // namespace

int main(int argc, char** argv)
{
    if (!gnomon::limitByEnvironment()) return 1;
    CLI::App app("Tables and figures of the theses that gnomon builds on, repeated with its methods", "gnomon-theses");
    app.set_version_flag("--version", "gnomon-theses " GNOMON_VERSION);
    app.require_subcommand(1);
    int exitCode = 0;
    TablesOptions tables;
    addTables(app, tables, exitCode);
    FigureOptions figure;
    addFigure(app, figure, exitCode);
    ReasonsOptions reasons;
    addReasons(app, reasons, exitCode);
    return runCommandLine(app, argc, argv, exitCode);
}
