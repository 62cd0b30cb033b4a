#include "runtime/rays/ray_scene.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <vector>

#include <glm/matrix.hpp>

#include "runtime/core/make_room.hpp"
#include "runtime/rays/mesh_rays.hpp"

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

/// A caster in the top level. Its index in the table is Embree's geometry id.
struct Placed {
    RTCGeometry geometry = nullptr; ///< Null: the entry is free.
    std::uint32_t id = 0;           ///< Caster::id
    const MeshRays* rays = nullptr;
    std::uint64_t meshRevision = 0; ///< Trees may reuse an address; revisions are unique.
    glm::mat3 basis{0.0f};
    glm::vec3 translation{0.0f};
    std::uint32_t mask = 0;
    PFN_gnOpacity opacity = nullptr;
    void* userData = nullptr;
    std::span<const std::uint32_t> givenNumbers; ///< MeshView::givenNumbers
    float reach = 0.0f;                          ///< reachOf()
    std::uint64_t seen = 0;                      ///< The last update() that brought it.

    /// What the host says of a hit; its triangles are numbered as it gave them.
    float opacityAt(std::uint32_t triangle, float u, float v) const
    {
        return opacity(givenNumbers.empty() ? triangle : givenNumbers[triangle], u, v, userData);
    }
};

bool unchanged(const Placed& placed, const Caster& caster)
{
    return placed.rays == caster.mesh->rays && placed.meshRevision == caster.mesh->revision &&
           placed.basis == caster.basis && placed.translation == caster.translation && placed.mask == caster.mask &&
           placed.opacity == opacityOf(caster) && placed.userData == caster.userData;
}

/// What the filter finds behind Embree's context.
struct Query {
    EmbreeQuery embree; // first, since Embree hands back a pointer to it
    const Placed* placed = nullptr;
    std::uint32_t lightMask = 0;
    std::int32_t reach = 0; ///< Bits of RayScene::Impl::reach.
};

} // namespace

namespace {

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
    bool whole = false;    ///< The top level is committed.
    bool hasMasks = false; ///< Embree was built with ray masks; otherwise the filter tests them.
    std::vector<Placed> placed;
    std::unordered_map<std::uint32_t, std::uint32_t> placeOf; ///< Caster::id -> index into `placed`.
    std::vector<std::uint32_t> lastOrder;                     ///< Places of the last update's casters, in its order.
    std::uint64_t updates = 0;
    std::uint32_t opacityMask = 0; ///< Union of the masks of casters with an opacity.
    float reach = 0.0f;            ///< Rays may start within, along each axis.
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
        if (!blocks) args->valid[i] = 0;
    }
}

/// Bits of |x|. Of numbers they are in the numbers' order, and infinities and what is no number come after all. Signed,
/// though never below 0: SSE2 compares no others.
std::int32_t magnitude(float x)
{
    return std::bit_cast<std::int32_t>(x) & 0x7fffffff;
}

/// Of a coordinate of a ray's origin and direction and its end.
bool isAskable(const Query& query, const ShadowRay& ray)
{
    std::int32_t most = 0;
    for (int axis = 0; axis < 3; ++axis)
        most = std::max({most, magnitude(ray.origin[axis]), magnitude(ray.direction[axis])});
    return most <= query.reach && !std::isnan(ray.tfar);
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

/// 16 rays at a time, for rays that lie close together.
void traceTiles(RTCScene scene, Query& query, std::span<const ShadowRay> rays, std::span<std::uint8_t> occluded)
{
    constexpr std::size_t width = 16;
    RTCRay16 packet{};
    alignas(64) int valid[width];
    for (std::size_t lane = 0; lane < width; ++lane)
        packet.mask[lane] = query.lightMask;
    for (std::size_t first = 0; first < rays.size(); first += width) {
        const std::size_t count = std::min(width, rays.size() - first);
        for (std::size_t lane = 0; lane < width; ++lane) {
            const ShadowRay& ray = rays[first + std::min(lane, count - 1)];
            valid[lane] = lane < count && isAskable(query, ray) ? -1 : 0;
            packet.org_x[lane] = ray.origin.x;
            packet.org_y[lane] = ray.origin.y;
            packet.org_z[lane] = ray.origin.z;
            packet.dir_x[lane] = ray.direction.x;
            packet.dir_y[lane] = ray.direction.y;
            packet.dir_z[lane] = ray.direction.z;
            packet.tfar[lane] = ray.tfar;
        }
        query.embree.occluded(valid, scene, packet);
        for (std::size_t lane = 0; lane < count; ++lane) // a hit leaves tfar = -infinity
            occluded[first + lane] = valid[lane] != 0 && packet.tfar[lane] < 0.0f && rays[first + lane].tfar >= 0.0f;
    }
}

/// Packets as they are.
void tracePackets(RTCScene scene, Query& query, std::span<RayPacket> packets)
{
    static_assert(offsetof(RayPacket, start) == offsetof(RTCRay16, tnear));
    static_assert(offsetof(RayPacket, direction) == offsetof(RTCRay16, dir_x));
    static_assert(offsetof(RayPacket, tfar) == offsetof(RTCRay16, tfar));
    static_assert(offsetof(RayPacket, flags) == offsetof(RTCRay16, flags));
    static_assert(offsetof(RayPacket, there) == sizeof(RTCRay16));
    for (RayPacket& packet : packets) {
        leaveOut(query, packet);
        std::fill(std::begin(packet.start), std::end(packet.start), 0.0f);
        std::fill(std::begin(packet.time), std::end(packet.time), 0.0f);
        std::fill(std::begin(packet.mask), std::end(packet.mask), query.lightMask);
        std::fill(std::begin(packet.id), std::end(packet.id), 0u);
        std::fill(std::begin(packet.flags), std::end(packet.flags), 0u);
        query.embree.occluded(packet.there, scene, reinterpret_cast<RTCRay16&>(packet));
    }
}

#if GNOMON_EMBREE_MAJOR == 3
// Ends before it starts: nobody asks.
constexpr ShadowRay kNoRay{.origin = glm::vec3(0.0f), .tfar = -1.0f, .direction = glm::vec3(1.0f, 0.0f, 0.0f)};

/// 256 rays at a time as a stream, for scattered rays.
void traceSparse(RTCScene scene, Query& query, std::span<const ShadowRay> rays, std::span<std::uint8_t> occluded)
{
    constexpr std::size_t width = 256;
    struct alignas(64) Stream {
        float orgX[width], orgY[width], orgZ[width], tnear[width];
        float dirX[width], dirY[width], dirZ[width], time[width], tfar[width], asked[width];
        unsigned mask[width], id[width], flags[width];
    } s{};
    for (unsigned& mask : s.mask)
        mask = query.lightMask;
    RTCRayNp pointers{s.orgX, s.orgY, s.orgZ, s.tnear, s.dirX, s.dirY, s.dirZ, s.time, s.tfar, s.mask, s.id, s.flags};
    for (std::size_t first = 0; first < rays.size(); first += width) {
        const std::size_t count = std::min(width, rays.size() - first);
        for (std::size_t lane = 0; lane < count; ++lane) {
            const bool asks = isAskable(query, rays[first + lane]);
            const ShadowRay ray = asks ? rays[first + lane] : kNoRay;
            s.orgX[lane] = ray.origin.x;
            s.orgY[lane] = ray.origin.y;
            s.orgZ[lane] = ray.origin.z;
            s.dirX[lane] = ray.direction.x;
            s.dirY[lane] = ray.direction.y;
            s.dirZ[lane] = ray.direction.z;
            s.tfar[lane] = s.asked[lane] = ray.tfar;
        }
        query.embree.occluded(scene, pointers, static_cast<unsigned>(count));
        for (std::size_t lane = 0; lane < count; ++lane)
            occluded[first + lane] = s.tfar[lane] < 0.0f && s.asked[lane] >= 0.0f;
    }
}
#else // has no streams
constexpr auto traceSparse = traceTiles;
#endif

} // namespace

Query RayScene::Impl::query(std::uint32_t lightMask) const
{
    Query query{};
    query.placed = placed.data();
    query.lightMask = lightMask;
    query.reach = std::bit_cast<std::int32_t>(reach);
    if ((opacityMask & lightMask) != 0 || !hasMasks) query.embree.setFilter(filterHits);
    return query;
}

RayScene::Impl::Impl()
{
    const FloatMode mode;
    device = rtcNewDevice("ignore_config_files=1,verbose=0,set_affinity=0,start_threads=0");
    if (!device) return;
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
    const FloatMode mode;
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
    const FloatMode mode;
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
    const FloatMode mode;
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
    scene.opacityMask = 0;
    scene.reach = static_cast<float>(kEmbreeReach);
    for (const Placed& entry : scene.placed) {
        scene.opacityMask |= entry.opacity ? entry.mask : 0u;
        if (entry.geometry) scene.reach = std::min(scene.reach, entry.reach);
    }
    commitHere(scene.top);
    scene.whole = rtcGetDeviceError(scene.device) == RTC_ERROR_NONE;
    if (!scene.whole)
        for (Placed& entry : scene.placed)
            entry.rays = nullptr; // Embree says not which of them it has: the next update places all
    return scene.whole && complete;
}

void RayScene::occluded(std::span<const ShadowRay> rays, std::uint32_t lightMask, RayCoherence coherence,
                        std::span<std::uint8_t> occluded) const
{
    if (!impl_->whole) {
        std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
        return;
    }
    const QueryTimer timer(impl_->queryNanoseconds);
    const FloatMode mode;
    Query query = impl_->query(lightMask);
    if (coherence == RayCoherence::tiles)
        traceTiles(impl_->top, query, rays, occluded);
    else
        traceSparse(impl_->top, query, rays, occluded);
}

void RayScene::occluded(std::span<RayPacket> packets, std::uint32_t lightMask) const
{
    if (!impl_->whole) return;
    const QueryTimer timer(impl_->queryNanoseconds);
    const FloatMode mode;
    Query query = impl_->query(lightMask);
    tracePackets(impl_->top, query, packets);
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
