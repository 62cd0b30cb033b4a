/// What ray_traced takes beside bare loops over Embree, alternating in one run: its trace stage beside a loop that
/// unprojects from the same depth buffer, and what it adds to a frame beside a loop over rays that lie ready. No test,
/// since machines differ: ninja bench_traced && ./bench_traced [SCENE...]

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <span>
#include <tbb/parallel_for.h>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "demo/program/measure.hpp"
#include "demo/program/receivers.hpp"
#include "runtime/rays/embree.hpp"

using namespace gnomon;
using namespace gnomon::demo;

namespace {

constexpr uint32_t kTile = 4, kRepeats = 60;

void flushDenormals()
{
#if defined(__SSE2__)
    _mm_setcsr(_mm_getcsr() | 0x8040u); // as Embree's manual asks of every thread that traces
#endif
}

/// The casters, two levels as a host with instances has them, world axes relative to the eye.
class BareScene {
public:
    BareScene(const Scene& scene, const SceneState& state, const glm::dvec3& eye)
        : device_(rtcNewDevice(nullptr)), top_(rtcNewScene(device_))
    {
        rtcSetSceneFlags(top_, RTC_SCENE_FLAG_ROBUST);
        for (const Mesh& mesh : scene.meshes)
            trees_.push_back(treeOf(mesh));
        for (size_t i = 0; i < scene.instances.size(); ++i) {
            const Transform& transform = state.instances[i];
            const glm::mat4x3 placed(glm::mat3(transform.linear)[0], glm::mat3(transform.linear)[1],
                                     glm::mat3(transform.linear)[2], glm::vec3(transform.translation - eye));
            const RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
            rtcSetGeometryInstancedScene(instance, trees_[scene.instances[i].mesh]);
            rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &placed[0][0]);
            rtcCommitGeometry(instance);
            rtcAttachGeometry(top_, instance);
            rtcReleaseGeometry(instance);
        }
        rtcCommitScene(top_);
    }
    ~BareScene()
    {
        rtcReleaseScene(top_);
        for (const RTCScene tree : trees_)
            rtcReleaseScene(tree);
        rtcReleaseDevice(device_);
    }
    BareScene(const BareScene&) = delete;
    BareScene& operator=(const BareScene&) = delete;

    RTCScene top() const { return top_; }

private:
    RTCScene treeOf(const Mesh& mesh)
    {
        const RTCScene tree = rtcNewScene(device_);
        rtcSetSceneFlags(tree, RTC_SCENE_FLAG_ROBUST);
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                 sizeof(glm::vec3), mesh.positions.size());
        std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<glm::vec3*>(vertices));
        void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(uint32_t), mesh.triangleCount());
        std::copy(mesh.indices.begin(), mesh.indices.end(), static_cast<uint32_t*>(indices));
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(tree, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(tree);
        return tree;
    }

    RTCDevice device_;
    RTCScene top_;
    std::vector<RTCScene> trees_;
};

/// Sixteen rays and the pixels they are of.
struct Packet {
    RTCRay16 rays;
    alignas(64) int valid[16];
    uint32_t pixels[16];
    uint32_t count;
};

struct View {
    gpu::ViewConstants constants;
    const FrameSurfaces& surfaces;
    uint32_t width, height;
};

/// The ray of a pixel behind those of the packet. @return false: none is needed, and `byte` is the answer
bool addRay(const View& view, const gpu::LightConstants& light, uint32_t x, uint32_t y, Packet& packet, uint8_t& byte)
{
    const float depth = *view.surfaces.depth.at(x, y);
    byte = 255;
    if (depth == view.constants.skyDepth) return false;
    const glm::vec3 viewRay = gpu::viewRayWs(view.constants, {float(x) + 0.5f, float(y) + 0.5f});
    const glm::vec3 receiver = gpu::linearDepth(view.constants, depth) * viewRay;
    if (!gpu::lightReaches(light, receiver)) return false;
    byte = 0;
    const float* n = view.surfaces.normals.at(x, y);
    const glm::vec3 normal = glm::normalize(glm::vec3(n[0], n[1], n[2]));
    if (!(glm::dot(normal, gpu::towardsLightWs(light, receiver)) > 0.0f)) return false;
    const float offset = gpu::receiverOffset(view.constants, light, depth, viewRay, receiver, normal);
    const glm::vec3 origin = receiver + offset * normal;
    const bool directional = light.type == gpu::LIGHT_DIRECTIONAL;
    const glm::vec3 direction = directional ? -glm::vec3(light.directionWs) : glm::vec3(light.positionWs) - origin;
    const uint32_t i = packet.count++;
    packet.rays.org_x[i] = origin.x;
    packet.rays.org_y[i] = origin.y;
    packet.rays.org_z[i] = origin.z;
    packet.rays.dir_x[i] = direction.x;
    packet.rays.dir_y[i] = direction.y;
    packet.rays.dir_z[i] = direction.z;
    packet.rays.tfar[i] = directional ? std::numeric_limits<float>::infinity() : 1.0f - offset / glm::length(direction);
    packet.pixels[i] = y * view.width + x;
    return true;
}

/// Answers a packet and empties it.
void ask(RTCScene scene, Packet& packet, std::span<uint8_t> visibility)
{
    if (packet.count == 0) return;
    EmbreeQuery query;
    for (uint32_t i = 0; i < 16; ++i)
        packet.valid[i] = i < packet.count ? -1 : 0;
    query.occluded(packet.valid, scene, packet.rays);
    for (uint32_t i = 0; i < packet.count; ++i)
        visibility[packet.pixels[i]] = packet.rays.tfar[i] < 0.0f ? 0 : 255;
    packet.count = 0;
}

/// The bare loop: rows of tiles over the cores, full packets in the order of tiles.
template <typename Full>
void overTiles(const View& view, const gpu::LightConstants& light, std::span<uint8_t> visibility, const Full& full)
{
    tbb::parallel_for(0u, (view.height + kTile - 1) / kTile, [&](uint32_t row) {
        flushDenormals();
        Packet packet{};
        std::fill_n(packet.rays.mask, 16, ~0u);
        for (uint32_t left = 0; left < view.width; left += kTile)
            for (uint32_t y = row * kTile; y < std::min(view.height, (row + 1) * kTile); ++y)
                for (uint32_t x = left; x < std::min(view.width, left + kTile); ++x) {
                    uint8_t byte;
                    if (!addRay(view, light, x, y, packet, byte))
                        visibility[y * view.width + x] = byte;
                    else if (packet.count == 16)
                        full(row, packet);
                }
        full(row, packet);
    });
}

template <typename Body>
double milliseconds(const Body& body)
{
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Minima over the repeats, milliseconds for all lights of a frame.
struct Times {
    double trace = 1e30;                ///< The method's host passes.
    double with = 1e30, without = 1e30; ///< A frame with the method and one without shadows.
    double unprojecting = 1e30;         ///< The bare loop from depth and normals.
    double prepared = 1e30;             ///< The bare loop over rays that lie ready.
    double rays = 1e30;                 ///< The method's time inside Embree, all threads.
};

/// All lights of a frame at rest, traced without gnomon.
class BareFrame {
public:
    explicit BareFrame(Session& session)
        : surfaces_{session.renderer.readDepth(), session.renderer.readNormals()},
          view_{
              viewConstants(session.scene, session.renderer.camera(), {surfaces_.depth.width, surfaces_.depth.height}),
              surfaces_, surfaces_.depth.width, surfaces_.depth.height},
          casters_(session.scene, session.renderer.state(), session.renderer.camera().eye)
    {
        for (const uint32_t light : session.renderer.state().present) {
            lights_.push_back(lightConstants(session.scene.lights[light], session.renderer.state().lights[light],
                                             session.renderer.camera().eye));
            visibility_.emplace_back(size_t(view_.width) * view_.height);
            std::vector<std::vector<Packet>> rows((view_.height + kTile - 1) / kTile);
            overTiles(view_, lights_.back(), visibility_.back(), [&](uint32_t row, Packet& packet) {
                rows[row].push_back(packet);
                packet.count = 0;
            });
            ready_.push_back(std::move(rows));
        }
    }

    void unprojectAndTrace()
    {
        for (size_t i = 0; i < lights_.size(); ++i)
            overTiles(view_, lights_[i], visibility_[i],
                      [&](uint32_t, Packet& packet) { ask(casters_.top(), packet, visibility_[i]); });
    }

    void tracePrepared()
    {
        for (size_t i = 0; i < lights_.size(); ++i)
            tbb::parallel_for(size_t{0}, ready_[i].size(), [&](size_t row) {
                flushDenormals();
                for (const Packet& packet : ready_[i][row]) {
                    Packet asked = packet; // the answer lands in it
                    ask(casters_.top(), asked, visibility_[i]);
                }
            });
    }

    /// Pixels that the loops and the method answer differently.
    size_t differing(const std::vector<Image8>& drawn) const
    {
        size_t count = 0;
        for (size_t i = 0; i < visibility_.size(); ++i)
            for (size_t p = 0; p < visibility_[i].size(); ++p)
                count += visibility_[i][p] != drawn[i].texels[p];
        return count;
    }

private:
    FrameSurfaces surfaces_;
    View view_;
    BareScene casters_;
    std::vector<gpu::LightConstants> lights_;
    std::vector<std::vector<uint8_t>> visibility_;
    std::vector<std::vector<std::vector<Packet>>> ready_; ///< By light and row of tiles.
};

void bench(const std::string& name)
{
    SessionOptions options;
    options.scene = name;
    Session session(options);
    if (!session.shadows.pinAll(kTruthMethod)) throw HostError("this build has no ray_traced");
    settle(session, kTruthMethod, frameTime(session.scene, 0), false);
    BareFrame bare(session);
    bare.unprojectAndTrace();
    const size_t differing = bare.differing(session.renderer.readVisibility());
    Times best;
    for (uint32_t i = 0; i < kRepeats; ++i) {
        for (const PassTime& pass : timePasses(session, 1))
            if (pass.name == "ray_traced.trace") best.trace = std::min(best.trace, pass.cpuMs);
        best.unprojecting = std::min(best.unprojecting, milliseconds([&] { bare.unprojectAndTrace(); }));
        const PairTimes pair = timePairs(session, 1, false, nullptr);
        best.with = std::min(best.with, pair.withMs.front());
        best.without = std::min(best.without, pair.withoutMs.front());
        best.rays = std::min(best.rays, pair.raysMs.front());
        best.prepared = std::min(best.prepared, milliseconds([&] { bare.tracePrepared(); }));
    }
    const double increment = best.with - best.without;
    std::printf("%-12s trace %8.2f ms, bare from depth %8.2f ms: %5.1f %%   method %8.2f ms, bare over prepared rays "
                "%8.2f ms: %5.1f %%   inside Embree %8.2f ms of CPU time   %zu pixels differ\n",
                name.c_str(), best.trace, best.unprojecting, 100.0 * best.unprojecting / best.trace, increment,
                best.prepared, 100.0 * best.prepared / increment, best.rays, differing);
}

} // namespace

int main(int count, char** arguments)
try {
    flushDenormals();
    std::vector<std::string> scenes(arguments + 1, arguments + count);
    if (scenes.empty()) scenes = {"torus_grid", "room", "colonnade", "bunny"};
    for (const std::string& scene : scenes)
        bench(scene);
    return 0;
} catch (const std::exception& failure) {
    std::fprintf(stderr, "bench_traced: %s\n", failure.what());
    return 1;
}
