#include "runtime/select/shared_parts.hpp"

#include <algorithm>
#include <utility>

#include "runtime/base/hash.hpp"

namespace gnomon {

namespace {

// More passes of view scope than all modules have together; others count as nothing.
constexpr std::size_t kMostPasses = 64;

} // namespace

SharedParts::SharedParts()
{
    entries_.reserve(kMostPasses); // once and for all
}

/// Null: there are too many.
SharedParts::Entry* SharedParts::entryOf(std::string_view pass)
{
    const std::uint64_t name = hashOfBytes(pass);
    const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == name; });
    if (entry != entries_.end()) return &*entry;
    return entries_.size() == kMostPasses ? nullptr : &entries_.emplace_back(Entry{.name = name});
}

void SharedParts::teach(std::span<const cost::KnowledgePart> parts,
                        std::span<const std::string_view> algorithms) noexcept
{
    for (Entry& entry : entries_) {
        if (entry.shown) continue;
        entry.msPerPixel.reset(); // an earlier base's
        entry.methods = {};
    }
    for (const cost::KnowledgePart& part : parts) {
        Entry* const entry = entryOf(part.pass);
        if (!entry) continue;
        for (std::size_t m = entry->shown ? taught_ : 0; m < algorithms.size(); ++m)
            if (algorithms[m] == part.algorithm) entry->methods.add(static_cast<std::uint32_t>(m));
        if (!entry->shown) entry->msPerPixel.add(static_cast<float>(part.msPerPixel));
    }
    taught_ = algorithms.size();
}

void SharedParts::note(const char* pass, const MethodSet& methods, float ms)
{
    Entry* const entry = entryOf(pass);
    if (!entry) return;
    entry->declarers |= methods;
    entry->ms += ms;
}

void SharedParts::endFrame(const MethodSet& ran, double pixels)
{
    for (Entry& entry : entries_) {
        entry.methods = (entry.methods - ran) | entry.declarers;
        if (!entry.declarers.empty()) {
            if (!std::exchange(entry.shown, true)) entry.msPerPixel.reset();
            entry.msPerPixel.add(static_cast<float>(entry.ms / pixels));
        }
        entry.declarers = {};
        entry.ms = 0.0f;
    }
}

std::span<const plan::SharedPart> SharedParts::parts(double pixels)
{
    std::size_t count = 0;
    for (const Entry& entry : entries_) {
        if (entry.methods.empty()) continue;
        const auto end = parts_.begin() + static_cast<std::ptrdiff_t>(count);
        auto part = std::find_if(parts_.begin(), end, [&](const auto& p) { return p.methods == entry.methods; });
        if (part == end) {
            if (count == parts_.size()) continue;
            *part = {.ms = 0.0, .methods = entry.methods};
            ++count;
        }
        part->ms += double{entry.msPerPixel.get()} * pixels;
    }
    return std::span(parts_).first(count);
}

} // namespace gnomon
