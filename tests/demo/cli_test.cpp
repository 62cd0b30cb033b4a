// The gnomon program from outside: exit codes, files, table headers.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

#include "cli_fixture.hpp"
#include "demo/io/csv.hpp"
#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "demo/io/pfm.hpp"
#include "demo/io/png.hpp"
#include "demo/program/pictures.hpp"
#include "demo/program/session.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {

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
          "frame,time_s,frame_ms,fps,shadow_gpu_ms,shadow_cpu_ms,decide_us,lights,switches,budget_ms,over_budget,"
          "pages_evicted,pages_without_room");
    const std::vector<std::string> lights = lines(folder.path / "lights.csv");
    REQUIRE(lights.size() > 1);
    CHECK(lights[0] == "frame,light,method,suitability,predicted_ms,measured_ms,distance,reason,map_side");
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
    const Outcome<ImageF> depth = readPfm(folder.path / "dump" / "depth.pfm");
    REQUIRE(depth);
    CHECK(depth->width == 160);
}

TEST_CASE("a street with 64 lights in one view runs, submitted and recorded")
{
    for (const char* entry : {"", " --recorded"}) {
        const Folder folder("street");
        const Ran ran =
            gnomonProgram("run city_night --frames 2 --size 96x54 --out '" + folder.path.string() + "'" + entry);
        CAPTURE(ran.output);
        REQUIRE(ran.exitCode == 0);
        std::set<std::string> lights;
        for (const std::string& line : lines(folder.path / "lights.csv")) {
            std::vector<std::string> cells;
            REQUIRE(splitCsvLine(line, cells));
            if (cells[0] == "1") lights.insert(cells[1]);
        }
        CHECK(lights.size() == 64);
    }
}

TEST_CASE("a row of frames.csv takes as long as others where a picture is taken")
{
    const Folder folder("frame_ms");
    const Ran ran =
        gnomonProgram("run room --method ray_traced --frames 33 --size 320x180 --out '" + folder.path.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    std::vector<double> ms;
    for (const std::string& line : lines(folder.path / "frames.csv")) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(line, cells));
        if (cells[0] != "frame") ms.push_back(std::stod(cells[2]));
    }
    REQUIRE(ms.size() == 33);
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    for (const size_t picture : {8, 16, 24})
        CHECK_MESSAGE(ms[picture] > 0.3 * sorted[16], ms[picture] << " of " << sorted[16]);
}

TEST_CASE("the log of a run answers every question without a device, and names what it does not have")
{
    const Folder folder("why");
    const Ran ran = gnomonProgram("run room --frames 6 --size 160x90 --out '" + folder.path.string() +
                                  "' --why 3:spot1 --why 3:spot1:shadow_map");
    CHECK(ran.exitCode == 0);
    CHECK(ran.output.find("light 'spot1', frame 3") != std::string::npos);
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

TEST_CASE("lights are told apart whatever their names: by why, in the files of a dump and in its JSON")
{
    const Folder folder("names");
    std::ofstream scene(folder.path / "names.yaml");
    scene << "name: names\nbase: " << fs::absolute(valueOf(findScene("torus_grid"))).string() << "\nlights:\n";
    for (const char* name : {"2", "1", "a b", "a_b", "a_b_3", "two\\nlines"})
        scene << "  - {name: \"" << name
              << "\", kind: spot, at: [6, 8, 5], aim: [0, 0, 0], cone: {outer: 40}, range: 20}\n";
    scene.close();
    const Ran ran = gnomonProgram("run names.yaml --frames 1 --size 32x24 --out out --dump dump --why 0:1 --why 0:77",
                                  "cd '" + folder.path.string() + "' &&");
    CAPTURE(ran.output);
    CHECK(ran.exitCode == 1); // of the last question
    CHECK(ran.output.find("light '1', frame 0") != std::string::npos);
    CHECK(ran.output.find("no light '77'") != std::string::npos);
    CHECK(ran.output.find("switches") != std::string::npos);
    std::set<std::string> pictures;
    for (const auto& file : fs::directory_iterator(folder.path / "dump"))
        if (file.path().extension() == ".png") pictures.insert(file.path().filename().string());
    CHECK(pictures.size() == 6);
    bool escaped = false;
    for (const std::string& line : lines(folder.path / "dump" / "frame.json"))
        escaped = escaped || line.find("\"two\\u000alines\"") != std::string::npos;
    CHECK(escaped);
}

TEST_CASE("a film has a picture every so many frames but the first, in its methods' colours")
{
    const Folder folder("film"), plain("film_plain");
    const std::string scene = "run torus_grid --method shadow_map --size 160x90 --frames 5 --out '";
    REQUIRE(gnomonProgram(scene + folder.path.string() + "' --film 2").exitCode == 0);
    REQUIRE(gnomonProgram(scene + plain.path.string() + "'").exitCode == 0);
    std::set<std::string> pictures;
    for (const auto& file : fs::directory_iterator(folder.path))
        if (file.path().extension() == ".png") pictures.insert(file.path().filename().string());
    CHECK(pictures == std::set<std::string>{"frame_00002_film.png", "frame_00004_film.png"});
    const Outcome<Image8> film = readPng(folder.path / "frame_00004_film.png", 3),
                          white = readPng(plain.path / "frame_00004.png", 3);
    REQUIRE(film);
    REQUIRE(white);
    const Rgb8 colour = methodColour("shadow_map");
    size_t legend = 0;
    double ours[3] = {}, lamp[3] = {}; // mean of each channel above the legend
    for (size_t i = 0; i < film->texels.size(); ++i) {
        if (i % 3 == 0) legend += Rgb8{film->texels[i], film->texels[i + 1], film->texels[i + 2]} == colour;
        if (i > film->texels.size() * 3 / 4) continue;
        ours[i % 3] += film->texels[i];
        lamp[i % 3] += white->texels[i];
    }
    CHECK(legend > 300);
    const uint8_t channels[] = {colour.r, colour.g, colour.b};
    const auto strongest = std::max_element(channels, channels + 3) - channels;
    const auto weakest = std::min_element(channels, channels + 3) - channels;
    CHECK(ours[strongest] / ours[weakest] > 1.1 * lamp[strongest] / lamp[weakest]);
}

TEST_CASE(
    "publish measures each kind of light by itself and writes a page and its table, from which the page comes again")
{
    const Folder folder("publish");
    const std::string out = " --out '" + (folder.path / "page.md").string() + "'";
    const Ran ran = gnomonProgram("publish room torus_grid --methods shadow_map,ray_traced,cube_map --size 64x36 "
                                  "--repeat 3" +
                                  out);
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    std::map<std::string, std::string> wrong; // by scene, method and kind
    for (const std::string& line : lines(folder.path / "page.csv")) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(line, cells));
        REQUIRE(cells.size() == 32);
        if (cells[0] == "scene") continue;
        CHECK(cells[2] == "1");        // light
        CHECK(cells[31].size() == 10); // date
        wrong[cells[0] + " " + cells[1] + " " + cells[30]] = cells[12];
    }
    std::set<std::string> expected;
    for (const char* scene : {"room", "torus_grid"}) {
        const Scene loaded = valueOf(loadScene(scene));
        for (const Light& light : loaded.lights)
            for (const char* method : {"shadow_map", "ray_traced", "cube_map"}) {
                const bool serves = method == std::string("ray_traced") ||
                                    (light.kind == LightKind::Point) == (method == std::string("cube_map"));
                if (serves) expected.insert(std::string(scene) + " " + method + " " + nameOf(light.kind));
            }
    }
    for (const std::string& row : expected)
        CHECK_MESSAGE(wrong.count(row) == 1, row);
    CHECK(wrong.size() == expected.size());
    CHECK(std::stod(wrong.at("room ray_traced spot")) == 0.0);
    CHECK(std::stod(wrong.at("room shadow_map spot")) > 0.0);
    const std::vector<std::string> page = lines(folder.path / "page.md");
    CHECK(std::find(page.begin(), page.end(), "### spot") != page.end());
    CHECK(std::any_of(page.begin(), page.end(), [](const std::string& line) {
        return line.starts_with("| [`ray_traced`](../algorithms/hybrid/ray_traced.md) | ") &&
               line.find(", 0.0000 %") != std::string::npos;
    }));

    const Ran again = gnomonProgram("publish --from '" + (folder.path / "page.csv").string() + "'" + out,
                                    "GNOMON_DEVICE=none"); // a page needs no device
    CHECK_MESSAGE(again.exitCode == 0, again.output);
    const std::vector<std::string> second = lines(folder.path / "page.md");
    CHECK(std::equal(page.rbegin(), page.rbegin() + 10, second.rbegin()));
    CHECK(page.size() == second.size());
}

TEST_CASE("publish takes the light with a shadow in view, and errors in penumbrae where the light has an extent")
{
    const Folder folder("publish_lights");
    std::ofstream(folder.path / "lit.yaml") << R"(name: lit
size: [96, 54]
frames: 8
meshes:
  floor: {box: {size: [12, 0.2, 12]}}
  block: {box: {size: [1, 1.5, 1]}}
instances:
  - {mesh: floor, at: [0, -0.1, 0]}
  - {mesh: block, at: [2, 0.75, 0]}
camera:
  - {eye: [0, 5, 8], target: [0, 0, 0]}
lights:
  - {name: idle, kind: spot, at: [-3, 4, 0], aim: [-3, 0, 0], cone: {outer: 20}, range: 10}
  - {name: casts, kind: spot, at: [3, 5, 0], aim: [2, 0, 0], cone: {outer: 40}, range: 10}
  - {name: bulb, kind: point, at: [-4, 1, 4], range: 2}
  - {name: window, kind: spot, at: [3, 5, 1], aim: [2, 0, 0], cone: {outer: 40}, range: 10,
     rectangle: {width: 0.8, height: 0.4}}
)";
    const std::string table = (folder.path / "page.csv").string();
    const Ran ran = gnomonProgram("publish '" + (folder.path / "lit.yaml").string() +
                                  "' --methods shadow_map,ray_traced --size 96x54 --repeat 3 --out '" +
                                  (folder.path / "page.md").string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    CHECK(ran.output.find("lit: spot: casts\n") != std::string::npos);
    CHECK(ran.output.find("lit: no point light throws a shadow") != std::string::npos);
    CHECK(ran.output.find("page.md: 4 measurements, ") != std::string::npos);
    const std::string text = valueOf(readText(folder.path / "page.md"));
    CHECK(ran.output.find(", " + std::to_string(text.size()) + " bytes, in ") != std::string::npos);
    CHECK(text.find("### rectangle") != std::string::npos);
    double rmse = 0.0; // of hard edges in a penumbra
    for (const std::string& line : lines(table)) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(line, cells));
        if (cells[1] == "shadow_map" && cells[30] == "rectangle") rmse = std::stod(cells[22]);
    }
    CHECK(rmse > 0.1);
    std::string shown;
    appendFixed(shown, rmse, 4);
    CHECK_MESSAGE(text.find(" MiB, " + shown) != std::string::npos, text);
}

TEST_CASE("a run that fails leaves nothing of an earlier one in its folders, and everything else")
{
    const Folder folder("stale");
    const fs::path out = folder.path / "out", dump = folder.path / "dump";
    fs::create_directories(out);
    fs::create_directories(dump);
    const auto write = [](const fs::path& file, const char* text = "x") { std::ofstream(file) << text; };
    for (const char* name :
         {"frames.csv", "lights.csv", "decisions.gnlog", "rules.yaml", "frame_00003.png", "frame_123456_methods.png",
          "frame_00004_film.png", "frame_mine.png", "frame_0003.png", "frame_00003_mine.png"})
        write(out / name);
    write(dump / "frame.json", "{\"visibility\": \"visibility_sun.png\"}");
    for (const char* name : {"depth.pfm", "visibility_sun.png", "visibility_mine.png"})
        write(dump / name);
    const auto names = [](const fs::path& path) {
        std::set<std::string> found;
        for (const auto& file : fs::directory_iterator(path))
            found.insert(file.path().filename().string());
        return found;
    };
    const std::string before = "cd '" + folder.path.string() + "' && GNOMON_DEVICE=none";
    CHECK(gnomonProgram("run room --rules out/rules.yaml --out out --dump dump", before).exitCode == 1);
    CHECK(names(out) ==
          std::set<std::string>{"frame_0003.png", "frame_00003_mine.png", "frame_mine.png", "rules.yaml"});
    CHECK(names(dump) == std::set<std::string>{"visibility_mine.png"});
    CHECK(gnomonProgram("run room --out out", before).exitCode == 1);
    CHECK(names(out).count("rules.yaml") == 0);
}

TEST_CASE("compare holds the rules against fixed choices, cold and warm, and writes every frame of every run")
{
    const Folder folder("compare");
    const fs::path csv = folder.path / "times.csv";
    const Ran ran = gnomonProgram("compare torus_grid --rules default,thesis --methods shadow_map,ray_traced --map 128 "
                                  "--size 96x64 --seconds 1.2 --stride 18 --alternations 2 --warm --csv '" +
                                  csv.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    for (const char* line : {"gnSubmitShadows, 4 frames (every 18 of 1.2 s), medians of 2 alternations",
                             "\nequal quality: ", "\ndefault rules ", "\nthesis rules ", "\nray_traced ",
                             "\nray_traced, warm ", "\nshadow_map ", "\nshadow_map_128 ",
                             "\ndefault rules, cold: against ", ", the best fixed choice of equal quality",
                             "\nthesis rules, warm: ", "total, normalised", "worst frame", "envelope, frame by frame",
                             "\nIn torus_grid, with 1 light, a frame by the default rules takes ", " served: "})
        CHECK_MESSAGE(ran.output.find(line) != std::string::npos, line);
    const std::vector<std::string> table = lines(csv);
    CHECK(table.at(0) == "scene,run,pass,alternation,frame,frame_ms,sentinel_ms,shadow_ms,adaptive,equal_quality,"
                         "near_wrong_pct,far_wrong_pct,command");
    CHECK(table.at(1).ends_with(
        ",\"gnomon compare torus_grid --rules default,thesis --methods shadow_map,ray_traced --map "
        "128 --size 96x64 --seconds 1.2 --stride 18 --alternations 2 --warm --csv " +
        csv.string() + "\""));
    CHECK(table.at(2).ends_with(","));
    std::map<std::string, int> frames;
    for (const std::string& line : table) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(line, cells));
        ++frames[cells.at(1) + " " + cells.at(2)];
    }
    for (const char* run : {"default rules cold", "thesis rules warm", "ray_traced cold", "ray_traced warm"})
        CHECK_MESSAGE(frames[run] == 2 * 4, run);
    const Ran wrong = gnomonProgram("compare torus_grid --methods cube_map");
    CHECK(wrong.exitCode == 1);
    CHECK(wrong.output.find("cube_map serves no light of torus_grid") != std::string::npos);
}

TEST_CASE("compare by the recorded entry point leaves out what needs the CPU between its passes, and sums up scenes")
{
    const std::string scene = std::string(GNOMON_TEST_SCENES) + "/yard.yaml";
    const Ran ran = gnomonProgram("compare torus_grid '" + scene +
                                  "' --entry recorded --methods ray_traced,stencil_volume "
                                  "--size 96x64 --seconds 0.1 --stride 2 --alternations 1 --budget 1.3x --warm "
                                  "--lights 2");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    CHECK(ran.output.find("of the budget that the host gave, 1.3 times the cheapest fixed choice of equal quality") !=
          std::string::npos);
    CHECK(ran.output.find("own budget") != std::string::npos); // it has reached the runtime
    CHECK(ran.output.find("gnCmdRenderShadows, 3 frames") != std::string::npos);
    CHECK(ran.output.find("left out: ray_traced: needs the CPU between its passes and cannot be recorded") !=
          std::string::npos);
    CHECK(ran.output.find("in one run, whose noise is not known") != std::string::npos);
    CHECK(ran.output.find("\nIn yard, with 2 lights, ") != std::string::npos);
    CHECK(ran.output.find("\ntorus_grid, default rules, cold: total ") != std::string::npos);
}

TEST_CASE(
    "calibrate writes a base of both passes of every method and what their lights share, and checks a scene against it")
{
    const Folder folder("calibrate");
    const fs::path csv = folder.path / "base.csv";
    const Ran ran = gnomonProgram("calibrate --methods shadow_map,ray_traced --seconds-per-method 1 --out '" +
                                  csv.string() + "' --samples '" + (folder.path / "samples.csv").string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> table = lines(csv);
    REQUIRE(table.size() > 2);
    CHECK(table[0].starts_with("# gnomon knowledge "));
    std::set<std::string> seen;
    for (size_t i = 2; i < table.size(); ++i) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(table[i], cells));
        seen.insert(cells.at(3) + " " + cells.at(4));
    }
    CHECK(seen == std::set<std::string>{"ray_traced method", "ray_traced resolve",
                                        "ray_traced view:view.depth_readback", "ray_traced view:view.normals_readback",
                                        "shadow_map method", "shadow_map resolve", "shadow_map update"});
    const Ran fitted = gnomonProgram("calibrate --fit '" + (folder.path / "samples.csv").string() + "' --out '" +
                                     (folder.path / "again.csv").string() + "'");
    CHECK(fitted.exitCode == 0);
    CHECK(lines(folder.path / "again.csv") == table); // the same samples, the same base
    const Ran checked = gnomonProgram("calibrate --check torus_grid --methods shadow_map,ray_traced --size 160x120 "
                                      "--knowledge '" +
                                      csv.string() + "'");
    CHECK(checked.exitCode == 0);
    for (const char* line : {"device factor ", "\nshadow_map  ", "\nray_traced  ", "\nall lights and methods "})
        CHECK_MESSAGE(checked.output.find(line) != std::string::npos, checked.output);
    CHECK(checked.output.find("left out") == std::string::npos); // all alternations saw the same lights and passes
    const Ran errors = gnomonProgram("calibrate --errors room --methods shadow_map,cube_map --map 256 --size 320x180");
    CHECK(errors.exitCode == 0);
    for (const char* line : {"room         spot1            shadow_map", "room         point2           cube_map",
                             "\nshadow_map: 2 lights, wrong pixels ", "\ncube_map: 2 lights, wrong pixels "})
        CHECK_MESSAGE(errors.output.find(line) != std::string::npos, errors.output);
}

TEST_CASE("rules edited during a run come into force and into its folder, and are said to be missing when they are")
{
    const Folder folder("reload");
    std::ofstream(folder.path / "kept.yaml") << valueOf(findRules("default")).text;
    std::ofstream(folder.path / "new.yaml") << valueOf(findRules("thesis")).text << "# edited\n";
    fs::copy_file(folder.path / "kept.yaml", folder.path / "rules.yaml");
    std::ofstream(folder.path / "script.sh") << // waits at most half a minute for each step, and ends the run
        "until_said() { n=0; until grep -q \"$1\" said; do sleep 0.1; n=$((n + 1)); [ $n -lt 300 ] || break; done; }\n"
        "'" GNOMON_PROGRAM "' run torus_grid --rules rules.yaml --size 32x24 --frames 1000000 --out out > said 2>&1 &\n"
        "until_said frames; sleep 0.1; cp new.yaml rules.yaml; until_said 'is in force'\n"
        "rm rules.yaml; until_said 'cannot be read'\n"
        "kill $!; wait $!; cat said\n";
    std::array<char, 4096> chunk{};
    std::string said;
    FILE* pipe = popen(("cd '" + folder.path.string() + "' && sh script.sh 2>&1").c_str(), "r");
    REQUIRE(pipe != nullptr);
    for (size_t got = 0; (got = fread(chunk.data(), 1, chunk.size(), pipe)) > 0;)
        said.append(chunk.data(), got);
    pclose(pipe);
    CHECK_MESSAGE(said.find("rules: rules.yaml is in force") != std::string::npos, said);
    CHECK_MESSAGE(said.find("rules.yaml: cannot be read") != std::string::npos, said);
    CHECK(lines(folder.path / "out" / "rules.yaml") == lines(folder.path / "new.yaml"));
}

} // namespace gnomon::demo
