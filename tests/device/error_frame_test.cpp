// Frames, views and calls that cannot be.
#include <algorithm>
#include <cmath>
#include <limits>

#include "device/error_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

using Views = std::vector<GnViewFrame>;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

struct FrameCase {
    const char* what;
    std::function<void(GnFrameInfo&, Views&)> change;
    GnResult expected;
    const char* named;
};

const GnLight kForeignLight = (GnLight)0x123456789abcull;
const GnSemaphorePoint kNoSemaphore{};

/// A projection that could be, in place of the host's.
void orthographic(GnViewFrame& view)
{
    const float projection[16] = {0.2f, 0, 0, 0, 0, -0.2f, 0, 0, 0, 0, 0.05f, 0, 0, 0, 1, 1};
    std::copy_n(projection, 16, view.projection);
    view.depthConvention = GN_DEPTH_REVERSED;
}

/// Some image as motion vectors; the frame ends before it is read.
void moves(GnViewFrame& view, VkFormat format)
{
    view.motionImage = view.normalImage;
    view.motionView = view.normalView;
    view.motionFormat = format;
}

// Every row changes one thing of a good frame.
const FrameCase kFrameCases[] = {
    {"frame 0", [](GnFrameInfo& f, Views&) { f.frame = 0; }, GN_ERROR_FRAME_ORDER, "frame is 0"},
    {"the same frame again", [](GnFrameInfo& f, Views&) { --f.frame; }, GN_ERROR_FRAME_ORDER, "frame is"},
    {"a frame left out", [](GnFrameInfo& f, Views&) { ++f.frame; }, GN_ERROR_FRAME_ORDER, "frame is"},
    {"completed before it began", [](GnFrameInfo& f, Views&) { f.completedFrame = f.frame; }, GN_ERROR_FRAME_ORDER,
     "completedFrame"},
    {"too many in flight", [](GnFrameInfo& f, Views&) { f.completedFrame = f.frame > 3 ? f.frame - 4 : 0; },
     GN_ERROR_FRAME_ORDER, "completedFrame is"},
    {"budget NaN", [](GnFrameInfo& f, Views&) { f.budgetMs = kNaN; }, GN_ERROR_NOT_A_NUMBER, "budgetMs"},
    {"budget infinite", [](GnFrameInfo& f, Views&) { f.budgetMs = kInf; }, GN_ERROR_INFINITE, "budgetMs"},
    {"budget negative", [](GnFrameInfo& f, Views&) { f.budgetMs = -1.5f; }, GN_ERROR_OUT_OF_RANGE, "-1.5"},
    {"a flag that is none", [](GnFrameInfo& f, Views&) { f.flags = GN_FRAME_TIMED_BIT | 0x40; }, GN_ERROR_OUT_OF_RANGE,
     "GnFrameInfo::flags has the bits 64"},
    {"views null", [](GnFrameInfo& f, Views&) { f.pViews = nullptr; }, GN_ERROR_NULL_ARGUMENT, "pViews"},
    {"waits null", [](GnFrameInfo& f, Views&) { f.waitCount = 1; }, GN_ERROR_NULL_ARGUMENT, "pWaits"},
    {"signals null", [](GnFrameInfo& f, Views&) { f.signalCount = 1; }, GN_ERROR_NULL_ARGUMENT, "pSignals"},
    {"a wait for no semaphore",
     [](GnFrameInfo& f, Views&) {
         f.pWaits = &kNoSemaphore;
         f.waitCount = 1;
     },
     GN_ERROR_NULL_ARGUMENT, "pWaits[0].semaphore"},
    {"a signal to no semaphore",
     [](GnFrameInfo& f, Views&) {
         f.pSignals = &kNoSemaphore;
         f.signalCount = 1;
     },
     GN_ERROR_NULL_ARGUMENT, "pSignals[0].semaphore"},
    {"no view", [](GnFrameInfo&, Views& v) { v[0].view = VK_NULL_HANDLE; }, GN_ERROR_INVALID_HANDLE, "pViews[0]"},
    {"a view twice",
     [](GnFrameInfo& f, Views& v) {
         v.push_back(v[0]);
         f.pViews = v.data();
         f.viewCount = 2;
     },
     GN_ERROR_OUT_OF_RANGE, "twice"},
    {"eye NaN", [](GnFrameInfo&, Views& v) { v[0].eye[2] = std::nan(""); }, GN_ERROR_NOT_A_NUMBER, "eye[2]"},
    {"eye infinite", [](GnFrameInfo&, Views& v) { v[0].eye[0] = HUGE_VAL; }, GN_ERROR_INFINITE, "eye[0]"},
    {"eye beyond everything", [](GnFrameInfo&, Views& v) { v[0].eye[0] = 1e200; }, GN_ERROR_OUT_OF_RANGE, "eye[0]"},
    {"rotation NaN", [](GnFrameInfo&, Views& v) { v[0].viewFromWorld[7] = kNaN; }, GN_ERROR_NOT_A_NUMBER,
     "viewFromWorld[7]"},
    {"rotation scaled", [](GnFrameInfo&, Views& v) { v[0].viewFromWorld[0] *= 2.0f; }, GN_ERROR_OUT_OF_RANGE,
     "viewFromWorld"},
    {"projection NaN", [](GnFrameInfo&, Views& v) { v[0].projection[5] = kNaN; }, GN_ERROR_NOT_A_NUMBER,
     "projection[5]"},
    {"projection infinite", [](GnFrameInfo&, Views& v) { v[0].projection[0] = kInf; }, GN_ERROR_INFINITE,
     "projection[0]"},
    {"an orthographic projection of rank 3",
     [](GnFrameInfo&, Views& v) {
         orthographic(v[0]);
         v[0].projection[10] = 0.0f;
     },
     GN_ERROR_OUT_OF_RANGE, "projection[10] is 0"},
    {"an orthographic projection that is hardly of rank 4",
     [](GnFrameInfo&, Views& v) {
         orthographic(v[0]);
         v[0].projection[5] = 1e-30f;
     },
     GN_ERROR_OUT_OF_RANGE, "projection[5] is 1.00000000"},
    {"orthographic depth across the view",
     [](GnFrameInfo&, Views& v) {
         orthographic(v[0]);
         v[0].projection[2] = 0.5f;
     },
     GN_ERROR_OUT_OF_RANGE, "projection[2] is 0.5"},
    {"orthographic and infinite",
     [](GnFrameInfo&, Views& v) {
         orthographic(v[0]);
         v[0].depthConvention = GN_DEPTH_REVERSED_INFINITE;
     },
     GN_ERROR_OUT_OF_RANGE, "depthConvention 0"},
    {"half a perspective", [](GnFrameInfo&, Views& v) { v[0].projection[15] = 0.5f; }, GN_ERROR_OUT_OF_RANGE,
     "projection[11] is -1"},
    {"a perspective of rank 3", [](GnFrameInfo&, Views& v) { v[0].projection[14] = 0.0f; }, GN_ERROR_OUT_OF_RANGE,
     "projection[14] is 0"},
    {"the wrong depth convention", [](GnFrameInfo&, Views& v) { v[0].depthConvention = GN_DEPTH_STANDARD; },
     GN_ERROR_OUT_OF_RANGE, "depthConvention 2"},
    {"no such depth convention",
     [](GnFrameInfo&, Views& v) { v[0].depthConvention = static_cast<GnDepthConvention>(9); }, GN_ERROR_OUT_OF_RANGE,
     "depthConvention is 9"},
    {"no depth", [](GnFrameInfo&, Views& v) { v[0].depthImage = VK_NULL_HANDLE; }, GN_ERROR_NULL_ARGUMENT,
     "depthImage"},
    {"depth that is colour", [](GnFrameInfo&, Views& v) { v[0].depthFormat = VK_FORMAT_R32_SFLOAT; },
     GN_ERROR_OUT_OF_RANGE, "depthFormat 100"},
    {"three samples", [](GnFrameInfo&, Views& v) { v[0].imageSamples = 3; }, GN_ERROR_OUT_OF_RANGE,
     "imageSamples is 3"},
    {"sixteen samples", [](GnFrameInfo&, Views& v) { v[0].imageSamples = 16; }, GN_ERROR_OUT_OF_RANGE,
     "imageSamples is 16"},
    {"a sample out of range",
     [](GnFrameInfo&, Views& v) {
         v[0].imageSamples = 4;
         v[0].imageSample = 4;
     },
     GN_ERROR_OUT_OF_RANGE, "imageSample is 4 of 4"},
    {"a layer out of range",
     [](GnFrameInfo&, Views& v) {
         v[0].imageLayers = 2;
         v[0].imageLayer = 2;
     },
     GN_ERROR_OUT_OF_RANGE, "imageLayer is 2"},
    {"a layer of no array", [](GnFrameInfo&, Views& v) { v[0].imageLayer = 1; }, GN_ERROR_OUT_OF_RANGE,
     "imageLayer is 1"},
    {"no such encoding", [](GnFrameInfo&, Views& v) { v[0].normalEncoding = static_cast<GnNormalEncoding>(7); },
     GN_ERROR_OUT_OF_RANGE, "normalEncoding is 7"},
    {"half a normal image", [](GnFrameInfo&, Views& v) { v[0].normalView = VK_NULL_HANDLE; }, GN_ERROR_NULL_ARGUMENT,
     "normalView"},
    {"normals in integers", [](GnFrameInfo&, Views& v) { v[0].normalFormat = VK_FORMAT_R8G8B8A8_UINT; },
     GN_ERROR_UNSUPPORTED, "normalFormat 41"},
    {"normals in depth", [](GnFrameInfo&, Views& v) { v[0].normalFormat = VK_FORMAT_D32_SFLOAT; },
     GN_ERROR_OUT_OF_RANGE, "normalFormat 126"},
    {"half a motion image", [](GnFrameInfo&, Views& v) { v[0].motionImage = v[0].normalImage; }, GN_ERROR_NULL_ARGUMENT,
     "motionView"},
    {"motion in integers", [](GnFrameInfo&, Views& v) { moves(v[0], VK_FORMAT_R16G16_SNORM); }, GN_ERROR_OUT_OF_RANGE,
     "motionFormat 78"},
    {"depth of motion without a channel",
     [](GnFrameInfo&, Views& v) {
         moves(v[0], VK_FORMAT_R16G16_SFLOAT);
         v[0].motionScale[2] = 2.5f;
     },
     GN_ERROR_OUT_OF_RANGE, "motionScale[2] is 2.5, but motionFormat 83"},
    {"motion of no scale",
     [](GnFrameInfo&, Views& v) {
         moves(v[0], VK_FORMAT_R16G16_SFLOAT);
         v[0].motionScale[1] = kNaN;
     },
     GN_ERROR_NOT_A_NUMBER, "motionScale[1] is NaN"},
    {"no pixels", [](GnFrameInfo&, Views& v) { v[0].imageExtent.width = 0; }, GN_ERROR_EMPTY, "0x180"},
    {"more pixels than any device has", [](GnFrameInfo&, Views& v) { v[0].imageExtent.height = 1u << 30; },
     GN_ERROR_OUT_OF_RANGE, "1073741824"},
    {"area outside the image",
     [](GnFrameInfo&, Views& v) {
         v[0].renderArea = {{300, 0}, {100, 100}};
     },
     GN_ERROR_OUT_OF_RANGE, "renderArea"},
    {"area left of the image",
     [](GnFrameInfo&, Views& v) {
         v[0].renderArea = {{-1, 0}, {100, 100}};
     },
     GN_ERROR_OUT_OF_RANGE, "renderArea"},
    {"lights null", [](GnFrameInfo&, Views& v) { v[0].pLights = nullptr; }, GN_ERROR_NULL_ARGUMENT, "pLights"},
    {"a light of nobody", [](GnFrameInfo&, Views& v) { v[0].pLights = &kForeignLight; }, GN_ERROR_INVALID_HANDLE,
     "pLights[0]"},
    {"a light twice",
     [](GnFrameInfo&, Views& v) {
         static GnLight twice[2];
         twice[0] = twice[1] = v[0].pLights[0];
         v[0].pLights = twice;
         v[0].lightCount = 2;
     },
     GN_ERROR_OUT_OF_RANGE, "pLights[1]"},
    {"more lights than the view holds",
     [](GnFrameInfo&, Views& v) {
         static std::vector<GnLight> many;
         many.assign(17, v[0].pLights[0]);
         v[0].pLights = many.data();
         v[0].lightCount = 17;
     },
     GN_ERROR_TOO_MANY, "17 lights"},
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a frame that cannot be is refused before anything changes, submitted, recorded or begun")
{
    Watched watched;
    watched.host.draw(4, {}); // past the first frames, where little is in flight
    for (const FrameCase& c : kFrameCases)
        for (const Call call : {Call::submit, Call::record, Call::begin}) {
            const std::string named = c.named;
            if (call == Call::record && (named.starts_with("pWaits") || named.starts_with("pSignals")))
                continue; // refused as such
            const GnResult result = watched.host.draw({.call = call, .adjust = c.change});
            if (result >= 0 && call == Call::begin) watched.host.require(watched.host.finish(UINT64_MAX));
            watched.refused(c.what, result, c.expected, c.named);
        }
}

TEST_CASE_FIXTURE(DeviceTest, "calls out of order are refused")
{
    Watched watched;
    Host& host = watched.host;
    watched.refused("finish without begin", gnFinishShadows(host.context, 0), GN_ERROR_FRAME_ORDER, "gnBeginShadows");
    GnView view = VK_NULL_HANDLE;
    host.require(gnCreateView(host.context, nullptr, &view));
    GnVisibility visibility{};
    watched.refused("visibility of no frame", gnGetVisibility(host.context, view, &visibility), GN_ERROR_FRAME_ORDER,
                    "view");
    GnDecision decision{};
    watched.refused("decision of no frame", gnGetDecision(host.context, view, host.lights[0], &decision),
                    GN_ERROR_INVALID_HANDLE, "view");
    host.pinAll("ray_traced");
    host.require(host.draw({.call = Call::begin}));
    GnFrameInfo next{};
    next.frame = host.frame() + 1;
    next.completedFrame = host.frame() - 1;
    CHECK(gnSubmitShadows(host.context, &next) == GN_ERROR_FRAME_ORDER);
    CHECK(host.lastError().find("gnFinishShadows") != std::string::npos);
    host.require(host.finish(UINT64_MAX));
    host.pinAll("shadow_map");
    host.require(host.draw());
    CHECK(differences(host.pictures(), watched.good) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "null where something is needed is an error of its own, in every call")
{
    Watched watched;
    const GnContext c = watched.host.context;
    const GnView view = watched.host.views[0];
    const GnLight light = watched.host.lights[0];
    GnMesh mesh = VK_NULL_HANDLE;
    GnInstance instance = VK_NULL_HANDLE;
    GnMeshCreateInfo meshInfo{};
    meshInfo.positionCount = 3;
    GnInstanceCreateInfo instanceInfo{};
    const auto null = [&](const char* named, GnResult result) {
        watched.refused(named, result, GN_ERROR_NULL_ARGUMENT, named);
    };
    null("pCreateInfo", gnCreateMesh(c, nullptr, &mesh));
    null("pMesh", gnCreateMesh(c, &meshInfo, nullptr));
    null("pPositions", gnCreateMesh(c, &meshInfo, &mesh));
    null("pPositions", gnUpdateMeshPositions(c, watched.host.meshes[0], nullptr, 8, 0));
    null("pCreateInfo", gnCreateInstance(c, nullptr, &instance));
    null("pInstance", gnCreateInstance(c, &instanceInfo, nullptr));
    null("pInfo", gnCreateLight(c, nullptr, nullptr));
    null("pView", gnCreateView(c, nullptr, nullptr));
    null("pFrame", gnSubmitShadows(c, nullptr));
    null("pFrame", gnBeginShadows(c, nullptr));
    null("pVisibility", gnGetVisibility(c, view, nullptr));
    null("pMap", gnGetLightMap(c, light, nullptr));
    null("pShadows", gnGetSampledShadows(c, view, nullptr, nullptr));
    null("pCount", gnEnumerateMethods(c, nullptr, nullptr));
    null("pName", gnAddMethod(c, nullptr, "shadow_map"));
    null("pMethod", gnSetMethodSetting(c, nullptr, "filter", 1.0));
    null("pText", gnLoadRules(c, nullptr, 0, "none"));
    null("pDecision", gnGetDecision(c, view, light, nullptr));
    null("pSize", gnExplain(c, view, light, nullptr, nullptr, nullptr));
    null("pCount", gnGetPassTimings(c, nullptr, nullptr, nullptr));
    null("pCount", gnGetFramePasses(c, nullptr, nullptr));
    null("pStats", gnGetFrameStats(c, nullptr));
    // What a call gives back is zero after it failed, for want of a context as well.
    GnVisibility visibility{};
    visibility.revision = 7;
    uint32_t count = 7;
    size_t size = 7;
    uint64_t frame = 7;
    CHECK(gnGetVisibility(nullptr, view, &visibility) == GN_ERROR_NULL_ARGUMENT);
    CHECK(visibility.revision == 0);
    CHECK(gnGetPassTimings(nullptr, &frame, &count, nullptr) == GN_ERROR_NULL_ARGUMENT);
    CHECK(frame + count == 0);
    CHECK(gnExplain(c, VK_NULL_HANDLE, light, nullptr, &size, nullptr) == GN_ERROR_INVALID_HANDLE);
    CHECK(size == 0);
    CHECK(gnWarmUp(nullptr) == GN_ERROR_NULL_ARGUMENT);
    CHECK(std::string(gnGetLastError(nullptr)).size() > 0);
    gnDestroyContext(nullptr);
}

TEST_CASE_FIXTURE(DeviceTest, "a context that cannot be is refused with a message and no handle")
{
    struct Heard {
        std::string text;
        static void GN_CALL on(const GnMessage* message, void* user)
        {
            static_cast<Heard*>(user)->text = message->pText;
        }
    };
    const auto create = [](auto change, GnResult expected, const char* named) {
        Heard heard;
        GnContextCreateInfo info = device().contextInfo();
        info.pfnMessage = &Heard::on;
        info.pUserData = &heard;
        change(info);
        GnContext context = reinterpret_cast<GnContext>(&heard);
        CAPTURE(std::string(named));
        CHECK(gnCreateContext(&info, &context) == expected);
        CHECK(context == nullptr);
        CHECK_MESSAGE(heard.text.find(named) != std::string::npos, heard.text);
    };
    create([](GnContextCreateInfo& i) { i.device = VK_NULL_HANDLE; }, GN_ERROR_NULL_ARGUMENT, "device");
    create([](GnContextCreateInfo& i) { i.queue = VK_NULL_HANDLE; }, GN_ERROR_NULL_ARGUMENT, "queue");
    create([](GnContextCreateInfo& i) { i.pEnabledFeatures = nullptr; }, GN_ERROR_NULL_ARGUMENT, "pEnabledFeatures");
    create([](GnContextCreateInfo& i) { i.pfnGetInstanceProcAddr = nullptr; }, GN_ERROR_NULL_ARGUMENT,
           "pfnGetInstanceProcAddr");
    create([](GnContextCreateInfo& i) { i.framesInFlight = 9; }, GN_ERROR_OUT_OF_RANGE, "9");
    create([](GnContextCreateInfo& i) { i.flags = 0x100; }, GN_ERROR_OUT_OF_RANGE, "flags has the bits 256");
    static const uint32_t families[] = {0, 77};
    create(
        [](GnContextCreateInfo& i) {
            i.pVisibilityQueueFamilies = families;
            i.visibilityQueueFamilyCount = 2;
            i.pName = "the second window";
        },
        GN_ERROR_OUT_OF_RANGE, "the second window: pVisibilityQueueFamilies[1] is 77");
    create([](GnContextCreateInfo& i) { i.apiVersion = VK_API_VERSION_1_1; }, GN_ERROR_OUT_OF_RANGE, "apiVersion");
    create([](GnContextCreateInfo& i) { i.pfnLockQueue = [](VkQueue, void*) {}; }, GN_ERROR_NULL_ARGUMENT,
           "pfnUnlockQueue");
    static const VkPhysicalDeviceFeatures2 bare{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    create([](GnContextCreateInfo& i) { i.pEnabledFeatures = &bare; }, GN_ERROR_FEATURE_MISSING, "dynamicRendering");
    CHECK(gnCreateContext(nullptr, nullptr) == GN_ERROR_NULL_ARGUMENT);
}

TEST_CASE_FIXTURE(DeviceTest, "methods and settings that do not exist are named")
{
    Watched watched;
    const GnContext c = watched.host.context;
    const GnLight light = watched.host.lights[0];
    watched.refused("method", gnSetLightMethod(c, light, "magic"), GN_ERROR_UNKNOWN_METHOD, "'magic'");
    watched.refused("kind of light", gnSetLightMethod(c, light, "cube_map"), GN_ERROR_UNKNOWN_METHOD, "'lamp'");
    watched.refused("setting", gnSetMethodSetting(c, "shadow_map", "magic", 1.0), GN_ERROR_UNKNOWN_METHOD, "'magic'");
    watched.refused("value", gnSetMethodSetting(c, "shadow_map", "resolution", 1e9), GN_ERROR_OUT_OF_RANGE, "8192");
    watched.refused("fraction", gnSetMethodSetting(c, "shadow_map", "resolution", 12.5), GN_ERROR_OUT_OF_RANGE, "12.5");
    watched.refused("NaN", gnSetMethodSetting(c, "shadow_map", "filter", std::nan("")), GN_ERROR_NOT_A_NUMBER,
                    "filter");
    watched.refused("algorithm", gnAddMethod(c, "mine", "magic"), GN_ERROR_UNKNOWN_METHOD, "'magic'");
    watched.refused("twice", gnAddMethod(c, "shadow_map", "shadow_map"), GN_ERROR_OUT_OF_RANGE, "'shadow_map'");
}
