#include "demo/program/soft_error.hpp"

#include <algorithm>

namespace gnomon::demo {
namespace {

constexpr double kLeastPenumbra = 0.02, kMostPenumbra = 0.98, kFar = 0.1;

} // namespace

void SoftError::Part::add(double off)
{
    ++pixels;
    sum += off;
    squares += off * off;
    worst = std::max(worst, off);
    far += off > kFar;
}

SoftError::Part& SoftError::Part::operator+=(const Part& other)
{
    pixels += other.pixels;
    sum += other.sum;
    squares += other.squares;
    worst = std::max(worst, other.worst);
    far += other.far;
    return *this;
}

void SoftError::add(double visibility, double truth)
{
    const double off = std::abs(visibility - truth);
    const bool soft = truth > kLeastPenumbra && truth < kMostPenumbra;
    (soft ? penumbra : outside).add(off);
    wrong += !soft && off >= 0.5;
}

SoftError& SoftError::operator+=(const SoftError& other)
{
    penumbra += other.penumbra;
    outside += other.outside;
    wrong += other.wrong;
    return *this;
}

SoftError compareSoft(const Image8& visibility, const Image8& truth, const std::vector<uint8_t>& counted)
{
    SoftError error;
    for (size_t i = 0; i < counted.size(); ++i)
        if (counted[i] == 1) error.add(visibility.texels[i] / 255.0, truth.texels[i] / 255.0);
    return error;
}

} // namespace gnomon::demo
