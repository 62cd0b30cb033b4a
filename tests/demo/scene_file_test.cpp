#include "demo/scene/scene_file.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iterator>
#include <locale>
#include <numbers>
#include <random>

using namespace gnomon::demo;
using doctest::Approx;

namespace {

constexpr const char* kCamera = "camera: [{eye: [0, 1, 5], target: [0, 0, 0]}]\n";

struct Malformed {
    const char* text;
    const char* error; ///< How the message begins, after "bad.yaml:".
};

constexpr Malformed kMalformed[] = {
    {"", "1:1: the file is empty"},
    {"- a list\n", "1:1: a scene must be a map of sections, got a list"},
    {"fps: 60\nfps: 30\n", "2:1: duplicate key 'fps', first given in line 1"},
    {"fps: &rate 60\n", "1:6: anchors are not allowed"},
    {"center: [0, 0, *a]\n", "1:"},
    {"fps: !!int 60\n", "1:"},
    {"fps: 60\n---\nfps: 60\n", "3:1: only one document is allowed in a file"},
    {"fps: [60\n", "2:1: "},
    {"fps: 60\n  frames: 3\n", "2:"},
    {"? [a, b]\n: 3\n", "1:3: a key must be a word"},
    {"speed: 60\n", "1:1: unknown key 'speed'; known here: name, description, size"},
    {"fps: fast\n", "1:6: fps must be a finite number, got 'fast'"},
    {"fps: .nan\n", "1:6: fps must be a finite number, got '.nan'"},
    {"fps: nan\n", "1:6: fps must be a finite number, got 'nan'"},
    {"fps: .inf\n", "1:6: fps must be a finite number, got '.inf'"},
    {"fps: 1e999\n", "1:6: fps must be a finite number, got '1e999'"},
    {"fps: 59,94\n", "1:6: fps must be a finite number, got '59,94'"},
    {"fps: \"60\"\n", "1:6: fps must be a finite number, got '60'"},
    {"fps: 0\n", "1:6: fps must be >= 1 and <= 1000, got 0"},
    {"fps: [60]\n", "1:6: fps must be a number, got a list"},
    {"fps:\n", "1:1: fps must be a number, got nothing"},
    {"frames: 1.5\n", "1:9: frames must be a whole number from 1 to 1000000, got '1.5'"},
    {"frames: -1\n", "1:9: frames must be a whole number from 1 to 1000000, got '-1'"},
    {"size: [640]\n", "1:7: size must be a list of 2 whole numbers"},
    {"size: [640, 0]\n", "1:13: height must be a whole number from 1 to 16384, got '0'"},
    {"center: [0, 1]\n", "1:9: center must be a list of 3 numbers, got 2 of them"},
    {"center: [0, 1e13, 0]\n", "1:13: center must be at most 1e+12 in size, got 1e13"},
    {"depth: {convention: reversed}\n",
     "1:21: depth: convention must be one of reversed_infinite, standard, got 'reversed'"},
    {"depth: {convention: standard, near: 1, far: 1}\n", "1:45: depth: far must be > 1, got 1"},
    {"meshes:\n  a: {cube: {}}\n", "2:7: mesh 'a': unknown key 'cube'; known here: file, parts, plane"},
    {"meshes:\n  a: {box: {}, card: {}}\n",
     "2:6: mesh 'a': a mesh must have exactly one of 'file', 'parts' or a shape"},
    {"meshes:\n  a: {}\n", "2:6: mesh 'a': a mesh must have exactly one of 'file', 'parts' or a shape"},
    {"meshes:\n  a: {box: {size: [1, 0, 1]}}\n", "2:23: mesh 'a': size must be >= 1e-04 and <= 1e+06, got 0"},
    {"meshes:\n  a: {box: {size: [1, 1e-60, 1]}}\n", "2:23: mesh 'a': size must be >="},
    {"meshes:\n  a: {torus: {tube: 2}}\n", "2:21: mesh 'a': tube must be >= 1e-04 and < 1, got 2"},
    {"meshes:\n  a: {torus: {ring_segments: 2}}\n",
     "2:30: mesh 'a': ring_segments must be a whole number from 3 to 4096, got '2'"},
    {"meshes:\n  a: {plane: {cells: [4096, 4096]}}\n", "2:14: mesh 'a': 33554432 triangles are more than the limit"},
    {"meshes:\n  a: {torus_knot: {p: 2, q: 4}}\n", "2:19: mesh 'a': p and q must have no common factor"},
    {"meshes:\n  a: {file: nowhere.obj}\n", "2:13: mesh 'a': mesh file 'nowhere.obj' not found; tried "},
    {"instances:\n  - {mesh: ghost}\n", "2:12: instance 0: there is no mesh 'ghost'"},
    {"instances:\n  - {name: x}\n", "2:5: instance 'x': 'mesh' is missing"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, name: x, scale: [1, -1e-9, 1]}\n",
     "3:31: instance 'x': scale must be 1e-6 at least, or -1e-6 at most where it mirrors"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, keys: [{time: 0, scale: 1}, {time: 1, scale: [1, -1, 1]}]}\n",
     "3:43: instance 0: scale must have the same signs in all keys: between them it would be 0"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, at: [0, 0, 0], keys: [{time: 0}]}\n",
     "3:15: instance 0: unknown key 'at'"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, keys: [{time: 1}, {time: 1}]}\n",
     "3:33: instance 0: times of keys must increase"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, static: true, spin: {degrees_per_second: 3}}\n",
     "3:5: instance 0: a static instance cannot have keys, a spin or an orbit"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, static: yes}\n",
     "3:23: instance 0: static must be true or false, got 'yes'"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, spin: {axis: [0, 0, 0], degrees_per_second: 3}}\n",
     "3:28: instance 0: axis must not be zero"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, repeat: {count: [1000, 1000, 1], spacing: [1, 1, 1]}}\n",
     "3:31: instance 0: more than 100000 copies"},
    {"meshes:\n  a: {parts: []}\n", "2:14: mesh 'a': parts must be a list of at least one part"},
    {"meshes:\n  a: {parts: [{at: [0, 1, 0]}]}\n", "2:15: mesh 'a': a part must have exactly one shape"},
    {"meshes:\n  a: {parts: [{box: {}, card: {}}]}\n", "2:15: mesh 'a': a part must have exactly one shape"},
    {"meshes:\n  a: {parts: [{plane: {cells: [1400, 1400]}}, {plane: {cells: [1400, 1400]}}]}\n",
     "2:47: mesh 'a': with this part the mesh has more than 4000000 triangles"},
    {"meshes:\n  a: {building: {size: [4, 2], recess: 0.6}}\n", "2:40: mesh 'a': recess must be >= 1e-04 and <= 0.5"},
    {"meshes:\n  a: {leaves: {closed: true, blades: 2}}\n",
     "2:38: mesh 'a': blades must be a whole number from 1 to 1, got '2'"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, ring: {count: 2}, repeat: {count: [2, 1, 1], spacing: [1, 1, "
     "1]}}\n",
     "3:21: instance 0: at most one of 'repeat' and 'ring' may be given"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, repeat: {count: [2, 1, 1], spacing: [1, 1, 1], grow: 1}}\n",
     "3:68: instance 0: grow must be >= 0 and <= 0.9, got 1"},
    {"meshes: {b: {box: {}}}\ninstances:\n  - {mesh: b, static: true, orbit: {degrees_per_second: 3}}\n",
     "3:5: instance 0: a static instance cannot have keys, a spin or an orbit"},
    {"lights:\n  - {kind: point, at: [0, 3, 0], range: 2, repeat: {count: [2, 1, 1], spacing: [1, 1, 1], turn: 2}}\n",
     "2:91: light 'light0': unknown key 'turn'"},
    {"lights:\n  - {name: a.1, kind: point, at: [0, 3, 0], range: 2}\n  - {name: a, kind: point, at: [0, 3, 0], range: "
     "2, "
     "ring: {count: 2}}\n",
     "3:12: light 2: light 0 is called 'a.1' already"},
    {"lights:\n  - {kind: lamp}\n", "2:12: light 'light0': kind must be one of directional, spot, point, got 'lamp'"},
    {"lights:\n  - {name: sun, kind: point, at: [0, 3, 0], range: -1}\n",
     "2:52: light 'sun': range must be > 0, got -1"},
    {"lights:\n  - {name: sun, kind: point, at: [0, 3, 0], range: 9, importance: 0}\n",
     "2:67: light 'sun': importance must be > 0, got 0"}, // the runtime reads 0 as 1
    {"lights:\n  - {name: sun, kind: point, at: [0, 3, 0], range: 1e-300}\n",
     "2:52: light 'sun': range must be > 0 in single precision, got 1e-300"},
    {"lights:\n  - {name: s, kind: spot, at: [0, 3, 0], cone: {outer: 30}, range: 9}\n",
     "2:5: light 's': exactly one of 'direction' and 'aim' must be given"},
    {"lights:\n  - {name: s, kind: spot, at: [0, 3, 0], aim: [0, 3, 0], cone: {outer: 30}, range: 9}\n",
     "2:47: light 's': aim must differ from the light's position"},
    {"lights:\n  - {name: s, kind: spot, at: [0, 3, 0], aim: [0, 0, 0], cone: {outer: 90}, range: 9}\n",
     "2:72: light 's': outer must be > 0 and <= 80, got 90"},
    {"lights:\n  - {name: s, kind: directional, direction: [0, 0, 0]}\n",
     "2:45: light 's': direction must not be zero"},
    {"lights:\n  - {name: s, kind: directional, direction: [0, -1, 0], range: 3}\n",
     "2:57: light 's': unknown key 'range'"},
    {"lights:\n  - {name: s, kind: directional, direction: [0, -1, 0], appear: 3, disappear: 3}\n",
     "2:79: light 's': disappear must come after appear"},
    {"lights:\n  - {name: s, kind: directional, direction: [0, -1, 0]}\n"
     "  - {name: s, kind: directional, direction: [1, -1, 0]}\n",
     "3:12: light 1: light 0 is called 's' already"},
    {"lights:\n  - {name: light1, kind: directional, direction: [0, -1, 0]}\n"
     "  - {kind: directional, direction: [1, -1, 0]}\n",
     "3:5: light 1: light 0 is called 'light1' already"},
    {"lights: []\nlight_count: 1\n", "2:14: light_count must be a whole number from 0 to 0, got '1'"},
    {"base: nothing.yaml\n", "1:7: base not found: nothing.yaml"},
    {"base: 3\n", "1:7: base not found: 3"},
};

constexpr Malformed kMalformedCameras[] = {
    {"fps: 60\n", "1:1: 'camera' is missing"},
    {"camera: []\n", "1:9: camera: camera must be a list of at least one key"},
    {"camera: [{eye: [0, 0, 0], target: [0, 0, 0]}]\n", "1:10: camera: eye and target must differ"},
    {"camera: [{eye: [0, 0, 1], target: [0, 0, 0], fov: 180}]\n", "1:51: camera: fov must be >= 1 and <= 160, got 180"},
    {"camera:\n  - {eye: [0, 0, 1], target: [0, 0, 0]}\n  - {time: 1, eye: [0, 0, 0], target: [0, 0, 1]}\n",
     "3:5: camera: eye and target must differ, also on the way"},
    {"camera: [{eye: [0, 0, 1]}]\n", "1:10: camera: 'target' is missing"},
};

std::string readWhole(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void checkError(const std::string& text, const std::string& expected)
{
    const auto scene = parseScene(text, "bad.yaml");
    INFO(text);
    REQUIRE_FALSE(scene);
    const std::string start = "bad.yaml:" + expected;
    CHECK(scene.error().substr(0, start.size()) == start);
}

/// A numeric facet as in German: comma for the point, dots between thousands.
struct CommaNumbers : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

/// Everything of a scene a text decides, as one string.
std::string fingerprint(const Scene& scene)
{
    std::string text;
    const auto add = [&text](double value) { text += std::to_string(int64_t(std::llround(value * 1e6))) + " "; };
    add(scene.framesPerSecond);
    for (const Instance& instance : scene.instances)
        for (int axis = 0; axis < 3; ++axis)
            add(instance.pose.position[axis] + instance.pose.scale[axis]);
    for (const Light& light : scene.lights)
        add(light.position.x + light.range + light.outerAngle + light.intensity);
    for (const Mesh& mesh : scene.meshes)
        for (const glm::vec3& p : mesh.positions)
            add(p.x + p.y + p.z);
    return text;
}

} // namespace

TEST_CASE("every malformed scene is refused with file, line, column and reason")
{
    for (const Malformed& bad : kMalformed)
        checkError(bad.text, bad.error);
    for (const Malformed& bad : kMalformedCameras)
        checkError(bad.text, bad.error);
}

TEST_CASE("ten megabytes of brackets are refused in a tenth of a second, and brackets in a text are no levels")
{
    const std::string brackets = "meshes: " + std::string(10'000'000, '[');
    const std::clock_t begin = std::clock();
    const auto refused = parseScene(brackets, "deep.yaml");
    CHECK(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC < 0.1);
    CHECK((!refused && refused.error() == "deep.yaml:1:40: nested too deeply"));
    checkError("meshes: {a: [{b: " + std::string(30, '[') + "#\n", "1:46: nested too deeply");
    const auto scene = parseScene("description: \"" + std::string(40, '[') + "\"\n" + kCamera, "text.yaml");
    REQUIRE(scene);
    CHECK(scene->description.size() == 40);
}

TEST_CASE("an error in a base names the base's file")
{
    const auto folder =
        std::filesystem::temp_directory_path() / ("gnomon_base_" + std::to_string(std::random_device{}()));
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "ground.yaml") << "frames: 10\nfps: 0\n" << kCamera;
    std::ofstream(folder / "loop.yaml") << "base: loop.yaml\n";
    const auto derived = parseScene("base: ground.yaml\nframes: 20\n", folder / "top.yaml");
    CHECK(derived.error() == (folder / "ground.yaml").string() + ":2:6: fps must be >= 1 and <= 1000, got 0");
    const auto fixed = parseScene("fps: 30\nbase: ground.yaml\n", folder / "top.yaml");
    REQUIRE_MESSAGE(fixed, fixed.error());
    CHECK(fixed->frames == 10);
    CHECK(fixed->framesPerSecond == 30.0);
    const auto loop = loadScene((folder / "loop.yaml").string());
    CHECK(loop.error().ends_with("loop.yaml:1:7: the scene is based on itself"));
    std::ofstream(folder / "there.yaml") << "base: back.yaml\n";
    std::ofstream(folder / "back.yaml") << "base: there.yaml\n";
    CHECK(loadScene((folder / "back.yaml").string()).error().ends_with("too many bases, one on the other"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("every key arrives where the documentation says")
{
    const std::string text = R"(name: full
size: [320, 200]
frames: 7
fps: 25
center: [1, 2, 3]
light_count: 1
depth: {convention: standard, near: 0.5, far: 90}
meshes:
  m: {sphere:}
  n: {cylinder: {radius: 0.5, top_radius: 0.25, height: 2, segments: 8}}
instances:
  - {name: i, mesh: n, at: [1, 2, 3], scale: 2, rotate: [{axis: [1, 0, 0], degrees: 90}, {axis: [0, 1, 0], degrees: 90}],
     mask: 0xff, alpha_tested: true, host_drawn: true, albedo: [0.1, 0.2, 0.3]}
  - {mesh: m, repeat: {count: [2, 1, 1], spacing: [4, 0, 0]}, spin: {degrees_per_frame: 2}}
lights:
  - {name: s, kind: spot, at: [0, 5, 0], direction: [0, -2, 0], cone: {inner: 20, outer: 40}, range: 12, radius: 0.1,
     colour: [1, 2, 3], intensity: 4, importance: 0.5, mask: 3, appear: 1, disappear: 2, static: true}
  - {kind: directional, direction: [0, -1, 0], radius_degrees: 90e-1}
camera:
  - {eye: [0, 1, 5], target: [0, 0, 0], fov: 60}
  - {time: 2, eye: [0, 1, 6], target: [0, 0, 0], cut: true}
)";
    const auto scene = parseScene(text, "full.yaml");
    REQUIRE_MESSAGE(scene, scene.error());
    CHECK(scene->name == "full");
    CHECK(scene->width == 320);
    CHECK(scene->height == 200);
    CHECK(scene->center == glm::dvec3(1.0, 2.0, 3.0));
    CHECK(scene->depth.convention == DepthConvention::Standard);
    CHECK(scene->depth.farPlane == 90.0);
    REQUIRE(scene->instances.size() == 3);
    const Instance& i = scene->instances[0];
    CHECK(scene->meshes[i.mesh].name == "n");
    CHECK(i.pose.scale == glm::dvec3(2.0));
    CHECK((i.alphaTested && i.hostDrawn && !i.isStatic));
    CHECK(i.casterMask == 0xffu);
    CHECK(i.albedo.z == 0.3f);
    // y goes to z by the first turn, and on to x by the second.
    CHECK((i.pose.rotation * glm::dvec3(0.0, 1.0, 0.0)).x == Approx(1.0));
    CHECK(scene->instances[1].pose.position.x == -2.0);
    CHECK(scene->instances[2].pose.position.x == 2.0);
    CHECK(scene->instances[2].spin.radiansPerSecond == Approx(50.0 * 3.14159265358979 / 180.0));
    REQUIRE(scene->lights.size() == 1);
    REQUIRE(scene->spareLights.size() == 1);
    const Light& s = scene->lights[0];
    CHECK(s.direction == glm::dvec3(0.0, -1.0, 0.0));
    CHECK(s.outerAngle == Approx(0.698131701));
    CHECK(s.innerAngle == Approx(0.34906585));
    CHECK((s.range == 12.0f && s.radius == 0.1f && s.intensity == 4.0f && s.importance == 0.5f));
    CHECK((s.appear == 1.0 && s.disappear == 2.0 && s.isStatic && s.casterMask == 3));
    CHECK(scene->spareLights[0].radius == Approx(0.157079632));
    REQUIRE(scene->camera.size() == 2);
    CHECK(scene->camera[1].cut);
    CHECK(scene->camera[1].verticalFov == Approx(1.04719755)); // inherited from the key before
}

TEST_CASE("a rectangle light has half extents, an axis that copies turn, and the radius of a disc of its area")
{
    const std::string rest = "name: r\ncamera: [{eye: [0, 3, 5], target: [0, 0, 0]}]\nmeshes: {b: {box: }}\n"
                             "instances: [{mesh: b}]\nlights:\n";
    const std::string light =
        "  - {name: l, kind: spot, at: [1, 3, 0], direction: [0, -1, 0], cone: {outer: 40}, range: 9, ";
    const auto scene =
        parseScene(rest + light + "rectangle: {width: 2, height: 0.5, axis: [0, 0, 3]}, ring: {count: 2}}\n", "r.yaml");
    REQUIRE_MESSAGE(scene, scene.error());
    REQUIRE(scene->lights.size() == 2);
    CHECK(scene->lights[1].rectangleAxis.z == Approx(-1.0));
    CHECK(scene->lights[0].rectangle == glm::vec2(1.0f, 0.25f));
    CHECK(scene->lights[0].rectangleAxis == glm::dvec3(0.0, 0.0, 1.0));
    CHECK(scene->lights[0].radius == Approx(std::sqrt(1.0 / std::numbers::pi)));
    const auto refused = [&](const std::string& line, const char* words) {
        const auto wrong = parseScene(rest + light + line + "}\n", "r.yaml");
        REQUIRE_FALSE(wrong);
        CHECK_MESSAGE(wrong.error().find(words) != std::string::npos, wrong.error());
    };
    refused("rectangle: {width: 2}", "height");
    refused("rectangle: {width: 2, height: 0}", "height");
    refused("rectangle: {width: 2, height: 1, axis: [0, 2, 0]}", "must not lie along the light's direction");
    refused("rectangle: {width: 2, height: 1}, radius: 0.1", "a rectangle or a radius, not both");
    refused("rectangle: {width: 2, height: 1}, orbit: {degrees_per_second: 5}", "cannot have keys or an orbit");
}

TEST_CASE("a disc light has its radius, and is of a spot alone, without another source")
{
    const std::string rest = "name: r\ncamera: [{eye: [0, 3, 5], target: [0, 0, 0]}]\nmeshes: {b: {box: }}\n"
                             "instances: [{mesh: b}]\nlights:\n";
    const std::string at = "  - {name: l, at: [1, 3, 0], range: 9, kind: ";
    const std::string spot = at + "spot, direction: [0, -1, 0], cone: {outer: 40}, ";
    const auto scene = parseScene(rest + spot + "disc: 0.25}\n", "r.yaml");
    REQUIRE_MESSAGE(scene, scene.error());
    CHECK(scene->lights[0].disc);
    CHECK(scene->lights[0].radius == 0.25f);
    const auto refused = [&](const std::string& line, const char* words) {
        const auto wrong = parseScene(rest + line + "}\n", "r.yaml");
        REQUIRE_FALSE(wrong);
        CHECK_MESSAGE(wrong.error().find(words) != std::string::npos, wrong.error());
    };
    refused(spot + "disc: 0", "disc");
    refused(spot + "disc: 0.2, radius: 0.1", "a disc or a radius, not both");
    refused(spot + "disc: 0.2, rectangle: {width: 2, height: 1}", "a disc or a rectangle, not both");
    refused(at + "point, disc: 0.2", "disc");
}

TEST_CASE("a comma locale changes nothing")
{
    const auto plain = loadScene("colonnade");
    REQUIRE_MESSAGE(plain, plain.error());
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaNumbers));
    // The C library's locale as well, where this machine has one with a comma.
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"})
        if (std::setlocale(LC_ALL, name) != nullptr) break;
    const auto comma = loadScene("colonnade");
    std::setlocale(LC_ALL, "C");
    std::locale::global(before);
    REQUIRE_MESSAGE(comma, comma.error());
    CHECK(fingerprint(*comma) == fingerprint(*plain));
}

TEST_CASE("damaged copies of every shipped scene, up to a thousand, are loaded or refused, never worse")
{
    // Small edits that keep most of the text sensible reach deeper than noise does.
    constexpr std::string_view kPieces[] = {"[",   "]",     "{",    "}",   ":",    ",", "-",  "\n",   "  ",
                                            "&a ", "*a",    "!!x ", "nan", "1e99", "0", "\"", "'",    "#",
                                            "? ",  "---\n", "<<: ", "\t",  "|",    ">", "%",  "\xff", "\xc3"};
    SceneFileOptions options;
    options.buildMeshes = false;
    std::mt19937 random(12345);
    uint64_t loaded = 0, refused = 0;
    for (const ShippedScene& shipped : shippedScenes()) {
        const std::string original = readWhole(shipped.file);
        // As much text of every scene.
        const size_t copies = std::min<size_t>(1000, 2'000'000 / original.size());
        for (size_t copy = 0; copy < copies; ++copy) {
            std::string text = original;
            for (size_t edit = 0, edits = 1 + random() % 3; edit < edits && !text.empty(); ++edit) {
                const size_t at = random() % text.size(), length = random() % 12;
                switch (random() % 4) {
                case 0:
                    text.erase(at, length);
                    break;
                case 1:
                    text.insert(at, kPieces[random() % std::size(kPieces)]);
                    break;
                case 2:
                    text[at] = static_cast<char>(random());
                    break;
                default:
                    text.insert(at, text.substr(random() % text.size(), length * 8));
                    break;
                }
            }
            const auto scene = parseScene(text, shipped.file, options);
            ++(scene ? loaded : refused);
            if (!scene) CHECK(scene.error().find(".yaml:") != std::string::npos);
        }
    }
    CHECK(loaded > 100);
    CHECK(refused > 1000);
}

TEST_CASE("deep nesting is refused before it can overflow the stack")
{
    for (const char* opening : {"[", "{a: "}) {
        std::string text = "center: ";
        for (int i = 0; i < 100000; ++i)
            text += opening;
        CHECK_FALSE(parseScene(text, "deep.yaml"));
    }
    std::string text;
    for (int i = 0; i < 1000; ++i)
        text += std::string(size_t(i), ' ') + "a:\n";
    CHECK_FALSE(parseScene(text, "deep.yaml"));
}

TEST_CASE("a name that no scene has is answered with the list of those that exist")
{
    const auto missing = loadScene("no_such_scene");
    CHECK_FALSE(missing);
    CHECK(missing.error().find("torus_grid") != std::string::npos);
    CHECK_FALSE(loadScene("../no/such.yaml"));
    CHECK_FALSE(loadScene(""));
}
