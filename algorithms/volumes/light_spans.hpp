#pragma once
// The tables of all casters of one light, kept while light and casters stand still.
#include <memory>
#include <span>
#include <vector>

#include "algorithms/volumes/span_table.hpp"
#include "runtime/base/jobs.hpp"

namespace gnomon {

/// One light's tables. A caster that moved has its own made again, a light that moved all.
class LightSpans {
public:
    struct Entry {
        std::uint32_t caster = 0;   ///< Caster::id.
        std::uint64_t revision = 0; ///< Caster::revision; 0: none's.
        CasterSpans spans;
    };

    /// What the tables must be of; differs exactly when something they depend on does.
    static std::uint64_t stampOf(const LightView& light, std::span<const Caster* const> casters, std::uint32_t rows);
    std::uint64_t stamp() const { return stamp_; }

    /// Makes what is missing, forgets what is gone. @return tables made.
    std::uint32_t update(const LightView& light, std::span<const Caster* const> casters, std::uint32_t rows,
                         JobSystem& jobs, FrameArena& arena);

    const SpanSpace& space() const { return space_; }
    std::span<const std::unique_ptr<Entry>> entries() const { return entries_; }
    std::size_t memoryBytes() const;

private:
    std::unique_ptr<Entry> takeSpare();
    void keepSpares();

    SpanSpace space_;
    std::uint64_t stamp_ = 0, revision_ = 0;
    std::uint32_t rows_ = 0;
    std::vector<std::unique_ptr<Entry>> entries_; ///< By rising caster.
    std::vector<std::unique_ptr<Entry>> old_;     ///< Those of before, while entries_ is made; empty otherwise.
    /// Of casters that left, no more than there are entries: one that comes and goes allocates nothing.
    std::vector<std::unique_ptr<Entry>> spares_;
    /// What a table needs while it is made, a thread each: as large as the largest caster's, not as all together.
    std::vector<std::unique_ptr<FrameArena>> scratch_;
};

} // namespace gnomon
