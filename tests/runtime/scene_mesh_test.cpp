// Meshes: what is refused, what is built, and how long the old stays.
#include <doctest/doctest.h>

#include <cstring>
#include <deque>
#include <limits>

#include "runtime/scene_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

const MeshView& onlyMesh(const SceneRegistry::Snapshot& snapshot)
{
    REQUIRE(snapshot.casters.size() == 1);
    REQUIRE(snapshot.casters[0].mesh);
    return *snapshot.casters[0].mesh;
}

GnMesh make(SceneFixture& scene, const Shape& shape, const char* name = "shape")
{
    Result<GnMesh> mesh = scene.registry->createMesh(shape.info(name));
    REQUIRE(mesh);
    return *mesh;
}

GnInstance place(SceneFixture& scene, GnMesh mesh, const GnTransform& transform = {}, GnInstanceFlags flags = 0)
{
    Result<GnInstance> instance = scene.registry->createInstance(instanceOf(mesh, transform, flags, "thing"));
    REQUIRE(instance);
    return *instance;
}

bool rewrite(SceneFixture& scene, GnMesh mesh, const Shape& shape)
{
    return bool(scene.registry->updateMeshPositions(mesh, shape.positions.data(),
                                                    static_cast<std::uint32_t>(shape.positions.size() / 3), 0));
}

} // namespace

TEST_CASE("a mesh that cannot be is refused with its own code and the value at fault")
{
    SceneFixture scene;
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const auto refused = [&scene](GnMeshCreateInfo info, GnResult code, const char* words) {
        info.pName = "rock";
        const Result<GnMesh> mesh = scene.registry->createMesh(info);
        REQUIRE_FALSE(mesh);
        CHECK(mesh.error().result == code);
        CAPTURE(mesh.error().text);
        CHECK(mesh.error().text.find("'rock'") != std::string::npos);
        CHECK(mesh.error().text.find(words) != std::string::npos);
    };
    Shape shape = cube();
    GnMeshCreateInfo info = shape.info("");
    const auto with = [&info](auto member, auto value) {
        GnMeshCreateInfo changed = info;
        changed.*member = value;
        return changed;
    };
    refused(with(&GnMeshCreateInfo::pPositions, nullptr), GN_ERROR_NULL_ARGUMENT, "pPositions");
    refused(with(&GnMeshCreateInfo::positionCount, 0u), GN_ERROR_EMPTY, "no vertices");
    refused(with(&GnMeshCreateInfo::indexCount, 0u), GN_ERROR_EMPTY, "no triangles");
    refused(with(&GnMeshCreateInfo::indexCount, 35u), GN_ERROR_OUT_OF_RANGE, "35");
    refused(with(&GnMeshCreateInfo::positionStride, 8u), GN_ERROR_OUT_OF_RANGE, "8");
    refused(with(&GnMeshCreateInfo::positionStride, 14u), GN_ERROR_OUT_OF_RANGE, "14");
    refused(with(&GnMeshCreateInfo::positionCount, 7u), GN_ERROR_OUT_OF_RANGE, "index 7 at position 10");
    refused(with(&GnMeshCreateInfo::pIndices, nullptr), GN_ERROR_OUT_OF_RANGE, "index 8 at position 8");
    refused(with(&GnMeshCreateInfo::positionCount, 1u << 28), GN_ERROR_TOO_MANY, "3221225472 bytes");
    std::uint32_t& largestIndex = scene.stub.table.properties.limits.maxDrawIndexedIndexValue;
    const std::uint32_t before = std::exchange(largestIndex, 6u);
    refused(info, GN_ERROR_TOO_MANY, "8 vertices; the largest index that the device draws is 6");
    largestIndex = before;
    const auto withValue = [&](float value) {
        shape.positions[3 * 5 + 1] = value;
        return shape.info("");
    };
    refused(withValue(nan), GN_ERROR_NOT_A_NUMBER, "vertex 5: y");
    refused(withValue(-infinity), GN_ERROR_INFINITE, "vertex 5: y");
    refused(withValue(2e18f), GN_ERROR_OUT_OF_RANGE, "vertex 5: y");
    refused(cube().scaled(0.0f).info(""), GN_ERROR_EMPTY, "triangle with an area");
    CHECK(scene.memory->used() == 0);
}

TEST_CASE("positions are read with their stride and indices default to 0, 1, 2")
{
    SceneFixture scene;
    const std::vector<float> strided = {0, 0, 0, 9, 1, 0, 0, 9, 0, 2, 0, 9};
    GnMeshCreateInfo info{};
    info.pPositions = strided.data();
    info.positionCount = 3;
    info.positionStride = 16;
    Result<GnMesh> mesh = scene.registry->createMesh(info);
    REQUIRE(mesh);
    place(scene, *mesh);
    const MeshView& view = onlyMesh(scene.begin());
    CHECK(view.positions[2] == glm::vec3(0, 2, 0));
    CHECK(std::vector(view.indices.begin(), view.indices.end()) == std::vector<std::uint32_t>{0, 1, 2});
    CHECK(view.bounds.upper == glm::vec3(1, 2, 0));
}

TEST_CASE("triangles without area are left out, counted once, and do not stretch the bounds")
{
    SceneFixture scene;
    Shape shape = cube();
    shape.positions.insert(shape.positions.end(), {7, 7, 7});
    shape.indices.insert(shape.indices.end(), {8, 8, 8, 0, 8, 7, 0, 0, 1}); // a point, a line, an edge
    const GnMesh mesh = make(scene, shape, "rock");
    const auto said = scene.said();
    REQUIRE(said.size() == 1);
    CHECK(said[0].id == "MeshZeroAreaTriangles");
    CHECK(said[0].text == "mesh 'rock' has 3 triangles without area; they are left out");
    place(scene, mesh);
    CHECK(onlyMesh(scene.begin()).triangleCount() == 12);
    CHECK(onlyMesh(scene.begin()).bounds.upper == glm::vec3(1.0f));
    CHECK(rewrite(scene, mesh, shape.scaled(2.0f)));
    CHECK(scene.said().empty());
}

TEST_CASE("a mesh knows the host's number of every triangle, also where some before it are left out")
{
    SceneFixture scene;
    Shape shape = triangle();
    shape.positions.insert(shape.positions.end(), {2, 0, 0, 3, 3, 3});
    shape.indices = {0, 0, 1, 0, 1, 2, 0, 1, 3, 2, 1, 4}; // an edge, a triangle, a line, a triangle
    const GnMesh mesh = make(scene, shape);
    place(scene, mesh);
    const auto numbers = [&scene] {
        const MeshView& view = onlyMesh(scene.begin());
        return std::vector(view.givenNumbers.begin(), view.givenNumbers.end());
    };
    CHECK(numbers() == std::vector<std::uint32_t>{1, 3});
    shape.positions[3 * 3 + 2] = 1.0f; // the line becomes a triangle
    REQUIRE(rewrite(scene, mesh, shape));
    CHECK(numbers() == std::vector<std::uint32_t>{1, 2, 3});
}

TEST_CASE("a triangle that gets an area by a rewrite casts from then on")
{
    SceneFixture scene;
    Shape shape = triangle();
    shape.positions.insert(shape.positions.end(), {2, 0, 0});
    shape.indices.insert(shape.indices.end(), {0, 1, 3});
    const GnMesh mesh = make(scene, shape);
    place(scene, mesh);
    CHECK(onlyMesh(scene.begin()).triangleCount() == 1);
    shape.positions[3 * 3 + 2] = 1.0f;
    REQUIRE(rewrite(scene, mesh, shape));
    const MeshView& view = onlyMesh(scene.begin());
    CHECK(view.triangleCount() == 2);
    CHECK(std::memcmp(scene.bytesOf(view.indexBuffer), shape.indices.data(), 6 * sizeof(std::uint32_t)) == 0);
}

TEST_CASE("buffers written in place hold the mesh and nothing is to be uploaded")
{
    SceneFixture scene;
    const Shape shape = cube();
    place(scene, make(scene, shape));
    const MeshView& view = onlyMesh(scene.begin());
    CHECK_FALSE(scene.registry->uploadsPending());
    CHECK(std::memcmp(scene.bytesOf(view.vertexBuffer), shape.positions.data(), 8 * 12) == 0);
    CHECK(std::memcmp(scene.bytesOf(view.indexBuffer), shape.indices.data(), 36 * 4) == 0);
}

TEST_CASE("uploads are recorded once, again if their frame is dropped, and staging goes when the frame is done")
{
    SceneFixture scene({.discrete = true});
    const Shape shape = cube();
    place(scene, make(scene, shape));
    CHECK(scene.registry->uploadsPending());
    CHECK(scene.stub.live("buffer") == 4);
    const MeshView& view = onlyMesh(scene.begin());
    scene.registry->recordUploads(VK_NULL_HANDLE, 1);
    CHECK_FALSE(scene.registry->uploadsPending());
    CHECK(scene.stub.counts["barrier"] == 2); // after what lay there, and before what reads
    CHECK(scene.copied.size() == 2);
    scene.copied.clear();

    scene.registry->dropUploads(1);
    REQUIRE(scene.registry->uploadsPending());
    scene.begin();
    scene.registry->recordUploads(VK_NULL_HANDLE, 2);
    REQUIRE(scene.copied[view.vertexBuffer].size() == 8 * 12);
    CHECK(std::memcmp(scene.copied[view.vertexBuffer].data(), shape.positions.data(), 8 * 12) == 0);
    REQUIRE(scene.copied[view.indexBuffer].size() == 36 * 4);
    CHECK(std::memcmp(scene.copied[view.indexBuffer].data(), shape.indices.data(), 36 * 4) == 0);

    scene.registry->retire(1);
    CHECK(scene.stub.live("buffer") == 4);
    scene.registry->retire(2);
    CHECK(scene.stub.live("buffer") == 2);
    scene.registry->recordUploads(VK_NULL_HANDLE, 3);
    CHECK(scene.stub.counts["barrier"] == 4);
}

TEST_CASE("what no frame has seen goes at once, staging included")
{
    SceneFixture scene({.discrete = true});
    const GnMesh mesh = make(scene, cube());
    CHECK(scene.memory->used() > 0);
    scene.registry->destroyMesh(mesh);
    CHECK(scene.memory->used() == 0);
    CHECK_FALSE(scene.registry->uploadsPending());
}

TEST_CASE("a mesh seen by a frame and destroyed before its upload was recorded is still uploaded for that frame")
{
    SceneFixture scene({.discrete = true});
    const GnMesh mesh = make(scene, cube());
    place(scene, mesh);
    const VkBuffer vertices = onlyMesh(scene.begin()).vertexBuffer;
    scene.registry->destroyMesh(mesh);
    scene.registry->recordUploads(VK_NULL_HANDLE, 1);
    CHECK(scene.copied.contains(vertices));
    CHECK(scene.alive(vertices));
    CHECK(scene.begin().casters.empty());
    scene.registry->retire(1);
    CHECK(scene.memory->used() == 0);
}

#ifdef GNOMON_WITH_OPENMESH
TEST_CASE("a mesh without trees is seen first, and with topology and trees once the worker has built them")
{
    SceneFixture scene({.background = true, .manualJobs = true});
    place(scene, make(scene, cube()), {}, GN_INSTANCE_STATIC_BIT);
    const Caster before = scene.begin().casters[0];
    CHECK(before.mesh->topology == nullptr);
    CHECK(before.mesh->rays == nullptr);
    CHECK_FALSE(before.closed);
    scene.queue.run();
    CHECK(before.mesh->rays == nullptr); // a frame's view does not change under its hands
    const Caster after = scene.begin().casters[0];
    REQUIRE(after.mesh->topology);
    CHECK(after.mesh->topology->facePlanes.size() == 12);
    CHECK((after.mesh->rays != nullptr) == kWithTrees);
    CHECK(after.closed);
    CHECK(after.isStatic);
    CHECK(after.revision != before.revision); // its map was drawn as that of an open mesh
    CHECK(after.mesh->revision == before.mesh->revision);
}
#endif

#ifdef GNOMON_WITH_OPENMESH
TEST_CASE("rewritten positions are never seen with the trees of the old ones")
{
    SceneFixture scene({.background = true, .manualJobs = true});
    const GnMesh mesh = make(scene, cube());
    place(scene, mesh);
    scene.queue.run();
    const MeshView old = onlyMesh(scene.begin());
    REQUIRE(rewrite(scene, mesh, cube().scaled(3.0f)));
    const MeshView bare = onlyMesh(scene.begin());
    CHECK(bare.topology == nullptr);
    CHECK(bare.rays == nullptr);
    CHECK(bare.revision != old.revision);
    CHECK(bare.bounds.upper == glm::vec3(3.0f));
    CHECK(bare.vertexBuffer != old.vertexBuffer);
    CHECK(bare.indexBuffer == old.indexBuffer);
    CHECK(scene.alive(old.vertexBuffer));
    CHECK(old.topology->facePlanes[0].w == doctest::Approx(-4.0f)); // the frame before still has its own
    scene.queue.run();
    const MeshView full = onlyMesh(scene.begin());
    REQUIRE(full.topology);
    CHECK(full.topology->facePlanes[0].w == doctest::Approx(-4.0f * 27.0f));
    CHECK(full.topology->edges.size() == old.topology->edges.size());
    scene.registry->retire(1);
    CHECK_FALSE(scene.alive(old.vertexBuffer));
}
#endif

#ifdef GNOMON_WITH_OPENMESH
TEST_CASE("connectivity is found again when vertices that were welded come apart")
{
    SceneFixture scene;
    Shape shape = triangle();
    shape.positions.insert(shape.positions.end(), {1, 0, 0, 0, 1, 0, 1, 1, 0}); // shares an edge by position only
    shape.indices.insert(shape.indices.end(), {3, 5, 4});
    const GnMesh mesh = make(scene, shape);
    place(scene, mesh);
    CHECK(onlyMesh(scene.begin()).topology->edges.size() == 5);
    for (std::size_t i = 9; i < 18; i += 3)
        shape.positions[i] += 4.0f;
    REQUIRE(rewrite(scene, mesh, shape));
    CHECK(onlyMesh(scene.begin()).topology->edges.size() == 6);
}
#endif

TEST_CASE("jobs of replaced positions do nothing")
{
    SceneFixture scene({.background = true, .manualJobs = true});
    const GnMesh mesh = make(scene, triangle(), "leaf");
    for (int i = 2; i < 6; ++i)
        REQUIRE(rewrite(scene, mesh, triangle().scaled(static_cast<float>(i))));
    scene.registry->destroyMesh(mesh);
    CHECK(scene.queue.size() == 5);
    scene.queue.run();
    CHECK(scene.said().empty()); // nobody looked at the topology, else the leaf had been called open
    scene.registry->retire(0);
    CHECK(scene.memory->used() == 0);
}

#ifdef GNOMON_WITH_OPENMESH
TEST_CASE("an open mesh is remarked upon once, with its border edges")
{
    SceneFixture scene;
    const GnMesh mesh = make(scene, triangle(), "leaf");
    REQUIRE(rewrite(scene, mesh, triangle().scaled(2.0f)));
    make(scene, cube(), "box");
    const auto said = scene.said();
    REQUIRE(said.size() == 1);
    CHECK(said[0].severity == GN_SEVERITY_INFO);
    CHECK(said[0].id == "MeshOpen");
    CHECK(said[0].text.find("mesh 'leaf' is open: 3 border edges") == 0);
}

TEST_CASE("a mesh that is inside out is remarked upon once, and is no closed caster")
{
    SceneFixture scene;
    Shape inverted = cube();
    for (std::size_t i = 0; i < inverted.indices.size(); i += 3)
        std::swap(inverted.indices[i], inverted.indices[i + 1]);
    const GnMesh mesh = make(scene, inverted, "crate");
    REQUIRE(rewrite(scene, mesh, inverted.scaled(2.0f)));
    const auto said = scene.said();
    REQUIRE(said.size() == 1);
    CHECK(said[0].severity == GN_SEVERITY_INFO);
    CHECK(said[0].id == "MeshInsideOut");
    CHECK(said[0].text.find("mesh 'crate' is inside out: ") == 0);
    CHECK(said[0].text.ends_with("; it casts with both sides of its triangles"));
}

TEST_CASE("a mesh that is no manifold surface, or turned against itself, is warned of once, by its name")
{
    SceneFixture scene;
    Shape twice = cube(); // every face a second time: closed, with four faces at an edge
    const std::vector<std::uint32_t> faces = twice.indices;
    twice.indices.insert(twice.indices.end(), faces.begin(), faces.end());
    Shape turned = cube();
    std::swap(turned.indices[1], turned.indices[2]);
    Shape fin = cube(); // a triangle more on one edge
    for (const float value : {0.0f, 0.0f, 9.0f})
        fin.positions.push_back(value);
    fin.indices.insert(fin.indices.end(),
                       {faces[0], faces[1], static_cast<std::uint32_t>(fin.positions.size() / 3 - 1)});
    const GnMesh mesh = make(scene, twice, "twice");
    REQUIRE(rewrite(scene, mesh, twice.scaled(2.0f)));
    make(scene, turned, "turned");
    make(scene, fin, "fin");
    const auto said = scene.said();
    REQUIRE(said.size() == 3);
    for (const auto& message : said) {
        CHECK(message.severity == GN_SEVERITY_WARNING);
        CHECK(message.id == "MeshNotManifold");
    }
    CHECK(said[0].text == "mesh 'twice' is no manifold surface; it casts as it is");
    CHECK(said[1].text ==
          "mesh 'turned' is a surface whose triangles disagree about the outside; it casts with both sides of "
          "its triangles");
    CHECK(said[2].text ==
          "mesh 'fin' is no manifold surface, and open: 2 border edges; it casts with both sides of its triangles");
}
#endif

TEST_CASE("a rewrite that cannot be changes nothing")
{
    SceneFixture scene;
    const GnMesh mesh = make(scene, cube(), "rock");
    place(scene, mesh);
    const MeshView before = onlyMesh(scene.begin());
    Shape bad = cube();
    bad.positions[0] = std::numeric_limits<float>::quiet_NaN();
    const auto update = [&](const Shape& shape, std::uint32_t count) {
        const Result<void> result = scene.registry->updateMeshPositions(mesh, shape.positions.data(), count, 0);
        return result ? GN_SUCCESS : result.error().result;
    };
    CHECK(update(bad, 8) == GN_ERROR_NOT_A_NUMBER);
    CHECK(update(cube(), 7) == GN_ERROR_OUT_OF_RANGE);
    CHECK(update(cube().scaled(0.0f), 8) == GN_ERROR_EMPTY);
    CHECK(onlyMesh(scene.begin()).revision == before.revision);
}

TEST_CASE("a device that fails at any call leaves no mesh and no memory behind")
{
    for (const bool discrete : {false, true}) {
        std::size_t failures = 0;
        for (std::size_t call = 0;; ++call) {
            SceneFixture scene({.discrete = discrete});
            scene.stub.failAt = call;
            Result<GnMesh> mesh = scene.registry->createMesh(cube().info("rock"));
            if (mesh) break;
            ++failures;
            CHECK(mesh.error().result == GN_ERROR_OUT_OF_HOST_MEMORY);
            CHECK(scene.memory->used() == 0);
            CHECK(scene.stub.live("buffer") == 0);
        }
        CHECK(failures >= (discrete ? 8u : 4u)); // create and bind, for each buffer
    }
}

TEST_CASE("meshes rewritten and destroyed in each of 100 frames keep what three frames in flight use, and no more")
{
    for (const bool discrete : {false, true}) {
        SceneFixture scene({.discrete = discrete, .background = true});
        const GnMesh deforming = make(scene, cube(), "deforming");
        place(scene, deforming);
        struct Used {
            std::vector<VkBuffer> buffers;
        };
        std::deque<Used> inFlight;
        std::size_t most = 0;
        for (std::uint64_t frame = 1; frame <= 100; ++frame) {
            if (inFlight.size() == 3) {
                inFlight.pop_front();
                scene.registry->retire(frame - 3);
            }
            const GnMesh passing = make(scene, cube().scaled(0.5f), "passing");
            const GnInstance instance = place(scene, passing);
            REQUIRE(rewrite(scene, deforming, cube().scaled(1.0f + 0.01f * static_cast<float>(frame))));
            const SceneRegistry::Snapshot& snapshot = scene.begin();
            REQUIRE(snapshot.casters.size() == 2);
            scene.registry->recordUploads(VK_NULL_HANDLE, frame);
            Used used;
            for (const Caster& caster : snapshot.casters)
                used.buffers.insert(used.buffers.end(), {caster.mesh->vertexBuffer, caster.mesh->indexBuffer});
            inFlight.push_back(used);
            scene.registry->destroyInstance(instance);
            scene.registry->destroyMesh(passing);
            if (frame % 2) REQUIRE(rewrite(scene, deforming, cube()));
            scene.registry->finishBackground(); // only so that the count below is exact
            for (const Used& entry : inFlight)
                for (const VkBuffer buffer : entry.buffers)
                    REQUIRE(scene.alive(buffer));
            most = std::max(most, scene.stub.live("buffer"));
        }
        // Per frame in flight: two buffers of `passing`, one of `deforming`, as much staging; besides what is current.
        CHECK(most <= (discrete ? 40u : 16u));
        scene.begin();
        scene.registry->recordUploads(VK_NULL_HANDLE, 101);
        scene.registry->retire(101);
        CHECK(scene.stub.live("buffer") == 2);
        CHECK(scene.stub.faults.empty());
    }
}

TEST_CASE("positions rewritten while no frame comes leave nothing but the newest")
{
    for (const bool discrete : {false, true})
        for (const bool background : {false, true}) {
            CAPTURE(discrete);
            CAPTURE(background);
            SceneFixture scene({.discrete = discrete, .background = background, .manualJobs = background});
            const GnMesh mesh = make(scene, cube());
            place(scene, mesh);
            scene.begin();
            scene.registry->recordUploads(VK_NULL_HANDLE, 1);
            scene.queue.run();
            for (int i = 0; i < 50; ++i) {
                REQUIRE(rewrite(scene, mesh, cube().scaled(1.0f + 0.01f * static_cast<float>(i))));
                scene.queue.run();
            }
            // Indices, what frame 1 sees and the newest; each with its staging, where there is any, and the newest but
            // one, which the next rewrite finds done.
            CHECK(scene.stub.live("buffer") <= (discrete ? 8u : 4u));
        }
}

TEST_CASE("the registry goes with jobs still in the queue")
{
    SceneFixture scene({.background = true, .manualJobs = true});
    for (int i = 0; i < 3; ++i)
        place(scene, make(scene, cube()));
    scene.begin();
    scene.registry.reset();
    CHECK(scene.memory->used() == 0);
}
