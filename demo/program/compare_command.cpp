#include <cstdio>
#include <utility>

#include "demo/compare/report.hpp"
#include "demo/program/checks.hpp"

namespace gnomon::demo {

int compareCommand(const CompareOptions& options)
{
    requireScenes(options.scenes);
    requireMethods(parseNames(options.methods));
    (void)mapSides(options);
    requireWritable(options.plot);
    requireGnuplot(options.plot);
    requireWritable(options.csv);
    if (!options.plot.empty() && options.scenes.size() > 1)
        throw HostError("--plot draws one scene, not " + std::to_string(options.scenes.size()));
    CsvWriter csv = emptyTable();
    std::string command = options.command;
    std::vector<ScenePart> parts;
    for (const std::string& scene : options.scenes) {
        Contest contest(options, scene);
        contest.run();
        const std::vector<ScenePart> ofScene = printReport(contest);
        parts.insert(parts.end(), ofScene.begin(), ofScene.end());
        printWords(contest);
        std::printf("\n");
        std::fflush(stdout); // another scene may take an hour
        appendTable(csv, contest, std::exchange(command, {}));
        if (!options.csv.empty()) expect(csv.save(options.csv)); // before drawing, which may fail
        if (!options.plot.empty()) plotFrames(contest, options.plot);
        requireSilence(contest.stage().device);
    }
    if (options.scenes.size() > 1) printSummary(parts);
    return 0;
}

} // namespace gnomon::demo
