#pragma once
// Casters of a light for a projection that bends edges: fine ones are drawn as they are, coarse ones are cut on the CPU
// and kept on the GPU until they or the light move.
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/omni/tessellation.hpp"
#include "algorithms/shared/light_cache.hpp"
#include "runtime/passes/pass_builder.hpp"

namespace gnomon {

/// What is drawn of one group of casters (static or moving) of a light.
struct CutCasters {
    BufferId vertices, indices;      ///< World-space triangles of the coarse casters; null ids where there are none.
    std::uint32_t closedIndices = 0; ///< Of closed casters, first in `indices`.
    std::uint32_t openIndices = 0;
};

/// Cuts, keeps and uploads; one per method.
class CasterCutter {
public:
    /// Declares the upload of the coarse ones among `casters` where it is out of date.
    /// @param group 0 static, 1 moving.
    CutCasters declare(PassBuilder& passes, const LightView& light, std::span<const Caster* const> casters,
                       std::uint32_t group, std::uint32_t resolution);

    bool isFine(const Caster& caster, const LightView& light, std::uint32_t resolution)
    {
        return fineEnough(caster, light.position(), maxEdgeAngle(resolution));
    }

private:
    struct Kept {
        std::uint64_t stamp = 0;
        FineMesh mesh;
    };
    LightCache<Kept> kept_;             ///< By group.
    std::vector<const Caster*> coarse_; ///< Scratch.
};

} // namespace gnomon
