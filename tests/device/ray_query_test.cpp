// Rays on the device: what they need, what is built when, and masks that eight bits cannot tell apart.
#include <algorithm>
#include <map>

#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1;
constexpr const char* kTraced = "ray_query";

/// Empty: it can run.
std::string unavailable(GnContext context)
{
    uint32_t count = 0;
    gnEnumerateMethods(context, &count, nullptr);
    std::vector<GnMethodInfo> methods(count);
    gnEnumerateMethods(context, &count, methods.data());
    const auto found = std::ranges::find_if(
        methods, [](const GnMethodInfo& method) { return std::string_view(method.pName) == kTraced; });
    REQUIRE(found != methods.end());
    return found->pUnavailable ? found->pUnavailable : "";
}

/// Tests of the method end here on devices without.
bool canTrace()
{
    return tracesRays(Host(smallScene(), {.warmUp = false}).context);
}

demo::Mesh ballOf(uint32_t frame)
{
    demo::Mesh ball = smallScene().meshes[kBall];
    for (glm::vec3& position : ball.positions)
        position *= glm::vec3(1.0f + 0.01f * static_cast<float>(frame % 50), 1.0f, 1.0f);
    return ball;
}

void reshape(Host& host, uint32_t frame)
{
    const demo::Mesh ball = ballOf(frame);
    host.require(gnUpdateMeshPositions(host.context, host.meshes[kBall], &ball.positions[0].x,
                                       static_cast<uint32_t>(ball.positions.size()), 0));
}

/// Bottom levels of the context, by handle: their bytes.
std::map<VkAccelerationStructureKHR, VkDeviceSize> bottomLevels;

template <typename Function>
Function realOf(const char* name)
{
    return reinterpret_cast<Function>(vkGetDeviceProcAddr(device().handle, name));
}

/// A driver that asks for twice the room that builds use, and says how much they have used. Lavapipe asks for what they
/// use, and would make no copies.
VKAPI_ATTR void VKAPI_CALL wastefulSizes(VkDevice handle, VkAccelerationStructureBuildTypeKHR type,
                                         const VkAccelerationStructureBuildGeometryInfoKHR* info, const uint32_t* count,
                                         VkAccelerationStructureBuildSizesInfoKHR* sizes)
{
    realOf<PFN_vkGetAccelerationStructureBuildSizesKHR>("vkGetAccelerationStructureBuildSizesKHR")(handle, type, info,
                                                                                                   count, sizes);
    sizes->accelerationStructureSize *= 2;
}

VKAPI_ATTR VkResult VKAPI_CALL countedCreate(VkDevice handle, const VkAccelerationStructureCreateInfoKHR* info,
                                             const VkAllocationCallbacks* allocator, VkAccelerationStructureKHR* out)
{
    const VkResult result =
        realOf<PFN_vkCreateAccelerationStructureKHR>("vkCreateAccelerationStructureKHR")(handle, info, allocator, out);
    if (result == VK_SUCCESS && info->type == VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR)
        bottomLevels[*out] = info->size;
    return result;
}

VKAPI_ATTR void VKAPI_CALL countedDestroy(VkDevice handle, VkAccelerationStructureKHR structure,
                                          const VkAllocationCallbacks* allocator)
{
    bottomLevels.erase(structure);
    realOf<PFN_vkDestroyAccelerationStructureKHR>("vkDestroyAccelerationStructureKHR")(handle, structure, allocator);
}

VkQueryPool sizeQueries = VK_NULL_HANDLE;

VKAPI_ATTR VkResult VKAPI_CALL notedPool(VkDevice handle, const VkQueryPoolCreateInfo* info,
                                         const VkAllocationCallbacks* allocator, VkQueryPool* pool)
{
    const VkResult result = vkCreateQueryPool(handle, info, allocator, pool);
    if (info->queryType == VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR) sizeQueries = *pool;
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL usedSizes(VkDevice handle, VkQueryPool pool, uint32_t first, uint32_t count,
                                         size_t bytes, void* data, VkDeviceSize stride, VkQueryResultFlags flags)
{
    const VkResult result = vkGetQueryPoolResults(handle, pool, first, count, bytes, data, stride, flags);
    if (pool == sizeQueries && result == VK_SUCCESS) *static_cast<uint64_t*>(data) /= 2;
    return result;
}

HostOptions wasteful()
{
    return hooked({}, {hook("vkCreateQueryPool", &notedPool), hook("vkGetQueryPoolResults", &usedSizes),
                       hook("vkGetAccelerationStructureBuildSizesKHR", &wastefulSizes),
                       hook("vkCreateAccelerationStructureKHR", &countedCreate),
                       hook("vkDestroyAccelerationStructureKHR", &countedDestroy)});
}

VkDeviceSize bottomBytes()
{
    VkDeviceSize sum = 0;
    for (const auto& [handle, bytes] : bottomLevels)
        sum += bytes;
    return sum;
}

/// Until no structure changes any more: sizes of copies are known a few frames after the builds.
void settle(Host& host)
{
    host.pinAll(kTraced);
    host.draw(4, {});
}

std::vector<Image8> drawn(Host& host, const char* method)
{
    host.pinAll(method);
    host.require(host.draw());
    REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
    return host.pictures();
}

/// Pixels in which the method and ray_traced differ, and of how many that are dark.
struct Apart {
    size_t pixels, dark;
};
Apart apart(Host& host)
{
    const std::vector<Image8> traced = drawn(host, kTraced), truth = drawn(host, "ray_traced");
    return {differences(traced, truth), dark(truth[0])};
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a host that leaves out what rays on the device need is told what")
{
    const Host all(smallScene(), {.warmUp = false});
    const std::string given = unavailable(all.context);
    const Host none(smallScene(),
                    {.warmUp = false, .context = [](GnContextCreateInfo& info) { info.enabledExtensionCount = 0; }});
    CHECK(unavailable(none.context) == "needs VK_KHR_acceleration_structure");
    CHECK(tracesRays(all.context) == given.empty());
    if (!given.empty()) {
        CHECK(given == "needs VK_KHR_acceleration_structure"); // of a driver without
        return;
    }
    const Host some(
        smallScene(),
        {.warmUp = false, .context = [](GnContextCreateInfo& info) {
             static std::vector<const char*> names;
             names.assign(info.ppEnabledExtensionNames, info.ppEnabledExtensionNames + info.enabledExtensionCount);
             std::erase_if(names, [](std::string_view name) { return name == VK_KHR_RAY_QUERY_EXTENSION_NAME; });
             info.ppEnabledExtensionNames = names.data();
             info.enabledExtensionCount = static_cast<uint32_t>(names.size());
         }});
    CHECK(unavailable(some.context) == "needs VK_KHR_ray_query");
}

TEST_CASE_FIXTURE(DeviceTest, "what stands still is built once, and a mesh that deforms is traced as it is")
{
    if (!canTrace()) return;
    Host host(smallScene());
    host.hide(kBall); // the camera would see it as it was
    Apart found = apart(host);
    CHECK(found.dark > 1000);
    CHECK(found.pixels <= 2);
    settle(host);
    CHECK(drawn(host, kTraced).size() == 1);
    CHECK(host.passCount("rays.meshes") == 0);
    CHECK(host.passCount("rays.compact") == 0);
    CHECK(host.passCount("rays.top_level") == 0);
    size_t different = 0;
    const std::vector<Image8> before = drawn(host, kTraced);
    for (uint32_t frame = 1; frame < 40; ++frame) { // longer than structures are refitted
        CAPTURE(frame);
        reshape(host, frame);
        const std::vector<Image8> traced = drawn(host, kTraced);
        CHECK(host.passCount("rays.meshes") == 1);
        CHECK(host.passCount("rays.top_level") == 1);
        different = differences(traced, before);
        found.pixels = differences(traced, drawn(host, "ray_traced"));
        CHECK(found.pixels <= 2);
    }
    CHECK(different > 100); // the shadow has grown
}

TEST_CASE_FIXTURE(DeviceTest, "casters of other masks do not cast, though eight bits hold the same of both")
{
    if (!canTrace()) return;
    Scene scene = smallScene();
    scene.lights.push_back(scene.lights[0]); // the casters of both are traced in one frame
    Host host(scene);
    for (size_t i = 1; i < host.instances.size(); ++i)
        host.require(gnSetInstanceCasterMask(host.context, host.instances[i], 0x100));
    const uint32_t masks[] = {0x1, 0x100};
    for (size_t i = 0; i < 2; ++i) {
        GnLightInfo light = demo::toGnLight(host.scene.lights[i], demo::lightAt(host.scene.lights[i], 0.0));
        light.casterMask = masks[i];
        host.require(gnUpdateLight(host.context, host.lights[i], &light));
    }
    const std::vector<Image8> traced = drawn(host, kTraced);
    CHECK(dark(traced[0]) + 100 < dark(traced[1])); // what faces away is dark in both
    CHECK(differences(traced, drawn(host, "ray_traced")) <= 2);
}

TEST_CASE_FIXTURE(DeviceTest, "a light may be traced before anything casts for it")
{
    if (!canTrace()) return;
    Host host(smallScene());
    const auto setMasks = [&host](uint32_t mask) {
        for (const GnInstance instance : host.instances)
            host.require(gnSetInstanceCasterMask(host.context, instance, mask));
    };
    GnLightInfo light = demo::toGnLight(host.scene.lights[0], demo::lightAt(host.scene.lights[0], 0.0));
    light.casterMask = 0x1;
    host.require(gnUpdateLight(host.context, host.lights[0], &light));
    setMasks(0x100);
    const Apart none = apart(host);
    CHECK(none.pixels == 0);
    setMasks(0x1);
    const Apart all = apart(host);
    CHECK(all.pixels <= 2);
    CHECK(all.dark > none.dark + 100);
}

TEST_CASE_FIXTURE(DeviceTest, "lights with casters that only the host can judge are served by others, which is said")
{
    if (!canTrace()) return;
    Scene scene = smallScene();
    scene.instances[kBall].alphaTested = true;
    Host host(scene);
    host.require(gnWarmUp(host.context)); // the others, too
    host.pinAll(kTraced);
    host.require(host.draw());
    CHECK(host.decision(0).reason != GN_REASON_PINNED);
    CHECK(host.explanation(0).find("ray_query: out, casters in range are alpha-tested by pfnOpacity") !=
          std::string::npos);
    CHECK(dark(host.pictures()[0]) > 500);
}

TEST_CASE_FIXTURE(DeviceTest, "large meshes are built over several frames, which another method serves")
{
    if (!canTrace()) return;
    Scene scene = smallScene();
    for (const size_t mesh : {size_t{0}, kBall}) { // more triangles than a frame builds, each
        const std::string name = scene.meshes[mesh].name;
        scene.meshes[mesh] = mesh == 0 ? demo::makePlane({.width = 10.0f, .depth = 10.0f, .columns = 400, .rows = 400})
                                       : demo::makeSphere({.radius = 0.5f, .slices = 512, .stacks = 300});
        scene.meshes[mesh].name = name;
    }
    Host host(scene, {.flags = 0});
    host.pinAll(kTraced);
    uint32_t frames = 0;
    do {
        host.require(host.draw());
        if (host.decision(0).reason == GN_REASON_PINNED) break;
        CHECK(host.passCount("rays.meshes") <= 1);
        CHECK(host.explanation(0).find("casters that the device has not built yet") != std::string::npos);
    } while (++frames < 50);
    CHECK(frames == 2);
    Host whole(scene); // builds what is missing in its first frame
    CHECK(differences(host.pictures(), drawn(whole, kTraced)) == 0);
    CHECK(dark(host.pictures()[0]) > 500);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "two lights that each want as much built as fits a frame are traced one frame after the other")
{
    if (!canTrace()) return;
    Scene scene = smallScene();
    for (const size_t mesh : {kBall, size_t{2}}) {
        const std::string name = scene.meshes[mesh].name;
        scene.meshes[mesh] = demo::makeSphere({.radius = 0.7f, .slices = 512, .stacks = 200}); // 204 000 triangles
        scene.meshes[mesh].name = name;
    }
    scene.lights.clear(); // each has one of them in its cone
    for (const size_t each : {size_t{1}, size_t{2}}) {
        const glm::dvec3 at = scene.instances[each].pose.position;
        scene.lights.push_back(spotLight(each == 1 ? "left" : "right", at + glm::dvec3(0.0, 5.0, 0.0), at, true));
        scene.lights.back().outerAngle = 0.2f;
        scene.lights.back().innerAngle = 0.15f;
    }
    Host host(scene, {.flags = 0});
    host.pinAll(kTraced);
    host.require(host.draw());
    CHECK(host.decision(0).reason == GN_REASON_PINNED);
    CHECK(host.decision(1).reason != GN_REASON_PINNED);
    CHECK(host.explanation(1).find("casters that the device has not built yet") != std::string::npos);
    host.require(host.draw());
    for (size_t light = 0; light < 2; ++light)
        CHECK(host.decision(light).reason == GN_REASON_PINNED);
    CHECK(dark(host.pictures()[0]) > 100);
    CHECK(differences(host.pictures(), drawn(host, "ray_traced")) <= 2);
}

TEST_CASE_FIXTURE(DeviceTest, "a light whose casters' structures have no room is served by another method")
{
    if (!canTrace()) return;
    Scene scene = smallScene();
    const std::string name = scene.meshes[kBall].name;
    scene.meshes[kBall] = demo::makeSphere({.radius = 0.5f, .slices = 512, .stacks = 300});
    scene.meshes[kBall].name = name;
    Host host(scene, {.context = [](GnContextCreateInfo& info) { info.memoryLimit = 24u << 20; }});
    host.require(gnWarmUp(host.context)); // the others, too
    host.pinAll(kTraced);
    host.require(host.draw());
    const std::vector<std::string> messages = host.takeMessages();
    REQUIRE(host.decision(0).pMethod);
    CHECK(std::string(host.decision(0).pMethod) != kTraced);
    CHECK(std::ranges::any_of(messages, [](const std::string& message) {
        return message.find("method 'ray_query': memory: needs") != std::string::npos;
    }));
    CHECK(dark(host.pictures()[0]) > 500);
}

TEST_CASE_FIXTURE(DeviceTest, "structures of meshes that stand still give back what their builds left unused")
{
    if (!canTrace()) return;
    Scene scene = smallScene();
    const std::string name = scene.meshes[kBall].name;
    scene.meshes[kBall] = demo::makeSphere({.radius = 0.5f, .slices = 256, .stacks = 128});
    scene.meshes[kBall].name = name;
    Host host(scene, wasteful());
    const std::vector<Image8> first = drawn(host, kTraced);
    const size_t count = bottomLevels.size();
    const VkDeviceSize built = bottomBytes();
    settle(host);
    CHECK(bottomLevels.size() == 2 * count);
    CHECK(differences(first, drawn(host, kTraced)) == 0);
    for (int i = 0; i < 70; ++i) // the pool keeps for a second what nobody uses
        host.require(host.draw());
    MESSAGE(count << " structures: " << built << " bytes as built, " << bottomBytes() << " as copies");
    CHECK(bottomLevels.size() == count);
    CHECK(100 * bottomBytes() < 51 * built); // half, and what sizes are rounded up by
    CHECK(differences(first, drawn(host, kTraced)) == 0);
    CHECK(host.passCount("rays.meshes") == 0);
}

namespace {

/// The sun straight above a floor and a lattice of triangles of 1/8 m between them, and a camera straight above them,
/// without perspective. Its pixels are 1/16 m wide, and their centres lie above corners, and in the middle of edges
/// along both axes and along the diagonal: all numbers are multiples of powers of two.
struct Lattice {
    static constexpr VkExtent2D kExtent{128, 64};
    static constexpr uint32_t kCells = 128; ///< Along a side of 16 m.

    static Scene scene(bool hole)
    {
        Scene scene = smallScene();
        demo::Mesh lattice = demo::makePlane({.width = 16.0f, .depth = 16.0f, .columns = kCells, .rows = kCells});
        lattice.name = scene.meshes[kBall].name;
        if (hole) { // the two triangles of a cell in the middle of the picture
            const auto at = lattice.indices.begin() + 6 * (kCells / 2 * kCells + kCells / 2);
            lattice.indices.erase(at, at + 6);
        }
        scene.meshes[kBall] = std::move(lattice);
        scene.instances.resize(2);
        scene.instances[kBall].pose = {};
        scene.instances[kBall].pose.position = {1.0 / 32.0, 2.0, 1.0 / 32.0};
        demo::Light& sun = scene.lights[0];
        sun.kind = demo::LightKind::Directional;
        sun.direction = {0.0, -1.0, 0.0};
        sun.range = sun.innerAngle = sun.outerAngle = 0.0f;
        return scene;
    }
    /// Right is x, down is z.
    static void lookDown(demo::CameraMatrices& camera)
    {
        constexpr float nearPlane = 1.0f, farPlane = 31.0f;
        camera.eye = {0.0, 8.0, 0.0};
        camera.viewFromWorld = glm::mat3(1, 0, 0, 0, 0, 1, 0, -1, 0); // columns
        glm::mat4& p = camera.projection;
        p = glm::mat4(0.0f);
        p[0][0] = 2.0f / 8.0f;
        p[1][1] = -2.0f / 4.0f;
        p[2][2] = 1.0f / (farPlane - nearPlane);
        p[3][2] = farPlane / (farPlane - nearPlane);
        p[3][3] = 1.0f;
        camera.clipFromEye = p * glm::mat4(camera.viewFromWorld);
    }
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "rays through edges and corners that triangles share are stopped by one of them")
{
    if (!canTrace()) return;
    const FrameOptions above{.lens = &Lattice::lookDown, .adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) {
                                 views[0].depthConvention = GN_DEPTH_REVERSED;
                             }};
    for (const bool hole : {false, true}) {
        Host host(Lattice::scene(hole), {.extent = Lattice::kExtent});
        host.hide(kBall); // the camera sees the floor
        for (const char* name : {kTraced, "ray_traced"}) {
            CAPTURE(std::string(name));
            for (const glm::dvec3& direction : {glm::dvec3(0.0, -1.0, 0.0), glm::dvec3(0.3, -1.0, -0.2)}) {
                host.scene.lights[0].direction = glm::normalize(direction);
                host.pinAll(name);
                host.require(host.draw(above));
                REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
                const Image8 picture = host.pictures()[0];
                const size_t through = picture.texels.size() - dark(picture);
                CAPTURE(through);
                CHECK(dark(picture) > 8000); // of 8192
                // Straight through the hole goes the middle of its diagonal alone; it is four pixels large.
                CHECK((hole ? through >= 1 && through <= 6 : through == 0));
            }
        }
    }
}
