// The page of `gnomon report`: well-formed whatever a run's tables hold, small however long the run was.
#include "demo/report/comparison.hpp"
#include "demo/report/csv_reader.hpp"
#include "demo/report/markup.hpp"
#include "demo/report/page.hpp"
#include "demo/report/sections.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "demo/host/vulkan.hpp"
#include "demo/io/file.hpp"
#include "demo/io/png.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/gnuplot.hpp"
#include "runtime/registry.hpp"

namespace fs = std::filesystem;
using namespace gnomon::demo;

namespace {

constexpr const char* kFramesHead = "frame,time_s,frame_ms,fps,shadow_gpu_ms,shadow_cpu_ms,decide_us,lights,switches,"
                                    "budget_ms,over_budget\n";
constexpr const char* kLightsHead =
    "frame,light,method,suitability,predicted_ms,measured_ms,distance,reason,map_side\n";

const std::string kCompareHead = "scene,run,pass,alternation,frame,frame_ms,sentinel_ms,shadow_ms,adaptive,"
                                 "equal_quality,near_wrong_pct,far_wrong_pct,command\n";
const std::string kBenchHead = "scene,method,map,increment_ms_min,wrong_pct,device,penumbra_rmse,memory_mib,command\n";

/// A folder as `gnomon run` leaves it.
struct Folder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / "gnomon_report_test";

    Folder()
    {
        std::filesystem::remove_all(path);
        std::filesystem::create_directories(path);
        write("frames.csv", kFramesHead);
        write("lights.csv", kLightsHead);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    void write(const char* name, const std::string& text) const { REQUIRE(writeFile(path / name, text)); }
    RunData read() const
    {
        Outcome<RunData> run = readRun(path);
        REQUIRE_MESSAGE(run, run.error());
        return std::move(*run);
    }
};

std::string frameLine(int frame, const std::string& ms, int lights = 1)
{
    return std::to_string(frame) + ",0," + ms + ",60,2.5,1.5,10," + std::to_string(lights) + ",0,0,0\n";
}

std::string lightLine(int frame, const std::string& light, const std::string& method, double distance)
{
    return std::to_string(frame) + "," + light + "," + method + ",0.5,1,0.75," + fixed(distance, 3) + ",rules R1,0\n";
}

std::string pageOf(const RunData& run)
{
    const std::string command = "gnomon report x";
    return page("test", headlineSection(run) + frameSection(run) + laneSection(run) + distanceSection(run) +
                            pictureSection(run) + worstSection(run) +
                            reproduceSection(std::span(&command, 1), run.notes));
}

/// Whether every tag is closed in order and nothing but known entities and tags stands in the text: what an XML parser
/// asks of the page.
bool isWellFormed(const std::string& text)
{
    std::vector<std::string> open;
    for (size_t i = text.find("<html"); i < text.size();) {
        const size_t tag = text.find('<', i);
        for (size_t amp = text.find('&', i); amp < std::min(tag, text.size()); amp = text.find('&', amp + 1)) {
            const std::string entity = text.substr(amp, text.find(';', amp) - amp + 1);
            if (entity != "&amp;" && entity != "&lt;" && entity != "&gt;" && entity != "&quot;") return false;
        }
        if (tag == std::string::npos) break;
        const size_t end = text.find('>', tag);
        if (end == std::string::npos || text.find('<', tag + 1) < end) return false;
        const std::string inside = text.substr(tag + 1, end - tag - 1);
        const std::string name = inside.substr(0, inside.find_first_of(" \n/"));
        if (inside[0] == '/') {
            if (open.empty() || open.back() != inside.substr(1)) return false;
            open.pop_back();
        } else if (inside.back() != '/') {
            open.push_back(name);
        }
        i = end + 1;
    }
    return open.empty();
}

/// The colour of the lane's box whose tip names the method.
std::string laneFill(const std::string& text, const std::string& method)
{
    const size_t tip = text.find("<title>of " + method + ", frame 0");
    const size_t fill = tip == std::string::npos ? tip : text.rfind("fill=\"", tip);
    return fill == std::string::npos ? std::string() : text.substr(fill + 6, 7);
}

/// What no format makes small.
Image8 noise(uint32_t width, uint32_t height)
{
    Image8 image(width, height, 3);
    uint32_t state = 1;
    for (uint8_t& texel : image.texels)
        texel = static_cast<uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
    return image;
}

size_t countOf(const std::string& text, std::string_view word)
{
    size_t count = 0;
    for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
        ++count;
    return count;
}

} // namespace

TEST_CASE("the reader of well-formed pages tells bad ones")
{
    CHECK(isWellFormed("<html><p>a &lt; b</p><br/></html>"));
    CHECK_FALSE(isWellFormed("<html><p>a & b</p></html>"));
    CHECK_FALSE(isWellFormed("<html><p>a</html></p>"));
    CHECK_FALSE(isWellFormed("<html><p title=\"a<b\">a</p></html>"));
}

TEST_CASE("base64 has RFC 4648's vectors")
{
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");
    CHECK(base64("fo") == "Zm8=");
    CHECK(base64("foobar") == "Zm9vYmFy");
}

TEST_CASE("ticks are round numbers within the axis")
{
    CHECK(ticks({.low = 0.0, .high = 10.0}) == std::vector<double>{0.0, 2.0, 4.0, 6.0, 8.0, 10.0});
    CHECK(ticks({.low = 0.5, .high = 30.0, .logarithmic = true}).size() == 6); // 0.5 1 2 5 10 20
    for (const double tick : ticks({.low = 3e-5, .high = 7e4, .logarithmic = true}))
        CHECK(std::abs(std::log10(tick) - std::round(std::log10(tick))) < 1e-9);
}

TEST_CASE("a run without frames, with one, and without lights has a page")
{
    const Folder folder;
    CHECK(isWellFormed(pageOf(folder.read())));
    CHECK(pageOf(folder.read()).find("has no frames") != std::string::npos);
    folder.write("frames.csv", kFramesHead + frameLine(0, "16.5", 0));
    const std::string one = pageOf(folder.read());
    CHECK(isWellFormed(one));
    CHECK(one.find("1 frames with up to 0 lights took 16.5 ms each, 4.0 ms") != std::string::npos);
    CHECK(one.find("nan") == std::string::npos);
}

TEST_CASE("names with quotes, brackets and ampersands stand in the page as they are")
{
    const Folder folder;
    folder.write("frames.csv", kFramesHead + frameLine(0, "10") + frameLine(1, "11"));
    folder.write("lights.csv", kLightsHead + lightLine(0, "\"a<b>&\"\"c\"\"\"", "shadow_map", 4.0) +
                                   lightLine(1, "\"a<b>&\"\"c\"\"\"", "<script>alert(1)</script>", 4.0));
    const RunData run = folder.read();
    REQUIRE(run.lights.size() == 1);
    CHECK(run.lights[0].name == "a<b>&\"c\"");
    const std::string text = pageOf(run);
    CHECK(isWellFormed(text));
    CHECK(text.find("<script>") == std::string::npos);
    CHECK(text.find("a&lt;b&gt;&amp;&quot;c&quot;") != std::string::npos);
}

TEST_CASE("stretches, distances and shares are those of the table")
{
    const Folder folder;
    std::string frames = kFramesHead, lights = kLightsHead;
    for (int frame = 0; frame < 10; ++frame) {
        frames += frameLine(frame, "10");
        lights += lightLine(frame, "lamp", frame < 4 ? "cube_map" : "ray_traced", frame < 4 ? 30.0 : 3.0);
    }
    folder.write("frames.csv", frames);
    folder.write("lights.csv", lights);
    const RunData run = folder.read();
    REQUIRE(run.lights.size() == 1);
    REQUIRE(run.lights[0].stretches.size() == 2);
    CHECK(run.lights[0].stretches[0].last == 3);
    CHECK(run.lights[0].stretches[1].first == 4);
    CHECK(run.uses[0].inBand[4] == 4); // 20 to 40 m
    CHECK(run.uses[1].inBand[1] == 6); // 2.5 to 5 m
    CHECK(run.uses[1].measuredMs == doctest::Approx(6 * 0.75));
    CHECK(countOf(laneSection(run), "<title>lamp") == 2);
}

TEST_CASE("a table cut off in the middle of a row is read up to there, and the page says so")
{
    const Folder folder;
    folder.write("frames.csv", kFramesHead + frameLine(0, "10") + frameLine(1, "11") + "2,0,1");
    const RunData run = folder.read();
    CHECK(run.frames.size() == 2);
    REQUIRE(run.notes.size() == 1);
    CHECK(run.notes[0].find("row 4") != std::string::npos);
    CHECK(pageOf(run).find("row 4 is not a whole row") != std::string::npos);
}

TEST_CASE("names of several lines and of letters beyond ASCII are read and cut whole")
{
    const Folder folder;
    folder.write("frames.csv", kFramesHead + frameLine(0, "10"));
    folder.write("lights.csv", kLightsHead + lightLine(0, "\"two\nlines\"", "cube_map", 4.0) +
                                   lightLine(0, "Hoflaterne\xc3\xa4\xc3\xa4", "cube_map", 4.0));
    const RunData run = folder.read();
    CHECK(run.notes.empty());
    REQUIRE(run.lights.size() == 2);
    CHECK(run.lights[0].name == "two\nlines");
    CHECK(laneSection(run).find(">Hoflaterne<") != std::string::npos); // 11 bytes would end within a letter
}

TEST_CASE("what is no folder of a run is named")
{
    CHECK(readRun("/nowhere").error().find("/nowhere/frames.csv") != std::string::npos);
    const Folder folder;
    folder.write("frames.csv", "a,b\n1,2\n");
    CHECK(readRun(folder.path).error().find("no column 'frame'") != std::string::npos);
    CHECK(readCompared(folder.path / "frames.csv").error().find("no column 'scene'") != std::string::npos);
}

TEST_CASE("a hundred thousand frames make a page under two megabytes that says what it left out")
{
    const Folder folder;
    std::ofstream frames(folder.path / "frames.csv"), lights(folder.path / "lights.csv");
    frames << kFramesHead;
    lights << kLightsHead;
    for (int frame = 0; frame < 100'000; ++frame) {
        frames << frameLine(frame, frame == 77'777 ? "99.5" : "10", 3);
        for (const char* light : {"a", "b", "c"}) // a change in every third frame
            lights << lightLine(frame, light, frame % 6 < 3 ? "cube_map" : "ray_traced", 5.0);
    }
    frames.close();
    lights.close();
    const std::string text = pageOf(folder.read());
    MESSAGE("page: " << text.size() << " bytes");
    CHECK(text.size() < 2'000'000);
    CHECK(isWellFormed(text));
    CHECK(text.find("100000 frames in") != std::string::npos);
    CHECK(text.find("Frame 77777: 99.5 ms") != std::string::npos);
    CHECK(text.find("short stretches are drawn with the one before") != std::string::npos);
}

TEST_CASE("fixed choices are held against the adaptive run of the same scene and pass")
{
    const Folder folder;
    std::string text = "scene,run,pass,alternation,frame,frame_ms,sentinel_ms,shadow_ms,adaptive,equal_quality,"
                       "near_wrong_pct,far_wrong_pct\n";
    for (const char* alternation : {"0", "1", "2"}) {
        text += std::string("hall,default,cold,") + alternation + ",0,20,1,8,1,1,0.1,0.2\n";
        text += std::string("hall,cube_map,cold,") + alternation + ",0,26,1,14,0,0,3,4\n";
        text += std::string("hall,cube_map,warm,") + alternation + ",0,90,1,70,0,0,3,4\n";
    }
    folder.write("compare.csv", text);
    const Outcome<Compared> compared = readCompared(folder.path / "compare.csv");
    REQUIRE(compared);
    REQUIRE(compared->runs.size() == 3);
    const std::string section = savedSection(*compared);
    CHECK(isWellFormed("<html>" + section + "</html>"));
    CHECK(section.find("<td>cube_map</td><td>26.0</td><td>6.0</td><td>14.0</td>") != std::string::npos);
    CHECK(section.find("90.0") == std::string::npos); // no adaptive run was warm
}

TEST_CASE("the Pareto front has what nothing else beats in both")
{
    const std::vector<Benched::Row> rows = {{.method = "slow and exact", .ms = 9.0, .error = 0.0},
                                            {.method = "beaten", .ms = 5.0, .error = 2.0},
                                            {.method = "middle", .ms = 4.0, .error = 1.0},
                                            {.method = "quick", .ms = 1.0, .error = 8.0}};
    CHECK(paretoFront(rows) == std::vector<size_t>{3, 2, 0});
    CHECK(isWellFormed("<html>" + errorSection({.rows = rows, .notes = {}}) + "</html>"));
    const std::string both = errorSection(
        {.rows = {{.scene = "a", .method = "x", .ms = 1.0, .error = 0.2, .soft = true}, {.scene = "a", .method = "y"}},
         .notes = {}});
    CHECK(countOf(both, "<svg") == 2); // an RMSE and a share of pixels do not stand on one axis
}

TEST_CASE("tables without a run make a page, beside the first of them, that says how each was made")
{
    const Folder folder;
    fs::remove(folder.path / "frames.csv");
    folder.write("compare.csv", kCompareHead + "hall,default,cold,0,0,20,1,8,1,1,0.1,0.2,gnomon compare hall\n" +
                                    "hall,cube_map,cold,0,0,26,1,14,0,0,3,4,\n");
    folder.write("bench.csv", kBenchHead + "room,ray_traced,,9,0,gpu,,2,gnomon bench room --repeat 3\n" +
                                  "room,shadow_map,512,3,0.5,gpu,,4,\n");
    const std::string compare = (folder.path / "compare.csv").string(), bench = (folder.path / "bench.csv").string();
    CHECK(reportCommand({.compare = {compare}, .bench = {bench}}) == 0);
    const std::string both = valueOf(readText(folder.path / "report.html"));
    CHECK(isWellFormed(both));
    CHECK(countOf(both, "<svg") == 1);
    CHECK(both.find("<td>cube_map</td><td>26.0</td>") != std::string::npos);
    CHECK(both.find("gnomon compare hall\ngnomon bench room --repeat 3\ngnomon report --compare " + compare) !=
          std::string::npos);
    CHECK(both.find("has no frames") == std::string::npos);

    folder.write("bench.csv", kBenchHead);
    CHECK(reportCommand({.bench = {bench}}) == 0);
    CHECK(valueOf(readText(folder.path / "report.html")).find("The tables hold nothing to draw") != std::string::npos);
    CHECK_THROWS(reportCommand({.run = folder.path.string(), .bench = {bench}})); // a run that is named must be there
}

TEST_CASE("a page over two megabytes goes without its pictures, and says so")
{
    const Folder folder;
    std::string rows;
    const std::string name(400, 'm');
    for (int i = 0; i < 1300; ++i)
        rows += "room," + name + std::to_string(i) + "," + "," + std::to_string(i + 1) + ",1,gpu,,2,\n";
    folder.write("frames.csv", kFramesHead + frameLine(0, "10"));
    folder.write("bench.csv", kBenchHead + rows);
    for (const char* picture : {"frame_00000.png", "frame_00000_methods.png"})
        REQUIRE(writePng(folder.path / picture, noise(400, 300)));
    const auto report = [&](std::vector<std::string> tables) {
        CHECK(reportCommand({.run = folder.path.string(), .bench = std::move(tables)}) == 0);
        return valueOf(readText(folder.path / "report.html"));
    };
    const std::string bench = (folder.path / "bench.csv").string();
    const std::string without = report({}), with = report({bench});
    MESSAGE("pages: " << without.size() << " and " << with.size() << " bytes");
    CHECK(without.find("data:image/png") != std::string::npos);
    CHECK(with.size() < 2'000'000);
    CHECK(with.find("data:image/png") == std::string::npos);
    CHECK(with.find("pictures are left out") != std::string::npos);
}

TEST_CASE("sixty-four methods keep apart in lanes and legend")
{
    const Folder folder;
    std::string lights = kLightsHead;
    std::vector<std::string> names;
    for (const gnomon::BuiltinAlgorithm& algorithm : gnomon::builtinRegistry().algorithms)
        if (names.size() < 64) names.emplace_back(algorithm.entry->name);
    const size_t builtIn = names.size();
    REQUIRE(builtIn > 20);
    while (names.size() < 64)
        names.push_back("plug_in_" + std::to_string(names.size()));
    for (const std::string& name : names)
        lights += lightLine(0, "of " + name, name, 5.0);
    folder.write("frames.csv", kFramesHead + frameLine(0, "10", int(names.size())));
    folder.write("lights.csv", lights);
    const std::string text = pageOf(folder.read());
    CHECK(isWellFormed(text));
    CHECK(text.size() < 200'000);
    std::set<std::string> colours;
    for (const std::string& name : names) {
        const std::string colour = hexOf(methodColour(name));
        if (&name - names.data() < std::ptrdiff_t(builtIn))
            colours.insert(colour); // those of plug-ins follow from their letters
        CHECK_MESSAGE(text.find("background:" + colour + "\"></i>" + name + "</span>") != std::string::npos, name);
        CHECK_MESSAGE(laneFill(text, name) == colour, name);
    }
    CHECK(colours.size() == builtIn);
}

TEST_CASE("a comparison has a table for each place and kind of light, and marks what nothing beats in time and error")
{
    const Folder folder;
    folder.write("a.csv", "scene,method,map,increment_ms_min,wrong_pct,memory_mib,device,driver,width,height,"
                          "light_kind,date,penumbra_rmse\n"
                          "room,ray_traced,,9,0,2,gpu,7,64,36,spot,2026-01-02,\n"
                          "room,shadow_map,512,3,0.5,4,gpu,7,64,36,spot,2026-01-02,\n"
                          "room,pcf_hybrid,512,4,0.5,6,gpu,7,64,36,spot,2026-01-02,\n" // slower, no better
                          "room,plug-in,,5,,6,gpu,7,64,36,spot,2026-01-02,\n"          // no truth
                          "bunny,ray_traced,,1,0,2,gpu,7,64,36,spot,2026-01-02,\n"
                          "bunny,ray_traced,,1,0,2,gpu,7,64,36,point,2026-01-02,\n"
                          "a|b,plug|in,,1,7,2,gpu,7,64,36,soft spot,2026-01-02,0.0625\n"
                          "room,broken,,,0,2,gpu,7,64,36,spot,2026-01-02,\n"); // no time
    folder.write("b.csv", "scene,method,map,increment_ms_min,wrong_pct,memory_mib,device,driver,width,height,"
                          "light_kind,date,penumbra_rmse\n"
                          "room,ray_traced,,2,0,2,other,7,64,36,spot,2026-01-02,\n"
                          "room,tile_shafts,,-0.4,0,2,other,7,64,36,spot,2026-01-02,\n" // by the clock alone
                          "room,pcf_hybrid,,0.05,0,2,other,7,64,36,spot,2026-01-02,\n"
                          "room,ray_tr");
    Compilation all;
    REQUIRE(readCompilation(folder.path / "a.csv", all));
    REQUIRE(readCompilation(folder.path / "b.csv", all));
    CHECK(all.rows.size() == 10);
    CHECK(all.notes.size() == 1); // the row that is cut off
    CHECK_FALSE(readCompilation(folder.path / "frames.csv", all));

    const std::string text = comparisonPage(all, "gnomon publish", {"a.csv", "b.csv"});
    const auto count = [&](std::string_view words) {
        size_t found = 0;
        for (size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
            ++found;
        return found;
    };
    CHECK(count("\n## gpu, 7, 64x36, 2026-01-02\n") == 1);
    CHECK(count("\n## other, 7, 64x36, 2026-01-02\n") == 1);
    CHECK(count("\n### spot\n") == 2);
    CHECK(count("\n### point\n") == 1);
    CHECK(count("\n| method | room | bunny |\n") == 1);
    CHECK(count("| [`ray_traced`](../algorithms/hybrid/ray_traced.md) | **9.00 ms, 2.0 MiB, 0.0000 %** | "
                "**1.00 ms, 2.0 MiB, 0.0000 %** |\n") == 1);
    CHECK(count("| **3.00 ms, 4.0 MiB, 0.5000 %** | - |\n") == 1);
    CHECK(count("| 4.00 ms, 6.0 MiB, 0.5000 % | - |\n") == 1);
    CHECK(count("| `plug-in` | 5.00 ms, 6.0 MiB | - |\n") == 1);
    CHECK(count("Bold in most scenes: `ray_traced` in 2, `shadow_map` in 1 of 2.") == 1);
    CHECK(count("| **< 0.1 ms, 2.0 MiB, 0.0000 %** |\n") == 2);
    CHECK(count("| 2.00 ms, 2.0 MiB, 0.0000 % |\n") == 1);
    CHECK(count("\n### soft spot\n\n| method | a\\|b |\n") == 1);
    CHECK(count("| `plug\\|in` | **1.00 ms, 2.0 MiB, 0.0625** |\n") == 1);
    CHECK(count("broken") == 0);
    CHECK(count("[`a.csv`](a.csv), [`b.csv`](b.csv)") == 1);
}
