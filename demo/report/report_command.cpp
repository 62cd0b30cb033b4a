// `gnomon report`: what a run, and measurements beside it, have shown, as one page.
#include <algorithm>
#include <cstdio>
#include <optional>

#include "demo/io/file.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/session.hpp"
#include "demo/report/csv_reader.hpp"
#include "demo/report/page.hpp"
#include "demo/report/sections.hpp"

namespace gnomon::demo {

std::string shellQuoted(const std::string& word)
{
    constexpr std::string_view plain = "_./,=:+-";
    const bool isPlain = !word.empty() && std::all_of(word.begin(), word.end(), [&](unsigned char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               plain.find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (isPlain) return word;
    std::string out = "'";
    for (const char c : word)
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

namespace {

constexpr size_t kMostBytes = 2'000'000; ///< Of a page: what a mail takes and a browser opens at once.

/// What a page is made of.
struct Material {
    std::optional<RunData> run; ///< None: tables alone.
    Compared compared;
    Benched benched;
    std::vector<std::string> commands; ///< Of the tables and of the page, in the order in which they are typed.
    std::vector<std::string> notes;
};

template <typename Table>
void take(const Table& table, const std::string& command, Material& all)
{
    all.notes.insert(all.notes.end(), table.notes.begin(), table.notes.end());
    if (!command.empty()) all.commands.push_back(command);
}

Material readAll(const ReportOptions& options, const std::filesystem::path& folder)
{
    Material all;
    if (!folder.empty()) {
        all.run = valueOf(readRun(folder));
        take(*all.run, all.run->fact("command"), all);
    }
    for (const std::string& file : options.compare) {
        const Compared more = valueOf(readCompared(file));
        all.compared.runs.insert(all.compared.runs.end(), more.runs.begin(), more.runs.end());
        take(more, commandIn(file), all);
    }
    for (const std::string& file : options.bench) {
        const Benched more = valueOf(readBenched(file));
        all.benched.rows.insert(all.benched.rows.end(), more.rows.begin(), more.rows.end());
        take(more, commandIn(file), all);
    }
    return all;
}

std::string commandOf(const ReportOptions& options)
{
    std::string command = "gnomon report";
    if (!options.run.empty()) command.append(" ").append(shellQuoted(options.run));
    for (const std::string& file : options.compare)
        command += " --compare " + shellQuoted(file);
    for (const std::string& file : options.bench)
        command += " --bench " + shellQuoted(file);
    if (!options.to.empty()) command += " --to " + shellQuoted(options.to);
    return command;
}

std::string pageOf(const Material& all, bool withPictures)
{
    const std::string measured = savedSection(all.compared) + errorSection(all.benched);
    const std::string reproduce = reproduceSection(all.commands, all.notes);
    if (!all.run) {
        const char* const head = "<section><h1>Measurements by gnomon</h1></section>\n";
        const char* const none = "<section><p>The tables hold nothing to draw.</p></section>\n";
        return page("gnomon", head + (measured.empty() ? none : measured) + reproduce);
    }
    const RunData& run = *all.run;
    const std::string scene = run.fact("scene");
    return page(scene.empty() ? "gnomon" : scene + " by gnomon",
                headlineSection(run) + frameSection(run) + laneSection(run) + distanceSection(run) + measured +
                    (withPictures ? pictureSection(run) : "") + worstSection(run) + reproduce);
}

} // namespace

int reportCommand(const ReportOptions& options)
{
    namespace fs = std::filesystem;
    const std::vector<std::string>& tables = options.compare.empty() ? options.bench : options.compare;
    const fs::path folder = options.run.empty() && tables.empty() ? "out/run" : options.run;
    const fs::path beside = folder.empty() ? fs::path(tables.front()).parent_path() : folder;
    const fs::path to = options.to.empty() ? beside / "report.html" : fs::path(options.to);
    Material all = readAll(options, folder);
    all.commands.push_back(commandOf(options));
    requireWritable(to);
    std::string text = pageOf(all, true);
    if (text.size() > kMostBytes && all.run && !all.run->pictures.empty()) {
        all.notes.emplace_back("pictures are left out: with them the page would be over 2 MB");
        text = pageOf(all, false);
    }
    if (text.size() > kMostBytes) // rows of tables: none is less worth drawing than another
        all.notes.push_back("the page has " + std::to_string(text.size()) + " bytes, over 2 MB: give it fewer tables");
    for (const std::string& note : all.notes)
        std::fprintf(stderr, "note: %s\n", note.c_str());
    expect(writeFile(to, text));
    std::printf("%s\n", fs::absolute(to).lexically_normal().c_str());
    return 0;
}

} // namespace gnomon::demo
