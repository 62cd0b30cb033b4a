#pragma once
// How far a method's visibility is from the truth, by the project's definitions of exactness: only pixels that face the
// light, lie within its range and cone, and are not grazing (0 < n.l < 0.03) count.

#include <vector>

#include "demo/host/renderer.hpp"

namespace gnomon::demo {

struct ErrorCount {
    uint64_t counted = 0;     ///< Light-facing, reached, not grazing.
    uint64_t falseLit = 0;    ///< Visibility >= 0.5 where the truth is below.
    uint64_t falseShadow = 0; ///< The opposite.
    uint64_t grazing = 0;     ///< Left out of `counted`.
    uint64_t ambiguous = 0;   ///< Counted pixels without a clear answer (ambiguity.hpp); 0 if not asked.
    uint64_t wrongClear = 0;  ///< Wrong ones among the others.
    double absoluteSum = 0.0; ///< Of |visibility - truth| over the counted pixels.

    uint64_t wrong() const { return falseLit + falseShadow; }
    double percent(uint64_t pixels) const { return counted > 0 ? 100.0 * double(pixels) / double(counted) : 0.0; }
    double meanAbsolute() const { return counted > 0 ? absoluteSum / double(counted) : 0.0; }
    ErrorCount& operator+=(const ErrorCount& other);
};

/// What is seen in a frame, without any shadows: the same for every method.
struct FrameSurfaces {
    ImageF depth, normals;
};

/// Per pixel: 0 not counted, 1 counted, 2 grazing.
std::vector<uint8_t> countedPixels(const Scene& scene, const CameraMatrices& camera, const FrameSurfaces& surfaces,
                                   const Light& light, const LightState& state);

/// A byte of visibility that is at least half.
bool isLit(uint8_t visibility);
/// Of two bytes of visibility: whether one is lit and the other is not.
bool isWrong(uint8_t visibility, uint8_t truth);

/// \param ambiguous per pixel, or empty.
ErrorCount compare(const Image8& visibility, const Image8& truth, const std::vector<uint8_t>& counted,
                   const std::vector<uint8_t>& ambiguous = {});

/// Where in the picture most wrong pixels lie within a window of the given size.
Rect worstWindow(const Image8& visibility, const Image8& truth, const std::vector<uint8_t>& counted, uint32_t width,
                 uint32_t height, uint64_t& wrongInside);

} // namespace gnomon::demo
