#pragma once
// The meshes of a task's casters, each once.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "runtime/base/arena.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Numbers meshes 0, 1, ... in the order in which they are first asked for, in time of the number of questions: open
/// addressing, half of it empty, in the frame's arena.
class MeshNumbers {
public:
    /// @param most  meshes that will be asked for
    MeshNumbers(FrameArena& arena, std::size_t most) : places_(arena.array<Place>(std::bit_ceil(2 * most + 1)))
    {
        std::uninitialized_fill(places_.begin(), places_.end(), Place{});
    }

    /// The mesh's number; count() as it was before, where it is new.
    std::uint32_t of(const MeshView& mesh)
    {
        const std::size_t mask = places_.size() - 1;
        std::size_t at = mesh.id * std::size_t{0x9e3779b97f4a7c15ull} >> 32 & mask; // Fibonacci hashing
        while (places_[at].mesh && places_[at].mesh != &mesh)
            at = (at + 1) & mask;
        if (!places_[at].mesh) places_[at] = {&mesh, count_++};
        return places_[at].number;
    }
    std::uint32_t count() const { return count_; }

private:
    struct Place {
        const MeshView* mesh = nullptr;
        std::uint32_t number = 0;
    };
    std::span<Place> places_;
    std::uint32_t count_ = 0;
};

} // namespace gnomon
