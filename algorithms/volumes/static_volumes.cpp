#include "algorithms/volumes/static_volumes.hpp"

#include <algorithm>
#include <optional>

#include <glm/geometric.hpp>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/volumes/volume_list.hpp"

namespace gnomon {

namespace {

// Volumes tried as concealers of others: those that look largest from the light. Testing all pairs of a thousand would
// take tens of milliseconds in the frame in which something changes, and small ones conceal little.
constexpr std::size_t kMostConcealers = 64;

/// How large a box looks from the light: squared size over squared distance.
float prominence(const Aabb& box, const LightView& light)
{
    const glm::vec3 half = box.halfExtent();
    const float size = glm::dot(half, half);
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return size;
    const glm::vec3 outside =
        glm::max(glm::max(box.lower - light.position(), light.position() - box.upper), glm::vec3(0.0f));
    return size / std::max(glm::dot(outside, outside), 1e-6f);
}

struct Concealer {
    std::uint32_t volume = 0; ///< Among all.
    Aabb bounds;
    float prominence = 0.0f;
    Umbra umbra;
};

std::vector<Concealer> findConcealers(const LightView& light, std::span<const VolumeSource> volumes)
{
    std::vector<Concealer> found;
    for (std::uint32_t i = 0; i < volumes.size(); ++i) {
        std::optional<Umbra> umbra = umbraOf(volumes[i], light);
        if (!umbra) continue;
        const Aabb bounds = volumes[i].bounds();
        found.push_back({i, bounds, prominence(bounds, light), std::move(*umbra)});
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Concealer& a, const Concealer& b) { return a.prominence > b.prominence; });
    if (found.size() > kMostConcealers) found.resize(kMostConcealers);
    return found;
}

bool isConcealed(std::uint32_t volume, const Aabb& bounds, const std::vector<Concealer>& concealers)
{
    return std::any_of(concealers.begin(), concealers.end(), [&](const Concealer& concealer) {
        return concealer.volume != volume && conceals(concealer.umbra, bounds);
    });
}

} // namespace

void chooseVolumes(const LightView& light, std::span<const VolumeSource> volumes, bool conceal, StaticVolumes& out)
{
    out.drawn.clear();
    out.occluders.clear();
    out.concealed = 0;
    const std::vector<Concealer> concealers = conceal ? findConcealers(light, volumes) : std::vector<Concealer>{};
    std::vector<Aabb> bounds;
    for (std::uint32_t i = 0; i < volumes.size(); ++i) {
        const Aabb box = volumes[i].bounds();
        if (isConcealed(i, box, concealers)) {
            ++out.concealed;
            continue;
        }
        out.drawn.push_back(i);
        bounds.push_back(box);
    }
    out.tree.build(bounds);
    for (const Concealer& concealer : concealers) {
        const auto drawn = std::lower_bound(out.drawn.begin(), out.drawn.end(), concealer.volume);
        if (drawn == out.drawn.end() || *drawn != concealer.volume) continue; // concealed itself
        out.occluders.push_back(
            {static_cast<std::uint32_t>(drawn - out.drawn.begin()), concealer.bounds, concealer.umbra});
        if (out.occluders.size() == gpu::UMBRAE) break;
    }
}

const StaticVolumes& StaticVolumesCache::find(const LightView& light, std::span<const VolumeSource> volumes,
                                              bool conceal)
{
    // The order counts, too: what is kept are indices.
    Stamp stamp;
    stamp.add(light.revision);
    for (const VolumeSource& volume : volumes)
        stamp.add(*volume.caster).add(std::uint64_t{volume.cluster});
    StaticVolumes& found = kept_.find(light.id, conceal ? 1 : 0);
    if (found.stamp != stamp.value()) {
        found.stamp = 0; // of half of them, should this fail
        chooseVolumes(light, volumes, conceal, found);
        found.stamp = stamp.value();
        ++built_;
    }
    return found;
}

} // namespace gnomon
