#include "algorithms/volumes/light_spans.hpp"

#include <algorithm>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/volumes/silhouette.hpp"

namespace gnomon {

namespace {

constexpr std::size_t kScratchBlock = 1u << 16; // a box at 300 rows takes some 50 kB

} // namespace

std::uint64_t LightSpans::stampOf(const LightView& light, std::span<const Caster* const> casters, std::uint32_t rows)
{
    Stamp stamp;
    stamp.add(light.revision).add(std::uint64_t{rows});
    for (const Caster* caster : casters) // of those with tables: topologies may come late, the host's own have none
        if (castsVolume(*caster)) stamp.add(*caster);
    return stamp.value();
}

std::uint32_t LightSpans::update(const LightView& light, std::span<const Caster* const> casters, std::uint32_t rows,
                                 JobSystem& jobs, FrameArena& arena)
{
    stamp_ = 0; // of half of them, should this fail
    old_.clear();
    if (light.revision != revision_ || rows != rows_) {
        for (const std::unique_ptr<Entry>& entry : entries_)
            entry->revision = 0; // no caster's: its memory is used again
        space_ = SpanSpace(light);
        revision_ = light.revision;
        rows_ = rows;
    }
    old_.swap(entries_);
    const std::span<std::uint32_t> ids = arena.array<std::uint32_t>(old_.size()); // entries are moved out one by one
    for (std::size_t i = 0; i < old_.size(); ++i)
        ids[i] = old_[i]->caster;
    const std::span<const Caster*> stale = arena.array<const Caster*>(casters.size());
    const std::span<Entry*> made = arena.array<Entry*>(casters.size());
    std::size_t count = 0;
    for (const Caster* caster : casters) {
        if (!castsVolume(*caster)) continue;
        const auto found = std::lower_bound(ids.begin(), ids.end(), caster->id);
        const bool known = found != ids.end() && *found == caster->id;
        std::unique_ptr<Entry> entry =
            known ? std::move(old_[static_cast<std::size_t>(found - ids.begin())]) : takeSpare();
        if (entry->revision != caster->revision) {
            stale[count] = caster;
            made[count++] = entry.get();
        }
        entry->caster = caster->id;
        entries_.push_back(std::move(entry));
    }
    keepSpares();
    std::sort(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) { return a->caster < b->caster; });
    scratch_.resize(jobs.threadCount());
    jobs.parallelFor(count, 1, [&](std::size_t begin, std::size_t end, std::uint32_t thread) {
        std::unique_ptr<FrameArena>& scratch = scratch_[thread];
        if (!scratch) scratch = std::make_unique<FrameArena>(kScratchBlock);
        for (std::size_t i = begin; i < end; ++i) {
            scratch->reset();
            made[i]->revision = 0;
            made[i]->spans.build(space_, light, *stale[i], rows, *scratch);
            made[i]->revision = stale[i]->revision;
        }
    });
    stamp_ = stampOf(light, casters, rows);
    return static_cast<std::uint32_t>(count);
}

std::unique_ptr<LightSpans::Entry> LightSpans::takeSpare()
{
    if (spares_.empty()) return std::make_unique<Entry>();
    std::unique_ptr<Entry> entry = std::move(spares_.back());
    spares_.pop_back();
    entry->revision = 0;
    return entry;
}

void LightSpans::keepSpares()
{
    for (std::unique_ptr<Entry>& gone : old_)
        if (gone && spares_.size() < entries_.size()) spares_.push_back(std::move(gone));
    old_.clear();
}

std::size_t LightSpans::memoryBytes() const
{
    std::size_t sum = 0;
    for (const auto* list : {&entries_, &spares_}) {
        sum += list->capacity() * sizeof(entries_[0]);
        for (const std::unique_ptr<Entry>& entry : *list)
            sum += sizeof(Entry) + entry->spans.memoryBytes();
    }
    return sum;
}

} // namespace gnomon
