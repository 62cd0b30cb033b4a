// What the gnomon program refuses, what it says then, and where its words and pictures go.
#include <doctest/doctest.h>

#include <cstdlib>
#include <sstream>

#include "cli_fixture.hpp"
#include "demo/io/file.hpp"
#include "demo/io/png.hpp"
#include "demo/program/gnuplot.hpp"
#include "demo/program/pictures.hpp"
#include "demo/program/session.hpp"
#include "demo/program/setting_choices.hpp"
#include "demo/scene/yaml_tree.hpp"
#include "gnomon/gnomon.h"

namespace gnomon::demo {

namespace {

/// The cells of a chart in an SVG text, found by the numbers at its axes.
class SvgSurface {
public:
    explicit SvgSurface(const std::string& text) : text_(text) {}

    /// Of the box drawn last over a place; black: of none.
    Rgb8 colourAt(double x, double y) const
    {
        const double left = place("middle", "x", x), top = place("end", "y", y) - 4.0; // numbers stand 4 pixels below
        Rgb8 found{};
        for (size_t at = text_.find("<rect fill="); at != std::string::npos; at = text_.find("<rect fill=", at + 1)) {
            const double x0 = attribute(at, "x"), y0 = attribute(at, "y");
            if (left < x0 || left >= x0 + attribute(at, "width") || top < y0 || top >= y0 + attribute(at, "height"))
                continue;
            const unsigned long hex = std::stoul(text_.substr(text_.find('#', at) + 1, 6), nullptr, 16);
            found = {uint8_t(hex >> 16), uint8_t(hex >> 8), uint8_t(hex)};
        }
        return found;
    }

private:
    double attribute(size_t element, const std::string& name) const
    {
        const size_t at = text_.find(" " + name + "=\"", element);
        return std::stod(text_.substr(at + name.size() + 3));
    }

    /// Of a number along the axis whose numbers have this anchor: straight between the first one and the last.
    double place(const std::string& anchor, const char* name, double value) const
    {
        std::vector<std::pair<double, double>> numbers;
        const std::string tick = "<text class=\"tick\" text-anchor=\"" + anchor + "\"";
        for (size_t at = text_.find(tick); at != std::string::npos; at = text_.find(tick, at + 1))
            numbers.emplace_back(std::stod(text_.substr(text_.find('>', at) + 1)), attribute(at, name));
        REQUIRE(numbers.size() > 1);
        const auto [v0, p0] = numbers.front();
        const auto [v1, p1] = numbers.back();
        return p0 + (value - v0) / (v1 - v0) * (p1 - p0);
    }

    std::string text_;
};

} // namespace

TEST_CASE("calibrate takes what a check reads with a check alone, and the seconds without one")
{
    for (const char* arguments :
         {"--size 64x48", "--knowledge none", "--verbose", "--check room --seconds-per-method 3"}) {
        const Ran ran = gnomonProgram(std::string("calibrate --out none/x.csv ") + arguments, "GNOMON_DEVICE=none");
        CHECK_MESSAGE(ran.exitCode > 1, ran.output);
        CHECK(ran.output.find("--check") != std::string::npos);
    }
}

TEST_CASE("blanks beside the = of a fact or a setting do not count")
{
    CHECK(gnomonProgram("explain thesis --facts 'viewerDistance = 4.5'").output ==
          gnomonProgram("explain thesis --facts viewerDistance=4.5").output);
    const std::vector<SettingChoice> choices = parseChoices("rows = 90 , resolution=\t64");
    REQUIRE(choices.size() == 2);
    CHECK(choices[0].name == "rows");
    CHECK(choices[1].value == 64.0);
}

TEST_CASE("a comma locale changes no number")
{
    const Ran plain = gnomonProgram("explain thesis --facts dynamicLights=6,viewerDistance=4.5", "LC_ALL=C");
    const Ran comma = gnomonProgram("explain thesis --facts dynamicLights=6,viewerDistance=4.5", "LC_ALL=de_DE.UTF-8");
    CHECK(plain.exitCode == 0);
    CHECK(plain.output == comma.output);
    CHECK(plain.output.find("rule") != std::string::npos);
}

TEST_CASE("methods, scenes and lint succeed and name what they are about")
{
    CHECK(gnomonProgram("methods").output.find("shadow_map") != std::string::npos);
    CHECK(gnomonProgram("scenes").output.find("torus_grid") != std::string::npos);
    for (const char* base : {"default", "thesis"})
        CHECK(gnomonProgram(std::string("lint ") + base).exitCode == 0);
}

TEST_CASE("lint fails on warnings where it is asked to, and speaks JSON")
{
    const Folder folder("strict");
    const std::string file = (folder.path / "hole \"a\".yaml").string();
    std::string text = valueOf(findRules("default")).text;
    const std::string_view far = "far: [30, 60, .inf, .inf]";
    text.replace(text.find(far), far.size(), "far: [70, 80, .inf, .inf]");
    std::ofstream(file) << text;
    CHECK(gnomonProgram("lint '" + file + "'").exitCode == 0);
    CHECK(gnomonProgram("lint --strict '" + file + "'").exitCode == 1);
    const Ran json = gnomonProgram("lint --json '" + file + "'");
    CHECK(json.exitCode == 0);
    const Outcome<YamlNode> findings = parseYaml(json.output, "json"); // YAML has JSON in it
    REQUIRE_MESSAGE(findings, findings.error());
    REQUIRE(findings->children.size() == 1);
    CHECK(findings->children[0].children[1].text == file);
    CHECK(findings->children[0].children[9].text == "L06");
    CHECK(gnomonProgram("explain default --facts screenShare=30").output.find("for per cent write 0.3") !=
          std::string::npos);
}

TEST_CASE("plot draws every variable, and over two facts the winners that explain names")
{
    const Folder folder("plot");
    const std::string file = (folder.path / "rules.html").string();
    const std::string facts = "screenShare=0.3,lightMotion=1,dynamicLights=4,penumbraPixels=0,recorded=0";
    CHECK(gnomonProgram("plot default --over viewerDistance,casterTriangles --facts " + facts + " --out " + file)
              .exitCode == 0);
    const std::string text = valueOf(readText(file));
    for (const char* variable : {"dynamicLights, count", "recorded, flag", "suitability", "directional lights"})
        CHECK_MESSAGE(text.find(variable) != std::string::npos, variable);
    CHECK(text.size() < 500'000);
    const Ran explained = gnomonProgram("explain default --facts viewerDistance=5,casterTriangles=3.5," + facts);
    const std::string first = explained.output.substr(0, explained.output.find(' '));
    CHECK_MESSAGE(text.find("<title>" + first) != std::string::npos, explained.output);
    for (const char* bad :
         {"--over viewerDistance", "--over viewerDistance,viewerDistance", "--over viewerDistanec,recorded"})
        CHECK_MESSAGE(gnomonProgram(std::string("plot default --out ") + file + " " + bad).output.find("--over") !=
                          std::string::npos,
                      bad);
}

TEST_CASE(
    "an SVG plot has the winner's colour, as pale as it is suited, in the cell of the facts that explain is given")
{
    const Folder folder("plot_svg");
    const std::string rules = (folder.path / "two.yaml").string(), file = (folder.path / "two.svg").string();
    std::ofstream(rules) << R"(version: 1
name: two
variables:
  viewerDistance: {universe: [0, 90], unit: m, terms: {near: [-.inf, -.inf, 10, 30], far: [10, 30, .inf, .inf]}}
  screenShare: {universe: [0, 1], unit: share, terms: {little: [-.inf, -.inf, 0.2, 0.4], much: [0.2, 0.4, .inf, .inf]}}
rules:
  - {id: a, rule: if viewerDistance is near and screenShare is much then stencil_volume is favoured}
  - {id: b, rule: if viewerDistance is near and screenShare is little then pcss is acceptable}
  - {id: c, rule: if viewerDistance is far then shadow_map is favoured}
)";
    const Ran ran = gnomonProgram("plot '" + rules + "' --over viewerDistance,screenShare --out '" + file + "'");
    REQUIRE_MESSAGE(ran.exitCode == 0, ran.output);
    const std::string text = valueOf(readText(file));
    CHECK(text.find("<html") == std::string::npos);
    const SvgSurface surface(text.substr(text.find(">Best suited, all methods<")));
    for (const auto& place : {std::pair(4.0, 0.8), std::pair(4.0, 0.1), std::pair(22.0, 0.8), std::pair(80.0, 0.5)}) {
        const double x = place.first, y = place.second; // clang 14 cannot capture structured bindings in lambdas
        CAPTURE(x);
        CAPTURE(y);
        const Ran explained = gnomonProgram("explain '" + rules + "' --facts viewerDistance=" + std::to_string(x) +
                                            ",screenShare=" + std::to_string(y));
        std::istringstream first(explained.output);
        std::string winner;
        double suitability = 0.0;
        first >> winner >> suitability;
        const Rgb8 full = methodColour(winner);
        const Rgb8 cell = surface.colourAt(x, y);
        for (const auto channel : {&Rgb8::r, &Rgb8::g, &Rgb8::b})
            CHECK(255 - cell.*channel ==
                  doctest::Approx((0.25 + 0.75 * suitability) * (255 - full.*channel)).scale(255).epsilon(0.03));
        CHECK_MESSAGE(text.find("fill=\"" + hexOf(full) + "\"/><text class=\"axis\"") != std::string::npos, winner);
    }
    CHECK(text.find(">near</text>") != std::string::npos); // in the legend of the terms
}

TEST_CASE("lint counts what was found while reading, too")
{
    const Folder folder("lint");
    const Outcome<RuleText> thesis = findRules("thesis");
    REQUIRE(thesis);
    std::ofstream(folder.path / "idle.yaml")
        << thesis->text << "\npolicy: {budget: {shadowCapMs: 3}}\n"; // no plan is made
    const Ran ran = gnomonProgram("lint '" + (folder.path / "idle.yaml").string() + "'");
    CHECK(ran.exitCode == 0);
    CHECK_MESSAGE(ran.output.find("L11") != std::string::npos, ran.output);
    CHECK_MESSAGE(ran.output.find(", 1 finding") != std::string::npos, ran.output);
}

TEST_CASE("a full disk is a failure, whether it was to hold text or a picture")
{
    if (!fs::exists("/dev/full")) return;
    CHECK(gnomonProgram("scenes > /dev/full").exitCode == 1);
    CHECK(gnomonProgram("--help > /dev/full").exitCode == 1);
    CHECK(gnomonProgram("scenes > /dev/null").exitCode == 0);
    const std::string commands[] = {"bench torus_grid --methods shadow_map --repeat 3 --size 32x24 > /dev/full",
                                    "contact torus_grid --methods shadow_map --size 32x24 --out /dev/full"};
    for (const std::string& command : commands)
        CHECK_MESSAGE(gnomonProgram(command).exitCode == 1, command);
}

TEST_CASE("bad input ends with one and a sentence that names it")
{
    const Folder folder("bad");
    std::ofstream(folder.path / "bad.yaml") << "version: 1\nrules: [}\n";
    const std::pair<std::string, const char*> cases[] = {
        {"run no_such_scene", "no_such_scene"},
        {"run room --size 0x9", "0x9"},
        {"run room --method no_such_method --frames 1", "no_such_method"},
        {"run room --rules '" + (folder.path / "bad.yaml").string() + "' --frames 1", "bad.yaml"},
        {"lint '" + (folder.path / "bad.yaml").string() + "'", "bad.yaml:2"},
        {"explain thesis --facts no_such_fact=1", "no_such_fact"},
        {"bench room --map 512,x", "'x'"},
        {"bench torus_grid --methods no_such_method --size 16x16 --repeat 3", "no_such_method"},
    };
    for (const auto& bad : cases) {
        const std::string& arguments = bad.first; // clang 14 cannot capture structured bindings in lambdas
        const char* word = bad.second;
        CAPTURE(arguments);
        const Ran ran = gnomonProgram(arguments, "cd '" + folder.path.string() + "' &&");
        CHECK(ran.exitCode == 1);
        CHECK_MESSAGE(ran.output.find(word) != std::string::npos, ran.output);
    }
    const Ran ran = gnomonProgram("scenes", "GNOMON_MAX_ISA=avx3");
    CHECK(ran.exitCode == 1);
    CHECK_MESSAGE(ran.output.find("'avx3'") != std::string::npos, ran.output);
}

TEST_CASE("what can be known before measuring is said before a device is looked for, and leaves nothing behind")
{
    const Folder folder("checks");
    std::ofstream(folder.path / "kept.csv") << "kept";
    const std::pair<const char*, const char*> cases[] = {
        {"bench room --set reslution=64", "'reslution'"},
        {"bench room --methods shadow_map --set rows=64", "'rows'"},
        {"bench room --set resolution=64,resolution=32", "twice"},
        {"bench room --methods shadow_map,nosuch", "'nosuch'"},
        {"bench room no_such_scene", "no_such_scene"},
        {"bench room --light lamp", "'lamp'"},
        {"bench room --set reasons=1", "'reasons'"},
        {"bench room --map 64 --set resolution=32", "--map"},
        {"bench room --csv none/x.csv", "none/x.csv"},
        {"contact room --methods shadow_map,nosuch", "'nosuch'"},
        {"contact room --out none/x.png", "none/x.png"},
        {"publish room --methods shadow_map,nosuch", "'nosuch'"},
        {"publish nosuch", "nosuch"},
        {"publish room --size 64", "'64'"},
        {"publish room --out none/x.md", "none/x.md"},
        {"publish --from none.csv --out x.md", "none.csv"},
        {"compare room --methods shadow_map,nosuch", "'nosuch'"},
        {"compare room --plot none/x.png", "none/x.png"},
        {"compare room bunny --plot x.png", "--plot draws one scene, not 2"},
        {"compare room --map 512,1k", "'1k'"},
        {"calibrate --out none/x.csv", "none/x.csv"},
        {"calibrate --methods shadow_map,nosuch", "'nosuch'"},
        {"trace room --methods shadow_map,nosuch", "'nosuch'"},
        {"trace room --out none/x", "none/x"},
        {"trace room --rules nosuch", "'nosuch'"},
        {"trace room --budget-ms 2x,3y", "3y"},
        {"run room --why foo", "'foo'"},
        {"run room --why 3:lamp", "'lamp'"},
        {"run room --lights 1 --why 3:point2", "'point2'"},
        {"run room --why 3:spot1:nosuch", "'nosuch'"},
        {"run room --frames 6 --why 6:spot1", "frame 6"},
        {"bench city_nihgt", "no scene named 'city_nihgt'; did you mean 'city_night'?"},
        {"bench room --methods shadwo_map", "no method named 'shadwo_map' in this build; did you mean 'shadow_map'?"},
        {"bench room --methods nosuch", "; known: none, bare_shadow_map, shadow_map, "},
        {"bench room --set reslution=64", "did you mean 'resolution'?"},
        {"lint defualt", "no rule base 'defualt', and no such file; did you mean 'default'? Known: default, "},
        {"explain thesis --facts viewrDistance=5", "no fact 'viewrDistance'; did you mean 'viewerDistance'?"},
        {"explain thesis --facts viewerDistance=1e9", "viewerDistance is a number from 0 to 1000000 (m)"},
        {"explain thesis --facts dynamicLights=2.5", "dynamicLights is a whole number from 0 to 65536 (count)"},
        {"explain thesis --facts viewerDistance=-1", "viewerDistance is a number from 0 to 1000000 (m)"},
        {"explain default --facts recorded=2", "recorded is a whole number from 0 to 1 (flag)"},
        {"trace room --budget-ms 1e9", "1e9"},
        {"run room --dump kept.csv/dump", "kept.csv/dump"},
        {"run room --out kept.csv", "kept.csv"},
        {"run room --method nosuch", "'nosuch'"},
        {"run room --recorded --method ray_traced", "cannot be recorded"},
        {"explain thesis --facts viewerDistance=5,viewerDistance=50", "twice"},
    };
    const std::string before = "cd '" + folder.path.string() + "' && GNOMON_DEVICE=none";
    for (const auto& bad : cases) {
        CAPTURE(bad.first);
        const Ran ran = gnomonProgram(bad.first, before);
        CHECK(ran.exitCode == 1);
        CHECK_MESSAGE(ran.output.find(bad.second) != std::string::npos, ran.output);
        CHECK(ran.output.find("Vulkan device") == std::string::npos);
    }
    fs::remove_all(folder.path / "out"); // of `run`, which makes its folder to see that it can
    CHECK(lines(folder.path / "kept.csv") == std::vector<std::string>{"kept"});
    CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 1);
    const Ran spaced = gnomonProgram("bench room --methods 'shadow_map , cube_map' --csv kept.csv", before);
    CHECK(spaced.output.find("Vulkan device") != std::string::npos); // nothing else is wrong with it
    CHECK(lines(folder.path / "kept.csv") == std::vector<std::string>{"kept"});
    for (const char* number : {"nan", "inf", "-1", "1e7", "1,5"})
        for (const char* command : {"replay x --rate=", "calibrate --seconds-per-method=", "bench room --radius="}) {
            const Ran ran = gnomonProgram(std::string(command) + number, before);
            CHECK_MESSAGE(ran.exitCode > 1, command, number);
            CHECK_MESSAGE(ran.output.find(number + std::string("' is no number from ")) != std::string::npos,
                          ran.output);
        }
    for (const char* number : {"0", "-0", "nan", "inf", "-1", "1e7", "1e-60", "1,5"})
        for (const char* command : {"run room --budget-ms=", "run room --budget=", "compare room --seconds="}) {
            const Ran ran = gnomonProgram(std::string(command) + number, before);
            CHECK_MESSAGE(ran.exitCode > 1, command, number);
            CHECK_MESSAGE(ran.output.find(number + std::string("' is no number above 0, up to ")) != std::string::npos,
                          ran.output);
        }
    for (const char* number : {"0", "-0", "nan", "inf", "-1x", "1e7", "1e-60", "1,5", "1.3x,2x", "x"})
        for (const char* option : {"compare room --budget-ms=", "compare room --budget="}) {
            const Ran ran = gnomonProgram(option + std::string("'") + number + "'", before);
            CHECK_MESSAGE(ran.exitCode > 1, option, number);
            CHECK_MESSAGE(ran.output.find(number + std::string(": no ")) != std::string::npos, ran.output);
        }
    CHECK(gnomonProgram("compare room --entry both", before).exitCode > 1);
    for (const char* nothing : {"compare room --rules ,", "compare room --methods ' , '", "bench room --methods ''",
                                "run room --method ''", "explain thesis --facts ''", "lint ''"}) {
        const Ran ran = gnomonProgram(nothing, before);
        CHECK_MESSAGE(ran.exitCode > 1, nothing);
        CHECK_MESSAGE(ran.output.find("' names nothing") != std::string::npos, ran.output);
    }
    CHECK(gnomonProgram("replay x --seed -1", before).output.find("'-1' is below 0") != std::string::npos);
    for (const char* flags : {"--screenshot x.png", "--resize-test 3", "--window --dump d", "--window --out d"})
        CHECK(gnomonProgram(std::string("run room ") + flags, before).exitCode > 1);
    for (const char* flags : {"--out d", "--dump d", "--film 2", "--method m --rules r"})
        CHECK(gnomonProgram(std::string("window room ") + flags, before).exitCode > 1);
}

TEST_CASE("a window without a display ends in words, before a device is looked for")
{
    for (const char* command : {"window room", "run room --window"}) {
        const Ran none = gnomonProgram(command, "env -u DISPLAY -u WAYLAND_DISPLAY GNOMON_DEVICE=none");
        CHECK(none.exitCode == 1);
        CHECK_MESSAGE(none.output.find("no window system: ") != std::string::npos, none.output);
        CHECK_MESSAGE(none.output.find("`gnomon run` needs none") != std::string::npos, none.output);
        const Ran absent = gnomonProgram(command, "env -u WAYLAND_DISPLAY DISPLAY=:4711 GNOMON_DEVICE=none");
        CHECK(absent.exitCode == 1);
        CHECK_MESSAGE(absent.output.find(":4711") != std::string::npos, absent.output);
    }
}

TEST_CASE("exit codes tell a command line that is not understood from a command that fails")
{
    const Folder folder("codes");
    const std::string before = "cd '" + folder.path.string() + "' && GNOMON_DEVICE=none";
    const std::pair<const char*, const char*> usage[] = {
        {"", "A subcommand is required"},
        {"nosuch --frames 6", "no command 'nosuch'; known: run, window, why, bench, "},
        {"benhc room", "no command 'benhc'; did you mean 'bench'?"},
        {"run", "SCENE is required"},
        {"run room --nosuch", "--nosuch"},
        {"run room --frames x", "--frames"},
        {"run room --frames 0", "--frames"},
        {"lint default --strict --json more", "more"},
    };
    for (const auto& bad : usage) {
        CAPTURE(bad.first);
        const Ran ran = gnomonProgram(bad.first, before);
        CHECK(ran.exitCode == 2);
        CHECK_MESSAGE(ran.output.find(bad.second) != std::string::npos, ran.output);
    }
    for (const char* good : {"--help", "run --help", "--version", "lint default", "methods"})
        CHECK_MESSAGE(gnomonProgram(good, good == std::string("methods") ? "" : before).exitCode == 0, good);
    for (const char* failing : {"run room --frames 1", "report none", "lint none", "why none --frame 0 --light a"})
        CHECK_MESSAGE(gnomonProgram(failing, before).exitCode == 1, failing);
    std::ofstream(folder.path / "bad.yaml") << "version: 1\nrules: [}\n";
    CHECK(gnomonProgram("lint bad.yaml", before).exitCode == 1);
}

TEST_CASE("a picture that gnuplot would draw is refused where gnuplot is missing, before anything is measured")
{
    const Folder folder("no_gnuplot");
    const std::string before = "cd '" + folder.path.string() + "' && PATH=/none GNOMON_DEVICE=none";
    const Ran ran = gnomonProgram("compare room --plot x.png", before);
    CHECK(ran.exitCode == 1);
    CHECK_MESSAGE(ran.output.find("x.png: gnuplot draws it, and cannot be run") != std::string::npos, ran.output);
    const char* path = std::getenv("PATH");
    const std::string kept = path ? path : "";
    setenv("PATH", "/none", 1);
    const std::vector<std::pair<double, double>> more(20000, {1.0, 2.0}); // than a pipe holds
    CHECK_THROWS(plotCurves("", {{"long", "lines", more}}, (folder.path / "x.png").string()));
    setenv("PATH", kept.c_str(), 1);
}

TEST_CASE("the program says its version, and an error in rules once")
{
    const Ran version = gnomonProgram("--version");
    CHECK(version.exitCode == 0);
    CHECK(version.output == "gnomon " + std::to_string(GN_VERSION_MAJOR) + "." + std::to_string(GN_VERSION_MINOR) +
                                "." + std::to_string(GN_VERSION_PATCH) + "\n");
    const Folder folder("rules_error");
    std::ofstream(folder.path / "bad.yaml") << "version: 1\nrules: [}\n";
    const Ran bad = gnomonProgram("run room --rules bad.yaml --frames 1", "cd '" + folder.path.string() + "' &&");
    CHECK(bad.exitCode == 1);
    const size_t first = bad.output.find("bad.yaml:2");
    CHECK(first != std::string::npos);
    CHECK_MESSAGE(bad.output.find("bad.yaml:2", first + 1) == std::string::npos, bad.output);
}

TEST_CASE("a plot goes to a file whose name and titles hold quotes")
{
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) return;
    const Folder folder("plot");
    const fs::path file = folder.path / "it's.png";
    plotCurves("set title " + gnuplotText("Fermat's") + "\n", {{"one's", "lines", {{0.0, 1.0}, {1.0, 2.0}}}},
               file.string());
    const Outcome<Image8> picture = readPng(file, 3);
    REQUIRE_MESSAGE(picture, picture.error());
    CHECK(picture->width == 640);
    if (fs::exists("/dev/full")) CHECK_THROWS(plotCurves("", {{"a", "lines", {{0.0, 1.0}, {1.0, 2.0}}}}, "/dev/full"));
}

} // namespace gnomon::demo
