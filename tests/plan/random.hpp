#pragma once

#include <cstdint>

#include "runtime/base/method_set.hpp"

namespace gnomon::test {

/// The same numbers in every build (splitmix64); the standard library's distributions are not.
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t bits()
    {
        uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    uint32_t below(uint32_t n) { return static_cast<uint32_t>(bits() % n); }

private:
    uint64_t state_;
};

/// At least one of so many methods; of the others each by an even chance.
inline MethodSet randomSet(Random& random, uint32_t methods)
{
    MethodSet set{random.below(methods)};
    for (uint32_t m = 0; m < methods; ++m)
        if (random.unit() < 0.5) set.add(m);
    return set;
}

} // namespace gnomon::test
