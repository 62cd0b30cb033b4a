#pragma once
// Wrong shares of near and of far receivers apart: what is seen from close by is held to the quality floor, what is far
// away is not.
#include <map>
#include <string>
#include <vector>

#include "demo/program/error_count.hpp"

namespace gnomon::demo {

/// Receivers closer to the eye than this are near, all others are far.
inline constexpr float kNearMetres = 30.0f;

struct WrongShare {
    uint64_t counted = 0, wrong = 0;

    double percent() const { return counted > 0 ? 100.0 * double(wrong) / double(counted) : 0.0; }
    WrongShare& operator+=(const WrongShare& other);
};

struct NearFar {
    WrongShare near, far;

    NearFar& operator+=(const NearFar& other);
};

/// Of one light, a bit per pixel: many frames of many lights are kept.
struct LightTruth {
    std::vector<bool> counted; ///< countedPixels(), without the grazing ones.
    std::vector<bool> lit;     ///< By half at least.
};

/// Of one frame.
struct FrameTruth {
    std::vector<bool> near; ///< Per pixel.
    std::map<std::string, LightTruth> lights;
};

/// Per pixel, by the distance between the eye and what is seen. The sky is far.
std::vector<bool> nearPixels(const CameraMatrices& camera, const ImageF& depth);

LightTruth truthOf(const Image8& visibility, const std::vector<uint8_t>& counted);

/// \param visibility as large as the truth's picture
NearFar countWrong(const Image8& visibility, const LightTruth& truth, const std::vector<bool>& near);

} // namespace gnomon::demo
