#pragma once
// Maps that are pictures of shadows, 64 texels to a side: no device, and the receiver lies in one plane.
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "shaders/shared/types.h"

namespace gnomon::gpu {

constexpr int kSide = 64;

struct Picture {
    std::array<bool, kSide * kSide> shadow{};
};

struct Tap {
    const Picture* map;
    uint64_t* fetches = nullptr; ///< Texels asked.
    uint64_t* beside = nullptr;  ///< Of these, beside the picture.
};

inline bool texelExists(Tap, vec2 centre)
{
    return centre.x > 0.0f && centre.y > 0.0f && centre.x < kSide && centre.y < kSide;
}

inline bool texelLit(Tap tap, vec2 centre)
{
    if (tap.fetches) ++*tap.fetches;
    if (tap.beside && !texelExists(tap, centre)) ++*tap.beside;
    return !texelExists(tap, centre) ||
           !tap.map->shadow[static_cast<size_t>(centre.y) * kSide + static_cast<size_t>(centre.x)];
}

} // namespace gnomon::gpu

#include "shaders/revectorized/line_kernel.h"

namespace gnomon {

constexpr uint32_t kLongest = 16;

using Shape = std::function<bool(double x, double y)>; ///< In shadow there, texels.

inline gpu::Picture drawn(const Shape& shape)
{
    gpu::Picture picture;
    for (int y = 0; y < gpu::kSide; ++y)
        for (int x = 0; x < gpu::kSide; ++x)
            picture.shadow[size_t(y) * gpu::kSide + size_t(x)] = shape(x + 0.5, y + 0.5);
    return picture;
}

inline float nearest(const gpu::Picture& picture, glm::vec2 at)
{
    return gpu::texelLit({&picture}, glm::floor(at) + 0.5f) ? 1.0f : 0.0f;
}

inline float revectorized(const gpu::Picture& picture, glm::vec2 at, uint32_t mode, uint32_t longest = kLongest)
{
    return gpu::revectorizedVisibility({&picture}, at, mode, longest);
}

/// A line, in shadow below it; or a disc.
inline Shape halfPlane(double angle, glm::dvec2 through)
{
    const glm::dvec2 normal(-std::sin(angle), std::cos(angle));
    return [=](double x, double y) { return glm::dot(normal, glm::dvec2(x, y) - through) < 0.0; };
}
inline Shape disc(glm::dvec2 centre, double radius)
{
    return [=](double x, double y) { return glm::length(glm::dvec2(x, y) - centre) < radius; };
}

// What lies far enough from the border for stairs not to reach it.
constexpr int kFirst = 17, kEnd = 47, kSub = 8;

template <typename Visit>
void forSamples(const Visit& visit)
{
    for (int y = kFirst * kSub; y < kEnd * kSub; ++y)
        for (int x = kFirst * kSub; x < kEnd * kSub; ++x)
            visit(glm::vec2(float(x) + 0.5f, float(y) + 0.5f) / float(kSub));
}

constexpr int kShapes = 40;

inline std::vector<Shape> randomShapes(uint32_t seed, const std::function<Shape(std::mt19937&)>& make)
{
    std::mt19937 random(seed);
    std::vector<Shape> shapes;
    for (int i = 0; i < kShapes; ++i)
        shapes.push_back(make(random));
    return shapes;
}

inline double between(std::mt19937& random, double lower, double upper)
{
    return lower + (upper - lower) * (double(random()) / 4294967296.0); // the same on every standard library
}

inline glm::dvec2 nearMiddle(std::mt19937& random)
{
    const double x = between(random, 30.0, 34.0);
    return {x, between(random, 30.0, 34.0)};
}

inline std::vector<Shape> halfPlanes()
{
    return randomShapes(1, [](std::mt19937& random) {
        const double angle = between(random, 0.0, 6.283185307);
        return halfPlane(angle, nearMiddle(random));
    });
}
inline std::vector<Shape> discs(double least, double most)
{
    return randomShapes(2, [=](std::mt19937& random) {
        const double radius = between(random, least, most), angle = between(random, 0.0, 6.283185307);
        const double away = radius < 14.0 ? 0.0 : radius; // of large ones the border passes through the middle
        return disc(nearMiddle(random) + away * glm::dvec2(std::cos(angle), std::sin(angle)), radius);
    });
}

} // namespace gnomon
