#pragma once
// The setting with which maps around a point light are told what to leave out.
#include "algorithms/shared/frusta.hpp"
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Its value is a MapCulling.
inline constexpr SettingSpec kCullingSetting{
    "culling",
    "What the maps leave out, the picture being the same. 0: nothing; 1: from each map the casters outside it; 2: maps "
    "that no visible receiver lies in, too; 3: casters whose shadow the view does not see, too.",
    0, 3, 2};

} // namespace gnomon
