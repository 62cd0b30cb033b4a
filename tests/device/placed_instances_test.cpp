// Instances whose transforms lie in a buffer against the same transforms given to the CPU.
#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "device/buffer_support.hpp"
#include "runtime/scene/scene_view.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr uint32_t kCount = 20;
constexpr size_t kBall = 1;
constexpr VkDeviceSize kBefore = 20;
constexpr uint32_t kStride = 60;

/// Small balls over the floor. All of their numbers are floats.
std::vector<GnTransform> crowd(double shift, bool mirrored = false)
{
    std::vector<GnTransform> out(kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
        GnTransform& transform = out[i];
        const float size = 0.25f + 0.0625f * static_cast<float>(i % 4);
        transform.basis[0] = mirrored ? -size : size;
        transform.basis[1] = 0.125f * size; // sheared
        transform.basis[4] = transform.basis[8] = size;
        transform.translation[0] = -3.0 + 1.25 * (i % 5) + shift;
        transform.translation[1] = 0.5 + 0.25 * (i % 3);
        transform.translation[2] = -2.0 + 1.5 * (i / 5);
    }
    return out;
}

/// Where transforms lie in a buffer, and the boxes of the instances.
class Placed {
public:
    Placed(const Host& host, const std::vector<GnTransform>& transforms, bool mirrored = false)
        : buffer(demo::makeBuffer(device(), kBefore + std::size_t{kStride} * kCount,
                                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT))
    {
        const demo::Mesh& ball = host.scene.meshes[host.scene.instances[kBall].mesh];
        mesh_ = {ball.positions[0], ball.positions[0]};
        for (const glm::vec3& position : ball.positions)
            mesh_ = unionOf(mesh_, {position, position});
        info_.stride = kStride;
        info_.transforms = {buffer.get(), kBefore, buffer.size - kBefore};
        info_.mirrored = mirrored ? VK_TRUE : VK_FALSE;
        write(transforms);
    }

    void write(const std::vector<GnTransform>& transforms)
    {
        for (uint32_t i = 0; i < kCount; ++i) {
            float* rows = row(i);
            glm::mat3 basis;
            glm::vec3 place;
            for (int r = 0; r < 3; ++r) {
                for (int c = 0; c < 3; ++c)
                    rows[4 * r + c] = basis[c][r] = transforms[i].basis[3 * r + c];
                rows[4 * r + 3] = place[r] = static_cast<float>(transforms[i].translation[r] - info_.origin[r]);
            }
            bounds_[i] = transformed(mesh_, basis, place);
        }
    }
    float* row(uint32_t element) const
    {
        return reinterpret_cast<float*>(static_cast<std::byte*>(buffer.mapped) + kBefore + kStride * element);
    }
    void moveOrigin(const glm::dvec3& origin)
    {
        for (int i = 0; i < 3; ++i)
            info_.origin[i] = origin[i];
    }
    const GnTransformBuffer& describe()
    {
        info_.pBounds = &bounds_[0].lower.x;
        return info_;
    }

    demo::Buffer buffer;

private:
    static_assert(sizeof(Aabb) == 6 * sizeof(float));
    GnTransformBuffer info_{};
    Aabb mesh_;
    std::array<Aabb, kCount> bounds_;
};

std::vector<GnInstance> createPlaced(const Host& host, Placed& placed, GnInstanceFlags flags = 0)
{
    std::vector<GnInstance> instances(kCount);
    GnInstanceCreateInfo info{};
    info.pName = "walker";
    info.flags = flags;
    info.mesh = host.meshes[kBall];
    info.pTransformBuffer = &placed.describe();
    host.require(gnCreateInstances(host.context, &info, kCount, nullptr, instances.data()));
    return instances;
}

std::vector<GnInstance> createGiven(const Host& host, const std::vector<GnTransform>& transforms)
{
    std::vector<GnInstance> instances(kCount);
    GnInstanceCreateInfo info{};
    info.mesh = host.meshes[kBall];
    host.require(gnCreateInstances(host.context, &info, kCount, transforms.data(), instances.data()));
    return instances;
}

void update(const Host& host, const std::vector<GnInstance>& instances, Placed& placed)
{
    host.require(gnUpdateInstancesFromBuffer(host.context, static_cast<uint32_t>(instances.size()), instances.data(),
                                             &placed.describe()));
}

std::vector<Image8> drawn(Host& host, const FrameOptions& options = {})
{
    host.require(host.draw(options));
    return host.pictures();
}

Scene crowdScene(demo::LightKind kind)
{
    Scene scene = smallScene();
    demo::Light& lamp = scene.lights[0];
    lamp.kind = kind;
    if (kind == demo::LightKind::Directional) lamp.range = 0.0f;
    lamp.radius = 0.2f;
    return scene;
}

/// The same scene twice.
struct Pair {
    explicit Pair(demo::LightKind kind)
        : given(crowdScene(kind), {.extent = {160, 90}}), placed(crowdScene(kind), {.extent = {160, 90}}),
          buffer(placed, crowd(0.0)), givenInstances(createGiven(given, crowd(0.0))),
          placedInstances(createPlaced(placed, buffer))
    {
    }
    void pin(const char* method)
    {
        given.pinAll(method);
        placed.pinAll(method);
    }
    void move(double shift)
    {
        const std::vector<GnTransform> moved = crowd(shift);
        given.require(gnSetInstanceTransforms(given.context, kCount, givenInstances.data(), moved.data()));
        buffer.write(moved);
        update(placed, placedInstances, buffer);
    }
    Host given, placed;
    Placed buffer;
    std::vector<GnInstance> givenInstances, placedInstances;
};

bool said(const std::vector<std::string>& messages, const std::string& words)
{
    return std::ranges::any_of(messages, [&](const std::string& text) { return text.find(words) != text.npos; });
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "every method shows transforms in a buffer as those it is given, or says that it cannot")
{
    std::map<demo::LightKind, std::unique_ptr<Pair>> pairs;
    std::set<GnTraits> needs; // of those that cannot: one of each sort is asked
    constexpr GnTraits kNeeds = GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT | GN_TRAIT_RAYS_BIT |
                                GN_TRAIT_DEVICE_RAYS_BIT | GN_TRAIT_POINT_BIT;
    uint32_t shown = 0;
    const Host probe(smallScene(), {.warmUp = false});
    for (const GnMethodInfo& method : availableMethods(probe.context)) {
        CAPTURE(std::string(method.pName));
        if (!(method.traits & GN_TRAIT_GPU_TRANSFORMS_BIT) && !needs.insert(method.traits & kNeeds).second) continue;
        std::unique_ptr<Pair>& pair = pairs[servedKind(method)];
        if (!pair) pair = std::make_unique<Pair>(servedKind(method));
        pair->pin(method.pName);
        if (!(method.traits & GN_TRAIT_GPU_TRANSFORMS_BIT)) {
            pair->placed.require(pair->placed.draw());
            CHECK(pair->placed.decision(0).reason != GN_REASON_PINNED);
            CHECK(pair->placed.explanation(0).find(std::string(method.pName) +
                                                   ": out, 20 casters whose transforms only the GPU reads") !=
                  std::string::npos);
            continue;
        }
        ++shown;
        const std::vector<Image8> before = drawn(pair->given);
        CHECK(differences(before, drawn(pair->placed)) == 0);
        REQUIRE(pair->placed.decision(0).reason == GN_REASON_PINNED);
        pair->move(0.5);
        const std::vector<Image8> after = drawn(pair->given);
        CHECK(differences(after, drawn(pair->placed)) == 0);
        CHECK(differences(before, after) > 200);
        pair->move(0.0);
    }
    CHECK(shown >= 10);
}

TEST_CASE_FIXTURE(DeviceTest, "instances of a buffer may go, be mirrored, stand alone and share a frame with others")
{
    Pair pair(demo::LightKind::Spot);
    pair.pin("shadow_map");
    for (const uint32_t gone : {3u, 4u, 11u}) {
        gnDestroyInstance(pair.given.context, pair.givenInstances[gone]);
        gnDestroyInstance(pair.placed.context, pair.placedInstances[gone]);
    }
    const std::vector<Image8> fewer = drawn(pair.given);
    CHECK(differences(fewer, drawn(pair.placed)) == 0);

    std::vector<GnTransform> turned = crowd(0.25, true);
    for (float& element : turned[0].basis)
        element *= 3.0f;
    Placed mirrored(pair.placed, turned, true);
    GnInstanceCreateInfo one{};
    one.mesh = pair.placed.meshes[kBall];
    one.pTransformBuffer = &mirrored.describe();
    GnInstance single = VK_NULL_HANDLE;
    pair.placed.require(gnCreateInstance(pair.placed.context, &one, &single));
    one.pTransformBuffer = nullptr;
    one.mesh = pair.given.meshes[kBall];
    one.transform = turned[0];
    GnInstance twin = VK_NULL_HANDLE;
    pair.given.require(gnCreateInstance(pair.given.context, &one, &twin));
    const std::vector<Image8> more = drawn(pair.given);
    CHECK(differences(more, drawn(pair.placed)) == 0);
    CHECK(differences(more, fewer) > 20);

    gnDestroyInstance(pair.given.context, twin);
    gnDestroyInstance(pair.placed.context, single);
    CHECK(differences(drawn(pair.given), fewer) == 0);
    CHECK(differences(drawn(pair.placed), fewer) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "the host's commands write the buffer before and after a frame without a barrier")
{
    Pair pair(demo::LightKind::Spot);
    pair.pin("shadow_map");
    const Placed next(pair.placed, crowd(0.5)), wrong(pair.placed, crowd(-0.5));
    const demo::Buffer *contents[] = {&next.buffer, &wrong.buffer}, &target = pair.buffer.buffer;
    demo::Buffer source[2];
    for (int i = 0; i < 2; ++i) {
        source[i] = demo::makeBuffer(device(), target.size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
        std::memcpy(source[i].mapped, contents[i]->mapped, target.size);
    }
    pair.move(0.5); // bounds
    const std::vector<Image8> expected = drawn(pair.given);
    pair.buffer.write(crowd(-0.25));
    const FrameOptions options{.call = Call::record, .around = [&](VkCommandBuffer cmd, bool begins) {
                                   const VkBufferCopy all{0, 0, target.size};
                                   vkCmdCopyBuffer(cmd, source[begins ? 0 : 1].get(), target.get(), 1, &all);
                               }};
    for (int frame = 0; frame < 3; ++frame)
        CHECK(differences(expected, drawn(pair.placed, options)) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "translations count from the origin that the host gives, wherever the frame's is")
{
    const glm::dvec3 far(1 << 20, 0.0, -(1 << 19));
    Host given(crowdScene(demo::LightKind::Spot), {.extent = {160, 90}});
    createGiven(given, crowd(0.0));
    given.pinAll("shadow_map");
    Scene scene = crowdScene(demo::LightKind::Spot);
    for (demo::Instance& instance : scene.instances)
        instance.pose.position += far;
    scene.lights[0].position += far;
    scene.camera[0].eye += far;
    scene.camera[0].target += far;
    Host there(scene, {.extent = {160, 90}});
    Placed placed(there, crowd(0.0));
    placed.moveOrigin(far);
    createPlaced(there, placed);
    there.pinAll("shadow_map");
    const std::vector<Image8> here = drawn(given);
    CHECK(differences(here, drawn(there)) <= 30); // the frame's origin is up to 128 m away: edges are rounded
    CHECK(dark(here[0]) > 300);
}

TEST_CASE_FIXTURE(DeviceTest, "what is no transform casts nothing and is reported once, by its place in the buffer")
{
    Host host(crowdScene(demo::LightKind::Spot), {.extent = {160, 90}});
    host.pinAll("shadow_map");
    Placed placed(host, crowd(0.0));
    createPlaced(host, placed);
    const std::vector<Image8> all = drawn(host);
    constexpr uint32_t kWrong[] = {7, 9, 12};
    for (const uint32_t i : kWrong)
        for (int r = 0; r < 3; ++r)
            placed.row(i)[4 * r + r] *= 1e-6f; // next to nothing
    const std::vector<Image8> without = drawn(host);
    CHECK(differences(all, without) > 20);
    CHECK(host.takeMessages().empty());

    placed.row(7)[3] = std::numeric_limits<float>::quiet_NaN();
    std::fill_n(placed.row(9), 3, 0.0f);
    placed.row(12)[0] *= -1e6f;
    placed.row(12)[5] *= 1e6f;
    placed.row(12)[10] *= 1e6f; // mirrored
    CHECK(differences(without, drawn(host)) == 0);
    for (int frame = 0; frame < 3; ++frame)
        drawn(host);
    const std::vector<std::string> messages = host.takeMessages();
    CHECK(messages.size() == 1);
    CHECK(said(messages, "instance 'walker': element 7 of its buffer of transforms"));
}

TEST_CASE_FIXTURE(DeviceTest,
                  "descriptions of transforms in buffers that cannot be read are errors that name the value")
{
    Host host(crowdScene(demo::LightKind::Spot), {.extent = {160, 90}});
    host.pinAll("shadow_map");
    Placed placed(host, crowd(0.0));
    const std::vector<GnInstance> instances = createPlaced(host, placed);
    const std::vector<Image8> before = drawn(host);
    const std::vector<float> bounds(placed.describe().pBounds, placed.describe().pBounds + 6 * kCount);
    const auto refused = [&](GnResult result, const std::string& words, const auto& change) {
        GnTransformBuffer transforms = placed.describe();
        std::vector<float> boxes = bounds;
        transforms.pBounds = boxes.data();
        GnInstanceCreateInfo info{};
        info.mesh = host.meshes[kBall];
        info.pTransformBuffer = &transforms;
        change(info, transforms, boxes);
        std::vector<GnInstance> made(kCount, instances[0]);
        CHECK(gnCreateInstances(host.context, &info, kCount, nullptr, made.data()) == result);
        CHECK_MESSAGE(host.lastError().find(words) != std::string::npos, host.lastError());
        CHECK(std::ranges::count(made, GnInstance(VK_NULL_HANDLE)) == kCount);
        if (info.flags || info.pTransformBuffer != &transforms) return;
        CHECK(gnUpdateInstancesFromBuffer(host.context, kCount, instances.data(), &transforms) == result);
        CHECK_MESSAGE(host.lastError().find(words) != std::string::npos, host.lastError());
    };
    using Info = GnInstanceCreateInfo;
    using From = GnTransformBuffer;
    using Boxes = std::vector<float>;
    constexpr GnResult kRange = GN_ERROR_OUT_OF_RANGE;
    refused(kRange, "stride 44 is not", [](Info&, From& t, Boxes&) { t.stride = 44; });
    refused(kRange, "stride 50 is not", [](Info&, From& t, Boxes&) { t.stride = 50; });
    refused(kRange, "transforms.offset is 18", [](Info&, From& t, Boxes&) { t.transforms.offset = 18; });
    refused(kRange, "transforms.range is 1187; 1188 bytes are needed",
            [](Info&, From& t, Boxes&) { t.transforms.range = 1187; });
    refused(kRange, "transforms.range is VK_WHOLE_SIZE",
            [](Info&, From& t, Boxes&) { t.transforms.range = VK_WHOLE_SIZE; });
    refused(GN_ERROR_NULL_ARGUMENT, "transforms.buffer is null",
            [](Info&, From& t, Boxes&) { t.transforms.buffer = VK_NULL_HANDLE; });
    refused(GN_ERROR_NULL_ARGUMENT, "pBounds is null", [](Info&, From& t, Boxes&) { t.pBounds = nullptr; });
    refused(GN_ERROR_INFINITE, "origin[1]",
            [](Info&, From& t, Boxes&) { t.origin[1] = std::numeric_limits<double>::infinity(); });
    refused(kRange, "pBounds of element 6: ", [](Info&, From&, Boxes& b) { b[6 * 6 + 3] = b[6 * 6] - 1.0f; });
    refused(kRange, "GN_INSTANCE_STATIC_BIT", [](Info& i, From&, Boxes&) { i.flags = GN_INSTANCE_STATIC_BIT; });
    refused(kRange, "GN_INSTANCE_HOST_DRAWN_BIT", [](Info& i, From&, Boxes&) { i.flags = GN_INSTANCE_HOST_DRAWN_BIT; });
    refused(GN_ERROR_NULL_ARGUMENT, "pTransforms", [](Info& i, From&, Boxes&) { i.pTransformBuffer = nullptr; });

    const std::vector<GnTransform> places = crowd(0.0);
    std::vector<GnInstance> made(kCount, instances[0]);
    GnInstanceCreateInfo info{};
    info.mesh = host.meshes[kBall];
    info.pTransformBuffer = &placed.describe();
    CHECK(gnCreateInstances(host.context, &info, kCount, places.data(), made.data()) == kRange);
    CHECK(gnSetInstanceTransform(host.context, instances[2], places.data()) == GN_ERROR_INVALID_HANDLE);
    CHECK(host.lastError().find("instance 'walker' has its transform in a buffer") != std::string::npos);
    CHECK(gnSetInstanceTransforms(host.context, 1, instances.data(), places.data()) == GN_ERROR_INVALID_HANDLE);
    std::vector<GnInstance> mixed = instances;
    mixed[5] = host.instances[kBall];
    CHECK(gnUpdateInstancesFromBuffer(host.context, kCount, mixed.data(), &placed.describe()) ==
          GN_ERROR_INVALID_HANDLE);
    CHECK(host.lastError().find("pInstances[5]: instance 'ball' was made with a transform") != std::string::npos);
    CHECK(differences(drawn(host), before) == 0);
}
