#include "demo/io/obj.hpp"
#include "demo/scene/mesh_file.hpp"
#include "demo/scene/primitives.hpp"
#include "scene_analysis.hpp"

#include <doctest/doctest.h>

#include <fstream>

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
