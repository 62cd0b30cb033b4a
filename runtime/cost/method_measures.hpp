#pragma once

/// What calibration saw of a method besides its times: how much it shows wrongly, and what its first frame costs.

#include <string_view>

#include "runtime/cost/knowledge_base.hpp"

namespace gnomon::cost {

struct MethodMeasures {
    /// Expected share of wrong light-facing pixels, percent: at map side 1024, or of a method without maps.
    double wrongPercent = 0.0;
    double firstFrameMs = 0.0; ///< By which the first frame after a switch takes longer, median; 0 unknown.

    /// Wrong percent with maps of a side: an error falls as 1 / side (a texel is an edge's step); side 0: no map.
    double wrongAt(double side) const noexcept;
    /// Share of the truth that is kept, (0, 1]: 1 / (1 + wrong percent).
    double quality(double side) const noexcept { return 1.0 / (1.0 + wrongAt(side)); }
};

/// Measurements of every device count for the error: the same algorithm draws the picture everywhere.
/// `typicalWrongPercent`, what the method's author says, counts as four of them, so that a single scene does not
/// decide. First frames are of `device` alone. @param device null: none
MethodMeasures measuresOf(const KnowledgeBase& base, const DeviceKnowledge* device, std::string_view algorithm,
                          double typicalWrongPercent) noexcept;

} // namespace gnomon::cost
