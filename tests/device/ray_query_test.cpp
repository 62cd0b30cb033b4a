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
    const Host host(smallScene(), {.warmUp = false});
    const std::string why = unavailable(host.context);
    if (!why.empty()) MESSAGE(why);
    return why.empty();
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
