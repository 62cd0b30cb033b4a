#include "algorithms/volumes/static_volumes.hpp"

#include <algorithm>
#include <optional>

#include <glm/geometric.hpp>

#include "algorithms/common/caster_lists.hpp"
#include "algorithms/volumes/silhouette.hpp"
#include "algorithms/volumes/volume_list.hpp"

namespace gnomon {

namespace {

// Volumes tried as concealers of others: those that look largest from the light. Testing all pairs of a thousand would
// take tens of milliseconds in the frame in which something changes, and small ones conceal little.
constexpr std::size_t kMostConcealers = 64;

// Entries not asked for in this many questions are forgotten: some hundred frames of many lights.
constexpr std::uint64_t kForgetAfter = 4096;

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
    StaticVolumes::Volume volume;
    Aabb bounds;
    float prominence = 0.0f;
    Umbra umbra;
};

/// Calls visit(volume, source) with the volumes of the casters.
template <typename Visit>
void forVolumes(std::span<const Caster* const> statics, const Visit& visit)
{
    for (std::uint32_t caster = 0; caster < statics.size(); ++caster) {
        if (!castsVolume(*statics[caster])) continue;
        const std::size_t clusters = statics[caster]->mesh->topology->clusters.size();
        for (std::uint32_t cluster = 0; cluster < clusters; ++cluster)
            visit(StaticVolumes::Volume{caster, cluster}, VolumeSource{statics[caster], cluster});
    }
}

std::vector<Concealer> findConcealers(const LightView& light, std::span<const Caster* const> statics)
{
    std::vector<Concealer> found;
    forVolumes(statics, [&](const StaticVolumes::Volume& volume, const VolumeSource& source) {
        std::optional<Umbra> umbra = umbraOf(*source.caster, source.cluster, light);
        if (!umbra) return;
        const Aabb bounds = source.bounds();
        found.push_back({volume, bounds, prominence(bounds, light), std::move(*umbra)});
    });
    std::stable_sort(found.begin(), found.end(),
                     [](const Concealer& a, const Concealer& b) { return a.prominence > b.prominence; });
    if (found.size() > kMostConcealers) found.resize(kMostConcealers);
    return found;
}

bool isConcealed(const StaticVolumes::Volume& volume, const Aabb& bounds, const std::vector<Concealer>& concealers)
{
    return std::any_of(concealers.begin(), concealers.end(), [&](const Concealer& concealer) {
        return concealer.volume != volume && conceals(concealer.umbra, bounds);
    });
}

} // namespace

void chooseVolumes(const LightView& light, std::span<const Caster* const> statics, bool conceal, StaticVolumes& out)
{
    out.drawn.clear();
    out.occluders.clear();
    out.concealed = 0;
    const std::vector<Concealer> concealers = conceal ? findConcealers(light, statics) : std::vector<Concealer>{};
    std::vector<Aabb> bounds;
    forVolumes(statics, [&](const StaticVolumes::Volume& volume, const VolumeSource& source) {
        const Aabb box = source.bounds();
        if (isConcealed(volume, box, concealers)) {
            ++out.concealed;
            return;
        }
        out.drawn.push_back(volume);
        bounds.push_back(box);
    });
    out.tree.build(bounds);
    for (const Concealer& concealer : concealers) {
        const auto drawn = std::lower_bound(out.drawn.begin(), out.drawn.end(), concealer.volume);
        if (drawn == out.drawn.end() || *drawn != concealer.volume) continue; // concealed itself
        out.occluders.push_back(
            {static_cast<std::uint32_t>(drawn - out.drawn.begin()), concealer.bounds, concealer.umbra});
        if (out.occluders.size() == gpu::UMBRAE) break;
    }
}

const StaticVolumes& StaticVolumesCache::find(const LightView& light, std::span<const Caster* const> statics,
                                              bool conceal)
{
    // The order of the casters counts, too: what is kept are indices.
    Stamp stamp;
    stamp.add(statics).add(light.revision);
    for (const Caster* caster : statics) // topologies may come late
        stamp.add(std::uint64_t{castsVolume(*caster)});

    ++asked_;
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const std::unique_ptr<Entry>& entry) {
        return entry->light == light.id && entry->conceal == conceal;
    });
    Entry* entry = found != entries_.end() ? found->get() : nullptr;
    if (!entry) {
        std::erase_if(entries_, [&](const std::unique_ptr<Entry>& old) { return old->used + kForgetAfter < asked_; });
        entry = entries_.emplace_back(std::make_unique<Entry>()).get();
        entry->light = light.id;
        entry->conceal = conceal;
    }
    entry->used = asked_;
    if (entry->volumes.stamp != stamp.value()) {
        chooseVolumes(light, statics, conceal, entry->volumes);
        entry->volumes.stamp = stamp.value();
        ++built_;
    }
    return entry->volumes;
}

} // namespace gnomon
