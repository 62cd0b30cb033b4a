// demo/embed: its picture is what rays in double precision say, by both entry points, and a window that is resized runs
// to its end. The layer is silent but for what it says of all hosts of gnomon, and of Dear ImGui.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <lodepng.h>

#include "demo/embed/scene.hpp"

namespace {

using embed::Scene;
using glm::dvec3;

constexpr int kWidth = 320, kHeight = 180, kFrames = 4;

std::string folder()
{
    const auto path = std::filesystem::temp_directory_path() / "gnomon_embed_test";
    std::filesystem::create_directories(path);
    return path.string() + "/";
}

std::string base64(const std::string& bytes)
{
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) { // whole threes: floats and indices are multiples of them here
        const auto byte = [&](size_t k) { return uint32_t(static_cast<unsigned char>(bytes[i + k])); };
        const uint32_t three = byte(0) << 16 | byte(1) << 8 | byte(2);
        for (const int shift : {18, 12, 6, 0})
            text += kDigits[three >> shift & 63];
    }
    return text;
}

/// A table: a slab on a foot, so that light gets below it. A glTF file of one mesh, which stands twice as large under a
/// node that is scaled.
std::string writeTable()
{
    std::string positions, indices;
    uint16_t first = 0;
    const auto put = [](std::string& to, auto value) {
        to.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const auto& [low, high] :
         {std::pair(dvec3(-1, 0.8, -1), dvec3(1, 1, 1)), std::pair(dvec3(-0.2, 0, -0.2), dvec3(0.2, 0.8, 0.2))}) {
        for (int corner = 0; corner < 8; ++corner)
            for (const double value :
                 {(corner & 1 ? high : low).x, (corner & 2 ? high : low).y, (corner & 4 ? high : low).z})
                put(positions, float(0.5 * value));
        for (const int index : {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5})
            put(indices, uint16_t(first + index));
        first = uint16_t(first + 8);
    }
    const std::string file = folder() + "table.gltf";
    std::ofstream(file) << R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "scale": [2, 2, 2]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"accessors": [
{"bufferView": 0, "componentType": 5126, "count": 16, "type": "VEC3", "min": [-0.5, 0, -0.5], "max": [0.5, 0.5, 0.5]},
{"bufferView": 1, "componentType": 5123, "count": 72, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 192}, {"buffer": 0, "byteOffset": 192, "byteLength": 144}],
"buffers": [{"byteLength": 336, "uri": "data:application/octet-stream;base64,)"
                        << base64(positions + indices) << "\"}]}";
    return file;
}

/// Runs the program; what it printed goes to `said`.
int run(const std::string& arguments, std::string& said, bool window = false)
{
    const std::string log = folder() + "said.txt";
    const std::string server = window ? "xvfb-run -a -s '-screen 0 1280x1024x24' " : "";
    const int result = std::system((server + "'" GNOMON_EMBED "' " + arguments + " >'" + log + "' 2>&1").c_str());
    std::ostringstream text;
    text << std::ifstream(log).rdbuf();
    said = text.str();
    return result;
}

/// Ids of the layer's messages that are the demo's or gnomon's to avoid.
std::string complaints(const std::string& said, bool panel)
{
    std::string others =
        "pipeline-stage-flags"           // images cross between host and gnomon, and timestamps follow, all commands
        "|ImageBarrierAccessLayout"      // this layer's table lacks SHADER_SAMPLED_READ, a part of SHADER_READ
        "|TransitionUndefinedToReadOnly" // layers of a map that nobody looks at are in the view that is bound
        "|SpirvDeprecated_WorkgroupSize" // the other way needs maintenance4, which hosts need not enable
        "|OutputNotConsumed";            // of one vertex shader that serves several fragment shaders
    if (panel)
        others += "|vkAllocateMemory-small-allocation|vkBindMemory-small-dedicated-allocation"; // ImGui's buffers
    // Newer layers give best practices other names, which are not looked for.
    const std::regex id("\\b(UNASSIGNED|VUID|SYNC)-[A-Za-z0-9_-]+"), known("^UNASSIGNED-.*(" + others + ")$");
    std::set<std::string> ids;
    for (std::sregex_iterator at(said.begin(), said.end(), id), end; at != end; ++at)
        if (!std::regex_search(at->str(), known)) ids.insert(at->str());
    std::string result;
    for (const std::string& one : ids)
        result += one + " ";
    return result;
}

struct Hit {
    double t = HUGE_VAL; ///< In lengths of the ray.
    const embed::Object* object = nullptr;
    dvec3 normal{};
};

/// The nearest of all triangles of some objects, by brute force (Moeller and Trumbore 1997).
Hit trace(const Scene& scene, const std::vector<embed::Object>& objects, const dvec3& from, const dvec3& ray)
{
    Hit hit;
    for (const embed::Object& object : objects)
        for (uint32_t i = 0; i < object.count; i += 3) {
            const glm::vec3* corner = &scene.corners[object.first + i];
            const dvec3 p(corner[0]), u = dvec3(corner[1]) - p, v = dvec3(corner[2]) - p;
            const dvec3 across = glm::cross(ray, v), s = from - p;
            const double determinant = glm::dot(u, across);
            if (determinant == 0.0) continue;
            const double a = glm::dot(s, across) / determinant, b = glm::dot(ray, glm::cross(s, u)) / determinant;
            const double t = glm::dot(v, glm::cross(s, u)) / determinant;
            if (a < 0.0 || b < 0.0 || a + b > 1.0 || t <= 0.0 || t >= hit.t) continue;
            hit = {t, &object, glm::normalize(glm::cross(u, v))};
        }
    if (glm::dot(hit.normal, ray) > 0.0) hit.normal = -hit.normal;
    return hit;
}

/// What a pixel shows, and by what: surfaces and visibilities. Where neighbours have another key an edge is near.
struct Pixel {
    dvec3 colour;
    std::string key;
    int dark = 0, lit = 0; ///< Lights that shine this way, by whether something is in between.
};

dvec3 sumOfLights(const Scene& scene, const dvec3& at, const dvec3& normal, bool bothSides, Pixel& pixel)
{
    dvec3 sum(0.08);
    for (const embed::Light& light : embed::lightsAt((kFrames - 1) / 60.0)) {
        const dvec3 direction(light.direction), position(light.position);
        const bool sun = light.position.w == 0.0f;
        const dvec3 toLight = sun ? -direction : position - at;
        const double away = glm::length(toLight), range = double(light.colour.w);
        const double fade = range > 0.0 ? 1.0 - std::min(away / range, 1.0) : 1.0;
        const double cosine = glm::dot(normal, toLight) / away,
                     facing = bothSides ? std::abs(cosine) : std::max(cosine, 0.0);
        const bool outside = glm::dot(direction, -toLight) < double(light.direction.w) * away;
        const bool reached = !outside && facing > 0.0 && fade > 0.0;
        const double far = sun ? HUGE_VAL : 1.0; // of a lamp the ray's end
        const bool blocked =
            reached && trace(scene, scene.opaque, at + 1e-6 * normal * (cosine < 0.0 ? -1.0 : 1.0), toLight).t < far;
        pixel.key += blocked ? 'd' : reached ? 'l' : '-';
        pixel.dark += blocked && facing > 0.1;
        pixel.lit += reached && !blocked;
        if (reached && !blocked) sum += dvec3(light.colour) * facing * fade * fade;
    }
    return sum;
}

std::vector<Pixel> expected(const Scene& scene)
{
    const embed::Camera camera;
    const dvec3 eye(camera.eye());
    const glm::dmat3 worldFromView = glm::transpose(glm::dmat3(glm::mat3(camera.viewFromWorld())));
    const glm::mat4 clipFromView = embed::Camera::clipFromView(float(kWidth) / float(kHeight));
    std::vector<Pixel> pixels(size_t(kWidth) * kHeight);
    for (int i = 0; i < kWidth * kHeight; ++i) {
        Pixel& pixel = pixels[size_t(i)];
        const double clipX = 2.0 * (i % kWidth + 0.5) / kWidth - 1.0, clipY = 2.0 * (i / kWidth + 0.5) / kHeight - 1.0;
        const dvec3 ray =
            worldFromView * dvec3(clipX / double(clipFromView[0][0]), clipY / double(clipFromView[1][1]), -1.0);
        const Hit behind = trace(scene, scene.opaque, eye, ray), front = trace(scene, scene.glass, eye, ray);
        pixel.colour = dvec3(0.1, 0.12, 0.16);
        if (behind.object) {
            pixel.key += behind.object->name + std::to_string(int(100.0 * behind.normal.x + 10.0 * behind.normal.y));
            pixel.colour =
                dvec3(behind.object->colour) * sumOfLights(scene, eye + behind.t * ray, behind.normal, false, pixel);
        }
        if (!front.object || front.t > behind.t) continue;
        pixel.key += front.object->name;
        pixel.dark = pixel.lit = 0;
        const dvec3 sum = sumOfLights(scene, eye + front.t * ray, front.normal, true, pixel);
        const double alpha = double(front.object->colour.a);
        pixel.colour = glm::mix(glm::min(pixel.colour, 1.0), dvec3(front.object->colour) * sum, alpha);
    }
    return pixels;
}

/// All eight neighbours show the same by the same lights.
bool isClear(const std::vector<Pixel>& pixels, int x, int y)
{
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            if (pixels[size_t((y + dy) * kWidth + x + dx)].key != pixels[size_t(y * kWidth + x)].key) return false;
    return true;
}

} // namespace

TEST_CASE("a glTF file's triangles stand where its nodes place them")
{
    const Scene scene = embed::loadScene(writeTable());
    const embed::Object& model = scene.opaque[1];
    CHECK(std::string(model.name) == "model");
    CHECK(model.count == 72);
    dvec3 low(HUGE_VAL), high(-HUGE_VAL);
    double volume = 0.0; // by the divergence theorem
    for (uint32_t i = 0; i < model.count; i += 3) {
        dvec3 p[3];
        for (uint32_t k = 0; k < 3; ++k) {
            p[k] = scene.corners[model.first + i + k];
            low = glm::min(low, p[k]);
            high = glm::max(high, p[k]);
        }
        volume += glm::dot(p[0], glm::cross(p[1], p[2])) / 6.0;
    }
    // Of the table, 1 m high and drawn 2 m high: a slab of 2 x 0.2 x 2 on a foot of 0.4 x 0.8 x 0.4.
    CHECK(std::abs(volume - 8.0 * (0.8 + 0.128)) < 1e-4);
    CHECK(glm::length(low - dvec3(-2, 0, -2)) < 1e-6);
    CHECK(glm::length(high - dvec3(2, 2, 2)) < 1e-6);
}

TEST_CASE("the picture is lit and dark where rays say so, glass included, by both entry points")
{
    const std::string model = writeTable(), picture = folder() + "picture.png";
    const std::vector<Pixel> truth = expected(embed::loadScene(model));
    for (const char* entry : {"", " --submitted"}) {
        CAPTURE(std::string(entry));
        std::string said;
        std::ostringstream command;
        command << "'" << model << "' --headless " << kFrames << " --width " << kWidth << " --height " << kHeight
                << " --out '" << picture << "'" << entry;
        REQUIRE_MESSAGE(run(command.str(), said) == 0, said);
        CHECK_MESSAGE(complaints(said, false) == "", said.substr(0, 4000));
        std::vector<unsigned char> shown;
        unsigned width = 0, height = 0;
        REQUIRE(lodepng::decode(shown, width, height, picture) == 0);
        REQUIRE(width == unsigned(kWidth));
        REQUIRE(height == unsigned(kHeight));

        std::map<std::string, int> clear, wrong; // by the surface in front
        int dark = 0, lit = 0, opaque = 0;
        for (size_t i = 3; i < shown.size(); i += 4)
            opaque += shown[i] == 255;
        CHECK(opaque == kWidth * kHeight);
        for (int y = 1; y + 1 < kHeight; ++y)
            for (int x = 1; x + 1 < kWidth; ++x) {
                if (!isClear(truth, x, y)) continue;
                const Pixel& pixel = truth[size_t(y * kWidth + x)];
                const std::string surface = pixel.key.find("glass") != std::string::npos ? "glass"
                                            : pixel.key.starts_with("floor")             ? "floor"
                                            : pixel.key.starts_with("model")             ? "model"
                                                                                         : "sky";
                double difference = 0.0;
                for (int c = 0; c < 3; ++c)
                    difference = std::max(difference, std::abs(255.0 * std::clamp(pixel.colour[c], 0.0, 1.0) -
                                                               double(shown[size_t(4 * (y * kWidth + x) + c)])));
                ++clear[surface];
                wrong[surface] += difference > 4.0; // albedo, picture and blending are rounded to 8 bits each
                dark += pixel.dark > 0;
                lit += pixel.lit > 0;
            }
        for (const auto& [name, count] : clear) {
            const std::string surface = name;
            std::printf("%s%s: %d of %d clear pixels differ\n", surface.c_str(), entry, wrong[surface], count);
            CHECK_MESSAGE(wrong[surface] * 100 <= count, surface); // maps are off by a texel at some edges
        }
        CHECK(clear.size() == 4);
        CHECK(dark > 2000);
        CHECK(lit > 10000);
    }
}

TEST_CASE("a window that is resized and changes its entry point runs to its end, with the panel")
{
    if (std::system("command -v xvfb-run >/dev/null 2>&1 && command -v xauth >/dev/null 2>&1") != 0) {
        MESSAGE("skipped: no virtual X server");
        return;
    }
    std::string said;
    const int result = run("'" + writeTable() + "' --frames 45 --width 320 --height 200 --exercise", said, true);
    CHECK_MESSAGE(result == 0, said.substr(0, 4000));
    CHECK(complaints(said, true) == "");
}

// Silence means something only where the layer is there and listens for all that complaints() looks for.
TEST_CASE("the layer is loaded, and looks for misuse, for hazards and at best practices")
{
    const char* const given = std::getenv("VK_LAYER_SETTINGS_PATH"); // as the test is run with
    if (!given) {
        MESSAGE("skipped: run without the layer");
        return;
    }
    const std::string settings = given;
    std::ostringstream text;
    text << std::ifstream(settings).rdbuf();
    const std::string talkative = std::regex_replace(text.str(), std::regex("report_flags = "), "report_flags = info,");
    REQUIRE(talkative != text.str());
    std::filesystem::create_directories(folder() + "talkative");
    std::ofstream(folder() + "talkative/vk_layer_settings.txt") << talkative;
    REQUIRE(setenv("VK_LAYER_SETTINGS_PATH", (folder() + "talkative/vk_layer_settings.txt").c_str(), 1) == 0);
    std::string said;
    const int result =
        run("'" + writeTable() + "' --headless 1 --width 16 --height 16 --out '" + folder() + "first.png'", said);
    REQUIRE(setenv("VK_LAYER_SETTINGS_PATH", settings.c_str(), 1) == 0);
    REQUIRE_MESSAGE(result == 0, said);
    INFO(said.substr(0, 2000));
    for (const char* word : {"Validation Layer Active", "BEST_PRACTICES", "SYNCHRONIZATION_VALIDATION"})
        CHECK_MESSAGE(said.find(word) != std::string::npos, std::string(word));
    // And complaints() reads what it prints.
    CHECK(complaints("Validation Error: [ VUID-vkCmdDraw-None-02699 ] Object 0", false) ==
          "VUID-vkCmdDraw-None-02699 ");
    CHECK(complaints("[ SYNC-HAZARD-WRITE-AFTER-WRITE ]", false) == "SYNC-HAZARD-WRITE-AFTER-WRITE ");
}

TEST_CASE("bad input is named")
{
    std::string said;
    CHECK(run("'" + folder() + "none.obj' --headless 1", said) != 0);
    CHECK_MESSAGE(said.find("none.obj: no triangles") != std::string::npos, said);
    CHECK(run("--headless 1 --width 0", said) != 0);
    CHECK_MESSAGE(said.find("--width") != std::string::npos, said);
    CHECK(run("'" + writeTable() + "' --headless 1 --width 32 --height 32 --out /none/such.png", said) != 0);
    CHECK_MESSAGE(said.find("/none/such.png") != std::string::npos, said);
}

int main(int argc, char** argv)
{
    std::string said;
    if (run("'" + writeTable() + "' --headless 1 --width 16 --height 16 --out '" + folder() + "first.png'", said) !=
            0 &&
        (said.find("no device") != std::string::npos || said.find("vk::") != std::string::npos)) {
        std::puts(("skipped: " + said).c_str());
        return 77;
    }
    const int result = doctest::Context(argc, argv).run();
    std::filesystem::remove_all(folder());
    return result;
}
