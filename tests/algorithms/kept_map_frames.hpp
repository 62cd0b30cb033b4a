#pragma once
// Frames in which one light's KeptMap is declared, over a Vulkan that does nothing: passes are carried out on lists of
// casters instead of images.
#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "algorithms/shared/kept_map.hpp"
#include "runtime/passes/pass_context.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/vk_stub.hpp"

namespace gnomon::test {

constexpr std::uint32_t kResolution = 64;
constexpr LayerNames kLayerNames[] = {{"casters 0", "statics 0", "copy 0"},
                                      {"casters 1", "statics 1", "copy 1"},
                                      {"casters 2", "statics 2", "copy 2"},
                                      {"casters 3", "statics 3", "copy 3"}};
using Revisions = std::vector<std::uint64_t>; ///< Of the casters that a layer holds, in ascending order.

/// Casters of which each is told by its revision.
struct Casters {
    std::vector<Caster> owned;
    std::vector<const Caster*> pointers;

    explicit Casters(const Revisions& revisions) : owned(revisions.size())
    {
        for (std::size_t i = 0; i < revisions.size(); ++i) {
            owned[i].id = static_cast<std::uint32_t>(i + 1);
            owned[i].revision = revisions[i];
            pointers.push_back(&owned[i]);
        }
    }
};

struct Drawn {
    Revisions* target = nullptr;
    std::vector<std::size_t> prepared; ///< Counts of statics and dynamics, in turn.
};

struct Draw {
    Drawn* drawn;
    BufferId read;

    void uses(PassRef& pass) const { pass.reads(read); }
    Draw prepared(PassBuilder&, std::span<const Caster* const> statics, std::span<const Caster* const> dynamics) const
    {
        drawn->prepared.insert(drawn->prepared.end(), {statics.size(), dynamics.size()});
        return *this;
    }
    void operator()(PassContext&, std::span<const Caster* const> casters, bool) const
    {
        for (const Caster* caster : casters)
            drawn->target->push_back(caster->revision);
    }
};

/// What a task wants of a layer in a frame; stamps 0: nothing.
struct Wanted {
    Revisions statics, dynamics;
    std::uint64_t stamp = 0, staticsStamp = 0;
};

/// Frames of one light, one after the other; images hold the casters that passes leave in them.
struct Frames {
    StubVulkan vulkan;
    DeviceMemory memory{vulkan.table, VkDeviceSize{1} << 30, {}};
    ResourcePool pool{memory};
    FrameArena arena;
    PassGraph graph{pool, arena};
    CameraView view;
    std::uint64_t frame = 0;
    std::map<std::pair<VkImage, std::uint32_t>, Revisions> held; ///< By image and layer.
    Drawn drawn;
    std::uint32_t kept = 0;
    std::vector<Revisions> layers;             ///< Of the sampled image.
    bool fails = false;                        ///< The tasks are taken back.
    std::uint32_t failing = UINT32_MAX;        ///< This one alone is, though nothing of the map is at fault.
    std::function<void(std::uint32_t)> before; ///< Each task.

    /// Runs a frame in which `tasks` tasks want the same. @return the passes in the order they are recorded.
    std::vector<std::string> run(std::span<const Wanted> wanted, std::uint32_t tasks = 1)
    {
        pool.begin(frame + 1, frame);
        ++frame;
        arena.reset();
        graph.reset();
        drawn.prepared.clear();
        std::vector<Casters> casters;
        casters.reserve(2 * wanted.size());
        for (const Wanted& layer : wanted) {
            casters.emplace_back(layer.statics);
            casters.emplace_back(layer.dynamics);
        }
        ImageId image;
        for (std::uint32_t task = 0; task < tasks; ++task) {
            graph.beginTask({.view = task + 1, .light = 1, .method = 0}, &view, {}, {});
            if (before) before(task);
            image = declare(wanted, casters);
            if (task == failing) PassBuilder(graph).fail({GN_ERROR_OUT_OF_DEVICE_MEMORY, "Test", "no room for more"});
            REQUIRE(graph.endTask().has_value() == (fails || task == failing));
        }
        kept = graph.counts().kept;
        const std::vector<std::string> names = execute();
        layers.clear();
        for (std::uint32_t i = 0; i < wanted.size(); ++i) {
            layers.push_back(held[{graph.image(image).gpu.image, i}]);
            std::sort(layers.back().begin(), layers.back().end());
        }
        return names;
    }

    /// Asks for more memory than there is: what the last frame has not used is given back.
    void runOut()
    {
        vulkan.heapSize = 0;
        CHECK(!pool.persistentImage(1, {.name = "too large", .format = VK_FORMAT_D32_SFLOAT, .extent = {4096, 4096}}));
        vulkan.heapSize = VkDeviceSize{1} << 40;
    }

    /// More than half of the memory there may be.
    std::unique_ptr<PooledImage> takeRoom()
    {
        auto most = pool.ownedImage({.format = VK_FORMAT_D32_SFLOAT, .extent = {16384, 10000}, .name = "most"});
        REQUIRE(most);
        return std::move(*most);
    }
    void giveRoom(std::unique_ptr<PooledImage> most) { pool.retire(std::move(most), 0); }

private:
    ImageId declare(std::span<const Wanted> wanted, std::span<const Casters> casters)
    {
        PassBuilder passes(graph);
        KeptMap map(passes, {.name = "map.depth",
                             .staticsName = "map.depth_statics",
                             .stampName = "map.stamp",
                             .resolution = kResolution,
                             .layers = static_cast<std::uint32_t>(wanted.size())});
        const BufferId read = passes.transient(BufferInfo{.name = "map.read", .scope = Scope::light, .size = 16});
        for (std::uint32_t i = 0; i < wanted.size(); ++i) {
            if (wanted[i].stamp != 0)
                map.update(i, kLayerNames[i],
                           {.statics = casters[2 * i].pointers,
                            .dynamics = casters[2 * i + 1].pointers,
                            .stamp = wanted[i].stamp,
                            .staticsStamp = wanted[i].staticsStamp},
                           Draw{&drawn, read});
        }
        return map.image();
    }

    std::vector<std::string> execute()
    {
        std::vector<std::string> names;
        for (const std::uint32_t index : graph.order()) {
            const Pass& pass = graph.passes()[index];
            if (!pass.fn) continue; // taken back
            names.emplace_back(pass.name);
            CHECK(pass.owner.light == 1);
            const auto at = [&](const Access& access) -> Revisions& {
                return held[{graph.imageAt(access.resource).gpu.image, access.part.layer}];
            };
            const std::span<const Access> accesses = graph.accesses(pass);
            REQUIRE(accesses.size() == 2);
            if (pass.kind == PassKind::transfer) {
                CHECK(accesses[0].kind == AccessKind::copySource);
                CHECK(accesses[1].kind == AccessKind::copyTarget);
                at(accesses[1]) = at(accesses[0]);
                continue;
            }
            CHECK(accesses[0].kind == AccessKind::depthWrite);
            CHECK(accesses[1].kind == AccessKind::storageRead); // Draw::uses()
            drawn.target = &at(accesses[0]);
            if (accesses[0].part.clear) drawn.target->clear();
            PassContext context;
            pass.fn(pass.body, &context, nullptr);
        }
        return names;
    }
};

} // namespace gnomon::test
