#pragma once
// How far visibility is from a soft truth, in the penumbra and outside of it: a mean over the whole picture would let a
// hard shadow pass.

#include <cmath>

#include "demo/io/image.hpp"

namespace gnomon::demo {

struct SoftError {
    /// Of some of the counted pixels.
    struct Part {
        uint64_t pixels = 0;
        double sum = 0.0;     ///< Of |visibility - truth|.
        double squares = 0.0; ///< Of its square.
        double worst = 0.0;
        uint64_t far = 0; ///< Pixels that are off by more than a tenth of the light.

        double mean() const { return pixels > 0 ? sum / double(pixels) : 0.0; }
        double rmse() const { return pixels > 0 ? std::sqrt(squares / double(pixels)) : 0.0; }
        double farPercent() const { return pixels > 0 ? 100.0 * double(far) / double(pixels) : 0.0; }
        void add(double off);
        Part& operator+=(const Part& other);
    };
    Part penumbra;      ///< The truth lies between 0.02 and 0.98.
    Part outside;       ///< The others: lit, or in the umbra.
    uint64_t wrong = 0; ///< Of these, off by half a light or more.

    void add(double visibility, double truth);
    SoftError& operator+=(const SoftError& other);
};

/// Of the pixels of one light that countedPixels() counts.
SoftError compareSoft(const Image8& visibility, const Image8& truth, const std::vector<uint8_t>& counted);

} // namespace gnomon::demo
