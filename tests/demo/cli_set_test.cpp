// What `--set` sets, and what each of the commands that take it refuses.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "cli_fixture.hpp"
#include "demo/io/csv.hpp"

namespace gnomon::demo {

namespace {

/// The per cent of wrong pixels that `contact` prints; negative: none.
double wrongPercent(const Ran& ran)
{
    const size_t at = ran.output.find("  wrong ");
    return at == std::string::npos ? -1.0 : std::stod(ran.output.substr(at + 8));
}

/// The sides of maps in lights.csv, each once.
std::set<std::string> mapSides(const fs::path& folder)
{
    std::set<std::string> sides;
    for (const std::string& line : lines(folder / "lights.csv")) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(line, cells));
        sides.insert(cells.at(8));
    }
    sides.erase("map_side");
    return sides;
}

} // namespace

TEST_CASE("what --set cannot mean is refused by each command in the same words, before a device is looked for")
{
    const Folder folder("set_words");
    const std::pair<std::string, const char*> cases[] = {
        {"--set reslution=64", "--set: no method has a setting 'reslution'; did you mean 'resolution'?"},
        {"--set resolution", "--set wants SETTING=NUMBER, not 'resolution'"},
        {"--set resolution=x", "--set wants SETTING=NUMBER, not 'resolution=x'"},
        {"--set resolution=64,resolution=32", "--set names 'resolution' twice"},
        {"--set reasons=1", "--set: 'reasons' puts codes in place of visibility"},
    };
    const std::pair<std::string, const char*> byMethod[] = {
        {"--set rows=64", "--set: no method that is asked for has a setting 'rows'; it belongs to "},
        {"--set resolution=1e9", "--set: shadow_map takes 'resolution' from "},
    };
    const std::string before = "cd '" + folder.path.string() + "' && env -u DISPLAY GNOMON_DEVICE=none";
    const auto refuses = [&](const std::string& command, const char* words) {
        CAPTURE(command);
        const Ran ran = gnomonProgram(command, before);
        CHECK(ran.exitCode == 1);
        CHECK_MESSAGE(ran.output.find(words) != std::string::npos, ran.output);
        CHECK(ran.output.find("Vulkan device") == std::string::npos);
        CHECK(ran.output.find("window system") == std::string::npos);
    };
    for (const char* command : {"bench room ", "contact room ", "run room ", "window room ", "run room --window "})
        for (const auto& bad : cases)
            refuses(command + bad.first, bad.second);
    for (const char* command :
         {"contact room --methods shadow_map ", "run room --method shadow_map ", "window room --method shadow_map "})
        for (const auto& bad : byMethod)
            refuses(command + bad.first, bad.second);
    refuses("bench room --methods shadow_map --set rows=64", byMethod[0].second); // ranges once it has a device
}

TEST_CASE("contact draws methods with the settings of --set, and says so beside the picture")
{
    const Folder folder("set_contact");
    const std::string before = "cd '" + folder.path.string() + "' &&";
    const auto sheet = [&](const std::string& set) {
        return gnomonProgram("contact torus_grid --methods shadow_map,ray_traced --size 160x90 --set " + set, before);
    };
    const Ran coarse = sheet("resolution=64"), fine = sheet("resolution=2048");
    REQUIRE_MESSAGE(coarse.exitCode == 0, coarse.output);
    REQUIRE_MESSAGE(fine.exitCode == 0, fine.output);
    CHECK(coarse.output.find("torus_grid  shadow_map resolution=64  wrong ") != std::string::npos);
    CHECK(coarse.output.find("torus_grid  ray_traced  wrong ") != std::string::npos); // has no such setting
    CHECK(wrongPercent(coarse) > 4.0 * wrongPercent(fine));                           // texels are 32 times as wide
    CHECK(wrongPercent(fine) > 0.0);
}

TEST_CASE("run sets what --set says for its method, or for all that have it, and its command says it again")
{
    const Folder folder("set_run");
    const std::string run = "run torus_grid --size 96x54 --frames 2 --out '" + folder.path.string() + "' ";
    const Ran pinned = gnomonProgram(run + "--method shadow_map --set 'resolution = 256'");
    REQUIRE_MESSAGE(pinned.exitCode == 0, pinned.output);
    CHECK(mapSides(folder.path) == std::set<std::string>{"256"});
    const std::vector<std::string> facts = lines(folder.path / "run.csv");
    CHECK(std::ranges::any_of(facts, [](const std::string& line) {
        return line.find("--method shadow_map --set 'resolution = 256'") != std::string::npos;
    }));
    std::ofstream(folder.path / "rules.yaml") << R"(version: 1
name: one
variables:
  recorded: {universe: [0, 1], unit: flag, terms: {no: [-.inf, -.inf, 0, 1]}}
rules:
  - {id: a, rule: if recorded is no then pcss is favoured}
)";
    const Ran ruled =
        gnomonProgram(run + "--set resolution=512 --rules '" + (folder.path / "rules.yaml").string() + "'");
    REQUIRE_MESSAGE(ruled.exitCode == 0, ruled.output);
    CHECK(mapSides(folder.path) == std::set<std::string>{"512"});
}

TEST_CASE("a value that counts as less is said by every command")
{
    const Folder folder("set_clamped");
    const std::string before = "cd '" + folder.path.string() + "' &&";
    for (const char* command :
         {"contact torus_grid --methods moments ", "bench torus_grid --methods moments --repeat 3 ",
          "run torus_grid --method moments --frames 1 "}) {
        const Ran ran = gnomonProgram(command + std::string("--size 64x36 --set exponent=20,bits=16"), before);
        CHECK_MESSAGE(ran.exitCode == 0, ran.output);
        const std::string words = "moments.exponent is 20, which counts as 5.54 beside the other settings";
        const size_t first = ran.output.find(words);
        CHECK_MESSAGE(first != std::string::npos, ran.output);
        CHECK_MESSAGE(ran.output.find(words, first + 1) == std::string::npos, ran.output);
    }
}

} // namespace gnomon::demo
