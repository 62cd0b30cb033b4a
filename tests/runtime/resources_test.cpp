// Images and buffers of frames that fail, are taken back and tried again, over a Vulkan that keeps books.
#include <doctest/doctest.h>

#include "runtime/passes/pass_context.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/passes/resources.hpp"
#include "runtime/vk_stub.hpp"

using namespace gnomon;
using test::StubVulkan;

namespace {

constexpr VkDeviceSize kMiB = 1u << 20;

/// 4 MiB, as far as the books go.
constexpr ImageInfo kMap{.name = "test.map", .format = VK_FORMAT_D32_SFLOAT, .extent = {1024, 1024}};
constexpr BufferInfo kList{.name = "test.list", .size = 4096, .place = BufferPlace::upload};

struct Pool {
    explicit Pool(VkDeviceSize limit = 64 * kMiB) : memory(stub.table, limit, {}) {}

    PooledImage* transient() { return *pool.transientImage(1, kMap); }
    PooledImage* persistent(std::uint64_t key = 2) { return *pool.persistentImage(key, kMap); }

    StubVulkan stub;
    DeviceMemory memory;
    ResourcePool pool{memory};
};

} // namespace

TEST_CASE("a frame tried again uses what it made before it was taken back")
{
    Pool p;
    for (const std::uint64_t frame : {1, 500}) { // right from the start, or long after what frame 1 left is given back
        PooledImage *transient = nullptr, *persistent = nullptr;
        PooledBuffer *ringed = nullptr, *kept = nullptr;
        for (int attempt = 0; attempt < 3; ++attempt) {
            p.pool.begin(frame, frame - 1);
            PooledImage *const image = p.transient(), *const map = p.persistent();
            PooledBuffer* const list = (*p.pool.transientBuffer(3, kList))->current;
            PooledBuffer* const lasting = (*p.pool.persistentBuffer(4, kList))->current;
            if (attempt > 0) {
                CHECK(image == transient);
                CHECK(map == persistent);
                CHECK(list == ringed);
                CHECK(lasting == kept);
            }
            transient = image, persistent = map, ringed = list, kept = lasting;
            CHECK(p.stub.live("image") == 2);
            CHECK(p.stub.live("buffer") == 2);
            if (attempt < 2) p.pool.withdraw(frame);
        }
    }
}

TEST_CASE("a frame taken back leaves the age of what it used")
{
    Pool p;
    p.pool.begin(1, 0);
    PooledImage* const map = p.persistent();
    p.pool.begin(2, 0);
    p.persistent();
    CHECK(map->kept.lastUsed == 2);
    p.pool.withdraw(2);
    CHECK(map->kept.lastUsed == 1);
    p.pool.withdraw(2); // once is enough
    CHECK(map->kept.lastUsed == 1);
    p.pool.begin(2, 0);
    p.persistent();
    p.pool.withdraw(1); // not the one begun last
    CHECK(map->kept.lastUsed == 2);
}

TEST_CASE("the host's image has the view that the attempt brings, not that of one taken back")
{
    Pool p;
    const auto image = (VkImage)std::uint64_t{0x10};
    const auto before = (VkImageView)std::uint64_t{0x20}, after = (VkImageView)std::uint64_t{0x30};
    p.pool.begin(1, 0);
    p.pool.import(image, before, VK_FORMAT_D32_SFLOAT, {64, 64});
    p.pool.withdraw(1);
    p.pool.begin(1, 0);
    CHECK(p.pool.import(image, after, VK_FORMAT_D32_SFLOAT, {64, 64})->gpu.view == after);
}

TEST_CASE("an image makes room for itself where the GPU has done with others, and has room later where it has not")
{
    const ImageCreate large{
        .format = VK_FORMAT_R8_UNORM, .extent = {4096, 2048}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT, .name = "large"};
    for (const bool done : {true, false}) {
        CAPTURE(done);
        Pool p(64 * kMiB);
        p.pool.begin(1, 0);
        const VkDeviceSize empty = p.memory.used();
        while (p.pool.persistentImage(2 + p.stub.live("image"), kMap)) { // until the memory is full
        }
        p.pool.begin(2, done ? 1 : 0);
        Result<std::unique_ptr<PooledImage>> made = p.pool.ownedImage(large);
        CHECK(bool(made) == done);
        if (!made) {
            CHECK(made.error().result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
            p.pool.withdraw(2);
            p.pool.begin(2, 1);
            made = p.pool.ownedImage(large);
        }
        REQUIRE(made);
        p.memory.destroy((*made)->gpu);
        p.pool.evictAll();
        CHECK(p.memory.used() == empty);
    }
}

TEST_CASE("what is given back after a failure is freed when the frames that use it are done")
{
    Pool p;
    p.pool.begin(1, 0);
    p.transient();
    p.persistent();
    REQUIRE(p.pool.transientBuffer(3, kList));
    p.pool.begin(2, 0);
    p.persistent(5);
    REQUIRE(p.pool.persistentBuffer(4, kList));
    p.pool.withdraw(2); // the GPU never saw what only this one used
    p.pool.evictAll();
    CHECK(p.stub.live("image") == 2);
    CHECK(p.stub.live("buffer") == 1);
    p.pool.begin(2, 1);
    CHECK(p.memory.used() == 0);
}

TEST_CASE("of a frame that ran in part nothing is kept, and its images are in no known layout")
{
    Pool p;
    p.pool.begin(1, 0);
    PooledImage *const used = p.persistent(2), *const other = p.persistent(3);
    for (PooledImage* image : {used, other}) {
        image->kept.stamp = 77;
        image->layers[0].layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    }
    p.pool.begin(2, 1);
    p.persistent(2);
    p.pool.abandon(2);
    CHECK(used->kept.stamp == 0);
    CHECK(used->layers[0].layout == VK_IMAGE_LAYOUT_UNDEFINED);
    CHECK(used->layers[0].writeStages == VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
    CHECK(used->kept.lastUsed == 1);
    CHECK(other->kept.stamp == 77);
    CHECK(other->layers[0].layout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

namespace {

constexpr BufferInfo kCopy{.name = "test.copy", .scope = Scope::light, .size = 4096, .place = BufferPlace::readback};

/// Frames in which a buffer's content is made again in parts.
struct PartFrames : Pool {
    FrameArena arena;
    PassGraph graph{pool, arena};
    CameraView view;
    std::uint64_t stamp = 0; ///< Another one for every call of make().

    void begin(std::uint64_t frame, std::uint64_t completed)
    {
        pool.begin(frame, completed);
        arena.reset();
        graph.reset();
    }
    /// A task that leaves parts. @return what the memory to be written held.
    KeptParts make(const KeptParts& parts, bool fails = false)
    {
        graph.beginTask({.view = 1, .light = 1, .method = 0}, &view, {}, {});
        PassBuilder passes(graph);
        const BufferId buffer = passes.persistent(kCopy);
        REQUIRE(passes.stale(buffer, ++stamp));
        const KeptParts before = passes.partsBefore(buffer);
        passes.keepParts(buffer, parts);
        CHECK(passes.parts(buffer).covered == parts.covered);
        passes.transfer("test.copy", Scope::light).writes(buffer).record([](PassContext&) {});
        if (fails) passes.fail({GN_ERROR_OUT_OF_DEVICE_MEMORY, "Test", "no room for more"});
        REQUIRE(graph.endTask().has_value() == fails);
        return before;
    }
};

} // namespace

TEST_CASE("the parts of a version are those it was left with, whatever other versions hold")
{
    PartFrames p;
    p.begin(1, 0);
    CHECK(p.make({9, 1}).base == 0);
    p.begin(2, 0); // frame 1 still reads its version
    CHECK(p.make({9, 2}).base == 0);
    p.begin(3, 1);
    CHECK(p.make({9, 4}).covered == 1);
    p.begin(4, 2);
    CHECK(p.make({8, 8}).covered == 2);
    p.begin(5, 4);
    CHECK(p.make({8, 16}).covered == 4); // the version not used for longest
    CHECK(p.stub.live("buffer") == 2);
}

TEST_CASE("a frame taken back leaves the parts, one that ran in part or a task that failed leaves none")
{
    PartFrames p; // two versions take turns
    p.begin(1, 0);
    p.make({9, 1});
    p.begin(2, 1);
    CHECK(p.make({9, 2}).base == 0);
    p.begin(3, 2);
    CHECK(p.make({9, 3}).covered == 1);
    p.pool.withdraw(3);
    p.begin(3, 2);
    CHECK(p.make({9, 4}).covered == 1);
    p.begin(4, 3);
    CHECK(p.make({9, 8}).covered == 2);
    p.pool.abandon(4);
    p.begin(4, 3);
    CHECK(p.make({9, 16}).base == 0);
    p.begin(5, 4);
    CHECK(p.make({9, 32}, true).base == 0); // frame 4 had begun with this version
    p.begin(6, 5);
    CHECK(p.make({9, 64}).covered == 16);
    p.begin(7, 6);
    CHECK(p.make({9, 128}).base == 0);
    CHECK(p.stub.live("buffer") == 2);
}
