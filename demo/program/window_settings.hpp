#pragma once
// What keys and the panel change in a window, and what they are told.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "demo/io/image.hpp"

namespace gnomon::demo {

/// What the colours of the lights show.
enum class Tint : uint8_t {
    none,
    method,
    cadence, ///< GnDecision::redrawEvery.
};

inline constexpr int kTints = 3;

struct WindowSettings {
    float budgetMs = 0.0f; ///< 0: that of the rules.
    Tint tint = Tint::none;
    bool split = false;                 ///< What comes from `ray_traced` is right of the divider.
    bool errors = false;                ///< There, the errors against it in place of its picture.
    double divider = 0.5;               ///< Share of the width.
    std::optional<double> wrongPercent; ///< Of what is right of the divider, as ErrorCount; while `errors` are shown.
    bool texels = false;                ///< Widths of texels of the selected light's map, in place of the picture.
    bool recording = false;
    struct LegendLine {
        std::string text;
        Rgb8 colour;
    };
    std::vector<LegendLine> legend; ///< Of what the picture shows.
    std::string notice;             ///< What did not go well last, or where the recorded pictures are.
};

} // namespace gnomon::demo
