// The gnomon program from outside: exit codes, files, table headers.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <sys/wait.h>

#include "demo/io/csv.hpp"
#include "demo/io/pfm.hpp"
#include "demo/io/png.hpp"
#include "demo/program/gnuplot.hpp"
#include "gnomon/gnomon.h"

namespace gnomon::demo {
namespace {

namespace fs = std::filesystem;

struct Ran {
    int exitCode = -1;
    std::string output; ///< Both streams.
};

Ran gnomonProgram(const std::string& arguments, const std::string& before = "")
{
    const std::string command = before + " '" GNOMON_PROGRAM "' " + arguments + " 2>&1";
    Ran ran;
    FILE* pipe = popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    std::array<char, 4096> chunk{};
    for (size_t got = 0; (got = fread(chunk.data(), 1, chunk.size(), pipe)) > 0;)
        ran.output.append(chunk.data(), got);
    const int status = pclose(pipe);
    ran.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return ran;
}

struct Folder {
    explicit Folder(const std::string& name) : path(fs::temp_directory_path() / ("gnomon_cli_" + name))
    {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
    fs::path path;
};

std::vector<std::string> lines(const fs::path& file)
{
    std::ifstream stream(file);
    std::vector<std::string> out;
    for (std::string line; std::getline(stream, line);)
        out.push_back(line);
    return out;
}

size_t distinctColours(const Image8& image)
{
    std::set<std::array<uint8_t, 3>> colours;
    for (size_t i = 0; i + 2 < image.texels.size(); i += 3)
        colours.insert({image.texels[i], image.texels[i + 1], image.texels[i + 2]});
    return colours.size();
}

} // namespace

TEST_CASE("run leaves both tables, pictures, the rules used and a dump, and its summary says so")
{
    const Folder folder("run");
    const Ran ran = gnomonProgram("run room --frames 6 --size 160x90 --out '" + folder.path.string() + "' --dump '" +
                                  (folder.path / "dump").string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> frames = lines(folder.path / "frames.csv");
    REQUIRE(frames.size() == 7);
    CHECK(frames[0] ==
          "frame,time_s,frame_ms,fps,shadow_gpu_ms,shadow_cpu_ms,decide_us,lights,switches,budget_ms,over_budget");
    const std::vector<std::string> lights = lines(folder.path / "lights.csv");
    REQUIRE(lights.size() > 1);
    CHECK(lights[0] == "frame,light,method,suitability,predicted_ms,measured_ms,distance,reason");
    CHECK(fs::file_size(folder.path / "rules.yaml") > 0);
    const Outcome<Image8> picture = readPng(folder.path / "frame_00005.png", 3);
    REQUIRE(picture);
    CHECK(distinctColours(*picture) > 100);
    const Outcome<Image8> caption = readPng(folder.path / "frame_00005_methods.png", 3);
    REQUIRE(caption);
    CHECK(caption->texels != picture->texels);
    for (const char* word : {"fps on average", "1 %-low", "% of light-frames", "switches", "over-budget", "frames.csv"})
        CHECK(ran.output.find(word) != std::string::npos);

    for (const char* file : {"frame.json", "casters.obj", "normals.pfm", "offset.pfm"})
        CHECK(fs::exists(folder.path / "dump" / file));
    const Outcome<ImageF> depth = readPfm(folder.path / "dump" / "depth.pfm", RowOrder::TopDown);
    REQUIRE(depth);
    CHECK(depth->width == 160);
}

TEST_CASE("the log of a run answers every question without a device, and names what it does not have")
{
    const Folder folder("why");
    const Ran ran = gnomonProgram("run room --frames 6 --size 160x90 --out '" + folder.path.string() +
                                  "' --why 3:" + "no_such_light");
    CHECK(ran.exitCode == 1);
    CHECK(ran.output.find("no_such_light") != std::string::npos);
    const fs::path log = folder.path / "decisions.gnlog";
    REQUIRE(fs::exists(log));
    std::vector<std::string> cells; // frame, light, method of the last row
    REQUIRE(splitCsvLine(lines(folder.path / "lights.csv").back(), cells));
    const std::string question = "why '" + log.string() + "' --frame " + cells[0] + " --light '" + cells[1] + "'";
    const auto answer = [&](const std::string& more) {
        const Ran asked = gnomonProgram(question + more, "GNOMON_DEVICE=none");
        CAPTURE(asked.output);
        CHECK(asked.exitCode == 0);
        CHECK(asked.output.find("light '" + cells[1] + "', frame " + cells[0]) == 0);
        CHECK(std::count(asked.output.begin(), asked.output.end(), '\n') <= 12);
        return asked.output;
    };
    CHECK(answer("").find("frame " + cells[0] + ": " + cells[2]) != std::string::npos);
    CHECK(answer("").find("because ") != std::string::npos);
    CHECK(answer(" --what-if").find("one fact at a time") != std::string::npos);
    CHECK(answer(" --changed").find("against frame ") != std::string::npos);
    answer(" --since-switch");
    answer(" --not shadow_map");

    const std::pair<std::string, const char*> bad[] = {
        {question + " --not no_such_method", "no_such_method"},
        {"why '" + log.string() + "' --frame 99 --light '" + cells[1] + "'", "frame 99"},
        {"why '" + log.string() + "' --frame 1 --light nobody", "'nobody'"},
        {"why '" + (folder.path / "lights.csv").string() + "' --frame 1 --light x", "does not start"},
        {"why '" + (folder.path / "none").string() + "' --frame 1 --light x", "cannot be read"},
    };
    for (const auto& entry : bad) {
        const std::string& arguments = entry.first;
        const char* word = entry.second;
        const Ran failed = gnomonProgram(arguments);
        CHECK(failed.exitCode == 1);
        CHECK_MESSAGE(failed.output.find(word) != std::string::npos, failed.output);
    }
}

TEST_CASE("bench prints exactly the promised columns and a base row first")
{
    const Folder folder("bench");
    const fs::path csv = folder.path / "bench.csv";
    const Ran ran = gnomonProgram("bench torus_grid --methods shadow_map,bare_shadow_map --map 128,256 --size 160x120 "
                                  "--repeat 3 --csv '" +
                                  csv.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> table = lines(csv);
    REQUIRE(table.size() == 6); // header, none, bare at two sizes, shadow_map at two sizes
    CHECK(table[0] == "scene,method,lights,width,height,map,triangles,gpu_ms_p50,cpu_ms_p50,wall_ms_min,wall_ms_p50,"
                      "increment_ms_min,wrong_pct,rays,memory_mib,device,driver,false_lit_pct,false_shadow_pct,"
                      "ambiguous_pct,mean_abs_error");
    CHECK(table[1].starts_with("torus_grid,none,1,160,120,"));
    for (size_t i = 1; i < table.size(); ++i) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(table[i], cells));
        CHECK(cells.size() == 21);
    }
}

TEST_CASE("bench measures one light alone by its name, whatever its place, and refuses a name that is no light's")
{
    const Folder folder("bench_light");
    const auto bench = [&](const std::string& lights) {
        const fs::path csv = folder.path / "bench.csv";
        const Ran ran = gnomonProgram("bench scenario --methods ray_traced --size 64x48 --repeat 3 --csv '" +
                                      csv.string() + "' " + lights);
        CAPTURE(ran.output);
        REQUIRE(ran.exitCode == 0);
        const std::vector<std::string> table = lines(csv);
        REQUIRE(table.size() == 3);
        return table[2];
    };
    CHECK(bench("--lights 4").starts_with("scenario,ray_traced,4,"));
    CHECK(bench("--lights 4 --light still3").starts_with("scenario,ray_traced,1,"));
    CHECK(bench("--light still4,still2").starts_with("scenario,ray_traced,2,"));
    const Ran misspelt = gnomonProgram("bench scenario --light still3,lamp");
    CHECK(misspelt.exitCode != 0);
    CHECK(misspelt.output.find("scene 'scenario' has no light 'lamp'") != std::string::npos);
    const Ran beyond = gnomonProgram("bench scenario --lights 2 --light still3");
    CHECK(beyond.exitCode != 0);
}

TEST_CASE("a figure is a row for every number of lights and faces")
{
    const Folder folder("figure");
    const fs::path csv = folder.path / "figure.csv";
    const Ran ran = gnomonProgram("bench --figure 4.19 --size 32x24 --repeat 3 --csv '" + csv.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> table = lines(csv);
    REQUIRE(table.size() == 1 + 4 * 5);
    CHECK(table[0] == "figure,method,faces,lights,increment_ms_min");
    CHECK(table[1].starts_with("4.19,shadow_map,600,1,"));
    CHECK(table.back().starts_with("4.19,shadow_map,100000,16,"));
    CHECK(gnomonProgram("bench torus_grid --still").exitCode != 0); // of a figure alone
}

TEST_CASE("compare runs the rules and every method that serves all lights, and holds them against each other")
{
    const Ran ran = gnomonProgram("compare torus_grid --rules default,thesis --size 96x64 --frames 3 --alternations 1 "
                                  "--budget-ms 1000");
    CHECK(ran.exitCode == 0);
    for (const char* line : {"\ndefault rules ", "\nthesis rules ", "\nstencil_volume ", "\nshadow_map ",
                             "over sentinel", "switches", "default rules / best single method", "frame by frame"})
        CHECK_MESSAGE(ran.output.find(line) != std::string::npos, ran.output);
    CHECK(ran.output.find("\ncube_map ") == std::string::npos); // serves no spot light
    const Ran wrong = gnomonProgram("compare torus_grid --methods cube_map");
    CHECK(wrong.exitCode == 1);
    CHECK(wrong.output.find("cube_map") != std::string::npos);
}

TEST_CASE(
    "calibrate writes a base of both passes of every method and what their lights share, and checks a scene against it")
{
    const Folder folder("calibrate");
    const fs::path csv = folder.path / "base.csv";
    const Ran ran =
        gnomonProgram("calibrate --methods shadow_map,ray_traced --seconds-per-method 1 --out '" + csv.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> table = lines(csv);
    REQUIRE(table.size() > 2);
    CHECK(table[0].starts_with("# gnomon knowledge "));
    std::set<std::string> seen;
    for (size_t i = 2; i < table.size(); ++i) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(table[i], cells));
        seen.insert(cells.at(2) + " " + cells.at(3));
    }
    CHECK(seen == std::set<std::string>{"ray_traced resolve", "ray_traced view:view.depth_readback",
                                        "ray_traced view:view.normals_readback", "shadow_map resolve",
                                        "shadow_map update"});
    const Ran checked = gnomonProgram("calibrate --check torus_grid --methods shadow_map,ray_traced --size 160x120 "
                                      "--knowledge '" +
                                      csv.string() + "'");
    CHECK(checked.exitCode == 0);
    for (const char* line : {"device factor ", "\nshadow_map  ", "\nray_traced  ", "\nall lights and methods "})
        CHECK_MESSAGE(checked.output.find(line) != std::string::npos, checked.output);
    CHECK(checked.output.find("left out") == std::string::npos); // all alternations saw the same lights and passes
}

TEST_CASE("reasons account for every pixel, and what a ray decided is never wrong")
{
    const Folder folder("reasons");
    const fs::path picture = folder.path / "reasons.png";
    const Ran ran = gnomonProgram("reasons torus_grid --method pcf_hybrid --set resolution=64 --size 160x120 --out '" +
                                  picture.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    std::istringstream output(ran.output);
    unsigned long long pixels = 0, wrongByMap = 0;
    std::set<std::string> reasons;
    for (std::string line; std::getline(output, line);) {
        std::vector<std::string> cells;
        if (!splitCsvLine(line, cells) || cells.size() != 7 || cells[0] != "torus_grid") continue;
        reasons.insert(cells[2]);
        pixels += std::stoull(cells[3]);
        const unsigned long long wrong = std::stoull(cells[5]) + std::stoull(cells[6]);
        if (cells[2].starts_with("rt_")) CHECK(wrong == 0);
        if (cells[2].starts_with("tc_")) wrongByMap += wrong;
    }
    CHECK(pixels == 160 * 120);
    CHECK(reasons == std::set<std::string>{"outside", "backfacing", "tc_lit", "tc_shadow", "rt_lit", "rt_shadow"});
    CHECK(wrongByMap > 0); // 64 texels cannot do it
    const auto drawn = readPng(picture, 3);
    REQUIRE(drawn);
    CHECK(drawn->width == 160);
    CHECK(distinctColours(*drawn) > 50);
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
        {"bench --figure 9.9", "9.9"},
        {"reasons torus_grid --method shadow_map --size 16x16", "reasons"},
        {"reasons torus_grid --method pcf_hybrid --light no_such_light", "no_such_light"},
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
        {"bench room --csv none/x.csv", "none/x.csv"},
        {"bench --figure 4.6 --out none/x.png", "none/x.png"},
        {"contact room --methods shadow_map,nosuch", "'nosuch'"},
        {"contact room --out none/x.png", "none/x.png"},
        {"compare room --methods shadow_map,nosuch", "'nosuch'"},
        {"compare room --plot none/x.png", "none/x.png"},
        {"calibrate --out none/x.csv", "none/x.csv"},
        {"calibrate --methods shadow_map,nosuch", "'nosuch'"},
        {"trace room --methods shadow_map,nosuch", "'nosuch'"},
        {"trace room --out none/x", "none/x"},
        {"trace room --rules nosuch", "'nosuch'"},
        {"trace room --budget-ms 2x,3y", "3y"},
        {"tables morais --csv none/x.csv", "none/x.csv"},
        {"reasons room --method pcf_hybrid --out none/x.png", "none/x.png"},
        {"reasons room --method pcf_hybrid --set nosuch=1", "'nosuch'"},
        {"run room --why foo", "'foo'"},
        {"run room --dump kept.csv/dump", "kept.csv/dump"},
        {"run room --out kept.csv", "kept.csv"},
        {"run room --method nosuch", "'nosuch'"},
        {"run room --recorded --method ray_traced", "cannot be recorded"},
        {"explain thesis --facts viewerDistance=5,viewerDistance=50", "twice"},
        {"explain thesis --facts ''", "names no fact"},
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
    for (const char* flags : {"--screenshot x.png", "--resize-test 3", "--window --dump d"})
        CHECK(gnomonProgram(std::string("run room ") + flags, before).exitCode > 1);
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
}

} // namespace gnomon::demo
