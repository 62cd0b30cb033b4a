// Meshes and instances from two threads while a third renders. Built with the thread sanitizer this is the test that
// says the promise of the header ("any thread") is kept; see tests/tsan.supp.
#include <atomic>
#include <thread>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr uint32_t kRounds = 60;

/// One thread's work: makes, moves, deforms and removes casters over the floor. Reports the first failure.
GnResult stream(GnContext context, uint32_t seed)
{
    for (uint32_t round = 0; round < kRounds; ++round) {
        const demo::Mesh ball = demo::makeSphere({.radius = 0.3f, .slices = 12 + (round + seed) % 5, .stacks = 8});
        const auto count = static_cast<uint32_t>(ball.positions.size());
        const GnMeshCreateInfo info{.pName = "streamed",
                                    .pPositions = &ball.positions[0].x,
                                    .positionCount = count,
                                    .positionStride = 0,
                                    .indexCount = static_cast<uint32_t>(ball.indices.size()),
                                    .pIndices = ball.indices.data()};
        GnMesh mesh = VK_NULL_HANDLE;
        if (const GnResult made = gnCreateMesh(context, &info, &mesh); made < 0) return made;
        GnInstanceCreateInfo instanceInfo{};
        instanceInfo.mesh = mesh;
        instanceInfo.transform.translation[1] = 2.0;
        GnInstance instance = VK_NULL_HANDLE;
        if (const GnResult made = gnCreateInstance(context, &instanceInfo, &instance); made < 0) return made;
        for (uint32_t step = 0; step < 4; ++step) {
            GnTransform transform{};
            transform.translation[0] = -2.0 + 0.1 * static_cast<double>((round * 4 + step + seed) % 40);
            transform.translation[1] = 2.0;
            if (const GnResult moved = gnSetInstanceTransform(context, instance, &transform); moved < 0) return moved;
            std::this_thread::yield();
        }
        std::vector<glm::vec3> squeezed = ball.positions;
        for (glm::vec3& position : squeezed)
            position.y *= 0.5f;
        if (const GnResult done = gnUpdateMeshPositions(context, mesh, &squeezed[0].x, count, 0); done < 0) return done;
        // Both orders of destruction: an instance may outlive its mesh.
        if (round % 2) gnDestroyMesh(context, mesh);
        gnDestroyInstance(context, instance);
        if (round % 2 == 0) gnDestroyMesh(context, mesh);
    }
    return GN_SUCCESS;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "two threads stream casters while a third renders")
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("bulb", {1.0, 5.0, 2.0}, true));
    // In the background, as hosts run it: topology, trees and pipelines come from workers.
    Host host(scene, {.extent = {160, 90}, .framesInFlight = 3, .flags = 0});
    std::atomic<uint32_t> running{2};
    std::atomic<int> failure{0};
    const auto work = [&](uint32_t seed) {
        if (const GnResult result = stream(host.context, seed); result < 0) failure = result;
        --running;
    };
    std::thread first(work, 1), second(work, 17);
    const std::vector<GnMethodInfo> methods = availableMethods(host.context);
    uint32_t frames = 0;
    while (running > 0 || frames < 12) {
        const GnMethodInfo& method = methods[frames++ % methods.size()];
        for (size_t light = 0; light < host.lights.size(); ++light)
            if (serves(method, host.scene.lights[light].kind)) host.pin(light, method.pName);
        if (host.draw() < 0) break;
    }
    first.join();
    second.join();
    CHECK(failure == 0);
    CHECK(frames >= 12);

    // What they left behind is what was there before.
    host.require(gnWarmUp(host.context));
    Host fresh(scene, {.extent = {160, 90}});
    for (Host* each : {&host, &fresh}) {
        each->pin(0, "stencil_volume");
        each->pin(1, "stencil_volume");
        each->draw(2, {});
    }
    CHECK(differences(host.pictures(), fresh.pictures()) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "every thread hears of its own failures, while others fail")
{
    Host host(smallScene(), {.extent = {64, 36}});
    std::atomic<int> mixed{0};
    const auto fail = [&](uint32_t thread) {
        for (uint32_t round = 0; round < 500; ++round) {
            // Longer than what strings keep within themselves, and of another length each time.
            const std::string name = "mesh of thread " + std::to_string(thread) + std::string(round % 40, '.');
            const float position[3] = {0, 0, 0};
            const uint32_t indices[3] = {0, 0, 1 + round};
            const GnMeshCreateInfo info{.pName = name.c_str(),
                                        .pPositions = position,
                                        .positionCount = 1,
                                        .positionStride = 0,
                                        .indexCount = 3,
                                        .pIndices = indices};
            GnMesh mesh = VK_NULL_HANDLE;
            if (gnCreateMesh(host.context, &info, &mesh) != GN_ERROR_OUT_OF_RANGE) ++mixed;
            if (std::string(gnGetLastError(host.context)).find(name) == std::string::npos) ++mixed;
        }
    };
    std::vector<std::thread> threads;
    for (uint32_t i = 0; i < 4; ++i)
        threads.emplace_back(fail, i);
    for (std::thread& thread : threads)
        thread.join();
    CHECK(mixed == 0);
    CHECK(host.lastError().empty()); // of this thread
}
