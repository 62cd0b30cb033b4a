// An outsider's look at what `gnomon run --dump` leaves: depth, normals and offsets give receivers, casters.obj the
// triangles, and a brute force in double precision says what is in shadow. Nothing of gnomon is used, the file formats
// least of all.
//
//     judge_dump PERCENT FOLDER...
//
// prints what is wrong among the pixels that face a light, lie in its range and cone and are not grazing, and returns 1
// if that is more than PERCENT for any light of any dump, or 2 if a dump cannot be read.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <lodepng.h>
#include <yaml-cpp/yaml.h>

namespace {

using glm::dvec3;

constexpr double kGrazing = 0.03; // of n.l, as gnomon counts it

struct Floats {
    int width = 0, height = 0, channels = 0;
    std::vector<float> values;
    const float* at(int x, int y) const { return &values[size_t(y * width + x) * size_t(channels)]; } // row 0 on top
};

struct Triangle {
    dvec3 a, ab, ac;
    uint32_t mask = 0;
};

std::string bytesOf(const std::string& file)
{
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error(file + ": cannot be read");
    return {std::istreambuf_iterator<char>(in), {}};
}

/// http://www.pauldebevec.com/Research/HDR/PFM: rows from the bottom to the top.
Floats readFloats(const std::string& file)
{
    const std::string bytes = bytesOf(file);
    std::istringstream in(bytes);
    std::string kind;
    double scale = 0.0;
    Floats out;
    in >> kind >> out.width >> out.height >> scale;
    in.get();
    out.channels = kind == "PF" ? 3 : 1;
    const size_t row = size_t(out.width) * size_t(out.channels);
    const size_t first = size_t(in.tellg());
    if (scale >= 0.0 || bytes.size() != first + row * size_t(out.height) * sizeof(float))
        throw std::runtime_error(file + ": not a little-endian PFM file");
    out.values.resize(row * size_t(out.height));
    for (int y = 0; y < out.height; ++y)
        std::memcpy(&out.values[size_t(out.height - 1 - y) * row], &bytes[first + size_t(y) * row * sizeof(float)],
                    row * sizeof(float));
    return out;
}

dvec3 vectorOf(const YAML::Node& node)
{
    return {node[0].as<double>(), node[1].as<double>(), node[2].as<double>()};
}

/// Relative to the eye. \param casters of frame.json, in the order of the file's groups
std::vector<Triangle> readTriangles(const std::string& file, const YAML::Node& casters, const dvec3& eye)
{
    std::istringstream in(bytesOf(file));
    std::vector<dvec3> corners;
    std::vector<Triangle> triangles;
    size_t groups = 0;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "o") ++groups;
        if (kind == "v") {
            dvec3 p;
            words >> p.x >> p.y >> p.z;
            corners.push_back(p - eye);
        }
        if (kind == "f") {
            size_t a = 0, b = 0, c = 0;
            words >> a >> b >> c;
            const dvec3 from = corners.at(a - 1);
            triangles.push_back({from, corners.at(b - 1) - from, corners.at(c - 1) - from,
                                 casters[groups - 1]["caster_mask"].as<uint32_t>()});
        }
    }
    if (groups != casters.size()) throw std::runtime_error(file + ": as many groups as casters were expected");
    return triangles;
}

/// T. Moeller and B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997; from either side.
bool meets(const Triangle& t, const dvec3& from, const dvec3& way, double end)
{
    const dvec3 p = glm::cross(way, t.ac);
    const double det = glm::dot(t.ab, p);
    if (det == 0.0) return false;
    const dvec3 s = from - t.a;
    const double u = glm::dot(s, p) / det;
    if (u < 0.0 || u > 1.0) return false;
    const dvec3 q = glm::cross(s, t.ab);
    const double v = glm::dot(way, q) / det;
    if (v < 0.0 || u + v > 1.0) return false;
    const double at = glm::dot(t.ac, q) / det;
    return at > 0.0 && at < end;
}

struct Dump {
    explicit Dump(const std::string& folder)
        : path(folder + "/"), frame(YAML::LoadFile(path + "frame.json")), depth(readFloats(path + "depth.pfm")),
          normals(readFloats(path + "normals.pfm")), eye(vectorOf(frame["eye"])),
          triangles(readTriangles(path + "casters.obj", frame["casters"], eye))
    {
        glm::dmat4 clipFromEye;
        for (int i = 0; i < 16; ++i)
            clipFromEye[i / 4][i % 4] = frame["clip_from_eye"][i].as<double>();
        eyeFromClip = glm::inverse(clipFromEye);
    }

    dvec3 receiver(int x, int y) const
    {
        const glm::dvec4 p = eyeFromClip * glm::dvec4(2.0 * (x + 0.5) / depth.width - 1.0,
                                                      2.0 * (y + 0.5) / depth.height - 1.0, *depth.at(x, y), 1.0);
        return dvec3(p) / p.w;
    }

    std::string path;
    YAML::Node frame;
    Floats depth, normals;
    dvec3 eye;
    std::vector<Triangle> triangles;
    glm::dmat4 eyeFromClip{1.0};
};

struct Count {
    long counted = 0, dark = 0, wrong = 0;
};

Count judge(const Dump& dump, const YAML::Node& light)
{
    const Floats offset = readFloats(dump.path + light["offset"].as<std::string>());
    std::vector<unsigned char> seen;
    unsigned width = 0, height = 0;
    const std::string picture = dump.path + light["visibility"].as<std::string>();
    if (lodepng::decode(seen, width, height, picture, LCT_GREY, 8) != 0)
        throw std::runtime_error(picture + ": cannot be read");
    const bool directional = light["kind"].as<std::string>() == "directional";
    const double range = light["range"].as<double>(), cone = light["cone_radians"].as<double>();
    const dvec3 heading = vectorOf(light["direction"]), place = vectorOf(light["position"]) - dump.eye;
    const auto mask = light["caster_mask"].as<uint32_t>();
    const double sky = dump.frame["sky_depth"].as<double>();
    Count count;
    for (int y = 0; y < dump.depth.height; ++y)
        for (int x = 0; x < dump.depth.width; ++x) {
            if (double(*dump.depth.at(x, y)) == sky) continue;
            const float* n = dump.normals.at(x, y);
            const dvec3 normal(n[0], n[1], n[2]), at = dump.receiver(x, y);
            const dvec3 way = directional ? -heading : place - at;
            const double distance = glm::length(way), cosine = glm::dot(normal, way) / distance;
            if (cosine < kGrazing || (!directional && range > 0.0 && distance > range)) continue;
            if (cone > 0.0 && glm::dot(-way, heading) < distance * std::cos(cone)) continue;
            const double lift = double(*offset.at(x, y));
            const dvec3 from = at + lift * normal, rest = directional ? way : place - from;
            const double end = directional ? std::numeric_limits<double>::infinity() : 1.0 - lift / glm::length(rest);
            bool dark = false;
            for (const Triangle& triangle : dump.triangles)
                if ((triangle.mask & mask) != 0 && (dark = meets(triangle, from, rest, end))) break;
            ++count.counted;
            count.dark += dark;
            count.wrong += (seen[size_t(y) * width + size_t(x)] < 128) != dark;
        }
    return count;
}

} // namespace

int main(int argc, char** argv)
try {
    const double most = argc > 1 ? std::stod(argv[1]) : 0.0;
    bool fine = true;
    for (int i = 2; i < argc; ++i) {
        const Dump dump(argv[i]);
        for (const YAML::Node& light : dump.frame["lights"]) {
            const Count count = judge(dump, light);
            const double percent = count.counted > 0 ? 100.0 * double(count.wrong) / double(count.counted) : 0.0;
            std::printf("%s %s: wrong %.4f %% of %ld, of which %ld dark\n", light["method"].as<std::string>().c_str(),
                        light["name"].as<std::string>().c_str(), percent, count.counted, count.dark);
            fine = fine && percent <= most;
        }
    }
    return fine ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
}
