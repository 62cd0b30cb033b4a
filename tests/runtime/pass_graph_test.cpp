// What the order of passes follows from, over a Vulkan that keeps books.
#include <doctest/doctest.h>

#include "runtime/passes/pass_context.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/vk_stub.hpp"

using namespace gnomon;
using test::StubVulkan;

namespace {

constexpr ImageInfo kDepth{.name = "test.depth", .format = VK_FORMAT_D32_SFLOAT_S8_UINT, .extent = {64, 64}};
constexpr Rect kLeft{0, 0, 32, 64}, kRight{32, 0, 32, 64};

/// A frame under declaration, in one task of one light.
struct Frame {
    Frame()
    {
        pool.begin(1, 0);
        graph.reset();
        graph.beginTask({.view = 1, .light = 1, .method = 0}, &view, {}, {});
    }
    using Add = PassRef& (PassRef::*)(ImageId, Part);
    /// A raster pass of one access.
    void pass(Add add, ImageId image, const Part& part)
    {
        PassRef pass = passes.raster("test.pass", Scope::task, count++);
        (pass.*add)(image, part);
        pass.record([](PassContext&) {});
    }
    std::uint32_t batch(std::size_t index) { return graph.passes()[index].batch; }

    StubVulkan stub;
    DeviceMemory memory{stub.table, 1u << 26, {}};
    ResourcePool pool{memory};
    FrameArena arena;
    PassGraph graph{pool, arena};
    PassBuilder passes{graph};
    CameraView view;
    std::uint32_t count = 0;
};

} // namespace

TEST_CASE("passes that test an image run side by side, but not before one that clears it to test it")
{
    for (const Frame::Add test : {&PassRef::depthTest, &PassRef::stencilTest}) {
        Frame frame;
        const ImageId image = frame.passes.transient(kDepth);
        frame.pass(test, image, {.clear = true});
        frame.pass(test, image, {});
        frame.pass(test, image, {});
        frame.pass(test, image, {.clear = true});
        CHECK(frame.batch(0) == 0);
        CHECK(frame.batch(1) == 1);
        CHECK(frame.batch(2) == 1);
        CHECK(frame.batch(3) == 2);
    }
}

TEST_CASE("passes that clear different parts of an image to test them run side by side")
{
    Frame frame;
    const ImageId image = frame.passes.transient(kDepth);
    frame.pass(&PassRef::depthTest, image, {.rect = kLeft, .clear = true});
    frame.pass(&PassRef::depthTest, image, {.rect = kRight, .clear = true});
    frame.pass(&PassRef::depthTest, image, {.rect = kRight});
    CHECK(frame.batch(0) == 0);
    CHECK(frame.batch(1) == 0);
    CHECK(frame.batch(2) == 1);
}

TEST_CASE("passes that trace run side by side, after builds before them and before builds after them")
{
    Frame frame;
    const BufferId order = frame.passes.persistent(BufferInfo{.name = "test.order", .scope = Scope::scene});
    const auto build = [&](const char* name) {
        frame.passes.compute(name, Scope::scene).builds(order).record([](PassContext&) {});
    };
    const auto trace = [&](std::uint32_t variant) {
        frame.passes.raster("test.trace", Scope::task, variant).traces(order).record([](PassContext&) {});
    };
    build("test.meshes");
    build("test.top_level");
    trace(0);
    trace(1);
    build("test.more_meshes");
    const std::uint32_t expected[] = {0, 1, 2, 2, 3};
    for (std::size_t i = 0; i < std::size(expected); ++i)
        CHECK(frame.batch(i) == expected[i]);
    const AccessTraits built = accessTraits(AccessKind::build, PassKind::compute);
    const AccessTraits traced = accessTraits(AccessKind::trace, PassKind::raster);
    CHECK(built.stages == VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR);
    CHECK((traced.stages & VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT) != 0);
    CHECK((built.access & traced.access) == VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR);
}

TEST_CASE("of an image that a failed task would have cleared to test it nothing is kept")
{
    Frame frame;
    const ImageId image = frame.passes.persistent(kDepth);
    KeptState& kept = frame.graph.image(image).kept;
    for (const bool clear : {false, true}) {
        kept.stamp = 77;
        frame.pass(&PassRef::stencilTest, image, {.clear = clear});
        frame.passes.fail({GN_ERROR_OUT_OF_DEVICE_MEMORY, "Test", "no room for more"});
        REQUIRE(frame.graph.endTask().has_value());
        CHECK(kept.stamp == (clear ? 0 : 77));
        frame.graph.resumeTask(0);
    }
}

TEST_CASE("pages of maps are counted for the frame, but those of a task that cannot run are not")
{
    Frame frame;
    frame.passes.pages(2, 3);
    CHECK(!frame.graph.endTask());
    frame.graph.beginTask({.view = 1, .light = 2, .method = 0}, &frame.view, {}, {});
    frame.passes.pages(5, 7);
    frame.passes.fail({GN_ERROR_OUT_OF_DEVICE_MEMORY, "Test", "no room"});
    CHECK(frame.graph.endTask());
    CHECK(frame.graph.counts().pagesEvicted == 2);
    CHECK(frame.graph.counts().pagesWithoutRoom == 3);
    frame.graph.reset();
    CHECK(frame.graph.counts().pagesEvicted == 0);
    CHECK(frame.graph.counts().pagesWithoutRoom == 0);
}
