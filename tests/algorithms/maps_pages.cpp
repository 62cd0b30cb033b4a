// Which pages of a virtual map are asked, and where they are kept, for cameras at random; no device.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include <doctest/doctest.h>

#include "algorithms/maps/page_requests.hpp"
#include "algorithms/maps/page_slots.hpp"
#include "algorithms/shared/light_map.hpp"
#include "maps_fixture.hpp"
#include "shaders/shared/cube.h"

namespace gnomon::test {
namespace {

constexpr std::uint32_t kTexels = 120, kBorder = 4;

/// Boxes under one light, and a camera among them.
struct Town {
    CameraView view;
    LightView lamp;
    std::vector<Caster> all;
    std::vector<const Caster*> pointers;
    LightCasters casters;
    PageRequests requests;

    explicit Town(Random& random, GnLightType type = GN_LIGHT_TYPE_DIRECTIONAL)
        : view(camera({random.in(-200.0f, 200.0f), random.in(1.0f, 20.0f), random.in(-200.0f, 200.0f)}, random.unit(),
                      random.in(0.2f, 0.6f), 1280, 720)),
          lamp(light(type, {random.in(-200.0f, 200.0f), random.in(5.0f, 60.0f), random.in(-200.0f, 200.0f)},
                     glm::normalize(glm::vec3(random.in(-1.0f, 1.0f), -1.0f, random.in(-1.0f, 1.0f))), 300.0f,
                     random.in(0.2f, 1.2f))),
          all(41)
    {
        all[0].bounds = {{-250.0f, -1.0f, -250.0f}, {250.0f, 0.0f, 250.0f}};
        for (std::size_t i = 1; i < all.size(); ++i) {
            const glm::vec3 at(random.in(-240.0f, 240.0f), 0.0f, random.in(-240.0f, 240.0f));
            all[i].bounds = {at,
                             at + glm::vec3(random.in(0.3f, 12.0f), random.in(0.3f, 30.0f), random.in(0.3f, 12.0f))};
        }
        for (const Caster& caster : all)
            pointers.push_back(&caster);
        casters.all = casters.statics = pointers;
    }

    Aabb bounds() const { return sceneBounds(casters); }
    ShadowTask task() const
    {
        ShadowTask task;
        task.view = &view;
        task.light = &lamp;
        task.casters = &casters;
        return task;
    }
    LightFit fit(std::uint32_t face = 0) const
    {
        return lamp.type == GN_LIGHT_TYPE_SPOT    ? fitSpot(lamp, bounds(), 4096, 4.0f)
               : lamp.type == GN_LIGHT_TYPE_POINT ? fitCubeFace(lamp, bounds(), face, 4096, 4.0f)
                                                  : fitDirectional(lamp, bounds());
    }
    PageGrid grid(std::uint32_t face = 0) const { return {fit(face), lamp, view.origin, kTexels, kBorder, face}; }
    void ask(std::uint32_t capacity, double density = 1.0)
    {
        std::vector<PageGrid> grids;
        const std::uint32_t needed = neededLayers(task());
        for (std::uint32_t face = 0; face < mapLayers(lamp.type); ++face)
            if (needed >> face & 1) grids.push_back(grid(face));
        if (grids.empty()) grids.push_back(grid());
        requests.ask(task(), bounds(), grids, {capacity, density});
    }
    /// That a point is looked up in.
    std::uint32_t faceOf(const glm::vec3& point) const
    {
        return lamp.type == GN_LIGHT_TYPE_POINT ? gpu::cubeFaceOf(point - lamp.position()) : 0;
    }
    bool asks(const Page& page) const { return std::ranges::binary_search(requests.pages(), keyOf(page)); }
};

/// Linear depth of what is in sight; below 0: it is not.
double seenAt(const CameraView& view, const glm::vec3& point)
{
    for (std::size_t i = 0; i < 5; ++i)
        if (glm::dot(view.frustum[i].normal, point) + view.frustum[i].distance < 0.0f) return -1.0;
    return static_cast<double>(glm::dot(view.frustum[4].normal, point - view.eye));
}

constexpr GnLightType kTypes[] = {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT, GN_LIGHT_TYPE_POINT};

} // namespace

TEST_CASE("a number is one page, and numbers are in the order of level, face, row and column")
{
    Random random;
    Page before{};
    for (int i = 0; i < 1000; ++i) {
        const auto any = [&](float most) { return static_cast<int>(random.in(-most, most)); };
        const Page page{any(40.0f), any(6e7f), any(6e7f), static_cast<std::uint32_t>(random.in(0.0f, 5.99f))};
        const auto orderOf = [](const Page& p) { return std::tie(p.level, p.face, p.y, p.x); };
        const Page back = pageOf(keyOf(page));
        CHECK(orderOf(back) == orderOf(page));
        CHECK((keyOf(before) < keyOf(page)) == (orderOf(before) < orderOf(page)));
        before = page;
    }
}

TEST_CASE("a page stays where it is in the world, and what is drawn into it is it and its border")
{
    Random random;
    for (int i = 0; i < 200; ++i) {
        const Town town(random);
        const LightFit whole = town.fit();
        const glm::dvec3 moved(random.vec(-1000.0f, 1000.0f));
        const double origin[3] = {moved.x, moved.y, moved.z};
        const PageGrid here(whole, town.lamp, town.view.origin, kTexels, kBorder),
            there(whole, town.lamp, origin, kTexels, kBorder);
        const glm::dvec3 point(random.vec(-300.0f, 300.0f));
        const int level = static_cast<int>(random.in(-10.0f, 4.0f));
        const glm::dvec2 place = here.placeOf(point), same = there.placeOf(point - moved);
        const Page page{level, here.pagesIn({place, place}, level).low.x, here.pagesIn({place, place}, level).low.y};
        const glm::dvec2 inPage = (place - here.cornerOf(page)) / here.width(level);
        if (std::min({inPage.x, inPage.y, 1.0 - inPage.x, 1.0 - inPage.y}) < 1e-6) continue;
        const PageRect other = there.pagesIn({same, same}, level);
        CHECK(other.low == glm::ivec2(page.x, page.y));
        CHECK(glm::length(there.cornerOf(page) + (place - same) - here.cornerOf(page)) < 1e-8 * 1e4);

        // In the picture's clip space the page ends a border's width before the picture does.
        const glm::dvec4 clip = glm::dmat4(here.fitOf(page).clipFromWorld) * glm::dvec4(point, 1.0);
        const double inner = double(kTexels) / (kTexels + 2 * kBorder);
        for (int axis = 0; axis < 2; ++axis)
            CHECK(clip[axis] == doctest::Approx(inner * (2.0 * inPage[axis] - 1.0)).epsilon(0.01));
    }
}

TEST_CASE("where there is room, each point of a caster in sight has a page whose texels are no wider than pixels there")
{
    Random random;
    for (const GnLightType type : kTypes) {
        CAPTURE(type);
        int points = 0;
        for (int i = 0; i < 100; ++i) {
            Town town(random, type);
            town.ask(6000);
            CHECK(town.requests.withoutRoom() == 0);
            for (int j = 0; j < 400; ++j) {
                const Caster& caster = town.all[static_cast<std::size_t>(j) % town.all.size()];
                const glm::vec3 share(random.in(0.0f, 1.0f), random.in(0.0f, 1.0f), random.in(0.0f, 1.0f));
                const glm::vec3 point = caster.bounds.lower + share * (caster.bounds.upper - caster.bounds.lower);
                const double distance = seenAt(town.view, point);
                if (distance < 1.0) continue; // what holds the eye asks from 1 m on
                if (type == GN_LIGHT_TYPE_POINT && glm::distance(point, town.lamp.position()) > 300.0f) continue;
                const PageGrid grid = town.grid(town.faceOf(point));
                const double depth = glm::dot(grid.depth(), glm::dvec4(glm::dvec3(point), 1.0));
                if (depth < grid.nearest()) continue;
                const glm::dvec2 place = grid.placeOf(glm::dvec3(point));
                if (!grid.all().overlaps({place, place})) continue; // beside the cone
                const double pixel = distance * static_cast<double>(town.view.constants.pixelSize) / depth;
                const int wanted = static_cast<int>(std::floor(std::log2(pixel)));
                const int level = std::clamp(wanted, town.requests.firstLevel(), town.requests.coarsest());
                const auto slice = static_cast<std::uint32_t>(level - town.requests.firstLevel());
                if (level < town.requests.coarsest()) {
                    REQUIRE(slice < town.requests.slices());
                    REQUIRE(town.requests.levelOf(slice) == level);
                }
                const PageRect page = grid.pagesIn({place, place}, level);
                CAPTURE(distance);
                CAPTURE(depth);
                REQUIRE(town.asks(grid.page(level, page.low.x, page.low.y)));
                ++points;
            }
        }
        CHECK(points > (type == GN_LIGHT_TYPE_SPOT ? 300 : 2000));
    }
}

TEST_CASE("faces of a point light that no receiver in view lies in take no page")
{
    Random random;
    for (int i = 0; i < 60; ++i) {
        const auto seen = static_cast<std::uint32_t>(i % 6);
        glm::vec3 ahead(0.0f);
        ahead[seen / 2] = seen % 2 ? -1.0f : 1.0f;
        Town town(random, GN_LIGHT_TYPE_POINT);
        town.view = camera(town.lamp.position() + 0.1f * ahead, ahead, 0.3f, 1280, 720); // 34 degrees to either side
        town.ask(256);
        REQUIRE(!town.requests.pages().empty());
        for (const PageKey page : town.requests.pages())
            CHECK(pageOf(page).face == seen);
    }
}

TEST_CASE("no more pages are asked than there is room for, the coarsest level always, and slices grow coarser in turn")
{
    Random random;
    int tight = 0, loose = 0;
    for (int i = 0; i < 300; ++i) {
        const GnLightType type = i < 200 ? GN_LIGHT_TYPE_DIRECTIONAL : GN_LIGHT_TYPE_POINT;
        Town town(random, type);
        const std::uint32_t capacity = std::max(4u << (i % 7), mapLayers(type)); // to 256
        town.ask(capacity, i % 2 ? 1.0 : 4.0);
        const PageRequests& asked = town.requests;
        CHECK(asked.pages().size() <= capacity);
        CHECK(std::ranges::is_sorted(asked.pages()));
        CHECK(std::ranges::adjacent_find(asked.pages()) == asked.pages().end());
        const std::uint32_t needed = neededLayers(town.task());
        for (std::uint32_t face = 0; type == GN_LIGHT_TYPE_POINT && face < 6; ++face) {
            if ((needed >> face & 1) == 0) continue;
            const PageGrid grid = town.grid(face);
            const PageRect rect = grid.pagesIn(grid.all(), asked.coarsest());
            CHECK(town.asks(grid.page(asked.coarsest(), rect.low.x, rect.low.y)));
            CHECK(town.asks(grid.page(asked.coarsest(), rect.high.x, rect.high.y)));
        }
        const PageGrid grid = town.grid();
        for (const Caster& caster : town.all) {
            if (type == GN_LIGHT_TYPE_POINT) break;
            const PageRect rect = grid.pagesIn(grid.rectOf(caster.bounds), asked.coarsest());
            CHECK(town.asks({asked.coarsest(), rect.low.x, rect.low.y}));
            CHECK(town.asks({asked.coarsest(), rect.high.x, rect.high.y}));
        }
        int least = 99, most = 0;
        for (std::uint32_t slice = 0; slice < asked.slices(); ++slice) {
            const int wanted = asked.firstLevel() + static_cast<int>(slice), step = asked.levelOf(slice) - wanted;
            CHECK(step >= 0);
            if (asked.levelOf(slice) >= asked.coarsest()) continue;
            least = std::min(least, step);
            most = std::max(most, step);
        }
        if (least <= most) CHECK(most <= least + 2); // some near slices have a part of a finer level
        if (asked.withoutRoom() == 0 && least <= most) CHECK(most == least); // what a slice's rows do not hold
        (asked.withoutRoom() > 0 ? tight : loose) += 1;
    }
    CHECK(tight > 20);
    CHECK(loose > 20);
}

TEST_CASE("however far casters reach, there is room for what is asked")
{
    Random random;
    for (const float reach : {1e9f, 1e15f, 1e18f, 1e36f})
        for (const GnLightType type : kTypes) {
            CAPTURE(reach);
            CAPTURE(type);
            Town town(random, type);
            town.all[0].bounds = {glm::vec3(-reach), glm::vec3(reach)};
            town.ask(64);
            CHECK(town.requests.pages().size() > 0);
            CHECK(town.requests.pages().size() <= 64);
            const PageGrid grid = town.grid();
            const PageRect all = grid.pagesIn(grid.all(), town.requests.coarsest());
            CHECK((reach > 1e18f || (all.width() <= 8 && all.height() <= 8)));
        }
}

TEST_CASE("pages keep their layers, and those asked least recently make way, as in a list in order of use")
{
    Random random;
    constexpr std::uint32_t kCapacity = 24;
    PageSlots slots(kCapacity);
    std::map<PageKey, std::uint64_t> resident; // the reference: page, frame in which it was asked last
    std::map<PageKey, std::uint32_t> layers;
    std::size_t evictions = 0;
    for (std::uint64_t frame = 1; frame <= 500; ++frame) {
        std::set<PageKey> wanted;
        const int first = static_cast<int>(frame / 10);
        while (wanted.size() < kCapacity / 2)
            wanted.insert(keyOf({0, first + static_cast<int>(random.in(0.0f, 30.0f)), 0}));
        const std::vector<PageKey> pages(wanted.begin(), wanted.end());
        std::size_t missing = 0, evicting = 0;
        for (const PageKey page : pages)
            missing += !resident.contains(page);
        const std::size_t free = kCapacity - resident.size();
        const std::span<const PlacedPage> placed = slots.place(pages, frame);
        REQUIRE(placed.size() == pages.size());
        std::set<std::uint32_t> used;
        for (std::size_t i = 0; i < pages.size(); ++i) {
            CHECK(placed[i].key == pages[i]);
            CHECK(placed[i].slot < kCapacity);
            CHECK(used.insert(placed[i].slot).second);
            if (resident.contains(pages[i])) CHECK(placed[i].slot == layers[pages[i]]);
            evicting += placed[i].evicts;
        }
        CHECK(evicting == (missing > free ? missing - free : 0));
        evictions += evicting;
        std::uint64_t youngest = 0; // of those that made way
        for (const PlacedPage& page : placed)
            for (const auto& [key, slot] : layers)
                if (page.evicts && slot == page.slot && resident.contains(key))
                    youngest = std::max(youngest, resident[key]);
        for (const PlacedPage& page : placed)
            std::erase_if(layers,
                          [&](const auto& entry) { return entry.second == page.slot && entry.first != page.key; });
        std::erase_if(resident, [&](const auto& entry) { return !layers.contains(entry.first); });
        for (const auto& [key, asked] : resident)
            if (!wanted.contains(key)) CHECK(asked >= youngest);
        for (const PlacedPage& page : placed) {
            resident[page.key] = frame;
            layers[page.key] = page.slot;
        }
    }
    CHECK(evictions > 100);
}

} // namespace gnomon::test
