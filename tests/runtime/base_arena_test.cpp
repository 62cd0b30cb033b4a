#include <doctest/doctest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "runtime/allocation_count.hpp"
#include "runtime/base/arena.hpp"

using namespace gnomon;

TEST_CASE("the counter that tests of steady frames rely on counts")
{
    const std::size_t before = test::allocationCount();
    const auto kept = std::make_unique<std::vector<int>>(100);
    CHECK(test::allocationCount() == before + 2);
    CHECK(kept->size() == 100);
}

TEST_CASE("what the arena gives is aligned and does not overlap")
{
    FrameArena arena(1000);
    struct Piece {
        std::uintptr_t begin, end;
    };
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < 500; ++i) {
        const std::size_t size = i * 37 % 300, alignment = std::size_t(1) << (i % 9);
        void* place = arena.allocate(size, alignment);
        REQUIRE(place != nullptr);
        const auto begin = reinterpret_cast<std::uintptr_t>(place);
        REQUIRE(begin % alignment == 0);
        std::memset(place, int(i), size); // within bounds: a sanitizer's business
        if (size) pieces.push_back({begin, begin + size});
    }
    std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.begin < b.begin; });
    for (std::size_t i = 1; i < pieces.size(); ++i)
        REQUIRE(pieces[i - 1].end <= pieces[i].begin);
}

TEST_CASE("a piece larger than a block gets a block that holds it")
{
    FrameArena arena(64);
    std::span<int> large = arena.array<int>(10000);
    std::fill(large.begin(), large.end(), 1);
    CHECK(large.size() == 10000);
    CHECK(arena.blockCount() == 1);
}

TEST_CASE("copy keeps the values and an empty array is valid")
{
    FrameArena arena;
    const std::vector<int> values{3, 1, 4};
    const std::span<int> copied = arena.copy(std::span<const int>(values));
    CHECK(std::equal(values.begin(), values.end(), copied.begin(), copied.end()));
    CHECK(arena.array<double>(0).empty());
    CHECK(*arena.make<int>(7) == 7);
}

TEST_CASE("a repeated frame allocates nothing, whatever the order of its requests")
{
    FrameArena arena(4096);
    std::vector<std::size_t> sizes;
    for (std::size_t i = 0; i < 40; ++i)
        sizes.push_back(i % 10 == 0 ? 6000 : 300);
    const auto frame = [&] {
        arena.reset();
        for (std::size_t size : sizes)
            arena.allocate(size, 16);
    };
    frame();
    std::reverse(sizes.begin(), sizes.end()); // the costliest order for blocks of two sizes
    frame();
    const std::size_t blocks = arena.blockCount(), before = test::allocationCount();
    for (int i = 0; i < 20; ++i) {
        std::rotate(sizes.begin(), sizes.begin() + 7, sizes.end());
        frame();
    }
    CHECK(test::allocationCount() == before);
    CHECK(arena.blockCount() == blocks);
}

TEST_CASE("threads get pieces of their own")
{
    FrameArena arena(512);
    std::vector<std::thread> threads;
    std::atomic<int> disturbed{0};
    for (int id = 0; id < 4; ++id)
        threads.emplace_back([&arena, &disturbed, id] {
            std::vector<std::span<int>> mine;
            for (std::size_t i = 1; i < 200; ++i) {
                mine.push_back(arena.array<int>(i % 30));
                std::fill(mine.back().begin(), mine.back().end(), id);
            }
            for (std::span<int> piece : mine)
                for (int value : piece)
                    if (value != id) ++disturbed;
        });
    for (std::thread& thread : threads)
        thread.join();
    CHECK(disturbed == 0);
}
