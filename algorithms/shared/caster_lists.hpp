#pragma once
// Which casters go into a map, and stamps that change exactly when its content would.
#include <cstdint>
#include <span>

#include <glm/mat4x4.hpp>

#include "runtime/base/arena.hpp"
#include "runtime/scene/scene_view.hpp"

namespace gnomon {

/// Running 64-bit hash of a map's inputs; the result is never 0, which means "nothing kept".
class Stamp {
public:
    Stamp& add(std::uint64_t value);
    Stamp& add(float value);
    Stamp& add(const glm::mat4& matrix);
    /// Identity, revision and the faces drawn: a mesh whose topology has just arrived is drawn differently.
    Stamp& add(const Caster& caster);
    Stamp& add(std::span<const Caster* const> casters);
    std::uint64_t value() const { return hash_ > 15 ? hash_ : hash_ + 16; } ///< Small numbers mean other things.

private:
    std::uint64_t hash_ = 0x9e3779b97f4a7c15ull;
};

/// The casters that touch a volume, in the order of the input; memory from the arena.
std::span<const Caster* const> castersIn(std::span<const Caster* const> casters, std::span<const Plane> volume,
                                         FrameArena& arena);

/// The same without those that the host draws, for maps that gnomon alone draws into: unless they are static they are
/// other casters in every frame, and the map would be drawn again for nothing.
std::span<const Caster* const> meshesIn(std::span<const Caster* const> casters, std::span<const Plane> volume,
                                        FrameArena& arena);

/// Whether a caster has a volume: solid triangles with a topology. Volumes cannot see holes that a texture cuts.
bool castsVolume(const Caster& caster);
/// The same of a caster whose edges and faces are known, but not where they are (GN_TRAIT_GPU_POSITIONS_BIT).
bool castsByConnectivity(const Caster& caster);

bool anyHostDrawn(std::span<const Caster* const> casters);

} // namespace gnomon
