// `gnomon report`: what a run, and measurements beside it, have shown, as one page.
#include <algorithm>
#include <cstdio>

#include "demo/io/file.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/session.hpp"
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

int reportCommand(const ReportOptions& options)
{
    const std::filesystem::path folder = options.run;
    const std::filesystem::path to = options.to.empty() ? folder / "report.html" : std::filesystem::path(options.to);
    RunData run = valueOf(readRun(folder));
    requireWritable(to);
    Compared compared;
    for (const std::string& file : options.compare) {
        Compared more = valueOf(readCompared(file));
        compared.runs.insert(compared.runs.end(), more.runs.begin(), more.runs.end());
        run.notes.insert(run.notes.end(), more.notes.begin(), more.notes.end());
    }
    Benched benched;
    for (const std::string& file : options.bench) {
        Benched more = valueOf(readBenched(file));
        benched.rows.insert(benched.rows.end(), more.rows.begin(), more.rows.end());
        run.notes.insert(run.notes.end(), more.notes.begin(), more.notes.end());
    }
    std::string command = "gnomon report " + shellQuoted(options.run);
    for (const std::string& file : options.compare)
        command += " --compare " + shellQuoted(file);
    for (const std::string& file : options.bench)
        command += " --bench " + shellQuoted(file);
    if (!options.to.empty()) command += " --to " + shellQuoted(options.to);
    const std::string body = headlineSection(run) + frameSection(run) + laneSection(run) + distanceSection(run) +
                             savedSection(compared) + errorSection(benched) + pictureSection(run) + worstSection(run) +
                             reproduceSection(run, std::span(&command, 1));
    for (const std::string& note : run.notes)
        std::fprintf(stderr, "note: %s\n", note.c_str());
    const std::string scene = run.fact("scene");
    expect(writeFile(to, page(scene.empty() ? "gnomon" : scene + " by gnomon", body)));
    std::printf("%s\n", std::filesystem::absolute(to).lexically_normal().c_str());
    return 0;
}

} // namespace gnomon::demo
