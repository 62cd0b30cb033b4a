#include "runtime/rays/ray_scene.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <unordered_map>
#include <vector>

#include <glm/matrix.hpp>

#include "runtime/base/instruction_set.hpp"
#include "runtime/base/make_room.hpp"
#include "runtime/rays/placed_caster.hpp"

namespace gnomon {
namespace {

/// Adds the time until its end to a sum of several threads.
class QueryTimer {
public:
    explicit QueryTimer(std::atomic<std::uint64_t>& sum) : sum_(sum) {}
    ~QueryTimer()
    {
        const auto took = std::chrono::steady_clock::now() - start_;
        const auto nanoseconds = std::chrono::duration_cast<std::chrono::nanoseconds>(took).count();
        sum_.fetch_add(static_cast<std::uint64_t>(nanoseconds), std::memory_order_relaxed);
    }
    QueryTimer(const QueryTimer&) = delete;
    QueryTimer& operator=(const QueryTimer&) = delete;

private:
    std::atomic<std::uint64_t>& sum_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool countBytes(void* total, ssize_t bytes, bool)
{
    static_cast<std::atomic<std::ptrdiff_t>*>(total)->fetch_add(bytes, std::memory_order_relaxed);
    embreeBytesHere += bytes;
    return true;
}

/// What the filter finds behind Embree's context.
struct Query {
    EmbreeQuery embree; // first, since Embree hands back a pointer to it
    const Placed* placed = nullptr;
    std::uint32_t lightMask = 0;
    std::int32_t reach = 0; ///< Bits of RayScene::Impl::reach.
};

/// Bits of |x|. Of numbers they are in the numbers' order, and infinities and what is no number come after all. Signed,
/// though never below 0: SSE2 compares no others.
std::int32_t magnitude(float x)
{
    return std::bit_cast<std::int32_t>(x) & 0x7fffffff;
}

/// Leaves out of a packet what Embree must not be asked: it is lit.
void leaveOut(const Query& query, RayPacket& packet)
{
    std::int32_t most[RayPacket::kWidth] = {};
    for (int axis = 0; axis < 3; ++axis)
        for (std::uint32_t lane = 0; lane < RayPacket::kWidth; ++lane)
            most[lane] =
                std::max({most[lane], magnitude(packet.origin[axis][lane]), magnitude(packet.direction[axis][lane])});
    for (std::uint32_t lane = 0; lane < RayPacket::kWidth; ++lane) {
        const bool within = (most[lane] <= query.reach) & (magnitude(packet.tfar[lane]) <= 0x7f800000);
        packet.there[lane] &= within ? -1 : 0;
    }
}

/// Asks for what is there of a packet, as many lanes at a time as Rays has.
template <typename Rays>
void traceLanes(RTCScene scene, Query& query, RayPacket& packet)
{
    constexpr std::uint32_t width = std::size(decltype(Rays::tfar){});
    for (std::uint32_t first = 0; first < RayPacket::kWidth; first += width) {
        alignas(64) int valid[width];
        std::copy_n(packet.there + first, width, valid);
        if (std::all_of(valid, valid + width, [](int there) { return there == 0; })) continue;
        Rays rays;
        std::copy_n(packet.origin[0] + first, width, rays.org_x);
        std::copy_n(packet.origin[1] + first, width, rays.org_y);
        std::copy_n(packet.origin[2] + first, width, rays.org_z);
        std::copy_n(packet.direction[0] + first, width, rays.dir_x);
        std::copy_n(packet.direction[1] + first, width, rays.dir_y);
        std::copy_n(packet.direction[2] + first, width, rays.dir_z);
        std::copy_n(packet.tfar + first, width, rays.tfar);
        std::fill_n(rays.tnear, width, 0.0f);
        std::fill_n(rays.time, width, 0.0f);
        std::fill_n(rays.mask, width, query.lightMask);
        std::fill_n(rays.id, width, 0u);
        std::fill_n(rays.flags, width, 0u);
        query.embree.occluded(valid, scene, rays);
        std::copy_n(rays.tfar, width, packet.tfar + first);
    }
}

/// A packet as it is.
template <>
void traceLanes<RTCRay16>(RTCScene scene, Query& query, RayPacket& packet)
{
    static_assert(offsetof(RayPacket, start) == offsetof(RTCRay16, tnear));
    static_assert(offsetof(RayPacket, direction) == offsetof(RTCRay16, dir_x));
    static_assert(offsetof(RayPacket, tfar) == offsetof(RTCRay16, tfar));
    static_assert(offsetof(RayPacket, flags) == offsetof(RTCRay16, flags));
    static_assert(offsetof(RayPacket, there) == sizeof(RTCRay16));
    std::fill(std::begin(packet.start), std::end(packet.start), 0.0f);
    std::fill(std::begin(packet.time), std::end(packet.time), 0.0f);
    std::fill(std::begin(packet.mask), std::end(packet.mask), query.lightMask);
    std::fill(std::begin(packet.id), std::end(packet.id), 0u);
    std::fill(std::begin(packet.flags), std::end(packet.flags), 0u);
    query.embree.occluded(packet.there, scene, reinterpret_cast<RTCRay16&>(packet));
}

using Tracer = void (*)(RTCScene, Query&, RayPacket&);

/// The widest packets that Embree has kernels for with the processor's instruction set (and within the limit that it
/// was told), and they alone: wider ones it takes apart, and Embree 3.13 then looks into lanes that are masked out, too
/// (where its asserts are on, NaN in them ends the program). On tiles they are the fastest, too (bench_packets).
Tracer tracerOf(RTCDevice device)
{
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) return traceLanes<RTCRay16>;
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) return traceLanes<RTCRay8>;
    return traceLanes<RTCRay4>;
}

// What Embree may be asked with lies within 1.844e18 (its API reference, on vertex buffers), in the space of every
// caster: where its asserts are on, a single ray beyond ends the program.
constexpr double kEmbreeReach = 1e18;
// What every caster leaves to rays, metres.
constexpr double kLeastReach = 1e9;

/// How far from the frame's origin rays may start so that Embree may be asked in the caster's space, metres; negative:
/// its basis has no inverse.
double reachOf(const Caster& caster)
{
    if (!std::isfinite(1.0f / glm::determinant(caster.basis))) return -1.0;
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(caster.basis));
    double most = 1.0;
    for (int row = 0; row < 3; ++row)
        most = std::max(most, std::abs(inverse[0][row]) + std::abs(inverse[1][row]) + std::abs(inverse[2][row]));
    const glm::vec3 away = glm::abs(caster.translation);
    return kEmbreeReach / most - double{std::max({away.x, away.y, away.z})};
}

} // namespace

bool castsRays(const Caster& caster)
{
    return caster.mesh && caster.mesh->rays && reachOf(caster) >= kLeastReach;
}

MeshRays::MeshRays(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MeshRays::~MeshRays() = default;
std::size_t MeshRays::memoryBytes() const noexcept
{
    return impl_->embree.bytes() + (impl_->tree ? impl_->tree->memoryBytes() : 0);
}
bool MeshRays::moved() const noexcept
{
    return impl_->moved;
}
const std::shared_ptr<const TriangleTree>& MeshRays::tree() const noexcept
{
    return impl_->tree;
}

struct RayScene::Impl {
    std::atomic<std::ptrdiff_t> bytes{0}; ///< Held by Embree, as it reports them.
    std::shared_ptr<std::atomic<std::ptrdiff_t>> treeBytes = std::make_shared<std::atomic<std::ptrdiff_t>>(0);
    RTCDevice device = nullptr;
    RTCScene top = nullptr;
    Tracer trace = nullptr; ///< tracerOf()
    bool whole = false;     ///< The top level is committed.
    bool hasMasks = false;  ///< Embree was built with ray masks; otherwise the filter tests them.
    std::vector<Placed> placed;
    std::unordered_map<std::uint32_t, std::uint32_t> placeOf; ///< Caster::id -> index into `placed`.
    std::vector<std::uint32_t> lastOrder;                     ///< Places of the last update's casters, in its order.
    std::uint64_t updates = 0;
    std::uint32_t filterMask = 0; ///< Union of the masks of casters with an opacity or long edges.
    float reach = 0.0f;           ///< Rays may start within, along each axis.
    alignas(64) mutable std::atomic<std::uint64_t> queryNanoseconds{0}; ///< Written by all, beside what all read.

    Impl();
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl();
    std::uint32_t find(std::size_t position, std::uint32_t id) const;
    void place(std::uint32_t index, const Caster& caster, RTCScene tree);
    std::uint32_t add(std::uint32_t id);
    bool removeUnseen();
    Query query(std::uint32_t lightMask) const;
    void ask(Query& query, RayPacket& packet) const
    {
        leaveOut(query, packet);
        trace(top, query, packet);
    }
};

namespace {

/// Called for hits that would end a ray: lets it go on where the caster is not opaque.
void filterHits(const RTCFilterFunctionNArguments* args)
{
    const auto* query = reinterpret_cast<const Query*>(args->context);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        const Placed& caster = query->placed[RTCHitN_instID(args->hit, args->N, i, 0)];
        bool blocks = (caster.mask & query->lightMask) != 0;
        if (blocks && caster.opacity)
            blocks = caster.opacityAt(RTCHitN_primID(args->hit, args->N, i), RTCHitN_u(args->hit, args->N, i),
                                      RTCHitN_v(args->hit, args->N, i)) >= 0.5f;
        if (blocks && caster.isLong)
            blocks = !caster.isStartedOn(RTCHitN_primID(args->hit, args->N, i),
                                         {RTCRayN_org_x(args->ray, args->N, i), RTCRayN_org_y(args->ray, args->N, i),
                                          RTCRayN_org_z(args->ray, args->N, i)});
        if (!blocks) args->valid[i] = 0;
    }
}

} // namespace

Query RayScene::Impl::query(std::uint32_t lightMask) const
{
    Query query{};
    query.placed = placed.data();
    query.lightMask = lightMask;
    query.reach = std::bit_cast<std::int32_t>(reach);
    if ((filterMask & lightMask) != 0 || !hasMasks) query.embree.setFilter(filterHits);
    return query;
}

RayScene::Impl::Impl()
{
    const EmbreeFloatMode mode;
    std::string config = "ignore_config_files=1,verbose=0,set_affinity=0,start_threads=0";
    if (const InstructionSet limit = instructionSetLimit(); limit != InstructionSet::Avx512)
        config += std::string(",max_isa=") + nameOf(limit);
    device = rtcNewDevice(config.c_str());
    if (!device) return;
    trace = tracerOf(device);
    rtcSetDeviceMemoryMonitorFunction(device, countBytes, &bytes);
    hasMasks = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) != 0;
    top = rtcNewScene(device);
    rtcSetSceneFlags(top, kSceneFlags | RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(top, RTC_BUILD_QUALITY_LOW);
    commitHere(top);
    whole = true;
}

RayScene::Impl::~Impl()
{
    if (!device) return;
    const EmbreeFloatMode mode;
    for (const Placed& entry : placed) {
        if (entry.geometry) rtcReleaseGeometry(entry.geometry);
    }
    rtcReleaseScene(top);
    rtcSetDeviceMemoryMonitorFunction(device, nullptr, nullptr); // trees may outlive this
    rtcReleaseDevice(device);
}

/// Where a caster is placed, UINT32_MAX if it is not. Casters mostly come in the order of the last update.
std::uint32_t RayScene::Impl::find(std::size_t position, std::uint32_t id) const
{
    if (position < lastOrder.size()) {
        const std::uint32_t index = lastOrder[position];
        if (placed[index].geometry && placed[index].id == id) return index;
    }
    const auto found = placeOf.find(id);
    return found == placeOf.end() ? UINT32_MAX : found->second;
}

std::uint32_t RayScene::Impl::add(std::uint32_t id)
{
    makeRoom(placed); // Embree's ids are the least that are free; what may throw comes before what changes
    const auto known = placeOf.try_emplace(id, UINT32_MAX).first;
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    if (!geometry) {
        placeOf.erase(known);
        return UINT32_MAX;
    }
    const std::uint32_t index = rtcAttachGeometry(top, geometry);
    if (index == RTC_INVALID_GEOMETRY_ID) {
        rtcReleaseGeometry(geometry);
        placeOf.erase(known);
        return UINT32_MAX;
    }
    if (index >= placed.size()) placed.resize(index + 1);
    placed[index] = {};
    placed[index].geometry = geometry;
    placed[index].id = id;
    known->second = index;
    return index;
}

void RayScene::Impl::place(std::uint32_t index, const Caster& caster, RTCScene tree)
{
    Placed& entry = placed[index];
    entry.rays = caster.mesh->rays;
    entry.meshRevision = caster.mesh->revision;
    entry.basis = caster.basis;
    entry.translation = caster.translation;
    entry.reach = static_cast<float>(reachOf(caster));
    entry.mask = caster.mask;
    entry.opacity = opacityOf(caster);
    entry.userData = caster.userData;
    entry.givenNumbers = caster.mesh->givenNumbers;
    entry.positions = caster.mesh->positions;
    entry.indices = caster.mesh->indices;
    entry.turned = caster.mesh->turned;
    entry.isLong = isLong(caster, caster.mesh->rays->impl_->longest);

    // glm's mat4x3 is four columns of vec3: Embree's 3x4 column-major.
    const glm::mat4x3 worldFromObject(caster.basis[0], caster.basis[1], caster.basis[2], caster.translation);
    rtcSetGeometryInstancedScene(entry.geometry, tree);
    rtcSetGeometryTransform(entry.geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &worldFromObject[0][0]);
    rtcSetGeometryMask(entry.geometry, caster.mask);
    rtcCommitGeometry(entry.geometry);
}

bool RayScene::Impl::removeUnseen()
{
    bool removed = false;
    for (std::uint32_t index = 0; index < placed.size(); ++index) {
        Placed& entry = placed[index];
        if (!entry.geometry || entry.seen == updates) continue;
        rtcDetachGeometry(top, index);
        rtcReleaseGeometry(entry.geometry);
        placeOf.erase(entry.id);
        entry = {};
        removed = true;
    }
    return removed;
}

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {}
RayScene::~RayScene() = default;

std::unique_ptr<MeshRays> RayScene::build(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                                          MeshRaysHistory* history)
{
    if (!impl_->device || indices.empty()) return nullptr;
    const EmbreeFloatMode mode;
    std::unique_ptr<MeshRays::Impl> mesh =
        makeMeshRays(impl_->device, positions, indices, history ? history->impl_ : nullptr);
    if (!mesh) return nullptr;
    mesh->treeBytes = impl_->treeBytes;
    if (mesh->tree)
        mesh->treeBytes->fetch_add(static_cast<std::ptrdiff_t>(mesh->tree->memoryBytes()), std::memory_order_relaxed);
    return std::unique_ptr<MeshRays>(new MeshRays(std::move(mesh)));
}

bool RayScene::update(std::span<const Caster> casters)
{
    Impl& scene = *impl_;
    if (!scene.device) return true;
    const EmbreeFloatMode mode;
    ++scene.updates;
    static_cast<void>(rtcGetDeviceError(scene.device)); // of this thread; clears what an earlier call left
    bool changed = !scene.whole, complete = true;
    std::size_t position = 0;
    if (scene.lastOrder.capacity() < casters.size()) scene.lastOrder.reserve(2 * casters.size());
    for (const Caster& caster : casters) {
        if (!castsRays(caster)) continue;
        std::uint32_t index = scene.find(position, caster.id);
        if (index == UINT32_MAX || !unchanged(scene.placed[index], caster)) {
            scene.whole = false; // until it is committed
            changed = true;
            if (index == UINT32_MAX) index = scene.add(caster.id);
            if (index == UINT32_MAX) { // no memory for it: tried again with the next frame
                complete = false;
                continue;
            }
            scene.place(index, caster, caster.mesh->rays->impl_->embree.scene());
        }
        scene.placed[index].seen = scene.updates;
        if (position == scene.lastOrder.size()) scene.lastOrder.push_back(index);
        scene.lastOrder[position++] = index;
    }
    scene.lastOrder.resize(position);
    if (scene.placeOf.size() > position && scene.removeUnseen()) {
        scene.whole = false;
        changed = true;
    }
    if (!changed) return complete;
    scene.filterMask = 0;
    scene.reach = static_cast<float>(kEmbreeReach);
    for (const Placed& entry : scene.placed) {
        scene.filterMask |= entry.opacity || entry.isLong ? entry.mask : 0u;
        if (entry.geometry) scene.reach = std::min(scene.reach, entry.reach);
    }
    commitHere(scene.top);
    scene.whole = rtcGetDeviceError(scene.device) == RTC_ERROR_NONE;
    if (!scene.whole)
        for (Placed& entry : scene.placed)
            entry.rays = nullptr; // Embree says not which of them it has: the next update places all
    return scene.whole && complete;
}

void RayScene::occluded(std::span<const ShadowRay> rays, std::uint32_t lightMask,
                        std::span<std::uint8_t> occluded) const
{
    constexpr std::size_t width = RayPacket::kWidth;
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    if (!impl_->whole) return;
    const QueryTimer timer(impl_->queryNanoseconds);
    const EmbreeFloatMode mode;
    Query query = impl_->query(lightMask);
    RayPacket packet{};
    for (std::size_t first = 0; first < rays.size(); first += width) {
        const std::size_t count = std::min(width, rays.size() - first);
        for (std::size_t lane = 0; lane < width; ++lane) {
            const ShadowRay& ray = rays[first + std::min(lane, count - 1)];
            for (int axis = 0; axis < 3; ++axis) {
                packet.origin[axis][lane] = ray.origin[axis];
                packet.direction[axis][lane] = ray.direction[axis];
            }
            packet.tfar[lane] = ray.tfar;
            packet.there[lane] = lane < count && ray.tfar >= 0.0f ? -1 : 0;
        }
        impl_->ask(query, packet);
        for (std::size_t lane = 0; lane < count; ++lane) // a hit leaves tfar = -infinity
            occluded[first + lane] = packet.there[lane] != 0 && packet.tfar[lane] < 0.0f;
    }
}

void RayScene::occluded(std::span<RayPacket> packets, std::uint32_t lightMask) const
{
    if (!impl_->whole) return;
    const QueryTimer timer(impl_->queryNanoseconds);
    const EmbreeFloatMode mode;
    Query query = impl_->query(lightMask);
    for (RayPacket& packet : packets)
        impl_->ask(query, packet);
}

std::uint64_t RayScene::queryNanoseconds() const noexcept
{
    return impl_->queryNanoseconds.load(std::memory_order_relaxed);
}

std::size_t RayScene::memoryBytes() const noexcept
{
    const std::ptrdiff_t bytes =
        impl_->bytes.load(std::memory_order_relaxed) + impl_->treeBytes->load(std::memory_order_relaxed);
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(bytes, 0));
}

} // namespace gnomon
