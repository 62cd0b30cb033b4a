#include "algorithms/shared/caster_lists.hpp"

#include <algorithm>
#include <bit>

#include "runtime/base/hash.hpp"
#include "runtime/scene/topology.hpp"

namespace gnomon {

Stamp& Stamp::add(std::uint64_t value)
{
    hash_ = mixed(hash_, value);
    return *this;
}

Stamp& Stamp::add(float value)
{
    return add(std::uint64_t{std::bit_cast<std::uint32_t>(value)});
}

Stamp& Stamp::add(const glm::mat4& matrix)
{
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            add(matrix[column][row]);
    return *this;
}

Stamp& Stamp::add(const Caster& caster)
{
    // A topology may come late; with it is known whether the mesh is closed, and which faces a light touches.
    const bool known = caster.mesh && caster.mesh->topology;
    return add((std::uint64_t{caster.id} << 2) | (known ? 2 : 0) | (caster.closed ? 1 : 0)).add(caster.revision);
}

Stamp& Stamp::add(std::span<const Caster* const> casters)
{
    add(casters.size());
    for (const Caster* caster : casters)
        add(*caster);
    return *this;
}

namespace {

template <typename Chosen>
std::span<const Caster* const> chosenOf(std::span<const Caster* const> casters, FrameArena& arena, const Chosen& chosen)
{
    const std::span<const Caster*> kept = arena.array<const Caster*>(casters.size());
    return {kept.begin(), std::copy_if(casters.begin(), casters.end(), kept.begin(), chosen)};
}

} // namespace

std::span<const Caster* const> castersIn(std::span<const Caster* const> casters, std::span<const Plane> volume,
                                         FrameArena& arena)
{
    return chosenOf(casters, arena, [&](const Caster* caster) { return touches(caster->bounds, volume); });
}

std::span<const Caster* const> meshesIn(std::span<const Caster* const> casters, std::span<const Plane> volume,
                                        FrameArena& arena)
{
    return chosenOf(casters, arena,
                    [&](const Caster* caster) { return !caster->hostDrawn && touches(caster->bounds, volume); });
}

bool castsVolume(const Caster& caster)
{
    return caster.mesh && caster.mesh->topology && !caster.hostDrawn && !caster.alphaTested &&
           !caster.mesh->topology->edges.empty();
}

bool castsByConnectivity(const Caster& caster)
{
    return caster.mesh && !caster.mesh->topology && caster.mesh->connectivity && !caster.hostDrawn &&
           !caster.alphaTested && !caster.mesh->connectivity->edges.empty();
}

bool anyHostDrawn(std::span<const Caster* const> casters)
{
    return std::any_of(casters.begin(), casters.end(), [](const Caster* caster) { return caster->hostDrawn; });
}

} // namespace gnomon
