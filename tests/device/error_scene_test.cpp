// Meshes, instances and lights that cannot be.
#include <cmath>
#include <limits>

#include "device/error_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

struct MeshCase {
    const char* what;
    std::vector<float> positions;
    std::vector<uint32_t> indices;
    GnResult expected;
    const char* named;
    uint32_t stride = 0;
};

GnResult createMesh(GnContext context, const MeshCase& c, GnMesh* mesh)
{
    GnMeshCreateInfo info{};
    info.pName = "suspect";
    static const float nothing = 0.0f; // a pointer that is not null, to nothing at all
    static const uint32_t noIndex = 0;
    info.pPositions = c.positions.empty() ? &nothing : c.positions.data();
    info.positionCount = static_cast<uint32_t>(c.positions.size() / 3);
    info.positionStride = c.stride;
    info.pIndices = c.indices.empty() ? &noIndex : c.indices.data();
    info.indexCount = static_cast<uint32_t>(c.indices.size());
    return gnCreateMesh(context, &info, mesh);
}

const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a mesh that cannot be is refused by name, and the picture stays")
{
    const MeshCase cases[] = {
        {"no vertices", {}, {0, 1, 2}, GN_ERROR_EMPTY, "'suspect'"},
        {"no indices", kTriangle, {}, GN_ERROR_EMPTY, "'suspect'"},
        {"two indices", kTriangle, {0, 1}, GN_ERROR_OUT_OF_RANGE, "2 indices"},
        {"index past the end", kTriangle, {0, 1, 3}, GN_ERROR_OUT_OF_RANGE, "index 3"},
        {"index far past the end", kTriangle, {0, 1, 0xffffffffu}, GN_ERROR_OUT_OF_RANGE, "4294967295"},
        {"NaN", {0, 0, 0, 1, kNaN, 0, 0, 1, 0}, {0, 1, 2}, GN_ERROR_NOT_A_NUMBER, "vertex 1"},
        {"infinite", {0, 0, 0, 1, 0, 0, 0, 1, -kInf}, {0, 1, 2}, GN_ERROR_INFINITE, "vertex 2"},
        {"too large", {0, 0, 0, 1, 0, 0, 0, 3e30f, 0}, {0, 1, 2}, GN_ERROR_OUT_OF_RANGE, "vertex 2"},
        {"odd stride", kTriangle, {0, 1, 2}, GN_ERROR_OUT_OF_RANGE, "13", 13},
        {"nothing but zero-area triangles", {0, 0, 0, 1, 1, 1, 2, 2, 2}, {0, 1, 2, 1, 1, 2}, GN_ERROR_EMPTY, "area"},
    };
    Watched watched;
    for (const MeshCase& c : cases) {
        GnMesh mesh = watched.host.meshes[0];
        const GnResult result = createMesh(watched.host.context, c, &mesh);
        CHECK(mesh == VK_NULL_HANDLE);
        watched.refused(c.what, result, c.expected, c.named);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "zero-area triangles are dropped with a warning; the rest casts by every method")
{
    // The box with a needle in each corner and one triangle that uses a vertex twice.
    Scene scene = smallScene();
    demo::Mesh clean = scene.meshes[2];
    demo::Mesh dirty = clean;
    for (uint32_t i = 0; i < clean.indices.size(); i += 6)
        dirty.indices.insert(dirty.indices.begin() + i, {clean.indices[i], clean.indices[i], clean.indices[i + 1]});
    Host host(scene), fresh(scene);
    const GnMeshCreateInfo info{.pName = "needles",
                                .pPositions = &dirty.positions[0].x,
                                .positionCount = static_cast<uint32_t>(dirty.positions.size()),
                                .positionStride = 0,
                                .indexCount = static_cast<uint32_t>(dirty.indices.size()),
                                .pIndices = dirty.indices.data()};
    GnMesh mesh = VK_NULL_HANDLE;
    host.takeMessages();
    host.require(gnCreateMesh(host.context, &info, &mesh));
    const std::vector<std::string> messages = host.takeMessages();
    REQUIRE(messages.size() == 1);
    CHECK(messages[0].find("needles") != std::string::npos);
    CHECK(messages[0].find(std::to_string((dirty.indices.size() - clean.indices.size()) / 3)) != std::string::npos);
    host.require(gnSetInstanceMesh(host.context, host.instances[2], mesh));
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        if (!serves(method, demo::LightKind::Spot)) continue;
        CAPTURE(std::string(method.pName));
        for (Host* each : {&host, &fresh}) {
            each->pinAll(method.pName);
            each->require(each->draw());
        }
        CHECK(differences(host.pictures(), fresh.pictures()) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "an instance that was put 1e18 m away takes no shadow from others, by any method")
{
    Scene scene = smallScene();
    demo::Instance& away = scene.instances.emplace_back(scene.instances[1]);
    away.name = "away";
    away.pose.position = {0.0, -1e18, 1e18};
    Host host(scene), without(smallScene());
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        if (!serves(method, demo::LightKind::Spot)) continue;
        CAPTURE(std::string(method.pName));
        for (Host* each : {&host, &without}) {
            each->pinAll(method.pName);
            each->require(each->draw());
        }
        CHECK(differences(host.pictures(), without.pictures()) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "an instance cannot stand at NaN, at infinity or be flat; it stays where it was")
{
    Watched watched;
    const GnContext context = watched.host.context;
    const GnInstance instance = watched.host.instances[1];
    const auto set = [&](auto change) {
        GnTransform transform{};
        transform.basis[0] = transform.basis[4] = transform.basis[8] = 1.0f;
        change(transform);
        return gnSetInstanceTransform(context, instance, &transform);
    };
    const double inf = std::numeric_limits<double>::infinity();
    watched.refused("NaN translation", set([](GnTransform& t) { t.translation[1] = std::nan(""); }),
                    GN_ERROR_NOT_A_NUMBER, "translation[1]");
    watched.refused("infinite translation", set([&](GnTransform& t) { t.translation[2] = inf; }), GN_ERROR_INFINITE,
                    "translation[2]");
    watched.refused("NaN basis", set([](GnTransform& t) { t.basis[4] = kNaN; }), GN_ERROR_NOT_A_NUMBER, "basis[4]");
    watched.refused("infinite basis", set([](GnTransform& t) { t.basis[8] = -kInf; }), GN_ERROR_INFINITE, "basis[8]");
    watched.refused("flat", set([](GnTransform& t) { t.basis[4] = 0.0f; }), GN_ERROR_OUT_OF_RANGE, "'ball'");
    watched.refused("null", gnSetInstanceTransform(context, instance, nullptr), GN_ERROR_NULL_ARGUMENT, "pTransform");
}

TEST_CASE_FIXTURE(DeviceTest, "a light that cannot be is refused, and a bad update changes nothing")
{
    Watched watched;
    const GnContext context = watched.host.context;
    const auto update = [&](auto change) {
        GnLightInfo info =
            demo::toGnLight(watched.host.scene.lights[0], demo::lightAt(watched.host.scene.lights[0], 0.0));
        change(info);
        return gnUpdateLight(context, watched.host.lights[0], &info);
    };
    watched.refused("NaN position", update([](GnLightInfo& l) { l.position[0] = std::nan(""); }), GN_ERROR_NOT_A_NUMBER,
                    "position[0]");
    watched.refused("infinite range", update([](GnLightInfo& l) { l.range = kInf; }), GN_ERROR_INFINITE, "range");
    watched.refused("negative range", update([](GnLightInfo& l) { l.range = -1.0f; }), GN_ERROR_OUT_OF_RANGE, "-1");
    watched.refused("no direction",
                    update([](GnLightInfo& l) { l.direction[0] = l.direction[1] = l.direction[2] = 0.0f; }),
                    GN_ERROR_OUT_OF_RANGE, "direction");
    watched.refused("half a sphere", update([](GnLightInfo& l) { l.coneAngle = 1.5708f; }), GN_ERROR_OUT_OF_RANGE,
                    "coneAngle");
    watched.refused("no such kind", update([](GnLightInfo& l) { l.type = static_cast<GnLightType>(7); }),
                    GN_ERROR_OUT_OF_RANGE, "7");
    GnLightInfo bad{};
    bad.type = GN_LIGHT_TYPE_POINT;
    bad.position[2] = std::nan("");
    GnLight light = watched.host.lights[0];
    const GnResult result = gnCreateLight(context, &bad, &light);
    CHECK(light == VK_NULL_HANDLE);
    watched.refused("a new one", result, GN_ERROR_NOT_A_NUMBER, "position[2]");
}

TEST_CASE_FIXTURE(DeviceTest, "handles of what is gone are errors, never another thing")
{
    Watched watched;
    Host& host = watched.host;
    GnMesh mesh = VK_NULL_HANDLE;
    host.require(createMesh(host.context, {"good", kTriangle, {0, 1, 2}, GN_SUCCESS, ""}, &mesh));
    gnDestroyMesh(host.context, mesh);
    GnMesh reused = VK_NULL_HANDLE; // most likely takes the place of the one that is gone
    host.require(createMesh(host.context, {"good", kTriangle, {0, 1, 2}, GN_SUCCESS, ""}, &reused));
    CHECK(reused != mesh);
    watched.refused("mesh", gnUpdateMeshPositions(host.context, mesh, kTriangle.data(), 3, 0), GN_ERROR_INVALID_HANDLE,
                    "mesh");
    watched.refused("instance's mesh", gnSetInstanceMesh(host.context, host.instances[1], mesh),
                    GN_ERROR_INVALID_HANDLE, "mesh");
    GnInstanceCreateInfo info{};
    info.mesh = mesh;
    GnInstance instance = VK_NULL_HANDLE;
    watched.refused("new instance's mesh", gnCreateInstance(host.context, &info, &instance), GN_ERROR_INVALID_HANDLE,
                    "mesh");
    info.mesh = reused;
    host.require(gnCreateInstance(host.context, &info, &instance));
    gnDestroyInstance(host.context, instance);
    const GnTransform transform{};
    watched.refused("instance", gnSetInstanceTransform(host.context, instance, &transform), GN_ERROR_INVALID_HANDLE,
                    "instance");
    watched.refused("count of positions", gnUpdateMeshPositions(host.context, reused, kTriangle.data(), 2, 0),
                    GN_ERROR_OUT_OF_RANGE, "2");
    watched.refused("null light", gnUpdateLight(host.context, VK_NULL_HANDLE, nullptr), GN_ERROR_NULL_ARGUMENT,
                    "pInfo");
    GnLight light = VK_NULL_HANDLE;
    const GnLightInfo point{.type = GN_LIGHT_TYPE_POINT};
    host.require(gnCreateLight(host.context, &point, &light));
    gnDestroyLight(host.context, light);
    watched.refused("light", gnUpdateLight(host.context, light, &point), GN_ERROR_INVALID_HANDLE, "light");
    watched.refused("light's method", gnSetLightMethod(host.context, light, nullptr), GN_ERROR_INVALID_HANDLE, "light");
    gnDestroyMesh(host.context, mesh); // and destroying twice or nothing is nothing
    gnDestroyInstance(host.context, instance);
    gnDestroyLight(host.context, light);
    gnDestroyMesh(host.context, VK_NULL_HANDLE);
    host.require(host.draw());
    CHECK(differences(host.pictures(), watched.good) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a light exactly on a receiver or on a caster's corner is served by every method")
{
    for (const bool onCorner : {false, true}) {
        Scene scene = smallScene();
        // The floor's upper side lies at 0; the box's corner is at these coordinates to the last bit.
        const glm::dvec3 place = onCorner ? glm::dvec3(1.4 + 0.5, 0.9 + 0.8, -0.6 + 0.5) : glm::dvec3(0.0);
        scene.lights = {spotLight("spot", place, place + glm::dvec3(-0.3, onCorner ? -1.0 : 1.0, 0.2), true),
                        pointLight("point", place, true)};
        Host host(scene);
        for (const GnMethodInfo& method : availableMethods(host.context)) {
            CAPTURE(std::string(method.pName));
            std::vector<GnLight> lights;
            for (size_t i = 0; i < 2; ++i) {
                if (!serves(method, scene.lights[i].kind)) continue;
                host.pin(i, method.pName);
                lights.push_back(host.lights[i]);
            }
            host.require(host.draw({.lights = &lights}));
            for (size_t i = 0; i < lights.size(); ++i)
                CHECK(lit(host.pictures()[i]) + dark(host.pictures()[i]) > 320 * 180 / 2);
        }
    }
}
