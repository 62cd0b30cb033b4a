// What `gnomon run --dump` leaves, judged by a program that knows nothing of gnomon (judge_dump.cpp).
#include "cli_fixture.hpp"

#include <sstream>

namespace gnomon::demo {
namespace {

Ran judged(const std::string& arguments)
{
    return run("'" GNOMON_JUDGE_DUMP "' " + arguments);
}

/// Exact methods that the device can run, as `gnomon methods` lists them.
std::vector<std::string> exactMethods()
{
    const Ran ran = gnomonProgram("methods");
    REQUIRE(ran.exitCode == 0);
    std::vector<std::string> names;
    std::istringstream lines(ran.output);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with(" ") && line.find(", exact") != std::string::npos &&
            line.find("; unavailable: ") == std::string::npos)
            names.push_back(line.substr(0, line.find(":")));
    return names;
}

} // namespace

TEST_CASE("by an outsider's rays, too, mirrored, inverted and masked casters are shown right by every exact method")
{
    const std::vector<std::string> methods = exactMethods();
    REQUIRE(methods.size() > 5);
    for (const std::string& method : methods) {
        CAPTURE(method);
        const Folder folder("outside");
        const std::string dump = (folder.path / "dump").string();
        const Ran ran = gnomonProgram("run '" GNOMON_TEST_SCENES "/sides.yaml' --size 320x180 --method " + method +
                                      " --out '" + folder.path.string() + "' --dump '" + dump + "'");
        REQUIRE_MESSAGE(ran.exitCode == 0, ran.output);
        // 0.01 % at 640x360, the scene's own size; of half the width twice the share of pixels lies along edges.
        const Ran judgement = judged("0.02 '" + dump + "'");
        CHECK_MESSAGE(judgement.exitCode == 0, judgement.output);
        CHECK_MESSAGE(judgement.output.find(method + " spot: ") != std::string::npos, judgement.output);
        MESSAGE(judgement.output);
    }
}

} // namespace gnomon::demo
