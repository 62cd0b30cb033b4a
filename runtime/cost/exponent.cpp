#include "runtime/cost/exponent.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace gnomon::cost {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLn2 = 0.6931471805599453094;
constexpr double kSqrt2 = 1.4142135623730950488;
constexpr std::array<double, 22> kReciprocals = [] { // of 1 to 21
    std::array<double, 22> values{};
    for (size_t k = 1; k < values.size(); ++k)
        values[k] = 1.0 / static_cast<double>(k);
    return values;
}();
constexpr std::array<double, 15> kOverFactorial = [] { // 1 / k! for k from 0 to 14
    std::array<double, 15> values{};
    double factorial = 1.0; // exact in 53 bits
    for (size_t k = 0; k < values.size(); factorial *= static_cast<double>(++k))
        values[k] = 1.0 / factorial;
    return values;
}();
constexpr uint64_t kMantissaMask = (uint64_t{1} << 52) - 1;

} // namespace

double log2Exactly(double x) noexcept
{
    if (!(x >= 0.0)) return std::numeric_limits<double>::quiet_NaN();
    if (x < std::numeric_limits<double>::min()) return -kInfinity;
    if (x == kInfinity) return x;
    // x = m 2^e with m in [sqrt(1/2), sqrt 2).
    const auto bits = std::bit_cast<uint64_t>(x);
    int exponent = static_cast<int>(bits >> 52) - 1023;
    double m = std::bit_cast<double>((bits & kMantissaMask) | (uint64_t{1023} << 52));
    if (m >= kSqrt2) m *= 0.5, ++exponent;
    // ln m = 2 artanh s, s = (m - 1) / (m + 1), |s| <= 0.1716. The first term left out of the series is
    // s^23 / 23 < 1.1e-19.
    const double s = (m - 1.0) / (m + 1.0);
    const double s2 = s * s;
    double sum = kReciprocals[21];
    for (int k = 19; k >= 1; k -= 2)
        sum = sum * s2 + kReciprocals[static_cast<size_t>(k)];
    return exponent + 2.0 / kLn2 * (s * sum);
}

double exp2Exactly(double x) noexcept
{
    if (x != x) return x;
    if (x < -1022.0) return 0.0;
    if (x >= 1024.0) return kInfinity;
    // x = n + r with |r| <= 1/2; 2^r = exp(r ln 2) by its series. The first term left out is 0.3466^15 / 15! < 1e-19.
    const double shifted = x + (x < 0.0 ? -0.5 : 0.5);
    const auto n = static_cast<int64_t>(shifted);
    const double t = (x - static_cast<double>(n)) * kLn2;
    // Halves, quarters and eighths of the series by themselves: one sum after the other would take three times as long.
    const auto two = [t](size_t k) { return kOverFactorial[k] + t * kOverFactorial[k + 1]; };
    const double t2 = t * t, t4 = t2 * t2;
    const auto four = [&](size_t k) { return two(k) + t2 * two(k + 2); };
    const double high = four(8) + t4 * (two(12) + t2 * kOverFactorial[14]);
    const double sum = (four(0) + t4 * four(4)) + t4 * t4 * high;
    // n reaches 1024 and -1022 only with a sum below or above 1; two factors keep each of them a normal number.
    const int64_t half = n / 2;
    const auto power = [](int64_t e) { return std::bit_cast<double>(static_cast<uint64_t>(e + 1023) << 52); };
    return sum * power(half) * power(n - half);
}

} // namespace gnomon::cost
