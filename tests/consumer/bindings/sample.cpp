// A host in C++20 that has the installed package and gnomon.hpp. First runs the example at its head, which the test
// takes out of it (gnomon_example.hpp), then looks at results, spans and handles. Prints the decision, as the other
// samples do.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "device.h"
#include "gnomon_example.hpp"

static void require(bool holds, const char* what)
{
    if (holds) return;
    std::fprintf(stderr, "not so: %s\n", what);
    std::exit(1);
}
#define REQUIRE(condition) require(condition, #condition)

struct Vertex {
    float x, y, z;
    float anything;
};

static std::vector<Vertex> floorAndSail()
{
    return {{-9, 0, -9, 0}, {-9, 0, 9, 0}, {9, 0, 9, 0}, {-9, 0, -9, 0},  {9, 0, 9, 0},
            {9, 0, -9, 0},  {-1, 1, 0, 0}, {1, 1, 0, 0}, {0, 1, -0.5f, 0}};
}

static GnViewFrame lookingDown(const ConsumerDevice& device, const gn::View& view)
{
    GnViewFrame camera{.view = view.get(),
                       .eye = {0.0, 4.0, 0.0},
                       .viewFromWorld = {1, 0, 0, 0, 0, -1, 0, 1, 0},
                       .depthImage = device.depth,
                       .depthView = device.depthView,
                       .depthFormat = VK_FORMAT_D32_SFLOAT,
                       .imageExtent = {CONSUMER_SIZE, CONSUMER_SIZE}};
    camera.projection[0] = 2.5f;
    camera.projection[5] = -2.5f;
    camera.projection[11] = -1.0f;
    camera.projection[14] = 0.1f;
    return camera;
}

static void checkResults(const gn::Context& context)
{
    const gn::Status refused = context.loadShippedRules("nobody's");
    REQUIRE(!refused && refused.status() == GN_ERROR_OUT_OF_RANGE);
    REQUIRE(std::strstr(refused.message(), "nobody's"));
    bool thrown = false;
    try {
        context.loadShippedRules("nobody's").require();
    } catch (const gn::Failure& failure) {
        thrown = failure.status() == GN_ERROR_OUT_OF_RANGE && std::strstr(failure.what(), "nobody's");
    }
    REQUIRE(thrown);
    const gn::Result mesh = context.createMesh(std::span<const Vertex>());
    REQUIRE(mesh.status() == GN_ERROR_NULL_ARGUMENT && !*mesh);
}

static void checkSpans(const gn::Context& context, const Shadows& shadows)
{
    const uint32_t count = *context.methodCount();
    std::vector<GnMethodInfo> methods(count);
    REQUIRE(count > 1 && context.methods(methods)->size() == count);
    const gn::Result few = context.methods(std::span(methods).first(1));
    REQUIRE(few.status() == GN_INCOMPLETE && few->size() == 1);
    REQUIRE(context.methods({}).status() == GN_INCOMPLETE && context.methods({})->empty());
    std::vector<GnCandidate> candidates(count);
    REQUIRE(shadows.view.candidates(shadows.sun, candidates)->size() == count);

    std::vector<char> text(*shadows.view.explanationSize(shadows.sun));
    REQUIRE(shadows.view.explain(shadows.sun, text)->size() + 1 == text.size());
    const std::string_view cut = *shadows.view.explain(shadows.sun, std::span(text).first(10));
    REQUIRE(cut.size() == 9);
    std::vector<std::byte> bytes(*shadows.view.decisionLogSize());
    REQUIRE(shadows.view.decisionLog(bytes)->size() == bytes.size());
    const gn::Result short1 = shadows.view.decisionLog(std::span(bytes).first(1));
    REQUIRE(short1.status() == GN_INCOMPLETE && short1->empty());
}

static void checkHandles(Shadows& shadows)
{
    const GnView handle = shadows.view.get();
    gn::View moved = std::move(shadows.view);
    REQUIRE(moved.get() == handle && !shadows.view);
    shadows.view = std::move(moved);
    REQUIRE(shadows.view.visibility()->layerCount == 16);
    gn::Light lamp = shadows.context.createLight({.type = GN_LIGHT_TYPE_POINT, .position = {0, 3, 0}}).value();
    const GnLight gone = lamp.get();
    lamp.reset();
    REQUIRE(gnSetLightMethod(shadows.context.get(), gone, nullptr) == GN_ERROR_INVALID_HANDLE);
}

static int run(const ConsumerDevice& device)
{
    const GnContextCreateInfo info{.instance = device.instance,
                                   .physicalDevice = device.gpu,
                                   .device = device.device,
                                   .queue = device.queue,
                                   .apiVersion = VK_API_VERSION_1_3,
                                   .pEnabledFeatures = device.pFeatures,
                                   .pfnGetInstanceProcAddr = device.pfnGetInstanceProcAddr};
    const std::vector<Vertex> vertices = floorAndSail();
    Shadows shadows = startShadows<Vertex>(info, vertices);
    const char* method = drawShadows(shadows, lookingDown(device, shadows.view), 1, 0);
    std::printf("decision: %s, reason %d\n", method, shadows.view.decision(shadows.sun)->reason);
    checkResults(shadows.context);
    checkSpans(shadows.context, shadows);
    checkHandles(shadows);
    return 0;
}

int main()
{
    ConsumerDevice device;
    int result = consumerOpen(&device);
    if (result == 0) {
        try {
            result = run(device);
        } catch (const gn::Failure& failure) {
            std::fprintf(stderr, "%s: %s\n", gn::name(failure.status()), failure.what());
            result = 1;
        }
    }
    consumerClose(&device);
    return result;
}
