#include "runtime/select/shared_parts.hpp"

#include <algorithm>

namespace gnomon {

namespace {

// More passes of view scope than all modules have together; others count as nothing.
constexpr std::size_t kMostPasses = 64;

std::uint64_t hashOf(const char* text)
{
    std::uint64_t hash = 0xcbf29ce484222325ull; // FNV-1a
    for (; *text; ++text)
        hash = (hash ^ static_cast<unsigned char>(*text)) * 0x100000001b3ull;
    return hash;
}

} // namespace

void SharedParts::note(const char* pass, std::uint32_t methods, float ms)
{
    const std::uint64_t name = hashOf(pass);
    auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == name; });
    if (entry == entries_.end()) {
        if (entries_.size() == kMostPasses) return;
        entry = entries_.insert(entry, Entry{.name = name});
    }
    entry->declarers |= methods;
    entry->ms += ms;
}

void SharedParts::endFrame(std::uint32_t ran, double pixels)
{
    for (Entry& entry : entries_) {
        entry.methods = (entry.methods & ~ran) | entry.declarers;
        if (entry.declarers) entry.msPerPixel.add(static_cast<float>(entry.ms / pixels));
        entry.declarers = 0;
        entry.ms = 0.0f;
    }
}

std::span<const plan::SharedPart> SharedParts::parts(double pixels)
{
    std::size_t count = 0;
    for (const Entry& entry : entries_) {
        if (!entry.methods) continue;
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
