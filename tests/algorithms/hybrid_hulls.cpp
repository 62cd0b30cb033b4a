// What squares of pixels say of a light is what each of their pixels says, and rays start inside of their hulls.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <random>

#include <glm/geometric.hpp>

#include "algorithms/hybrid/receiver_hulls.hpp"
#include "algorithms/hybrid/receivers.hpp"
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

CameraView viewFrom(glm::vec3 eye)
{
    CameraView view;
    gpu::ViewConstants& v = view.constants;
    v.eyeWs = glm::vec4(eye, 0.0f);
    v.rayCornerWs = glm::vec4(-0.7f, 0.5f, -1.0f, 0.0f);
    v.rayDxWs = glm::vec4(0.0095f, 0.001f, 0.0f, 0.0f);
    v.rayDyWs = glm::vec4(0.001f, -0.01f, 0.001f, 0.0f);
    v.depthScale = 0.1f;
    v.depthMul = 1.0f;
    v.depthAdd = 0.0f;
    v.skyDepth = 0.0f;
    v.offsetFactor = 1.0f;
    v.pixelSize = 0.01f;
    v.hasNormals = 1;
    view.normalFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
    view.extent = {kWidth + 5, kHeight + 3};
    view.area = {{3, 2}, {kWidth, kHeight}};
    return view;
}

Picture pictureOf(std::mt19937& random)
{
    Picture picture;
    picture.view = viewFrom(randomPoint(random, 30.0f));
    const CameraView& view = picture.view;
    const glm::vec3 eye(view.constants.eyeWs);
    picture.ahead = eye + glm::vec3(0.0f, 0.0f, -8.0f);
    glm::vec3 through[3], facing[3];
    for (int i = 0; i < 3; ++i) {
        through[i] = picture.ahead + randomPoint(random, 4.0f);
        facing[i] = glm::normalize(randomPoint(random, 1.0f) + glm::vec3(0.0f, 0.0f, 1e-3f));
    }
    const glm::vec3 ball = picture.ahead + randomPoint(random, 3.0f);
    std::vector<glm::vec4> normals;
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
            picture.depth.push_back(nearest < 60.0f ? 0.1f / nearest : 0.0f);
            normals.emplace_back(normal, 0.0f);
        }
    picture.normals.resize(normals.size() * sizeof(glm::vec4));
    std::memcpy(picture.normals.data(), normals.data(), picture.normals.size());
    return picture;
}

LightView lightOf(GnLightType type, glm::vec3 position, glm::vec3 direction)
{
    return test::lightOf(type, position, direction, 9.0f, 0.6f);
}

using Answer = SquareAnswers::Answer;

struct Census {
    int squares[4] = {}; ///< By answer.
    int wrong = 0;       ///< Pixels that do not say what their square does.
    int outside = 0;     ///< Rays that do not start in the hull, or farther from the surface than it says.
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

void checkSquares(const Picture& picture, const std::vector<ReceiverHull>& hulls, const LightView& light,
                  Census& census)
{
    const CameraView& view = picture.view;
    const HullPyramid pyramid(view.area.extent);
    const SquareAnswers answers(view, light);
    const Receivers receivers(view, light, picture.depth, picture.normals);
    for (std::uint32_t side = HullPyramid::kSmallest; side <= HullPyramid::kLargest; side *= 2)
        for (std::uint32_t top = 0; top < kHeight; top += side)
            for (std::uint32_t left = 0; left < kWidth; left += side) {
                const ReceiverHull& square = hulls[pyramid.index(side, left, top)];
                const Answer answer = answers.of(square);
                ++census.squares[static_cast<int>(answer)];
                if (answer == Answer::mixed) continue;
                const Hull hull = answer == Answer::rays ? answers.hull(square) : Hull{};
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
        const Picture picture = pictureOf(random);
        const CameraView& view = picture.view;
        std::vector<ReceiverHull> hulls(HullPyramid(view.area.extent).count());
        const auto all = kernelsHere();
        const lanes::Kernels& kernels = *all[std::size_t(trial) % all.size()];
        const BlockReader reader(kernels, view, picture.depth, picture.normals);
        const HullMaker maker(kernels, reader, view, hulls);
        for (std::uint32_t top = 0; top < kHeight; top += HullPyramid::kLargest)
            maker.row(top);
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
}
