// Meshes that the GPU deforms, without a word to the CPU, against the same positions in arrays.
#include <algorithm>
#include <array>

#include <glm/gtc/matrix_transform.hpp>

#include "device/buffer_support.hpp"
#include "shaders/skin_comp.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1;
constexpr double kMapSide = 1024.0; // maps fitted to other bounds differ by parts of a texel

struct SkinPush { // as in skin.comp
    glm::vec4 lower[3], upper[3];
    float bottom, top;
    uint32_t count;
};

struct Pose {
    float bend = 0.0f;
    float grown = 1.0f; ///< Size of the upper bone's part; at 0 all of it is a point.
    float top = 0.8f;   ///< From here up vertices are the upper bone's alone.
};

/// A host's skinning: two bones that bend a ball.
class Skinning {
public:
    explicit Skinning(const demo::Mesh& mesh)
        : mesh_(mesh), bytes_(mesh.positions.size() * sizeof(glm::vec3)),
          bind_(demo::makeBuffer(device(), bytes_, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)),
          skinned(demo::makeBuffer(device(), bytes_, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true)),
          setLayout_(demo::makeSetLayout(device(), std::array{binding(0), binding(1)})),
          layout_(demo::makePipelineLayout(device(), std::array{setLayout_.get()}, sizeof(SkinPush),
                                           VK_SHADER_STAGE_COMPUTE_BIT)),
          pipeline_(demo::makeComputePipeline(device(), k_skin_comp, layout_.get()))
    {
        std::ranges::copy(mesh.positions, bind_.as<glm::vec3>().begin());
        const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2};
        const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                                  .maxSets = 1,
                                                  .poolSizeCount = 1,
                                                  .pPoolSizes = &size};
        VkDescriptorPool pool = VK_NULL_HANDLE;
        demo::vkCheck(vkCreateDescriptorPool(device().handle, &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
        pool_ = {device().handle, pool};
        const VkDescriptorSetLayout layout = setLayout_.get();
        const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .descriptorPool = pool,
                                               .descriptorSetCount = 1,
                                               .pSetLayouts = &layout};
        demo::vkCheck(vkAllocateDescriptorSets(device().handle, &info, &set_), "vkAllocateDescriptorSets");
        const VkDescriptorBufferInfo buffers[] = {{bind_.get(), 0, bytes_}, {skinned.get(), 0, bytes_}};
        const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                         .dstSet = set_,
                                         .descriptorCount = 2,
                                         .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                         .pBufferInfo = buffers};
        vkUpdateDescriptorSets(device().handle, 1, &write, 0, nullptr);
    }

    /// Without a barrier: gnomon's order what comes before and after.
    void record(VkCommandBuffer cmd, const Pose& pose) const
    {
        SkinPush push{.bottom = -0.8f, .top = pose.top, .count = static_cast<uint32_t>(mesh_.positions.size())};
        const glm::mat4 turned = glm::rotate(glm::mat4(1.0f), pose.bend, {0.0f, 0.0f, 1.0f}), lower(1.0f),
                        upper = glm::scale(glm::translate(turned, {pose.bend, 0.0f, 0.0f}), glm::vec3(pose.grown));
        for (int row = 0; row < 3; ++row) {
            push.lower[row] = glm::vec4(lower[0][row], lower[1][row], lower[2][row], lower[3][row]);
            push.upper[row] = glm::vec4(upper[0][row], upper[1][row], upper[2][row], upper[3][row]);
        }
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.get());
        vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set_, 0, nullptr);
        vkCmdPushConstants(cmd, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
        vkCmdDispatch(cmd, (push.count + 63) / 64, 1, 1);
    }
    VkDescriptorBufferInfo range() const { return {skinned.get(), 0, bytes_}; }
    GnMeshBuffers describe(const BufferMeshData& bind) const
    {
        GnMeshBuffers buffers = bind.buffers;
        buffers.positions = range();
        for (int i = 0; i < 3; ++i) { // of all poses
            buffers.boundsMin[i] = -2.0f;
            buffers.boundsMax[i] = 2.0f;
        }
        return buffers;
    }

private:
    static VkDescriptorSetLayoutBinding binding(uint32_t number)
    {
        return {number, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
    }

    const demo::Mesh mesh_;
    VkDeviceSize bytes_;
    demo::Buffer bind_;

public:
    demo::Buffer skinned; ///< Host-visible: what the CPU is to expect.

private:
    demo::UniqueSetLayout setLayout_;
    demo::UniquePipelineLayout layout_;
    demo::UniquePipeline pipeline_;
    demo::UniqueDescriptorPool pool_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

constexpr demo::Access kSkinned{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
constexpr demo::Access kToHost{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};

Scene motionScene(const GnMethodInfo& method)
{
    Scene scene = sceneFor(method);
    scene.instances[kBall].isStatic = false;
    return scene;
}

/// A recorded frame whose command buffer skins the mesh first.
FrameOptions skinned(const Skinning& skinning, const Pose& pose, bool drop = false)
{
    return {.call = Call::record, .drop = drop, .around = [&skinning, pose](VkCommandBuffer cmd, bool begins) {
                if (begins)
                    skinning.record(cmd, pose);
                else
                    demo::cmdMemoryBarrier(cmd, kSkinned, kToHost);
            }};
}

void update(Host& host, GnMesh mesh, const Skinning& skinning)
{
    const VkDescriptorBufferInfo range = skinning.range();
    host.require(gnUpdateMeshFromBuffer(host.context, mesh, &range, nullptr, nullptr));
}

std::vector<Image8> drawArrays(Host& host, GnMesh mesh, const Skinning& skinning)
{
    const std::span<const glm::vec3> positions = skinning.skinned.as<glm::vec3>();
    host.require(
        gnUpdateMeshPositions(host.context, mesh, &positions[0].x, static_cast<uint32_t>(positions.size()), 0));
    host.require(host.draw({.call = Call::record}));
    return host.pictures();
}

/// In buffers that the skinning writes; it casts in place of the ball.
GnMesh createSkinned(Host& host, const Skinning& skinning, const BufferMeshData& bind, GnMeshFlags flags)
{
    const GnMeshBuffers buffers = skinning.describe(bind);
    GnMeshCreateInfo info = bind.info(flags);
    info.pBuffers = &buffers;
    GnMesh mesh = VK_NULL_HANDLE;
    host.require(gnCreateMesh(host.context, &info, &mesh));
    replaceMesh(host, kBall, mesh);
    host.hide(kBall);
    return mesh;
}

demo::Mesh ball()
{
    return demo::makeSphere({.radius = 0.8f, .slices = 24, .stacks = 12});
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a mesh that the GPU skins casts as its positions in arrays do, by every method that can")
{
    Host probe(smallScene(), {.warmUp = false});
    const Skinning skinning(ball());
    const BufferMeshData bind(ball(), {.name = "skinned"});
    const uint32_t waits = vulkanCalls().deviceWaitIdle + vulkanCalls().queueWaitIdle;
    uint32_t methods = 0;
    for (const GnMethodInfo& method : availableMethods(probe.context)) {
        const bool byConnectivity = readsTriangles(method) && (method.traits & GN_TRAIT_GPU_POSITIONS_BIT) != 0;
        if ((readsTriangles(method) && !byConnectivity) || method.roundTrips > 0) continue;
        CAPTURE(std::string(method.pName));
        ++methods;
        Host host(motionScene(method), {.mapSide = kMapSide}), arrays(motionScene(method), {.mapSide = kMapSide});
        host.pinAll(method.pName);
        arrays.pinAll(method.pName);
        const GnMesh mesh =
            createSkinned(host, skinning, bind, byConnectivity ? 0 : GN_MESH_NO_CPU_COPY_BIT | GN_MESH_CLOSED_BIT);
        const GnMesh reference = createOfArrays(arrays, bind.decoded);
        replaceMesh(arrays, kBall, reference);
        arrays.hide(kBall);
        for (int frame = 0; byConnectivity && frame < 4; ++frame) { // one copy is made, in motion
            host.require(host.draw(skinned(skinning, {})));
            host.pictures();
            update(host, mesh, skinning);
        }
        std::vector<Image8> before;
        for (int frame = 0; frame < 5; ++frame) {
            CAPTURE(frame);
            if (frame > 0) update(host, mesh, skinning);
            host.require(host.draw(skinned(skinning, {.bend = 0.25f * static_cast<float>(frame)})));
            const std::vector<Image8> got = host.pictures(), expected = drawArrays(arrays, reference, skinning);
            CHECK(std::string(host.decision(0).pMethod) == method.pName);
            MESSAGE(std::string(method.pName)
                    << ", frame " << frame << ": " << differences(expected, got) << " differ");
            // Maps are fitted to bounds, here those of all poses: slices of cascades, and how depths are scaled, which
            // averages of them round by.
            // Of 25 maps, as a mean over points of the light has, one or two may differ at an edge: 10 levels each.
            size_t apart = 0;
            for (size_t i = 0; i < got[0].texels.size(); ++i)
                apart += std::abs(got[0].texels[i] - expected[0].texels[i]) > 21;
            CHECK(apart <= 8);
            CHECK(dark(got[0]) > 100);
            if (frame > 0) CHECK(differences(before, got) > 50);
            if (frame > 2) CHECK(host.stats().deviceAllocations == 0);
            before = got;
        }
    }
    CHECK(methods >= 5);
    CHECK(vulkanCalls().deviceWaitIdle + vulkanCalls().queueWaitIdle == waits);
}

namespace {

/// A mesh that the GPU skins, in a scene with this light, and the same scene with its positions in arrays.
struct Twins {
    Twins(const Scene& scene, const char* method)
        : skinning(ball()), bind(ball(), {.name = "skinned"}), host(scene), arrays(scene)
    {
        for (Host* each : {&host, &arrays})
            each->pinAll(method);
        mesh = createSkinned(host, skinning, bind, 0);
        reference = createOfArrays(arrays, bind.decoded);
        replaceMesh(arrays, kBall, reference);
        arrays.hide(kBall);
    }
    /// Frames of that pose, each of which rewrites the mesh.
    void frames(int count, const Pose& pose)
    {
        for (int i = 0; i < count; ++i) {
            host.require(host.draw(skinned(skinning, pose)));
            host.pictures();
            update(host, mesh, skinning);
        }
    }
    /// Pixels by which the newest pictures differ.
    size_t differ() { return differences(drawArrays(arrays, reference, skinning), host.pictures()); }

    const Skinning skinning;
    const BufferMeshData bind;
    Host host, arrays;
    GnMesh mesh, reference;
};

const char* const kByConnectivity[] = {"stencil_volume", "all_edges_volume"};

Scene movingScene()
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = false;
    return scene;
}

} // namespace

TEST_CASE_FIXTURE(
    DeviceTest, "volumes of a skinned mesh are those of arrays for every light, by z-pass and z-fail, mirrored or not")
{
    for (const char* method : kByConnectivity)
        for (const demo::LightKind kind : {demo::LightKind::Directional, demo::LightKind::Spot, demo::LightKind::Point})
            for (const bool mirrored : {false, true}) {
                CAPTURE(method);
                CAPTURE(static_cast<int>(kind));
                CAPTURE(mirrored);
                Scene scene = movingScene();
                scene.lights[0].kind = kind;
                if (kind == demo::LightKind::Directional) scene.lights[0].range = 0.0f;
                Twins twins(scene, method);
                GnTransform place{};
                place.basis[0] = mirrored ? -1.2f : 1.2f;
                place.basis[4] = place.basis[8] = 0.9f;
                const double at[3] = {0.2, 1.9, 0.3};
                std::copy_n(at, 3, place.translation);
                for (Host* host : {&twins.host, &twins.arrays})
                    host->require(gnSetInstanceTransform(host->context, host->instances[kBall], &place));
                twins.frames(4, {});
                for (const double fails : {0.0, 1.0}) {
                    CAPTURE(fails);
                    for (Host* host : {&twins.host, &twins.arrays})
                        host->require(gnSetMethodSetting(host->context, method, "z_fail", fails));
                    twins.frames(2, {.bend = 0.5f});
                    CHECK(std::string(twins.host.decision(0).pMethod) == method);
                    CHECK(dark(twins.host.pictures()[0]) > 300);
                    CHECK(twins.differ() == 0);
                }
            }
}

TEST_CASE_FIXTURE(DeviceTest, "faces without an area in the pose that was copied cast once they have one")
{
    for (const char* method : kByConnectivity) {
        CAPTURE(method);
        Twins twins(movingScene(), method);
        twins.frames(8, {.bend = 0.4f, .grown = 0.0f, .top = 0.1f});
        CHECK(std::string(twins.host.decision(0).pMethod) == method);
        const std::vector<Image8> half = twins.host.pictures();
        twins.frames(8, {.bend = 0.4f, .top = 0.1f});
        CHECK(std::string(twins.host.decision(0).pMethod) == method);
        CHECK(differences(half, twins.host.pictures()) > 200);
        CHECK(twins.differ() == 0);
        twins.frames(8, {.bend = 0.8f, .top = 0.1f}); // corrected: it needs no further copy
        CHECK(twins.differ() == 0);
        CHECK(twins.host.stats().deviceAllocations == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "what a dropped frame was to read is read by the next, and several updates are one")
{
    GnMethodInfo method{};
    Host probe(smallScene(), {.warmUp = false});
    for (const GnMethodInfo& each : availableMethods(probe.context))
        if (std::string_view(each.pName) == "shadow_map") method = each;
    const Skinning skinning(ball());
    const BufferMeshData bind(ball(), {.name = "skinned"});
    Host host(motionScene(method)), arrays(motionScene(method));
    host.pinAll("shadow_map");
    arrays.pinAll("shadow_map");
    const GnMesh mesh = createSkinned(host, skinning, bind, GN_MESH_NO_CPU_COPY_BIT | GN_MESH_CLOSED_BIT);
    const GnMesh reference = createOfArrays(arrays, bind.decoded);
    replaceMesh(arrays, kBall, reference);
    arrays.hide(kBall);

    host.require(host.draw(skinned(skinning, {.bend = 0.1f}, true))); // the first one: indices as well
    update(host, mesh, skinning);
    update(host, mesh, skinning);
    host.require(host.draw(skinned(skinning, {.bend = 0.2f}, true)));
    host.require(host.draw(skinned(skinning, {.bend = 0.6f})));
    const std::vector<Image8> got = host.pictures();
    CHECK(differences(drawArrays(arrays, reference, skinning), got) <= 2);
    CHECK(dark(got[0]) > 300);

    update(host, mesh, skinning); // nobody reads for a mesh that is gone
    gnDestroyMesh(host.context, mesh);
    host.require(host.draw());
    CHECK(differences(host.pictures(), got) > 50);
}

TEST_CASE_FIXTURE(DeviceTest, "methods that read triangles serve a deformed mesh some frames after it has come to rest")
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = false;
    const Skinning skinning(ball());
    const BufferMeshData bind(ball(), {.name = "cloth"});
    Host host(scene), arrays(scene);
    const GnMesh mesh = createSkinned(host, skinning, bind, 0);
    const GnMesh reference = createOfArrays(arrays, bind.decoded);
    replaceMesh(arrays, kBall, reference);
    arrays.hide(kBall);
    for (const std::string method : {"octree_volume", "shadow_map"}) {
        host.pinAll(method.c_str());
        arrays.pinAll(method.c_str());
        for (const float bend : {0.2f, 0.7f}) {
            CAPTURE(method);
            CAPTURE(bend);
            update(host, mesh, skinning);
            host.require(host.draw(skinned(skinning, {.bend = bend})));
            update(host, mesh, skinning);
            host.require(host.draw(skinned(skinning, {.bend = bend})));
            const bool reads = method == "octree_volume";
            if (reads) CHECK(host.explanation(0).find("1 casters without a copy for the CPU yet") != std::string::npos);
            for (int i = 0; i < 12; ++i) { // eight at rest, then the copy comes
                host.require(host.draw({.call = Call::record}));
                host.pictures();
            }
            CHECK(std::string(host.decision(0).pMethod) == method);
            CHECK(differences(drawArrays(arrays, reference, skinning), host.pictures()) == 0);
        }
    }
    CHECK(host.takeMessages().empty());
}

TEST_CASE_FIXTURE(DeviceTest, "updates from buffers that cannot be read are errors, and the mesh stays as it was")
{
    Host host(smallScene());
    const Skinning skinning(ball());
    const BufferMeshData bind(ball(), {.name = "skinned"});
    const GnMesh mesh = createSkinned(host, skinning, bind, 0);
    const auto refused = [&](GnMesh of, GnResult result, const std::string& words, VkDescriptorBufferInfo range,
                             const float* lower = nullptr, const float* upper = nullptr) {
        CHECK(gnUpdateMeshFromBuffer(host.context, of, &range, lower, upper) == result);
        CHECK_MESSAGE(host.lastError().find(words) != std::string::npos, host.lastError());
    };
    VkDescriptorBufferInfo range = skinning.range();
    refused(host.meshes[0], GN_ERROR_INVALID_HANDLE, "is not in buffers", range);
    const float low[3] = {0.0f, 0.0f, 0.0f}, high[3] = {1.0f, -1.0f, 1.0f};
    refused(mesh, GN_ERROR_OUT_OF_RANGE, "boundsMin[1] is 0, above boundsMax[1]", range, low, high);
    refused(mesh, GN_ERROR_NULL_ARGUMENT, "boundsMin and boundsMax go together", range, low);
    range.offset = 4;
    range.range -= 4;
    refused(mesh, GN_ERROR_OUT_OF_RANGE, "mesh 'skinned': positions.range is " + std::to_string(range.range), range);
    range.buffer = VK_NULL_HANDLE;
    refused(mesh, GN_ERROR_NULL_ARGUMENT, "positions.buffer is null", range);
    const float positions[3] = {};
    CHECK(gnUpdateMeshPositions(host.context, mesh, positions, 1, 0) == GN_ERROR_INVALID_HANDLE);
    CHECK(host.lastError().find("gnUpdateMeshFromBuffer") != std::string::npos);
    CHECK(gnUpdateMeshFromBuffer(host.context, mesh, nullptr, nullptr, nullptr) == GN_ERROR_NULL_ARGUMENT);
}
