// gnomon bench from outside: columns, what it refuses and leaves out.
#include <doctest/doctest.h>

#include <map>
#include <set>
#include <sstream>

#include "cli_fixture.hpp"
#include "demo/host/vulkan.hpp"
#include "demo/io/csv.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {

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
                      "ambiguous_pct,mean_abs_error,penumbra_pct,penumbra_rmse,penumbra_mean_abs,penumbra_off_pct,"
                      "outside_rmse,outside_mean_abs,outside_off_pct,aliasing_p50,aliasing_p95,command");
    CHECK(table[1].starts_with("torus_grid,none,1,160,120,"));
    for (size_t i = 1; i < table.size(); ++i) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(table[i], cells));
        CHECK(cells.size() == 31);
        CHECK(cells.at(28).empty() == (cells.at(1) != "shadow_map")); // the others hand out no map
        CHECK(cells.at(21).empty());                                  // its light has no radius
        CHECK(cells.at(30) == (i > 1 ? ""
                                     : "gnomon bench torus_grid --methods shadow_map,bare_shadow_map --map 128,256 "
                                       "--size 160x120 --repeat 3 --csv " +
                                           csv.string()));
        CHECK(cells.at(5) == std::array{"", "128", "256", "128", "256"}.at(i - 1));
    }
}

TEST_CASE("bench holds lights with a radius against the soft truth: a soft method is nearer to it than a hard one")
{
    const Folder folder("bench_soft");
    const fs::path csv = folder.path / "bench.csv";
    const fs::path plot = folder.path / "bench.svg";
    const Ran ran = gnomonProgram("bench torus_grid --radius 0.6 --methods ray_traced,coherence_sampling --size 96x64 "
                                  "--repeat 3 --csv '" +
                                  csv.string() + "' --plot '" + plot.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> picture = lines(plot);
    REQUIRE_FALSE(picture.empty());
    CHECK(picture.front().starts_with("<svg xmlns="));
    CHECK(picture.back() == "</svg>");
    size_t dots = 0;
    for (const std::string& line : picture)
        for (size_t at = line.find("<circle"); at != std::string::npos; at = line.find("<circle", at + 1))
            ++dots;
    CHECK(dots == 2); // methods; none has no dot
    CHECK(ran.output.find("soft: penumbra ") != std::string::npos);
    std::map<std::string, std::vector<std::string>> rows;
    for (const std::string& line : lines(csv)) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(line, cells));
        rows[cells.at(1)] = cells;
    }
    CHECK(rows.at("none").at(22).empty()); // penumbra_rmse
    const std::vector<std::string>&hard = rows.at("ray_traced"), &soft = rows.at("coherence_sampling");
    CHECK(std::stod(hard.at(12)) == 0.0); // wrong_pct is of the hard truth
    CHECK(std::stod(hard.at(21)) > 1.0);  // penumbra_pct
    CHECK(std::stod(hard.at(22)) > 0.2);
    CHECK(std::stod(soft.at(22)) < 0.03);
    CHECK(std::stod(soft.at(24)) < std::stod(hard.at(24))); // penumbra_off_pct
}

TEST_CASE("the column map says which size was in force where --set set it")
{
    const Folder folder("bench_map");
    const fs::path csv = folder.path / "bench.csv";
    const Ran ran = gnomonProgram("bench torus_grid --size 96x64 --repeat 3 --set resolution=512,rows=90 --methods "
                                  "shadow_map,angular_spans,ray_traced --csv '" +
                                  csv.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    std::set<std::string> maps;
    for (const std::string& line : lines(csv)) {
        std::vector<std::string> cells;
        REQUIRE(splitCsvLine(line, cells));
        maps.insert(cells.at(1) + ' ' + cells.at(5));
    }
    CHECK(maps == std::set<std::string>{"method map", "none ", "shadow_map 512", "angular_spans 90", "ray_traced "});
}

TEST_CASE("bench leaves out what a method does not take before it measures, and names lights that are not there")
{
    const Folder folder("bench_range");
    const std::string csv = "--csv '" + (folder.path / "bench.csv").string() + "'", few = " --size 96x64 --repeat 3 ";
    const Ran beyond = gnomonProgram("bench torus_grid --methods shadow_map --map 128,16384" + few + csv);
    CHECK(beyond.exitCode == 0);
    CHECK_MESSAGE(beyond.output.find("shadow_map with map 16384 is left out: its resolution is from ") !=
                      std::string::npos,
                  beyond.output);
    CHECK(lines(folder.path / "bench.csv").size() == 3); // header, none, shadow_map
    const Ran set = gnomonProgram("bench torus_grid --methods ray_traced,shadow_map --set resolution=1e9" + few);
    CHECK(set.exitCode == 1);
    CHECK_MESSAGE(set.output.find("--set: shadow_map takes 'resolution' from ") != std::string::npos, set.output);
    CHECK(set.output.find("increment") == std::string::npos);
    const Ran bare = gnomonProgram("bench scenario --light moving1 --methods bare_shadow_map,ray_traced" + few);
    CHECK(bare.exitCode == 0);
    CHECK_MESSAGE(bare.output.find("the first light is not there in all frames") != std::string::npos, bare.output);
    CHECK_MESSAGE(bare.output.find("not there in frame 3, in which errors are counted: moving1") != std::string::npos,
                  bare.output);
}

TEST_CASE(
    "a method that the memory limit keeps from serving is named with gnomon's reason, and the others are measured")
{
    const Folder folder("short_memory");
    const std::string before = "cd '" + folder.path.string() + "' &&", few = " --size 96x64 --repeat 3 --memory 8 ";
    const Ran beside = gnomonProgram("bench torus_grid --methods shadow_map,ray_traced --map 4096" + few, before);
    CHECK(beside.exitCode == 0);
    CHECK_MESSAGE(beside.output.find("shadow_map is left out: light 'lamp'") != std::string::npos, beside.output);
    CHECK(beside.output.find("memory: needs ") != std::string::npos);
    CHECK(beside.output.find("torus_grid,ray_traced,1,") != std::string::npos);
    const Ran alone = gnomonProgram("bench torus_grid --methods shadow_map --map 4096" + few, before);
    CHECK(alone.exitCode == 1);
    CHECK(alone.output.find("none of the methods") != std::string::npos);
}

TEST_CASE("a method that serves none of the lights is named, and where no other is left nothing is measured")
{
    const Folder folder("unserved");
    const std::string before = "cd '" + folder.path.string() + "' &&", few = " --size 96x64 ";
    const Ran beside = gnomonProgram("bench torus_grid --repeat 3 --methods cube_map,shadow_map" + few, before);
    CHECK(beside.exitCode == 0);
    CHECK(beside.output.find("cube_map is left out: it serves none of the lights") != std::string::npos);
    CHECK(beside.output.find("torus_grid,shadow_map,1,") != std::string::npos);
    const Ran alone = gnomonProgram("bench torus_grid --methods cube_map" + few, before);
    CHECK(alone.exitCode == 1);
    CHECK_MESSAGE(alone.output.find("none of the methods") != std::string::npos, alone.output);
    CHECK(alone.output.find("torus_grid,none") == std::string::npos);
    const Ran bare = gnomonProgram("bench bunny --light sun --methods bare_shadow_map" + few, before);
    CHECK(bare.exitCode == 1);
    CHECK_MESSAGE(bare.output.find("the first light is no spot light") != std::string::npos, bare.output);
    const Ran sheet = gnomonProgram("contact torus_grid --methods cube_map --out x.png" + few, before);
    CHECK(sheet.exitCode == 1);
    CHECK(sheet.output.find("cube_map is left out: it serves none of the lights") != std::string::npos);
    CHECK_FALSE(fs::exists(folder.path / "x.png"));
}

TEST_CASE("a light that is there for a part of the scene is traced, and missed aloud where it is not there")
{
    const Folder folder("late");
    const auto write = [&](const char* file, const char* until) {
        std::ofstream(folder.path / file)
            << "name: late\nframes: 60\nbase: " << fs::absolute(valueOf(findScene("torus_grid"))).string()
            << "\nlights:\n  - {name: lamp, kind: spot, at: [6, 14, 6], aim: [0, 0, 0], cone: {outer: 50}, range: 60, "
            << "appear: 0.4, disappear: " << until << "}\n";
    };
    write("late.yaml", "0.9");
    write("short.yaml", "0.45");
    const std::string before = "cd '" + folder.path.string() + "' &&";
    const Ran traced = gnomonProgram(
        "trace late.yaml --frames 10 --sweeps 1 --size 64x48 --methods shadow_map,ray_traced,cube_map", before);
    CHECK_MESSAGE(traced.exitCode == 0, traced.output);
    CHECK(traced.output.find("note: cube_map is left out: ") != std::string::npos);
    const Ran replayed = gnomonProgram("replay scene.gntrace", before);
    CHECK_MESSAGE(replayed.exitCode == 0, replayed.output);
    CHECK(replayed.output.find("budget 0 to 0 ms") == std::string::npos);
    const std::pair<const char*, const char*> refused[] = {
        {"trace short.yaml --frames 3", "has no light in any frame"},
        {"trace scenario --frames 65536 --lights 32 --methods shadow_map", "more than a trace may hold"},
        {"contact short.yaml --methods shadow_map --size 64x48", "shadow_map is left out: none of its lights is there"},
        {"calibrate --errors room --methods ray_traced", "--methods ray_traced: none of them has maps"},
        {"calibrate --check short.yaml --methods shadow_map", "has no light at any of the 3 moments"},
    };
    for (const auto& entry : refused) {
        const Ran ran = gnomonProgram(entry.first, before);
        CHECK_MESSAGE(ran.exitCode == 1, entry.first);
        CHECK_MESSAGE(ran.output.find(entry.second) != std::string::npos, ran.output);
    }
}

TEST_CASE("a radius given to bench makes lamps wide, one in degrees suns")
{
    /// Rays to all of the source over rays to its centre.
    const auto rays = [](const std::string& arguments) {
        const Ran ran =
            gnomonProgram("bench " + arguments + " --methods ray_traced,coherence_sampling --size 96x64 --repeat 3");
        CAPTURE(ran.output);
        REQUIRE(ran.exitCode == 0);
        std::istringstream output(ran.output);
        double soft = 0.0, hard = 0.0;
        for (std::string line; std::getline(output, line);) {
            std::vector<std::string> cells;
            if (!splitCsvLine(line, cells) || cells.size() != 31) continue;
            if (cells[1] == "coherence_sampling") soft = std::stod(cells[13]);
            if (cells[1] == "ray_traced") hard = std::stod(cells[13]);
        }
        return soft / hard;
    };
    CHECK(rays("torus_grid --radius 0.6 --radius-degrees 0") > 1.5);
    CHECK(rays("colonnade --light sun --radius-degrees 3") > 1.5);
    CHECK(rays("colonnade --light sun --radius 0.6 --radius-degrees 0") == 1.0);
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
    CHECK(misspelt.output.find("scene 'scenario' has no light 'lamp'; there are still1, ") != std::string::npos);
    const Ran beyond = gnomonProgram("bench scenario --lights 2 --light still3");
    CHECK(beyond.exitCode != 0);
    CHECK(beyond.output.find("'still3' of scene 'scenario' is not among the first 2, which are used: still1, still2") !=
          std::string::npos);
}

} // namespace gnomon::demo
