/// How wide packets of shadow rays are best asked for: 16, 8 and 4 lanes, and a stream where Embree has them, over the
/// same rays alternating in one run; the least of many repeats for each piece of 2048 rays, added up. No test, since
/// machines differ: ninja bench_packets && GNOMON_MAX_ISA=avx2 ./bench_packets
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <limits>

#include "runtime/base/instruction_set.hpp"
#include "runtime/ray_fixture.hpp"
#include "runtime/rays/mesh_rays.hpp"

using namespace gnomon;

namespace {

constexpr std::size_t kPiece = 2048, kPieces = 8;
constexpr int kRepeats = 20;

/// Nine instances of 50 000 triangles.
class Bare {
public:
    explicit Bare(std::mt19937& random) : corners_(test::randomTriangles(random, 50000, 10.0f, 0.15f))
    {
        std::string config = "start_threads=0,set_affinity=0,max_isa=";
        device_ = rtcNewDevice((config + nameOf(instructionSetLimit())).c_str());
        for (std::uint32_t i = 0; i < corners_.size(); ++i)
            indices_.push_back(i);
        corners_.emplace_back(0.0f);
        tree_ = EmbreeTree(device_, std::span(corners_).first(indices_.size()), indices_, false);
        top_ = rtcNewScene(device_);
        rtcSetSceneFlags(top_, kSceneFlags | RTC_SCENE_FLAG_DYNAMIC);
        for (int i = 0; i < 9; ++i) {
            const glm::mat4x3 placed(glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1),
                                     glm::vec3(float(i % 3) * 15.0f - 15.0f, 10.0f, float(i / 3) * 15.0f - 15.0f));
            const RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
            rtcSetGeometryInstancedScene(instance, tree_.scene());
            rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &placed[0][0]);
            rtcSetGeometryMask(instance, ~0u);
            rtcCommitGeometry(instance);
            rtcAttachGeometry(top_, instance);
            rtcReleaseGeometry(instance);
        }
        commitHere(top_);
    }
    ~Bare()
    {
        rtcReleaseScene(top_);
        tree_ = {};
        rtcReleaseDevice(device_);
    }
    Bare(const Bare&) = delete;
    Bare& operator=(const Bare&) = delete;
    RTCScene top() const { return top_; }

private:
    std::vector<glm::vec3> corners_;
    std::vector<std::uint32_t> indices_;
    RTCDevice device_;
    EmbreeTree tree_;
    RTCScene top_ = nullptr;
};

/// Rays whose tfar is negative are masked out.
template <typename Rays>
std::size_t askPackets(RTCScene scene, std::span<const ShadowRay> rays)
{
    constexpr std::size_t width = std::size(decltype(Rays::tfar){});
    Rays packet{};
    alignas(64) int valid[width];
    EmbreeQuery query;
    std::fill_n(packet.mask, width, ~0u);
    std::size_t blocked = 0;
    for (std::size_t first = 0; first < rays.size(); first += width) {
        for (std::size_t i = 0; i < width; ++i) {
            const ShadowRay& ray = rays[first + i];
            valid[i] = ray.tfar < 0.0f ? 0 : -1;
            packet.org_x[i] = ray.origin.x, packet.org_y[i] = ray.origin.y, packet.org_z[i] = ray.origin.z;
            packet.dir_x[i] = ray.direction.x, packet.dir_y[i] = ray.direction.y, packet.dir_z[i] = ray.direction.z;
            packet.tfar[i] = ray.tfar;
        }
        query.occluded(valid, scene, packet);
        for (std::size_t i = 0; i < width; ++i)
            blocked += packet.tfar[i] == -std::numeric_limits<float>::infinity();
    }
    return blocked;
}

#if GNOMON_EMBREE_MAJOR == 3
std::size_t askStream(RTCScene scene, std::span<const ShadowRay> rays)
{
    constexpr std::size_t width = 256;
    struct alignas(64) {
        float org[3][width], tnear[width], dir[3][width], time[width], tfar[width];
        unsigned mask[width], id[width], flags[width];
    } s{};
    std::fill_n(s.mask, width, ~0u);
    RTCRayNp pointers{s.org[0], s.org[1], s.org[2], s.tnear, s.dir[0], s.dir[1],
                      s.dir[2], s.time,   s.tfar,   s.mask,  s.id,     s.flags};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    std::size_t blocked = 0;
    for (std::size_t first = 0; first < rays.size(); first += width) {
        for (std::size_t i = 0; i < width; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                s.org[axis][i] = rays[first + i].origin[axis];
                s.dir[axis][i] = rays[first + i].direction[axis];
            }
            s.tfar[i] = rays[first + i].tfar;
        }
        rtcOccludedNp(scene, &context, &pointers, width);
        for (std::size_t i = 0; i < width; ++i)
            blocked += s.tfar[i] == -std::numeric_limits<float>::infinity();
    }
    return blocked;
}
#endif

using Ask = std::size_t (*)(RTCScene, std::span<const ShadowRay>);
struct Way {
    const char* name;
    Ask ask;
};
constexpr Way kWays[] = {
    {"16", askPackets<RTCRay16>},
    {"8", askPackets<RTCRay8>},
    {"4", askPackets<RTCRay4>},
#if GNOMON_EMBREE_MAJOR == 3
    {"stream", askStream},
#endif
};

/// Rays towards one point: from 4x4 tiles of a grid on the ground, or from anywhere.
std::vector<ShadowRay> raysOf(std::mt19937& random, bool tiles, float masked)
{
    std::uniform_real_distribution<float> share(0.0f, 1.0f);
    std::vector<ShadowRay> rays;
    for (std::size_t i = 0; i < kPiece * kPieces; ++i) {
        const std::size_t tile = i / 16, x = tile % 64 * 4 + i % 4, z = tile / 64 * 4 + i / 4 % 4;
        const glm::vec3 ground(float(x) * 0.15f - 19.0f, 0.01f, float(z) * 0.15f - 19.0f);
        const glm::vec3 origin = tiles ? ground : test::randomPoint(random, 18.0f);
        rays.push_back({origin, share(random) < masked ? -1.0f : 0.999f, glm::vec3(5, 40, 3) - origin});
    }
    return rays;
}

void compare(RTCScene scene, const char* name, const std::vector<ShadowRay>& rays)
{
    std::array<double, std::size(kWays)> sum{};
    std::array<std::size_t, std::size(kWays)> blocked{};
    for (std::size_t first = 0; first < rays.size(); first += kPiece) {
        const std::span<const ShadowRay> piece = std::span(rays).subspan(first, kPiece);
        std::array<double, std::size(kWays)> least;
        least.fill(1e30);
        for (int repeat = 0; repeat < kRepeats; ++repeat)
            for (std::size_t way = 0; way < std::size(kWays); ++way) {
                const auto start = std::chrono::steady_clock::now();
                const std::size_t found = kWays[way].ask(scene, piece);
                const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
                least[way] = std::min(least[way], took.count());
                if (repeat == 0) blocked[way] += found;
            }
        for (std::size_t way = 0; way < std::size(kWays); ++way)
            sum[way] += least[way];
    }
    const auto asked = double(std::ranges::count_if(rays, [](const ShadowRay& ray) { return ray.tfar >= 0.0f; }));
    std::printf("%-22s", name);
    for (std::size_t way = 0; way < std::size(kWays); ++way)
        std::printf("  %6s %6.1f ns%s", kWays[way].name, sum[way] / asked, blocked[way] == blocked[0] ? "" : " (!)");
    std::puts("");
}

} // namespace

int main()
{
    if (!limitByEnvironment()) return 1;
    const EmbreeFloatMode mode;
    std::mt19937 random(7);
    const Bare bare(random);
    std::printf("Embree " RTC_VERSION_STRING ", at most %s; ns a ray that is there\n", nameOf(instructionSetLimit()));
    compare(bare.top(), "tiles, all", raysOf(random, true, 0.0f));
    compare(bare.top(), "tiles, 6 of 10", raysOf(random, true, 0.4f));
    compare(bare.top(), "scattered, all", raysOf(random, false, 0.0f));
    compare(bare.top(), "scattered, 6 of 10", raysOf(random, false, 0.4f));
    return 0;
}
