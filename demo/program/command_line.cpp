#include "demo/program/command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>

#include "demo/io/number.hpp"
#include "rules/engine/diagnostic.hpp"

namespace gnomon::demo {
namespace {

constexpr int kNotUnderstood = 2; ///< Exit code: the command line; what fails later is 1.

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

/// The first word is no command. CLI11 would say that one is required, not that this is none.
bool isUnknownCommand(const CLI::App& app, int argc, char** argv)
{
    if (argc < 2 || argv[1][0] == '-') return false;
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return false;
    const std::vector<std::string_view> known(names.begin(), names.end());
    std::fprintf(stderr, "%s: no command '%s'%s\n", app.get_name().c_str(), argv[1],
                 rules::suggestion(argv[1], known).c_str());
    return true;
}

/// The exit code, unless what was printed has not arrived, as on a full disk.
int finish(const CLI::App& app, int exitCode)
{
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return exitCode;
    std::fprintf(stderr, "%s: standard output: cannot be written\n", app.get_name().c_str());
    return 1;
}

} // namespace

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

CLI::Validator numberAbove0To(double high)
{
    std::string last;
    appendNumber(last, high);
    const auto check = [=](const std::string& text) {
        const std::optional<double> value = parseNumber(text);
        if (value && static_cast<float>(*value) > 0.0f && *value <= high) return std::string();
        return "'" + text + "' is no number above 0, up to " + last;
    };
    return {check, "above 0, up to " + last};
}

CLI::Validator notNegative()
{
    return {[](const std::string& text) { return text.starts_with('-') ? "'" + text + "' is below 0" : std::string(); },
            ""};
}

int runCommandLine(CLI::App& app, int argc, char** argv, const int& exitCode)
{
    refuseNothing(app);
    if (isUnknownCommand(app, argc, argv)) return kNotUnderstood;
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return finish(app, app.exit(error) == 0 ? 0 : kNotUnderstood); // --help ends here, too
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
        return 1;
    }
    return finish(app, exitCode);
}

} // namespace gnomon::demo
