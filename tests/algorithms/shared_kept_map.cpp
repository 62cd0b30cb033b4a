// What a kept map draws, copies or leaves alone, and that every layer asked for holds its casters afterwards.
#include <doctest/doctest.h>

#include <random>

#include "algorithms/kept_map_frames.hpp"

using namespace gnomon;
using namespace gnomon::test;

using Names = std::vector<std::string>;

TEST_CASE("a layer's stamps change with what is drawn into it, the one of the statics without the dynamic casters")
{
    const LightView still{.revision = 5, .isStatic = true};
    const Casters statics({11, 12}), moved({11, 13}), fewer({11}), dynamics({21}), nearer({22});
    const LayerContent base = layerContent(still, statics.pointers, dynamics.pointers, 7);
    CHECK(base.statics.data() == statics.pointers.data());
    CHECK(base.dynamics.data() == dynamics.pointers.data());
    REQUIRE(base.stamp > 15); // smaller ones mean other things
    REQUIRE(base.staticsStamp > 15);
    const auto changes = [&](const LayerContent& other, bool all, bool ofStatics) {
        CHECK((other.stamp != base.stamp) == all);
        CHECK((other.staticsStamp != base.staticsStamp) == ofStatics);
    };
    changes(layerContent(still, statics.pointers, dynamics.pointers, 7), false, false);
    changes(layerContent(still, statics.pointers, nearer.pointers, 7), true, false);
    changes(layerContent(still, statics.pointers, {}, 7), true, false);
    changes(layerContent(still, moved.pointers, dynamics.pointers, 7), true, true);
    changes(layerContent(still, fewer.pointers, dynamics.pointers, 7), true, true);
    changes(layerContent(still, statics.pointers, dynamics.pointers, 8), true, true);
    changes(layerContent({.revision = 6, .isStatic = true}, statics.pointers, dynamics.pointers, 7), true, true);
    // A light that moves: nothing is kept apart, the rest is as it was. Without static casters nothing is to keep.
    const LayerContent moving = layerContent({.revision = 5}, statics.pointers, dynamics.pointers, 7);
    CHECK(moving.staticsStamp == 0);
    CHECK(moving.stamp == base.stamp);
    CHECK(layerContent(still, {}, dynamics.pointers, 7).staticsStamp == 0);
}

TEST_CASE("a layer is drawn when its own stamp changes, and once for all tasks of the light")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1}, {2}, 100, 0}, {{3}, {}, 200, 0}};
    CHECK(frames.run(wanted, 2) == Names{"casters 0", "casters 1"});
    CHECK(frames.layers == std::vector<Revisions>{{1, 2}, {3}});
    CHECK(frames.run(wanted, 2).empty());
    CHECK(frames.kept == 4); // a layer and task each
    CHECK(frames.drawn.prepared.empty());
    wanted[1] = {{4}, {5, 6}, 201, 0};
    CHECK(frames.run(wanted) == Names{"casters 1"});
    CHECK(frames.kept == 1);
    CHECK(frames.drawn.prepared == std::vector<std::size_t>{1, 2});
    CHECK(frames.layers == std::vector<Revisions>{{1, 2}, {4, 5, 6}});
}

TEST_CASE("under moving casters the static ones are drawn once and copied")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1, 2}, {8}, 100, 50}};
    CHECK(frames.run(wanted) == Names{"statics 0", "copy 0", "casters 0"});
    CHECK(frames.drawn.prepared == std::vector<std::size_t>{2, 0, 0, 1});
    CHECK(frames.layers[0] == Revisions{1, 2, 8});
    wanted[0].dynamics = {9};
    wanted[0].stamp = 101;
    CHECK(frames.run(wanted) == Names{"copy 0", "casters 0"});
    CHECK(frames.kept == 1);
    CHECK(frames.layers[0] == Revisions{1, 2, 9});
    wanted[0] = {{1, 3}, {9}, 102, 51};
    CHECK(frames.run(wanted) == Names{"statics 0", "copy 0", "casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 3, 9});
    wanted[0] = {{1, 3}, {}, 103, 51}; // nothing moves over a copy: drawn as they are
    CHECK(frames.run(wanted) == Names{"casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 3});
}

TEST_CASE("where there is no room for an image of the static casters they are drawn with the moving ones")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1, 2}, {8}, 100, 50}};
    auto most = frames.takeRoom();
    CHECK(frames.run(wanted) == Names{"casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 2, 8});
    frames.giveRoom(std::move(most));
    CHECK(frames.run(wanted).empty());
    wanted[0].dynamics = {9};
    wanted[0].stamp = 101;
    CHECK(frames.run(wanted) == Names{"statics 0", "copy 0", "casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 2, 9});
    most = frames.takeRoom(); // the image that is there goes on serving
    wanted[0].dynamics = {10};
    wanted[0].stamp = 102;
    CHECK(frames.run(wanted) == Names{"copy 0", "casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 2, 10});
}

TEST_CASE("where room is found between two tasks of a frame the layer holds its casters all the same")
{
    Frames frames;
    std::unique_ptr<PooledImage> most;
    frames.before = [&](std::uint32_t task) {
        if (task == 0)
            most = frames.takeRoom();
        else
            frames.giveRoom(std::move(most));
    };
    const std::vector<Wanted> wanted{{{1, 2}, {8}, 100, 50}};
    CHECK(frames.run(wanted, 2) == Names{"casters 0", "statics 0", "copy 0", "casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 2, 8});
}

TEST_CASE(
    "an image made again is drawn whatever its stamps say, a layer not asked for meanwhile when it is wanted again")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1}, {}, 100, 0}, {{2}, {}, 200, 0}};
    CHECK(frames.run(wanted).size() == 2);
    wanted[1].stamp = 0;
    CHECK(frames.run(wanted).empty()); // skipped: left as it is
    wanted[1].stamp = 200;
    CHECK(frames.run(wanted).empty());   // and still what it was
    wanted.push_back({{3}, {}, 300, 0}); // three layers are another image
    wanted[1].stamp = 0;
    CHECK(frames.run(wanted).size() == 2);
    wanted[1].stamp = 200;
    CHECK(frames.run(wanted) == Names{"casters 1"});
    CHECK(frames.layers == std::vector<Revisions>{{1}, {2}, {3}});
}

namespace {

/// Draws layers of static and moving casters, then gives the statics' image back, which a second frame has no use for.
void loseStatics(Frames& frames, const std::vector<Wanted>& wanted)
{
    CHECK(frames.run(wanted).size() == 3 * wanted.size());
    CHECK(frames.run(wanted).empty());
    frames.runOut();
}

} // namespace

TEST_CASE("static casters are drawn again when their image alone was given back")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1}, {7}, 100, 50}};
    loseStatics(frames, wanted);
    CHECK(frames.run(wanted).empty()); // nobody misses it yet
    wanted[0].dynamics = {8};
    wanted[0].stamp = 101;
    CHECK(frames.run(wanted) == Names{"statics 0", "copy 0", "casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 8});
}

TEST_CASE("whatever changes from frame to frame, every layer wanted holds its casters")
{
    Frames frames;
    std::mt19937 random(17);
    std::vector<Wanted> wanted(4);
    std::uint64_t next = 1;
    int copied = 0, untouched = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<Wanted> asked;
        for (Wanted& layer : wanted) {
            const bool fresh = layer.stamp == 0;
            if (fresh || random() % 8 == 0) layer.statics = {next++, next++};
            if (fresh || random() % 4 == 0) layer.dynamics = Revisions(random() % 3, next++);
            Stamp stamp;
            for (const std::uint64_t revision : layer.statics)
                stamp.add(revision);
            layer.staticsStamp = random() % 8 ? stamp.value() : 0;
            stamp.add(std::uint64_t{layer.dynamics.size()});
            for (const std::uint64_t revision : layer.dynamics)
                stamp.add(revision);
            layer.stamp = stamp.value();
            asked.push_back(random() % 4 ? layer : Wanted{});
        }
        const Names names = frames.run(asked);
        copied += names.size() > 1 && names.front().starts_with("copy");
        untouched += names.empty();
        for (std::size_t k = 0; k < asked.size(); ++k) {
            if (asked[k].stamp == 0) continue;
            Revisions all(asked[k].statics);
            all.insert(all.end(), asked[k].dynamics.begin(), asked[k].dynamics.end());
            std::sort(all.begin(), all.end());
            CHECK(frames.layers[k] == all);
        }
    }
    CHECK(copied > 20);
    CHECK(untouched > 10);
    CHECK(frames.vulkan.faults.empty());
}

TEST_CASE(
    "where the statics' image was made again, a layer that moves later than another draws its statics again as well")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1}, {7}, 100, 50}, {{2}, {8}, 200, 60}};
    loseStatics(frames, wanted);
    wanted[0].dynamics = {9};
    wanted[0].stamp = 101;
    CHECK(frames.run(wanted) == Names{"statics 0", "copy 0", "casters 0"});
    wanted[1].dynamics = {10};
    wanted[1].stamp = 201;
    CHECK(frames.run(wanted) == Names{"statics 1", "copy 1", "casters 1"});
    CHECK(frames.layers[1] == Revisions{2, 10});
}

TEST_CASE("what a task that failed has promised is drawn when it is declared again")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1}, {}, 100, 50}};
    CHECK(frames.run(wanted).size() == 1);
    wanted[0] = {{1}, {7}, 101, 50};
    frames.vulkan.failAt = frames.vulkan.fallibleCalls; // no image for the statics
    frames.fails = true;
    frames.run(wanted);
    CHECK(frames.layers[0] == Revisions{1});
    frames.fails = false;
    CHECK(frames.run(wanted) == Names{"statics 0", "copy 0", "casters 0"});
    CHECK(frames.layers[0] == Revisions{1, 7});
}

TEST_CASE("what a task that failed was to draw is drawn for a later task of the frame, and kept")
{
    for (const std::uint32_t failing : {0u, 1u}) {
        Frames frames;
        const std::vector<Wanted> wanted{{{1}, {7}, 100, 50}, {{2}, {}, 200, 0}};
        frames.failing = failing;
        CHECK(frames.run(wanted, 2) == Names{"statics 0", "casters 1", "copy 0", "casters 0"});
        CHECK(frames.layers == std::vector<Revisions>{{1, 7}, {2}});
        frames.failing = UINT32_MAX;
        CHECK(frames.run(wanted, 2).empty());
        CHECK(frames.layers == std::vector<Revisions>{{1, 7}, {2}});
    }
}

TEST_CASE("a frame that is taken back and submitted again with other casters leaves their stamp")
{
    Frames frames;
    std::vector<Wanted> wanted{{{1}, {}, 100, 0}};
    CHECK(frames.run(wanted).size() == 1);
    wanted[0] = {{2}, {}, 101, 0};
    CHECK(frames.run(wanted).size() == 1);
    frames.pool.withdraw(frames.frame);
    --frames.frame;
    wanted[0] = {{3}, {}, 102, 0};
    CHECK(frames.run(wanted).size() == 1);
    wanted[0] = {{1}, {}, 100, 0};
    CHECK(frames.run(wanted).size() == 1);
    CHECK(frames.layers[0] == Revisions{1});
}
