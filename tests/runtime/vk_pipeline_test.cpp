// Life of a pipeline, from description to warm-up draw, against a Vulkan that keeps books.
#include <doctest/doctest.h>

#include <string>
#include <thread>

#include "runtime/vk/pipeline_store.hpp"
#include "runtime/vk_stub.hpp"

using namespace gnomon;
using test::StubVulkan;

namespace {

constexpr VkDeviceSize kMiB = 1u << 20;
constexpr std::uint32_t kVertexCode[] = {1}, kFragmentCode[] = {2}, kComputeCode[] = {3}; // the stub compiles anything
constexpr BindingInfo kBindings[] = {
    {.binding = 2, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT},
    {.binding = 0, .kind = BindingKind::constants},
};
const VkCommandBuffer kCommands = nullptr;

GraphicsPipelineInfo resolveInfo()
{
    return {.name = "test.resolve",
            .vertex = {.code = kVertexCode},
            .fragment = {.code = kFragmentCode},
            .bindings = kBindings,
            .pushBytes = 16,
            .colorFormat = VK_FORMAT_R8_UNORM};
}

GraphicsPipelineInfo castersInfo()
{
    return {.name = "test.casters",
            .vertex = {.code = kVertexCode},
            .vertexStride = 12,
            .casters = true,
            .transforms = true,
            .depthTest = true,
            .depthWrite = true,
            .depthCompare = VK_COMPARE_OP_LESS,
            .depthFormat = VK_FORMAT_D32_SFLOAT_S8_UINT};
}

ComputePipelineInfo listInfo()
{
    static constexpr BindingInfo kList[] = {{.binding = 0, .kind = BindingKind::storageBuffer},
                                            {.binding = 1, .kind = BindingKind::storageBuffer}};
    return {.name = "test.list", .compute = {.code = kComputeCode}, .bindings = kList};
}

struct Fixture {
    StubVulkan stub;
    DeviceMemory memory{stub.table, 512 * kMiB, {}};
    SamplerSet samplers{stub.table};
    PipelineStore store{stub.table, memory, samplers};

    void createAll(std::uint32_t owner)
    {
        while (store.createNext(owner)) {
        }
    }
};

} // namespace

TEST_CASE("equal descriptions are one pipeline, and any difference makes another")
{
    Fixture at;
    const PipelineId first = at.store.graphics(resolveInfo());
    CHECK(at.store.graphics(resolveInfo()) == first);

    const BindingInfo turned[] = {kBindings[1], kBindings[0]};
    GraphicsPipelineInfo info = resolveInfo();
    info.bindings = turned;
    CHECK(at.store.graphics(info) == first); // the order of the list says nothing

    const auto differs = [&](auto change) {
        GraphicsPipelineInfo changed = resolveInfo();
        change(changed);
        const PipelineId id = at.store.graphics(changed);
        CHECK_FALSE(id == first);
        CHECK(at.store.graphics(changed) == id);
    };
    differs([](GraphicsPipelineInfo& i) { i.name = "test.other"; });
    differs([](GraphicsPipelineInfo& i) { i.fragment.code = kVertexCode; });
    differs([](GraphicsPipelineInfo& i) { i.fragment.specializationCount = 1; });
    differs([](GraphicsPipelineInfo& i) { i.fragment = {kFragmentCode, 1, {5}}; });
    differs([](GraphicsPipelineInfo& i) { i.colorFormat = VK_FORMAT_R32_SFLOAT; });
    differs([](GraphicsPipelineInfo& i) { i.stencil.enable = true; });
    differs([](GraphicsPipelineInfo& i) { i.blendScale = true; });
    differs([](GraphicsPipelineInfo& i) { i.transforms = true; });
    differs([](GraphicsPipelineInfo& i) { i.depthCompare = VK_COMPARE_OP_LESS; });
    differs([](GraphicsPipelineInfo& i) { i.bindings = std::span(kBindings).first(1); });
}

TEST_CASE("bindings are kept in the order of dynamic offsets")
{
    Fixture at;
    const PipelineId resolve = at.store.graphics(resolveInfo());
    const PipelineId casters = at.store.graphics(castersInfo());
    at.createAll(0);
    const Pipeline& made = at.store.get(resolve);
    REQUIRE(made.bindings.size() == 2);
    CHECK(made.bindings[0].binding == 0);
    CHECK(made.bindings[1].binding == 2);
    CHECK(made.pushBytes == 16);
    CHECK_FALSE(made.casters);
    CHECK(at.store.get(casters).bindings.empty());
    CHECK(at.store.get(casters).casters);
}

TEST_CASE("pipelines are made with the host's cache, which stays the host's, or with one of our own")
{
    StubVulkan stub;
    const VkPipelineCacheCreateInfo empty{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO, nullptr, 0, 0, nullptr};
    VkPipelineCache hosts = VK_NULL_HANDLE;
    REQUIRE(stub.table.vkCreatePipelineCache(VK_NULL_HANDLE, &empty, nullptr, &hosts) == VK_SUCCESS);
    for (const bool given : {true, false}) {
        CAPTURE(given);
        stub.table.pipelineCache = given ? hosts : VkPipelineCache(VK_NULL_HANDLE);
        {
            DeviceMemory memory{stub.table, 512 * kMiB, {}};
            SamplerSet samplers{stub.table};
            PipelineStore store{stub.table, memory, samplers};
            for (const PipelineId id : {store.graphics(resolveInfo()), store.compute(listInfo())}) {
                stub.lastPipelineCache = VK_NULL_HANDLE;
                REQUIRE(store.createNext(0));
                CHECK(stub.lastPipelineCache != VkPipelineCache(VK_NULL_HANDLE));
                CHECK((stub.lastPipelineCache == hosts) == given);
                CHECK(store.get(id).pipeline != VkPipeline(VK_NULL_HANDLE));
            }
            CHECK(stub.live("cache") == (given ? 1 : 2));
        }
        CHECK(stub.live("cache") == 1);
    }
    stub.table.vkDestroyPipelineCache(VK_NULL_HANDLE, hosts, nullptr);
}

TEST_CASE("a method is ready once all of its pipelines, shared ones included, are created and tried")
{
    Fixture at;
    at.store.setOwner(1);
    at.store.graphics(resolveInfo());
    at.store.setOwner(2);
    at.store.graphics(resolveInfo());
    at.store.compute(listInfo());
    CHECK_FALSE(at.store.created(1));
    CHECK_FALSE(at.store.ready(2));
    CHECK(at.store.ready(3)); // has none

    CHECK(at.store.createNext(1));
    CHECK_FALSE(at.store.createNext(1));
    CHECK(at.store.created(1));
    CHECK_FALSE(at.store.created(2));
    REQUIRE(at.store.recordWarmupDraws(kCommands, 1));
    CHECK(at.store.ready(1));
    CHECK_FALSE(at.store.ready(2));
    CHECK(at.stub.counts["draw"] == 1);

    CHECK(at.store.createNext(2));
    CHECK_FALSE(at.store.createNext(2));
    REQUIRE(at.store.recordWarmupDraws(kCommands, 2));
    CHECK(at.store.ready(2));
    CHECK(at.stub.counts["draw"] == 1); // the shared one was tried already
    CHECK(at.stub.counts["dispatch"] == 1);
    CHECK(at.stub.table.pipelinesMade == 2);
    CHECK(at.stub.live("module") == 0);
}

TEST_CASE("a warm-up draw clears what it binds, keeps rendering scopes closed and tries casters with and without bias")
{
    Fixture at;
    at.store.graphics(resolveInfo());
    at.store.graphics(castersInfo());
    at.store.compute(listInfo());
    at.createAll(0);
    REQUIRE(at.store.recordWarmupDraws(kCommands, 0));
    CHECK(at.stub.counts["begin"] == 2);
    CHECK(at.stub.counts["end"] == 2);
    CHECK(at.stub.counts["draw"] == 1);
    CHECK(at.stub.counts["drawIndexed"] == 2);
    CHECK(at.stub.counts["dispatch"] == 1);
    CHECK(at.stub.counts["clear"] == 3);          // sampled depth, colour target, depth target
    CHECK(at.stub.counts["fill"] == 3 * (2 + 1)); // two storage buffers and a mark before each of three warmups
    const std::size_t made = at.stub.table.objectsMade;
    REQUIRE(at.store.recordWarmupDraws(kCommands, 0));
    CHECK(at.stub.table.objectsMade == made);
    CHECK(at.stub.counts["draw"] == 1);
}

TEST_CASE("a failure at any step of creation or warmup leaves nothing behind")
{
    std::size_t step = 0;
    for (bool done = false; !done; ++step) {
        StubVulkan stub;
        stub.failAt = step;
        {
            DeviceMemory memory(stub.table, 512 * kMiB, {});
            SamplerSet samplers(stub.table);
            const bool sampled = static_cast<bool>(samplers.create());
            PipelineStore store(stub.table, memory, samplers);
            store.graphics(resolveInfo());
            store.graphics(castersInfo());
            store.compute(listInfo());
            while (store.createNext(0)) {
            }
            CHECK(stub.live("module") == 0);
            CHECK(store.created(0) == store.failure(0).empty());
            if (!store.created(0)) CHECK(store.failure(0).find("failed") != std::string::npos);
            const bool tried = static_cast<bool>(store.recordWarmupDraws(kCommands, 0));
            CHECK(store.ready(0) == (tried && store.created(0)));
            if (!tried) {
                CHECK(stub.counts["begin"] == 0);
                CHECK(store.recordWarmupDraws(kCommands, 0)); // the next frame tries again
                CHECK(store.ready(0));
            }
            done = sampled && tried && store.created(0) && step > stub.fallibleCalls;
        }
        CHECK(stub.live() == 0);
        CHECK(stub.faults.empty());
    }
    CHECK(step > 30);
}

TEST_CASE("what the device was not asked for is refused by name, not attempted")
{
    Fixture at;
    GraphicsPipelineInfo info = castersInfo();
    info.depthClamp = true;
    at.store.graphics(info);
    at.createAll(0);
    CHECK(at.store.failure(0) == "test.casters: needs depthClamp");
    CHECK(at.stub.counts["pipeline"] == 0);

    at.stub.table.enabled.depthClamp = VK_TRUE;
    at.store.setOwner(1);
    info.name = "test.clamped";
    at.store.graphics(info);
    at.createAll(1);
    CHECK(at.store.created(1));

    at.store.setOwner(2);
    const BindingInfo unnamed[] = {{.binding = 3, .kind = BindingKind::storageImage}};
    ComputePipelineInfo list = listInfo();
    list.bindings = unnamed;
    at.store.compute(list);
    at.createAll(2);
    CHECK(at.store.failure(2) == "test.list: binding 3 names no image format");
}

TEST_CASE("more bindings than a stage may have are refused by name, not attempted")
{
    struct Case {
        BindingKind kind;
        std::uint32_t count;
        const char* failure; ///< Empty: as many as every device allows.
    };
    for (const Case& each : {Case{BindingKind::storageBuffer, 4, ""},
                             Case{BindingKind::storageBuffer, 5, "test.list: 5 storage buffers; at most 4"},
                             Case{BindingKind::constants, 9, "test.list: 9 uniform buffers; at most 8"},
                             Case{BindingKind::storageImage, 5, "test.list: 5 storage images; at most 4"},
                             Case{BindingKind::sampledImage, 16, ""},
                             Case{BindingKind::sampledImage, 17, "test.list: 17 sampled images; at most 16"}}) {
        Fixture at;
        std::vector<BindingInfo> bindings;
        for (std::uint32_t i = 0; i < each.count; ++i)
            bindings.push_back({.binding = i, .kind = each.kind, .format = VK_FORMAT_R8_UNORM});
        ComputePipelineInfo list = listInfo();
        list.bindings = bindings;
        at.store.compute(list);
        at.createAll(0);
        CHECK(at.store.failure(0) == each.failure);
        CHECK(at.stub.counts["pipeline"] == (*each.failure ? 0 : 1));
    }

    Fixture at; // of allowed kinds, but too many in all
    std::vector<BindingInfo> bindings;
    for (std::uint32_t i = 0; i < 17; ++i)
        bindings.push_back({.binding = i,
                            .kind = i < 3 ? BindingKind::storageBuffer : BindingKind::sampledImage,
                            .format = VK_FORMAT_R8_UNORM});
    ComputePipelineInfo list = listInfo();
    list.bindings = bindings;
    at.store.compute(list);
    at.createAll(0);
    CHECK(at.store.failure(0) == "test.list: 17 bindings; at most 16");
}

TEST_CASE("a worker creates while the frame's thread describes and asks")
{
    Fixture at;
    for (std::uint32_t i = 0; i < 50; ++i) {
        ComputePipelineInfo info = listInfo();
        info.compute.specializationCount = 1;
        info.compute.specialization[0] = i;
        at.store.compute(info);
    }
    std::thread worker([&at] { at.createAll(0); });
    at.store.setOwner(1);
    for (std::uint32_t i = 0; i < 200; ++i) {
        ComputePipelineInfo info = listInfo();
        info.compute.specializationCount = 1;
        info.compute.specialization[0] = i;
        at.store.compute(info);
        if (at.store.created(0)) CHECK(at.store.failure(0).empty());
    }
    worker.join();
    CHECK(at.store.created(0));
    at.createAll(1);
    CHECK(at.store.created(1));
    CHECK(at.stub.live("pipeline") == 200);
}
