// Which acceleration structures a frame builds, over a Vulkan that keeps books.
#include <algorithm>
#include <deque>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "runtime/accel/device_rays.hpp"
#include "runtime/passes/pass_context.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/vk_stub.hpp"

using namespace gnomon;
using test::StubVulkan;

namespace {

constexpr std::uint32_t kMany = 200'000; ///< Triangles: two such meshes are more than a frame builds.

/// Casters of one light, each with a mesh of its own.
struct Casters {
    /// @param first number of casters and meshes
    explicit Casters(std::vector<std::uint32_t> triangles, std::uint32_t first = 0)
    {
        for (const std::uint32_t count : triangles) {
            const auto number = first + static_cast<std::uint32_t>(meshes.size());
            indices.emplace_back(3 * count);
            MeshView& mesh = meshes.emplace_back();
            mesh.id = number + 1;
            mesh.positions = positions;
            mesh.indices = indices.back();
            mesh.revision = mesh.faces = number + 1;
            casters.push_back({.index = number, .id = number + 1, .mesh = &mesh, .revision = number + 1});
            light.triangles += count;
        }
        for (const Caster& caster : casters)
            pointers.push_back(&caster);
        light.all = light.statics = pointers;
        light.staticStamp = 1;
    }
    Casters(const Casters&) = delete;

    std::vector<glm::vec3> positions{glm::vec3(0.0f), glm::vec3(1.0f), glm::vec3(2.0f)};
    std::deque<std::vector<std::uint32_t>> indices;
    std::deque<MeshView> meshes;
    std::deque<Caster> casters;
    std::vector<const Caster*> pointers;
    LightCasters light;
};

/// Frames of a light that traces its casters, and what each declares.
struct Frames {
    explicit Frames(bool inFrame) : rays(stub.table, inFrame) { stub.addRays(); }

    void begin()
    {
        arena.reset();
        ++frame;
        pool.begin(frame, frame - 1);
        graph.reset();
        rays.begin();
        graph.beginTask({.view = 1, .light = 1, .method = 0}, &view, {}, {});
    }
    /// @return whether the scene was there
    bool trace(const LightCasters& casters)
    {
        rays.need(casters);
        const bool there = rays.declare(passes, casters) != nullptr;
        failed = graph.endTask().has_value();
        return there;
    }
    /// Frames that do not trace, long enough for the pool to give back what is not used.
    void rest(int count)
    {
        for (int i = 0; i < count; ++i) {
            begin();
            (void)graph.endTask();
        }
    }
    std::uint32_t unbuilt(const LightCasters& casters) { return rays.unbuilt(passes, casters, known); }
    bool runs(std::string_view name) const
    {
        return std::ranges::any_of(graph.passes(), [name](const Pass& pass) { return pass.fn && pass.name == name; });
    }

    StubVulkan stub;
    DeviceMemory memory{stub.table, 1u << 28, {}};
    ResourcePool pool{memory};
    FrameArena arena;
    PassGraph graph{pool, arena};
    PassBuilder passes{graph};
    DeviceRays rays;
    CameraView view;
    UnbuiltCasters known;
    std::uint64_t frame = 0;
    bool failed = false;
};

} // namespace

TEST_CASE("structures are built when something changes, and then no more of them than that changes")
{
    Frames frames(true);
    Casters scene({10, 20});
    const auto built = [&] {
        frames.begin();
        REQUIRE(frames.trace(scene.light));
        return std::pair(frames.runs("rays.meshes"), frames.runs("rays.top_level"));
    };
    CHECK(built() == std::pair(true, true));
    CHECK(frames.stub.live("structure") == 3);
    CHECK(built() == std::pair(false, false));
    scene.casters[0].revision = 100; // it has moved
    CHECK(built() == std::pair(false, true));
    CHECK(built() == std::pair(false, false));
    scene.meshes[1].revision = 101; // its positions were rewritten
    scene.casters[1].revision = 102;
    CHECK(built() == std::pair(true, true));
    CHECK(frames.stub.live("structure") == 4); // and from now on it can be refitted
    scene.meshes[1].revision = 103;
    scene.casters[1].revision = 104;
    CHECK(built() == std::pair(true, true));
    CHECK(frames.stub.live("structure") == 4);
    frames.pool.withdraw(frames.frame--); // as if it had not been
    CHECK(built() == std::pair(true, true));
    CHECK(built() == std::pair(false, false));
}

TEST_CASE("what has not been seen for a second is given back, and built again when it is seen again")
{
    Frames frames(true);
    Casters scene({10});
    frames.begin();
    REQUIRE(frames.trace(scene.light));
    frames.rest(70);
    CHECK(frames.stub.live("structure") == 0);
    frames.begin();
    REQUIRE(frames.trace(scene.light));
    CHECK(frames.runs("rays.meshes"));
    CHECK(frames.runs("rays.top_level"));
}

TEST_CASE("of large meshes a frame builds some, and the light waits until the rest fits a frame")
{
    Frames frames(false);
    const Casters scene({kMany, kMany, kMany}), small({kMany});
    frames.begin();
    CHECK(frames.unbuilt(small.light) == 0); // the frame that traces it builds it
    frames.known = {};
    std::vector<std::uint32_t> waits;
    for (int i = 0; i < 5; ++i) {
        waits.push_back(frames.unbuilt(scene.light));
        frames.rays.want(scene.light);
        frames.rays.declareWanted(frames.passes);
        CHECK_FALSE(frames.graph.endTask().has_value());
        CHECK(frames.runs("rays.meshes") == (i < 3));
        frames.begin();
    }
    CHECK(waits == std::vector<std::uint32_t>{3, 2, 0, 0, 0});
    REQUIRE(frames.trace(scene.light));
    CHECK_FALSE(frames.runs("rays.meshes"));
    CHECK(frames.runs("rays.top_level"));
}

TEST_CASE("what a frame builds is shared by its lights, and none is counted twice")
{
    Frames frames(false);
    const Casters first({kMany}), second({kMany}, 1), small({kMany / 4}, 2);
    UnbuiltCasters ofFirst, ofSecond, ofSmall;
    const auto unbuilt = [&](const Casters& scene, UnbuiltCasters& known) {
        return frames.rays.unbuilt(frames.passes, scene.light, known);
    };
    frames.begin();
    for (int view = 0; view < 2; ++view) {
        CHECK(unbuilt(first, ofFirst) == 0);
        CHECK(unbuilt(second, ofSecond) == 1);
        CHECK(unbuilt(small, ofSmall) == 0);
    }
    frames.rays.need(small.light);
    frames.rays.want(second.light);
    REQUIRE(frames.trace(first.light));
    const std::size_t built = frames.stub.live("structure");
    frames.graph.beginTask({}, nullptr, {}, {});
    frames.rays.declareWanted(frames.passes); // beside what is needed there is no room
    CHECK_FALSE(frames.graph.endTask().has_value());
    CHECK(built == 3); // two meshes and the top level
    CHECK(frames.stub.live("structure") == built);
    frames.begin();
    CHECK(unbuilt(first, ofFirst) == 0); // takes nothing: it is built
    CHECK(unbuilt(second, ofSecond) == 0);
    frames.rays.need(first.light);
    REQUIRE(frames.trace(second.light));
    CHECK(frames.stub.live("structure") == built + 1);
}

TEST_CASE("whatever call fails, the light's task fails, and the next frame has all of it")
{
    std::size_t failures = 0;
    for (std::size_t call = 0;; ++call) {
        CAPTURE(call);
        Frames frames(true);
        const Casters scene({10, 20});
        frames.begin();
        frames.stub.fallibleCalls = 0;
        frames.stub.failAt = call;
        const bool there = frames.trace(scene.light);
        CHECK(there == !frames.failed);
        frames.stub.failAt = SIZE_MAX;
        if (frames.stub.fallibleCalls <= call) break; // there are no more
        CHECK_FALSE(there);
        ++failures;
        frames.graph.beginTask({.view = 1, .light = 2, .method = 0}, &frames.view, {}, {});
        CHECK(frames.trace(scene.light)); // another light of the frame tries again
        CHECK(frames.runs("rays.meshes"));
        CHECK(frames.runs("rays.top_level"));
        frames.begin();
        REQUIRE(frames.trace(scene.light));
        CHECK(frames.stub.live("structure") == 3);
        CHECK(frames.stub.faults.empty());
    }
    CHECK(failures > 10);
}

TEST_CASE("what is bound to trace holds every caster of the light, or there is nothing to bind")
{
    Frames frames(true);
    const Casters scene({10}), other({10, 20});
    frames.begin();
    frames.rays.need(scene.light);
    REQUIRE(frames.rays.declare(frames.passes, scene.light));
    frames.rays.need(other.light); // too late
    CHECK_FALSE(static_cast<bool>(frames.rays.declare(frames.passes, other.light)));
    CHECK_FALSE(frames.graph.endTask().has_value());
}

TEST_CASE("what the pool has given back early, for want of memory, is not built")
{
    Frames frames(false);
    const Casters scene({kMany, kMany});
    frames.begin();
    REQUIRE(frames.trace(scene.light));
    frames.rest(1);
    CHECK(frames.unbuilt(scene.light) == 0);
    const Result<GpuBuffer> much = frames.memory.createBuffer(frames.memory.limit() / 2, 0, MemoryUse::device, "much");
    REQUIRE(much);
    frames.rest(10);
    REQUIRE(frames.stub.live("structure") == 0);
    CHECK(frames.unbuilt(scene.light) == 2);
    GpuBuffer given = *much;
    frames.memory.destroy(given);
}

TEST_CASE("what a dropped frame would have built is not built")
{
    Frames frames(false);
    const Casters scene({kMany, kMany});
    frames.begin();
    REQUIRE(frames.trace(scene.light));
    CHECK(frames.unbuilt(scene.light) == 0);
    frames.pool.withdraw(frames.frame--);
    frames.rays.begin();
    CHECK(frames.unbuilt(scene.light) == 2);
    frames.begin();
    REQUIRE(frames.trace(scene.light));
    frames.begin();
    CHECK(frames.unbuilt(scene.light) == 0);
    frames.pool.lose(frames.frame - 1); // the same of a frame before the newest
    frames.rays.begin();
    CHECK(frames.unbuilt(scene.light) == 2);
}

TEST_CASE("casters are counted again when they or the structures change, and not in other frames")
{
    Frames frames(false);
    Casters scene({kMany, kMany});
    frames.begin();
    CHECK(frames.unbuilt(scene.light) == 2);
    const std::vector<const Caster*> nobody(2, nullptr); // whoever looks at them crashes
    LightCasters unseen = scene.light;
    unseen.all = unseen.statics = nobody;
    frames.rest(1);
    CHECK(frames.unbuilt(unseen) == 2);
    frames.begin();
    REQUIRE(frames.trace(scene.light));
    CHECK(frames.unbuilt(scene.light) == 0);
    scene.meshes[0].revision = 100; // moved apart by the host
    scene.light.staticStamp = 2;
    frames.rest(1);
    CHECK(frames.unbuilt(scene.light) == 0); // one alone may be built by the frame
    scene.meshes[1].revision = 101;
    scene.light.staticStamp = 3;
    frames.rays.begin();
    CHECK(frames.unbuilt(scene.light) == 2);
}

TEST_CASE("a structure whose size is known is copied once, and the whole one goes")
{
    Frames frames(true);
    Casters scene({1000});
    const auto traced = [&](std::string_view pass) {
        frames.begin();
        REQUIRE(frames.trace(scene.light));
        return frames.runs(pass);
    };
    CHECK(traced("rays.sizes"));
    CHECK_FALSE(traced("rays.compact")); // the device has not said it yet
    const VkDeviceSize before = frames.memory.used();
    frames.stub.compactSize = 1024;
    CHECK(traced("rays.compact"));
    CHECK(frames.runs("rays.top_level")); // the mesh is elsewhere
    frames.pool.withdraw(frames.frame--);
    CHECK(traced("rays.compact")); // the copy was not made
    CHECK_FALSE(frames.runs("rays.meshes"));
    CHECK_FALSE(traced("rays.compact"));
    CHECK_FALSE(frames.runs("rays.top_level"));
    CHECK(frames.stub.live("structure") == 3);
    for (int i = 0; i < 70; ++i)
        CHECK_FALSE(traced("rays.meshes"));
    CHECK(frames.stub.live("structure") == 2);
    CHECK(frames.memory.used() + 50'000 < before);
    scene.meshes[0].revision = 100; // it deforms, and is refitted from now on
    scene.casters[0].revision = 101;
    CHECK(traced("rays.meshes"));
    CHECK_FALSE(traced("rays.sizes"));
    CHECK_FALSE(frames.runs("rays.compact"));
    CHECK(frames.stub.faults.empty());
}

TEST_CASE("where there is no room for the copy the whole structure serves")
{
    Frames frames(true);
    const Casters scene({1000});
    frames.begin();
    REQUIRE(frames.trace(scene.light));
    frames.stub.compactSize = 1024;
    for (int i = 0; i < 4; ++i) {
        frames.begin();
        frames.stub.failAt = i == 0 ? frames.stub.fallibleCalls : SIZE_MAX;
        REQUIRE(frames.trace(scene.light));
        CHECK_FALSE(frames.failed);
        CHECK_FALSE(frames.runs("rays.compact"));
        CHECK_FALSE(frames.runs("rays.meshes"));
    }
    CHECK(frames.stub.live("structure") == 2);
}
