#include "demo/io/obj.hpp"
#include "demo/scene/mesh_file.hpp"
#include "demo/scene/primitives.hpp"
#include "scene_analysis.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <fstream>
#include <initializer_list>

using namespace gnomon::demo;
namespace fs = std::filesystem;

namespace {

fs::path writeText(const char* name, const std::string& text)
{
    const fs::path file = fs::temp_directory_path() / name;
    std::ofstream(file, std::ios::binary) << text;
    return file;
}

} // namespace

TEST_CASE("a mesh written as OBJ comes back bit for bit")
{
    const Mesh torus = makeTorus({1.0f, 0.35f, 9, 7});
    ObjWriter writer;
    writer.add("torus", torus, Transform{});
    const fs::path file = fs::temp_directory_path() / "gnomon_torus.obj";
    REQUIRE(writer.save(file));
    const auto imported = importMesh(file);
    REQUIRE_MESSAGE(imported, imported.error());
    CHECK(imported->droppedTriangles == 0);
    REQUIRE(imported->mesh.indices.size() == torus.indices.size());
    for (size_t i = 0; i < torus.indices.size(); ++i)
        CHECK(imported->mesh.positions[imported->mesh.indices[i]] == torus.positions[torus.indices[i]]);
    fs::remove(file);
}

TEST_CASE("import welds equal positions, takes -0 for 0 and drops triangles without area")
{
    const fs::path file = writeText("gnomon_weld.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 0 0\nv 1 0 0\nv 0 -1 0\n"
                                                       "v 2 0 0\nv 9 9 9\n"
                                                       "f 1 2 3\nf 4 6 5\nf 1 2 7\nf 1 5 2\n");
    const auto imported = importMesh(file);
    REQUIRE_MESSAGE(imported, imported.error());
    CHECK(imported->mesh.triangleCount() == 2);
    CHECK(imported->mesh.positions.size() == 4);
    CHECK(imported->droppedTriangles == 2);
    CHECK(countEdges(imported->mesh).border == 4);
    fs::remove(file);
}

TEST_CASE("a fitted mesh stands on y = 0, centred, with the height asked for")
{
    const fs::path file =
        writeText("gnomon_fit.obj", "v 10 5 2\nv 14 5 2\nv 10 5 8\nv 10 9 2\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
    const auto imported = importMesh(file, {.fitHeight = 2.0f});
    REQUIRE_MESSAGE(imported, imported.error());
    glm::vec3 low(1e9f), high(-1e9f);
    for (const glm::vec3& p : imported->mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    CHECK(low.y == 0.0f);
    CHECK(high.y == 2.0f);
    CHECK(low.x == -high.x);
    CHECK(low.z == -high.z);
    CHECK(high.x == 1.0f);
    CHECK(signedVolume(imported->mesh) > 0.0);
    fs::remove(file);
}

TEST_CASE("an up axis turns the mesh without mirroring it")
{
    const fs::path file =
        writeText("gnomon_up.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const auto highest = [&file](UpAxis up) {
        const auto imported = importMesh(file, {.up = up});
        REQUIRE_MESSAGE(imported, imported.error());
        CHECK(signedVolume(imported->mesh) == doctest::Approx(0.5));
        float high = -1e9f;
        for (const glm::vec3& p : imported->mesh.positions)
            high = std::max(high, p.y);
        return high;
    };
    CHECK(highest(UpAxis::Y) == 1.0f);
    CHECK(highest(UpAxis::Z) == 3.0f);
    CHECK(highest(UpAxis::MinusZ) == 0.0f);
    fs::remove(file);
}

TEST_CASE("files that are no meshes are refused by name")
{
    for (const char* text : {"", "not a mesh at all", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"}) {
        const fs::path file = writeText("gnomon_bad.obj", text);
        const auto imported = importMesh(file);
        CHECK_FALSE(imported);
        CHECK(imported.error().starts_with(file.string() + ": "));
        fs::remove(file);
    }
    for (const char* face : {"3 0 1 700000000", "4 0 1 2 700000000", "2 0 700000000"}) {
        const fs::path file = writeText("gnomon_far.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\n"
                                                                      "property float x\nproperty float y\n"
                                                                      "property float z\nelement face 1\n"
                                                                      "property list uchar int vertex_indices\n"
                                                                      "end_header\n0 0 0\n1 0 0\n0 1 0\n") +
                                                              face + "\n");
        const auto imported = importMesh(file);
        CHECK_FALSE(imported);
        CHECK_MESSAGE(imported.error().find("face 0 names vertex 700000000 of 3") != std::string::npos,
                      imported.error());
        fs::remove(file);
    }
    const auto missing = findMeshFile("no/such.obj", "/some/folder");
    CHECK_FALSE(missing);
    CHECK(missing.error().find("/some/folder/no/such.obj") != std::string::npos);
}

namespace {

// Four float triples, then twelve 16-bit indices of which the last is 3, or 61.
constexpr const char* kTetrahedron = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"
                                     "AAACAAEAAAABAAMAAAADAAIAAQACAAMA";
constexpr const char* kBadTetrahedron = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"
                                        "AAACAAEAAAABAAMAAAADAAIAAQACAD0A";

/// A glTF file of one tetrahedron. \param buffer JSON
std::string gltf(const std::string& nodes, const std::string& buffer)
{
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
           R"(,"meshes":[{"name":"f\ud83c\udf32ur","primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},)"
           R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],)"
           R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],)"
           R"("buffers":[)" +
           buffer + "]}";
}

std::string inBase64(const char* bytes)
{
    return std::string(R"({"byteLength":72,"uri":"data:application/octet-stream;base64,)") + bytes + "\"}";
}

std::string word(uint32_t value)
{
    std::string bytes;
    for (int i = 0; i < 4; ++i)
        bytes += static_cast<char>(value >> (8 * i) & 0xffu);
    return bytes;
}

/// Chunk of a .3ds file: its kind, its length and all of it.
std::string chunk3ds(uint32_t kind, const std::string& content)
{
    return word(kind).substr(0, 2) + word(static_cast<uint32_t>(6 + content.size())) + content;
}

/// A tetrahedron. \param last index
std::string tetrahedron3ds(uint32_t last)
{
    const auto floats = [](std::initializer_list<float> values) {
        std::string bytes;
        for (const float value : values)
            bytes += word(std::bit_cast<uint32_t>(value));
        return bytes;
    };
    std::string faces = word(4).substr(0, 2);
    for (const uint32_t index :
         {0u, 2u, 1u, 0u, 0u, 1u, 3u, 0u, 0u, 3u, 2u, 0u, 1u, 2u, last, 0u}) // flags every fourth
        faces += word(index).substr(0, 2);
    const std::string mesh =
        chunk3ds(0x4110, word(4).substr(0, 2) + floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1})) + chunk3ds(0x4120, faces);
    return chunk3ds(0x4d4d, chunk3ds(0x3d3d, chunk3ds(0x4000, std::string("four", 5) + chunk3ds(0x4100, mesh))));
}

} // namespace

TEST_CASE("a node that mirrors leaves the outside of its mesh outside, one in a mirror that mirrors again too")
{
    for (const char* nodes :
         {R"([{"mesh":0}])", R"([{"mesh":0,"scale":[-1,1,1]}])", R"([{"mesh":0,"scale":[-2,-3,-1]}])",
          R"([{"scale":[1,-1,1],"children":[1]},{"mesh":0,"rotation":[0.6,0,0,0.8],"scale":[1,1,-2]}])",
          R"([{"scale":[1,-1,1],"children":[1]},{"mesh":0,"rotation":[0.6,0,0,0.8],"scale":[1,2,1]}])"}) {
        CAPTURE(nodes);
        const fs::path file = writeText("gnomon_mirror.gltf", gltf(nodes, inBase64(kTetrahedron)));
        const auto imported = importMesh(file);
        REQUIRE_MESSAGE(imported, imported.error());
        CHECK(imported->mesh.triangleCount() == 4);
        CHECK(signedVolume(imported->mesh) > 0.1);
        fs::remove(file);
    }
    const fs::path file =
        writeText("gnomon_twice.gltf",
                  gltf(R"([{"mesh":0,"children":[1]},{"mesh":0,"scale":[-1,1,1]}])", inBase64(kTetrahedron)));
    const auto twice = importMesh(file);
    REQUIRE_MESSAGE(twice, twice.error());
    CHECK(twice->mesh.triangleCount() == 8);
    CHECK(signedVolume(twice->mesh) == doctest::Approx(2.0 / 6.0));
    fs::remove(file);
}

TEST_CASE("an index past the end of a glTF file's vertices is an error that names it and its bound")
{
    constexpr const char* kSays =
        "mesh 0 'f__d83c__df32ur', primitive 0: index 11 (of triangle 3) names vertex 61 of 4";
    const auto check = [&](const fs::path& file) {
        const auto imported = importMesh(file);
        CHECK_FALSE(imported);
        CHECK_MESSAGE(imported.error().find(kSays) != std::string::npos, imported.error());
        CHECK(imported.error().starts_with(file.string() + ": "));
        fs::remove(file);
    };
    check(writeText("gnomon_far.gltf", gltf(R"([{"mesh":0}])", inBase64(kBadTetrahedron))));

    std::string binary(72, '\0');
    binary[70] = 61; // the last index; the others are 0
    const fs::path bytes = writeText("gnomon_far.bin", binary);
    check(writeText("gnomon_far.gltf", gltf(R"([{"mesh":0}])", R"({"byteLength":72,"uri":"gnomon_far.bin"})")));
    fs::remove(bytes);

    std::string json = gltf(R"([{"mesh":0}])", R"({"byteLength":72})");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto size = static_cast<uint32_t>(json.size());
    check(writeText("gnomon_far.glb", "glTF" + word(2) + word(28 + size + 72) + word(size) + "JSON" + json + word(72) +
                                          std::string("BIN\0", 4) + binary));
}

TEST_CASE("glTF nodes that are no trees, or too deep ones, are errors")
{
    const auto says = [](const std::string& nodes, const char* words) {
        const fs::path file = writeText("gnomon_nodes.gltf", gltf(nodes, inBase64(kTetrahedron)));
        const auto imported = importMesh(file);
        CHECK_FALSE(imported);
        CHECK_MESSAGE(imported.error().find(words) != std::string::npos, imported.error());
        fs::remove(file);
    };
    std::string chain = "[", diamonds = "[";
    for (int i = 1; i <= 30'000; ++i)
        chain += R"({"children":[)" + std::to_string(i) + "]},";
    for (int i = 1; i <= 60; i += 2) // 2^30 ways to the mesh
        for (int twin = 0; twin < 2; ++twin)
            diamonds += R"({"children":[)" + std::to_string(i + 1) + "," + std::to_string(i + 2) + "]},";
    says(chain + R"({"mesh":0}])", "node 1000 is a child's child");
    says(diamonds + R"({"mesh":0},{"mesh":0},{"mesh":0}])", "node 2 is a child of nodes 0 and 1");
    says(R"([{"mesh":0,"children":[0]}])", "node 0 is a child's child");
}

TEST_CASE("a .3ds face that names no vertex is an error, not another face")
{
    const fs::path good = writeText("gnomon_good.3ds", tetrahedron3ds(3));
    const auto imported = importMesh(good);
    REQUIRE_MESSAGE(imported, imported.error());
    CHECK(imported->mesh.triangleCount() == 4);
    fs::remove(good);
    const fs::path file = writeText("gnomon_far.3ds", tetrahedron3ds(61));
    const auto far = importMesh(file);
    CHECK_FALSE(far);
    CHECK_MESSAGE(far.error().find("ertex index") != std::string::npos, far.error());
    fs::remove(file);
}
