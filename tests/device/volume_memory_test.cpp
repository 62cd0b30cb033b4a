// What the volume methods hold per view, light and caster: the bytes their pages state against the buffers and images
// there are, and against what the plan is told.
#include <algorithm>
#include <bit>

#include "algorithms/entries.hpp"
#include "device/memory_books.hpp"
#include "runtime/algorithm.hpp"
#include "runtime/scene/topology.hpp"
#include "shaders/volumes/cull.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

// No multiple of a strip or a tile, ours or a device's; but nearly of the 128 rows that storedImageSize() counts by,
// which of 180 rows would claim two fifths more than a device takes that has no tiles.
constexpr VkExtent2D kExtent{328, 244};

/// Buffers are rounded up to a power of two.
VkDeviceSize rounded(VkDeviceSize bytes)
{
    return bytes == 0 ? 0 : std::bit_ceil(std::max<VkDeviceSize>(bytes, 256));
}

struct CasterBytes {
    VkDeviceSize sides = 0, caps = 0;
    uint32_t pieces = 0; ///< Of sides.
};

/// "Memory" in stencil_volume.md.
CasterBytes statedBytes(const demo::Mesh& mesh)
{
    constexpr VkDeviceSize kCommand = 20, kPiece = 8192;
    const Topology topology = buildTopology(mesh.positions, mesh.indices);
    const VkDeviceSize faces = mesh.indices.size() / 3, edges = topology.edges.size();
    const VkDeviceSize sidePieces = (edges + kPiece - 1) / kPiece, capPieces = (faces + kPiece - 1) / kPiece;
    return {.sides = kCommand * sidePieces + (topology.closed ? 24 * edges : 72 * faces),
            .caps = kCommand * capPieces + 24 * faces,
            .pieces = static_cast<uint32_t>(sidePieces)};
}

/// Of the instances that match; the floor of smallScene() is the first.
template <typename Chosen>
CasterBytes statedBytes(const Scene& scene, Chosen&& chosen)
{
    CasterBytes sum;
    for (const demo::Instance& instance : scene.instances) {
        if (!chosen(instance)) continue;
        const CasterBytes one = statedBytes(scene.meshes[instance.mesh]);
        sum.sides += one.sides;
        sum.caps += one.caps;
        sum.pieces += one.pieces;
    }
    return sum;
}

constexpr auto kStatic = [](const demo::Instance& instance) { return instance.isStatic; };
constexpr auto kMoving = [](const demo::Instance& instance) { return !instance.isStatic; };
constexpr auto kAll = [](const demo::Instance&) { return true; };

/// Closed casters small and large, and an open one; the ball moves.
Scene memoryScene()
{
    Scene scene = smallScene();
    scene.instances[1].isStatic = false;
    scene.meshes.push_back(demo::makeTorus({.radius = 0.8f, .tube = 0.3f, .ringSegments = 96, .tubeSegments = 64}));
    scene.meshes.push_back(demo::makePlane({.width = 1.5f, .depth = 1.5f, .columns = 20, .rows = 20}));
    for (const uint32_t mesh : {3u, 4u}) {
        demo::Instance instance = scene.instances[2];
        instance.name = mesh == 3 ? "ring" : "sheet";
        instance.mesh = mesh;
        instance.pose.position = {mesh == 3 ? 0.0 : -1.0, 1.5 + mesh * 0.2, 1.0};
        scene.instances.push_back(instance);
    }
    return scene;
}

struct Setting {
    const char* name;
    double value;
};

struct Drawn {
    Host host;
    explicit Drawn(const MemoryBooks& books, const char* method, const Scene& scene, HostOptions options = {},
                   const std::vector<Setting>& settings = {})
        : host(scene, books.options(std::move(options)))
    {
        host.fixMapSides(4096.0); // those of toldBytes()
        host.pinAll(method);
        for (const Setting& setting : settings)
            host.require(gnSetMethodSetting(host.context, method, setting.name, setting.value));
        for (int frame = 0; frame < 12; ++frame) {
            host.scene.instances[1].pose.position.x += frame % 2 ? 0.01 : -0.01;
            host.require(host.draw());
            for (size_t light = 0; light < host.lights.size(); ++light)
                REQUIRE(std::string(host.decision(light).pMethod) == method);
        }
    }
};

VkDeviceSize toldBytes(const AlgorithmEntry& entry, GnLightType type)
{
    std::vector<double> defaults;
    for (const SettingSpec& setting : entry.settings)
        defaults.push_back(setting.standard);
    return entry.memoryFor(defaults, kExtent, type);
}

VkDeviceSize viewBytes(const MemoryBooks& books)
{
    VkDeviceSize sum = 0;
    for (const char* name :
         {"volumes.depths", "volumes.depth_stencil", "volumes.bounds", "volumes.strips", "volumes.receiver_tiles"})
        sum += books.held(name).bytes;
    return sum;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "sides take 24 bytes an edge of closed casters and 72 a triangle of open ones, per light")
{
    for (const uint32_t lights : {1u, 3u})
        for (const uint32_t inFlight : {1u, 2u, 3u}) {
            CAPTURE(lights);
            CAPTURE(inFlight);
            MemoryBooks books;
            Scene scene = memoryScene();
            while (scene.lights.size() < lights)
                scene.lights.push_back(
                    spotLight("more", {-2.0, 6.0 + static_cast<double>(scene.lights.size()), 2.0}, {0, 0, 0}, true));
            const Drawn drawn(books, "stencil_volume", scene, {.extent = kExtent, .framesInFlight = inFlight});
            const MemoryBooks::Entry sides = books.held("volumes.sides");
            CAPTURE(books.list());
            // What is shown stays while the next is written; how many are in flight at once the device decides.
            const uint32_t dynamics = sides.count - lights;
            CHECK(dynamics >= 2 * lights);
            CHECK(dynamics <= std::max(2u, inFlight) * lights);
            CHECK(sides.bytes == lights * rounded(statedBytes(scene, kStatic).sides) +
                                     dynamics * rounded(statedBytes(scene, kMoving).sides));
            CHECK(books.held("volumes.caps").count == 0); // z-pass serves for all
        }
}

TEST_CASE_FIXTURE(DeviceTest, "caps take 24 bytes a triangle of the casters that z-fail counts, per light and view")
{
    MemoryBooks books;
    const Scene scene = memoryScene();
    Drawn drawn(books, "stencil_volume", scene, {.extent = kExtent, .framesInFlight = 2});
    drawn.host.require(gnSetMethodSetting(drawn.host.context, "stencil_volume", "z_fail", 1.0));
    for (int frame = 0; frame < 6; ++frame) {
        drawn.host.scene.instances[1].pose.position.x += frame % 2 ? 0.01 : -0.01;
        drawn.host.require(drawn.host.draw());
    }
    const MemoryBooks::Entry caps = books.held("volumes.caps");
    CAPTURE(books.list());
    CHECK(caps.count == 3); // static casters once, the moving one in two versions
    CHECK(caps.bytes == rounded(statedBytes(scene, kStatic).caps) + 2 * rounded(statedBytes(scene, kMoving).caps));
}

TEST_CASE_FIXTURE(DeviceTest, "silhouettes on the device take edges and planes of every mesh once, whatever the lights")
{
    for (const bool several : {false, true}) {
        CAPTURE(several);
        MemoryBooks books;
        Scene scene = memoryScene();
        if (several) scene.lights.push_back(spotLight("second", {-4.0, 6.0, 2.0}, {0.0, 0.0, 0.0}, true));
        const Drawn drawn(books, "stencil_volume", scene, {.extent = kExtent, .framesInFlight = 2},
                          {{"silhouettes", 1.0}});
        CAPTURE(books.list());
        VkDeviceSize edgeBytes = 0, planeBytes = 0;
        for (const demo::Mesh& mesh : scene.meshes) {
            const VkDeviceSize faces = mesh.indices.size() / 3;
            edgeBytes += rounded(16 * buildTopology(mesh.positions, mesh.indices).edges.size() + 4 * 3 * faces);
            planeBytes += rounded(16 * faces);
        }
        CHECK(books.held("volumes.mesh_edges").count == scene.meshes.size());
        CHECK(books.held("volumes.mesh_edges").bytes == edgeBytes);
        CHECK(books.held("volumes.mesh_planes").count == scene.meshes.size());
        CHECK(books.held("volumes.mesh_planes").bytes == planeBytes);
        // One list of either kind: the device writes in order.
        CHECK(books.held("volumes.mesh_sides").count == 2 * scene.lights.size());
        CHECK(books.held("volumes.mesh_sides").bytes ==
              scene.lights.size() *
                  (rounded(statedBytes(scene, kStatic).sides) + rounded(statedBytes(scene, kMoving).sides)));
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a view takes what its methods tell the plan, once, however many lights there are")
{
    for (const AlgorithmEntry* entry : {&kStencilVolume, &kOctreeVolume, &kAllEdgesVolume}) {
        CAPTURE(std::string(entry->name));
        for (const bool several : {false, true}) {
            MemoryBooks books;
            Scene scene = memoryScene();
            if (several) scene.lights.push_back(spotLight("second", {-4.0, 6.0, 2.0}, {0.0, 0.0, 0.0}, true));
            const Drawn drawn(books, entry->name, scene, {.extent = kExtent});
            const VkDeviceSize view = viewBytes(books), told = toldBytes(*entry, GN_LIGHT_TYPE_SPOT);
            MESSAGE(std::string(entry->name) << ": " << view << " bytes a view, " << told << " told");
            CAPTURE(books.list());
            CHECK(view <= told);
            CHECK(told <= view + view / 8);
            CHECK(books.held("volumes.depth_stencil").count == 1);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "volumes held against the depth image take 4 kB and 160 bytes a caster more, per light")
{
    for (const char* method : {"octree_volume", "stencil_volume"}) {
        CAPTURE(method);
        MemoryBooks books;
        const Scene scene = memoryScene();
        const Drawn drawn(books, method, scene, {.extent = kExtent}, {{"extents", 1.0}});
        const VkDeviceSize statics =
            static_cast<VkDeviceSize>(std::count_if(scene.instances.begin(), scene.instances.end(), kStatic));
        CAPTURE(books.list());
        CHECK(books.held("volumes.regions").bytes == rounded(4096 + 160 * statics)); // one caster moves: too few
        CHECK(books.held("volumes.sides").bytes ==
              rounded(statedBytes(scene, kStatic).sides) + 2 * rounded(statedBytes(scene, kMoving).sides));
        const VkDeviceSize tiles = (kExtent.width + 31) / 32 * ((kExtent.height + 31) / 32);
        CHECK(books.held("volumes.reached").bytes == rounded(16 + 32 * tiles));
        const VkDeviceSize commands = 20 * statedBytes(scene, kStatic).pieces;
        CHECK(books.held("volumes.culled_sides").bytes == rounded(commands));
    }
}

TEST_CASE_FIXTURE(DeviceTest, "chan_durand holds a map of 4 bytes a texel and its copy, cells, and 176 bytes a command")
{
    for (const bool point : {false, true}) {
        CAPTURE(point);
        MemoryBooks books;
        Scene scene = memoryScene();
        if (point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
        const VkDeviceSize layers = point ? 6 : 1, resolution = 512;
        const Drawn drawn(books, "chan_durand", scene, {.extent = kExtent});
        CAPTURE(books.list());
        const char* map = point ? "cube_faces" : "depth_map";
        CHECK(books.held(map).bytes >= layers * resolution * resolution * 4);
        CHECK(books.held(map).bytes <= 2 * layers * (resolution * resolution * 4 + 256));
        CHECK(books.held("chan_durand.cells").bytes == rounded(4096 * layers));
        const VkDeviceSize commands = statedBytes(scene, kAll).pieces; // no caps are needed here
        CHECK(books.held("chan_durand.items").bytes == 2 * rounded(156 * commands));
        CHECK(books.held("chan_durand.commands").bytes == rounded(20 * commands));
        const VkDeviceSize held = viewBytes(books) + books.held(map).bytes;
        const VkDeviceSize told = toldBytes(kChanDurand, point ? GN_LIGHT_TYPE_POINT : GN_LIGHT_TYPE_SPOT);
        CHECK(held <= told);
        CHECK(told <= 2 * held); // a copy of the static casters is kept apart only where others move
    }
}

TEST_CASE_FIXTURE(
    DeviceTest,
    "all_edges_volume holds 116 bytes a triangle and mesh, and 20 more an edge of open ones, for all lights")
{
    for (const bool several : {false, true}) {
        MemoryBooks books;
        Scene scene = memoryScene();
        scene.instances.push_back(scene.instances.back()); // a second caster of the open mesh
        scene.instances.back().pose.position.x -= 1.0;
        if (several) scene.lights.push_back(spotLight("second", {-4.0, 6.0, 2.0}, {0.0, 0.0, 0.0}, true));
        const Drawn drawn(books, "all_edges_volume", scene, {.extent = kExtent});
        VkDeviceSize bytes = 0;
        for (const demo::Mesh& mesh : scene.meshes) {
            const Topology topology = buildTopology(mesh.positions, mesh.indices);
            constexpr VkDeviceSize kCommands = 64; // three of 20 bytes, up to a slot of 16
            bytes += rounded(kCommands + 116 * (mesh.indices.size() / 3) +
                             (topology.closed ? 0 : 20 * VkDeviceSize{topology.edges.size()}));
        }
        CAPTURE(books.list());
        CHECK(books.held("volumes.edges").count == scene.meshes.size());
        CHECK(books.held("volumes.edges").bytes == bytes);
        CHECK(books.held("volumes.sides").count == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "mccool holds a map of 4 bytes a texel, its copy, and 76 bytes a cell that may have a jump")
{
    for (const bool point : {false, true}) {
        CAPTURE(point);
        MemoryBooks books;
        Scene scene = memoryScene();
        if (point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
        const VkDeviceSize layers = point ? 6 : 1, resolution = 1024, cells = 64 * resolution;
        const Drawn drawn(books, "mccool", scene, {.extent = kExtent});
        CAPTURE(books.list());
        const std::string map = point ? "cube_faces" : "depth_map";
        const VkDeviceSize maps = books.held(map + ".depth").bytes + books.held(map + ".statics").bytes;
        CHECK(maps >= layers * resolution * resolution * 4);
        CHECK(maps <= 2 * layers * (resolution * resolution * 4 + 256));
        const VkDeviceSize lists = books.held("mccool.polygons").bytes + books.held("mccool.cells").bytes;
        const MemoryBooks::Entry polygons = books.held("mccool.polygons");
        CHECK(polygons.bytes == polygons.count * rounded(32 + 72 * cells));
        CHECK(lists == polygons.count * (rounded(32 + 72 * cells) + rounded(4 + 4 * cells)));
        CHECK(polygons.count <= layers); // a face that no visible receiver needs has none
        CHECK(polygons.count >= (layers + 1) / 2);
        const VkDeviceSize held = viewBytes(books) + maps + lists;
        const VkDeviceSize told = toldBytes(kMccool, point ? GN_LIGHT_TYPE_POINT : GN_LIGHT_TYPE_SPOT);
        MESSAGE("mccool: " << held << " bytes held, " << told << " told");
        CHECK(held <= told);
        CHECK(told <= 2 * held);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "projected_planar holds 16 bytes a tile of 16 x 16 pixels and view, and 16 a light")
{
    for (const uint32_t lights : {1u, 2u}) {
        MemoryBooks books;
        Scene scene = memoryScene();
        if (lights == 2) scene.lights.push_back(spotLight("second", {-4.0, 6.0, 2.0}, {0.0, 0.0, 0.0}, true));
        const Drawn drawn(books, "projected_planar", scene, {.extent = kExtent});
        const VkDeviceSize tiles = kExtent.width / 16 * (kExtent.height / 16); // whole ones
        CAPTURE(books.list());
        CHECK(books.held("projected_planar.tiles").count == 1);
        CHECK(books.held("projected_planar.tiles").bytes == rounded(16 * tiles));
        CHECK(books.held("projected_planar.plane").bytes == lights * rounded(16));
        const VkDeviceSize held = books.held("projected_planar").bytes;
        const VkDeviceSize told = toldBytes(kProjectedPlanar, GN_LIGHT_TYPE_SPOT);
        CHECK(held <= lights * told);
        CHECK(lights * told <= 2 * held);
    }
}
