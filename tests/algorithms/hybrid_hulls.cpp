// What squares of pixels say of a light is what each of their pixels says, and rays start inside of their hulls.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>

#include "algorithms/hybrid/receiver_pyramid.hpp"
#include "algorithms/shared/receivers.hpp"
#include "runtime/ray_fixture.hpp"

using namespace gnomon;
using test::randomPoint;

namespace {

constexpr std::uint32_t kWidth = 150, kHeight = 101; // squares are cut on both sides

/// What a camera sees of some planes and a ball, each with the normals of its surface.
struct Picture {
    CameraView view;
    std::vector<float> depth;
    std::vector<std::byte> normals;
    glm::vec3 ahead; ///< A point before the camera.
};

/// @param standard depth 1 - near / w in place of near / w
CameraView viewFrom(glm::vec3 eye, bool standard, VkFormat normals)
{
    CameraView view;
    gpu::ViewConstants& v = view.constants;
    v.eyeWs = glm::vec4(eye, 0.0f);
    v.rayCornerWs = glm::vec4(-0.7f, 0.5f, -1.0f, 0.0f);
    v.rayDxWs = glm::vec4(0.0095f, 0.001f, 0.0f, 0.0f);
    v.rayDyWs = glm::vec4(0.001f, -0.01f, 0.001f, 0.0f);
    v.depthScale = 0.1f;
    if (standard) v.depthScale *= 0.9f; // so that the product with depthMul is rounded
    v.depthMul = standard ? -0.9f : 1.0f;
    v.depthAdd = standard ? 0.9f : 0.0f;
    v.skyDepth = standard ? 1.0f : 0.0f;
    v.offsetFactor = standard ? 3.0f : 1.0f;
    v.pixelSize = 0.01f;
    v.hasNormals = 1;
    view.normalFormat = normals;
    view.extent = {kWidth + 5, kHeight + 3};
    view.area = {{3, 2}, {kWidth, kHeight}};
    return view;
}

Picture pictureOf(std::mt19937& random, bool standard, VkFormat format)
{
    Picture picture;
    picture.view = viewFrom(randomPoint(random, 30.0f), standard, format);
    const CameraView& view = picture.view;
    const glm::vec3 eye(view.constants.eyeWs);
    picture.ahead = eye + glm::vec3(0.0f, 0.0f, -8.0f);
    glm::vec3 through[3], facing[3];
    for (int i = 0; i < 3; ++i) {
        through[i] = picture.ahead + randomPoint(random, 4.0f);
        facing[i] = glm::normalize(randomPoint(random, 1.0f) + glm::vec3(0.0f, 0.0f, 1e-3f));
    }
    const glm::vec3 ball = picture.ahead + randomPoint(random, 3.0f);
    const bool halves = format == VK_FORMAT_R16G16B16A16_SFLOAT;
    for (std::uint32_t y = 0; y < view.extent.height; ++y)
        for (std::uint32_t x = 0; x < view.extent.width; ++x) {
            const glm::vec3 ray = gpu::viewRayWs(view.constants, glm::vec2(float(x) + 0.5f, float(y) + 0.5f));
            float nearest = 60.0f; // beyond: sky
            glm::vec3 normal(0.0f);
            for (int i = 0; i < 3; ++i) {
                const float w = glm::dot(facing[i], through[i] - eye) / glm::dot(facing[i], ray);
                if (!(w > 0.5f && w < nearest)) continue;
                nearest = w;
                normal = glm::dot(facing[i], ray) < 0.0f ? facing[i] : -facing[i];
            }
            const float b = glm::dot(ray, ball - eye), a = glm::dot(ray, ray);
            const float under = b * b - a * (glm::dot(ball - eye, ball - eye) - 4.0f);
            const float w = (b - std::sqrt(std::max(under, 0.0f))) / a;
            if (under > 0.0f && w > 0.5f && w < nearest) {
                nearest = w;
                normal = glm::normalize(eye + w * ray - ball);
            }
            const float inverse = nearest < 60.0f ? 0.1f / nearest : 0.0f;
            picture.depth.push_back(standard ? 1.0f - inverse : inverse);
            // What is in the fourth number is nobody's business.
            const glm::vec4 full(normal, std::numeric_limits<float>::quiet_NaN());
            const std::uint64_t half = glm::packHalf4x16(full);
            const auto* bytes =
                halves ? reinterpret_cast<const std::byte*>(&half) : reinterpret_cast<const std::byte*>(&full);
            picture.normals.insert(picture.normals.end(), bytes, bytes + (halves ? sizeof half : sizeof full));
        }
    return picture;
}

constexpr float kRange = 9.0f;

LightView lightOf(GnLightType type, glm::vec3 position, glm::vec3 direction, float range = kRange)
{
    return test::lightOf(type, position, direction, range, 0.6f);
}

std::vector<ReceiverSquare> squaresOf(const Picture& picture, const simd::Kernels& kernels)
{
    std::vector<ReceiverSquare> squares(ReceiverPyramid(picture.view.area.extent).count());
    const SquareMaker maker(kernels, picture.view, picture.depth, picture.normals, squares);
    for (std::uint32_t top = 0; top < kHeight; top += ReceiverPyramid::kLargest)
        maker.row(top);
    return squares;
}

using Answer = SquareAnswers::Answer;
using Holds = ReceiverSquare::Holds;

struct Census {
    int squares[4] = {}; ///< By answer.
    int wrong = 0;       ///< Pixels that do not say what their square does.
    int outside = 0;     ///< Rays that do not start in the hull, or farther from the surface than it says.
    int flat = 0;        ///< Hulls thinner than a tenth of their length.
    int above = 0; ///< Flat hulls that leave out the surface below them, as the plane of a receiver's own triangle.
};

void checkPixel(const Receivers& receivers, const CameraView& view, const Picture& picture, std::uint32_t x,
                std::uint32_t y, Answer answer, const Hull& hull, Census& census)
{
    constexpr Asked kExpected[] = {Asked::lit, Asked::dark, Asked::ray};
    ShadowRay ray;
    Receiver receiver;
    census.wrong += receivers.at(x, y, ray, receiver) != kExpected[static_cast<int>(answer)];
    if (answer != Answer::rays) return;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
        inside = inside && std::abs(glm::dot(hull.axis[axis], glm::dvec3(ray.origin) - hull.centre)) <= hull.half[axis];
    const float depth = picture.depth[std::size_t(y) * view.extent.width + x];
    const glm::dvec3 surface = glm::dvec3(glm::vec3(view.constants.eyeWs)) +
                               double(gpu::linearDepth(view.constants, depth)) * glm::dvec3(receiver.viewRay);
    const double rounded = 1e-5; // of the surface's own coordinates, up to 100 m
    inside = inside && glm::length(glm::dvec3(ray.origin) - surface) <= hull.largestOffset + rounded;
    census.outside += !inside;
}

/// Of what lies on one plane, rays start above it: a hull that held the plane could prove nothing about triangles in
/// it.
void countFlat(const Picture& picture, const ReceiverSquare& square, const Hull& hull, Census& census)
{
    if (!(hull.half[2] < 0.1 * hull.half[0])) return;
    ++census.flat;
    const gpu::ViewConstants& v = picture.view.constants;
    double highest = -1e300;
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
        const std::uint32_t x = 3 + square.left + (corner & 1 ? square.width - 1 : 0);
        const std::uint32_t y = 2 + square.top + (corner & 2 ? square.height - 1 : 0);
        const float depth = picture.depth[std::size_t(y) * picture.view.extent.width + x];
        const glm::dvec3 at = glm::dvec3(glm::vec3(v.eyeWs)) +
                              double(gpu::linearDepth(v, depth)) *
                                  glm::dvec3(gpu::viewRayWs(v, glm::vec2(float(x) + 0.5f, float(y) + 0.5f)));
        highest = std::max(highest, glm::dot(hull.axis[2], at - hull.centre));
    }
    census.above += highest < -hull.half[2];
}

void checkSquares(const Picture& picture, const std::vector<ReceiverSquare>& hulls, const LightView& light,
                  Census& census)
{
    const CameraView& view = picture.view;
    const ReceiverPyramid pyramid(view.area.extent);
    const SquareAnswers answers(view, light);
    const Receivers receivers(view, light, picture.depth, picture.normals);
    for (std::uint32_t side = ReceiverPyramid::kSmallest; side <= ReceiverPyramid::kLargest; side *= 2)
        for (std::uint32_t top = 0; top < kHeight; top += side)
            for (std::uint32_t left = 0; left < kWidth; left += side) {
                const ReceiverSquare& square = hulls[pyramid.index(side, left, top)];
                const Answer answer = answers.of(square);
                ++census.squares[static_cast<int>(answer)];
                if (answer == Answer::mixed) continue;
                const Hull hull = answer == Answer::rays ? answers.hull(square) : Hull{};
                countFlat(picture, square, hull, census);
                for (std::uint32_t y = top; y < std::min(top + side, kHeight); ++y)
                    for (std::uint32_t x = left; x < std::min(left + side, kWidth); ++x)
                        checkPixel(receivers, view, picture, x + 3, y + 2, answer, hull, census);
            }
}

} // namespace

TEST_CASE("squares say what each of their pixels says, and hold the starts of its rays")
{
    std::mt19937 random(29);
    Census census;
    for (int trial = 0; trial < 60; ++trial) {
        const VkFormat format = trial % 2 == 0 ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R16G16B16A16_SFLOAT;
        const Picture picture = pictureOf(random, trial / 2 % 2 != 0, format);
        const auto all = kernelsHere();
        const std::vector<ReceiverSquare> hulls = squaresOf(picture, *all[std::size_t(trial) % all.size()]);
        for (const GnLightType type : {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT, GN_LIGHT_TYPE_POINT}) {
            const glm::vec3 position = picture.ahead + randomPoint(random, 9.0f);
            checkSquares(picture, hulls, lightOf(type, position, picture.ahead - position), census);
        }
    }
    MESSAGE("lit " << census.squares[0] << ", dark " << census.squares[1] << ", rays " << census.squares[2]
                   << ", mixed " << census.squares[3]);
    CHECK(census.wrong == 0);
    CHECK(census.outside == 0);
    for (const int squares : census.squares)
        CHECK(squares > 2000);
    CHECK(census.squares[3] < census.squares[0] + census.squares[1] + census.squares[2]);
    MESSAGE("flat " << census.flat << ", above their surface " << census.above);
    CHECK(census.flat > 2000);
    CHECK(census.above > census.flat / 2);
}

TEST_CASE("rays to a light that is far from all that is seen start in the hulls, too")
{
    std::mt19937 random(41);
    Census census;
    for (int trial = 0; trial < 10; ++trial) {
        Picture picture = pictureOf(random, false, VK_FORMAT_R32G32B32A32_SFLOAT);
        // Offsets by the light's coordinates: nothing else is of their size.
        picture.view.constants.eyeWs = glm::vec4(0.0f);
        picture.view.constants.pixelSize = 1e-6f;
        const glm::vec3 position = glm::vec3(0.0f, 0.0f, -8.0f) + randomPoint(random, 400.0f);
        const LightView light = lightOf(GN_LIGHT_TYPE_POINT, position, glm::vec3(0.0f, -1.0f, 0.0f), 2000.0f);
        checkSquares(picture, squaresOf(picture, widestKernels()), light, census);
    }
    CHECK(census.outside == 0);
    CHECK(census.squares[static_cast<int>(Answer::rays)] > 200);
}

TEST_CASE("squares come out the same whichever instructions make them")
{
    std::mt19937 random(31);
    for (const VkFormat format : {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT}) {
        const Picture picture = pictureOf(random, false, format);
        const std::vector<ReceiverSquare> baseline = squaresOf(picture, *kernelsHere().front());
        for (const simd::Kernels* kernels : kernelsHere()) {
            const std::vector<ReceiverSquare> squares = squaresOf(picture, *kernels);
            int different = 0;
            for (std::size_t i = 0; i < squares.size(); ++i) {
                const ReceiverSquare &a = baseline[i], &b = squares[i];
                different += a.holds != b.holds;
                if (a.holds != Holds::whole) continue;
                different += std::memcmp(&a.plane, &b.plane, sizeof a.plane) != 0;
                different += a.normalLower != b.normalLower || a.normalUpper != b.normalUpper;
            }
            CHECK(different == 0);
        }
    }
}

TEST_CASE("of squares with one pixel that is no receiver, or none that can be, nothing is said")
{
    std::mt19937 random(37);
    constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
    constexpr std::uint32_t x = 3 + 32 + 5, y = 2 + 32 + 6; // in the area's second square of 32 pixels, either way
    for (const VkFormat format : {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT}) {
        Picture clean = pictureOf(random, false, format);
        const std::size_t pixels = clean.depth.size(), pixel = y * std::size_t(clean.view.extent.width) + x;
        std::fill(clean.depth.begin(), clean.depth.end(), 0.02f);
        const std::size_t size = clean.normals.size() / pixels;
        for (std::size_t i = 0; i < pixels; ++i) {
            const glm::vec4 up(0.0f, 0.0f, 1.0f, 0.0f);
            const std::uint64_t half = glm::packHalf4x16(up);
            std::memcpy(&clean.normals[i * size], size == 8 ? static_cast<const void*>(&half) : &up, size);
        }
        const ReceiverPyramid pyramid(clean.view.area.extent);
        const auto holds = [&](const Picture& picture, const simd::Kernels& kernels, std::uint32_t side) {
            return squaresOf(picture, kernels)[pyramid.index(side, x - 3, y - 2)].holds;
        };
        for (const simd::Kernels* kernels : kernelsHere()) {
            for (std::uint32_t side = 8; side <= 64; side *= 2)
                CHECK(holds(clean, *kernels, side) == Holds::whole);
            for (const float depth : {0.0f, -0.02f, kNoNumber, std::numeric_limits<float>::infinity()}) {
                Picture spoilt = clean;
                spoilt.depth[pixel] = depth;
                CAPTURE(depth);
                for (std::uint32_t side = 8; side <= 64; side *= 2)
                    CHECK(holds(spoilt, *kernels, side) == Holds::partial);
            }
            for (const float number : {kNoNumber, std::numeric_limits<float>::infinity()})
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    Picture spoilt = clean;
                    const std::uint16_t half = glm::packHalf1x16(number);
                    std::memcpy(&spoilt.normals[pixel * size + axis * size / 4],
                                size == 8 ? static_cast<const void*>(&half) : &number, size / 4);
                    CHECK(holds(spoilt, *kernels, 8) == Holds::partial);
                    CHECK(holds(spoilt, *kernels, 32) == Holds::partial);
                }
        }
    }
}
