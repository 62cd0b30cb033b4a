#include "algorithms/hybrid/receiver_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "algorithms/shared/receivers.hpp"

namespace gnomon {

using simd::DepthPlane;

namespace {

using Holds = ReceiverSquare::Holds;

Holds together(Holds a, Holds b)
{
    return a == Holds::beyond || a == b ? b : b == Holds::beyond ? a : Holds::partial;
}

/// Inverse linear depth of a depth value: affine, so its least and largest values in a square lie at corners.
struct InverseDepth {
    double mul, add;

    explicit InverseDepth(const gpu::ViewConstants& view)
        : mul(double(view.depthMul) / double(view.depthScale)), add(double(view.depthAdd) / double(view.depthScale))
    {
    }
    double of(double depth) const { return depth * mul + add; }
};

/// By how much depths of a square change, at most.
double changeIn(const ReceiverSquare& square)
{
    const DepthPlane& plane = square.plane;
    return std::abs(double(plane.dx)) * (square.width - 1) + std::abs(double(plane.dy)) * (square.height - 1) +
           double(plane.above) - double(plane.below);
}

/// How far depths, as they were unprojected, may lie off what the plane says. Sums of a plane are rounded by parts of
/// what changes within the square: six times in the smallest, eight times a level, where quarters change by no more
/// than twice as much. The product with depthMul is rounded by a part of the value itself.
double unsureDepth(const DepthPlane& plane, double change)
{
    return 0x1p-17 * change + 0x1p-24 * (std::abs(double(plane.depth)) + change);
}

/// Whether all of a square lies ahead of the eye and at distances that are numbers when they are squared.
bool isAhead(const ReceiverSquare& square, const InverseDepth& inverse)
{
    const DepthPlane& plane = square.plane;
    const double unsure = unsureDepth(plane, changeIn(square));
    const double least = inverse.of(plane.depth) + std::min(inverse.mul * plane.dx * (square.width - 1), 0.0) +
                         std::min(inverse.mul * plane.dy * (square.height - 1), 0.0) +
                         std::min(inverse.mul * (plane.below - unsure), inverse.mul * (plane.above + unsure));
    return least > 1e-15;
}

/// The plane at a pixel, from the depth `start`.
float planeAt(const DepthPlane& plane, float start, std::uint32_t column, std::uint32_t row)
{
    return (plane.depth - start) + (static_cast<float>(column) * plane.dx + static_cast<float>(row) * plane.dy);
}

} // namespace

ReceiverPyramid::ReceiverPyramid(VkExtent2D extent)
{
    const std::uint32_t rows = (extent.height + kLargest - 1) / kLargest;
    columns_ = (extent.width + kLargest - 1) / kLargest;
    first_[0] = 0;
    for (std::uint32_t level = 0; level < kLevels; ++level) {
        const std::uint32_t across = kLargest / (kSmallest << level);
        first_[level + 1] = first_[level] + std::size_t(columns_) * rows * across * across;
    }
}

std::size_t ReceiverPyramid::index(std::uint32_t side, std::uint32_t x, std::uint32_t y) const
{
    const auto level = static_cast<std::uint32_t>(std::countr_zero(side / kSmallest));
    return first_[level] + std::size_t(y / side) * (columns_ * (kLargest / side)) + x / side;
}

SquareMaker::SquareMaker(const simd::Kernels& kernels, const CameraView& view, std::span<const float> depth,
                         std::span<const std::byte> normals, std::span<ReceiverSquare> squares)
    : kernels_(kernels), view_(view.constants), area_(view.area), width_(view.extent.width), depth_(depth),
      normals_(normals), halfNormals_(view.normalFormat == VK_FORMAT_R16G16B16A16_SFLOAT), pyramid_(area_.extent),
      squares_(squares)
{
}

simd::SquareTexels SquareMaker::texels(std::uint32_t x, std::uint32_t y) const
{
    const std::size_t pixel =
        (static_cast<std::uint32_t>(area_.offset.y) + y) * width_ + static_cast<std::uint32_t>(area_.offset.x) + x;
    return {.depth = depth_.data() + pixel,
            .normals = normals_.data() + pixel * (halfNormals_ ? 8 : 16),
            .width = width_,
            .skyDepth = view_.skyDepth,
            .halfNormals = halfNormals_};
}

/// Eight rows at once are more than processors follow by themselves.
void SquareMaker::prefetch(std::uint32_t x, std::uint32_t y) const
{
    if (x >= area_.extent.width || y + simd::kSquareSide > area_.extent.height) return;
    const simd::SquareTexels there = texels(x, y);
    for (std::size_t row = 0; row < simd::kSquareSide; ++row) {
        prefetchRead(there.depth + row * width_);
        prefetchRead(static_cast<const std::byte*>(there.normals) + row * width_ * (halfNormals_ ? 8 : 16));
    }
}

/// One of the smallest squares, from its pixels.
void SquareMaker::smallest(std::uint32_t x, std::uint32_t y) const
{
    constexpr std::uint32_t side = ReceiverPyramid::kSmallest;
    static_assert(side == simd::kSquareSide);
    ReceiverSquare& square = squares_[pyramid_.index(side, x, y)];
    square.holds = Holds::beyond;
    if (x >= area_.extent.width || y >= area_.extent.height) return;
    square.left = static_cast<std::uint16_t>(x);
    square.top = static_cast<std::uint16_t>(y);
    square.width = square.height = side;
    const simd::SquareTexels from = texels(x, y);
    if (x + side > area_.extent.width || y + side > area_.extent.height) {
        square.holds = Holds::sky;
        for (std::uint32_t row = 0; row < std::min(side, area_.extent.height - y); ++row)
            for (std::uint32_t column = 0; column < std::min(side, area_.extent.width - x); ++column)
                if (from.depth[row * width_ + column] != view_.skyDepth) square.holds = Holds::partial;
        return;
    }
    simd::Square shown;
    kernels_.square(from, shown);
    square.holds = shown.receivers == 0 ? Holds::sky : Holds::partial;
    if (shown.receivers != side * side || shown.finite == 0) return;
    square.plane = shown.plane;
    for (int axis = 0; axis < 3; ++axis) {
        square.normalLower[axis] = shown.normalLower[axis];
        square.normalUpper[axis] = shown.normalUpper[axis];
    }
    if (isAhead(square, InverseDepth(view_))) square.holds = Holds::whole;
}

/// A larger square, from its quarters.
void SquareMaker::join(std::uint32_t side, std::uint32_t x, std::uint32_t y) const
{
    const std::uint32_t half = side / 2;
    const ReceiverSquare* quarters[4] = {
        &squares_[pyramid_.index(half, x, y)], &squares_[pyramid_.index(half, x + half, y)],
        &squares_[pyramid_.index(half, x, y + half)], &squares_[pyramid_.index(half, x + half, y + half)]};
    ReceiverSquare& square = squares_[pyramid_.index(side, x, y)];
    Holds holds = Holds::beyond;
    for (const ReceiverSquare* quarter : quarters)
        holds = together(holds, quarter->holds);
    square.holds = holds;
    if (holds != Holds::whole) return; // else the first quarter is: the area cuts to the right and down
    const ReceiverSquare& first = *quarters[0];
    square = first;
    if (quarters[1]->holds == Holds::whole) square.width = static_cast<std::uint8_t>(half + quarters[1]->width);
    if (quarters[2]->holds == Holds::whole) square.height = static_cast<std::uint8_t>(half + quarters[2]->height);
    DepthPlane& plane = square.plane;
    const float start = plane.depth;

    // As the smallest: mean slopes of the borders, now between what the outermost quarters' planes say.
    const std::uint32_t right = square.width - 1u, bottom = square.height - 1u;
    const auto corner = [&](std::uint32_t column, std::uint32_t row) {
        const ReceiverSquare& from = *quarters[(row >= half ? 2 : 0) + (column >= half ? 1 : 0)];
        return planeAt(from.plane, start, column % half, row % half);
    };
    const float topRight = corner(right, 0), bottomLeft = corner(0, bottom), last = corner(right, bottom);
    plane.dx = (topRight + (last - bottomLeft)) / static_cast<float>(2 * right);
    plane.dy = (bottomLeft + (last - topRight)) / static_cast<float>(2 * bottom);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const ReceiverSquare& part = *quarters[i];
        if (part.holds != Holds::whole) continue;
        square.normalLower = glm::min(square.normalLower, part.normalLower);
        square.normalUpper = glm::max(square.normalUpper, part.normalUpper);
        for (std::uint32_t at = 0; at < 4; ++at) { // two planes are farthest apart at corners
            const std::uint32_t column = at % 2 * (part.width - 1u), row = at / 2 * (part.height - 1u);
            const float off =
                planeAt(part.plane, start, column, row) - (static_cast<float>(i % 2 * half + column) * plane.dx +
                                                           static_cast<float>(i / 2 * half + row) * plane.dy);
            plane.below = std::min(plane.below, off + part.plane.below);
            plane.above = std::max(plane.above, off + part.plane.above);
        }
    }
    if (!isAhead(square, InverseDepth(view_))) square.holds = Holds::partial;
}

void SquareMaker::row(std::uint32_t top) const
{
    constexpr std::uint32_t side = ReceiverPyramid::kSmallest, largest = ReceiverPyramid::kLargest;
    const std::uint32_t width = (area_.extent.width + largest - 1) / largest * largest;
    for (std::uint32_t y = top; y < top + largest; y += side)
        for (std::uint32_t x = 0; x < width; x += side) {
            prefetch(x + 2 * side, y);
            smallest(x, y);
        }
    for (std::uint32_t joined = 2 * side; joined <= largest; joined *= 2)
        for (std::uint32_t y = top; y < top + largest; y += joined)
            for (std::uint32_t x = 0; x < width; x += joined)
                join(joined, x, y);
}

SquareAnswers::SquareAnswers(const CameraView& view, const LightView& light)
    : view_(view), light_(light), position_(light.position()), axis_(light.direction()), range_(light.constants.range),
      cosine_(-1.0), sine_(0.0),
      // receiverOffset() (shaders/shared/receiver.h)
      offset_(double(view.constants.offsetFactor) * double(leastCoordinate(view, light)) / 2097152.0),
      cone_(light.type == GN_LIGHT_TYPE_SPOT)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        axis_ = -axis_;
        return;
    }
    if (!cone_) return;
    cosine_ = light.constants.directionWs.w;
    sine_ = std::sqrt(std::max(1.0 - cosine_ * cosine_, 0.0));
}

/// What a square's depths enclose: the corners of what lies between two planes of image space and the square's borders.
/// Unprojecting keeps planes, so all of it lies between the corners in the world as well.
struct SquareAnswers::Prism {
    static constexpr int kCorners = 8;
    glm::dvec3 corner[kCorners]; ///< World, from the eye.
    glm::dvec3 rounding;         ///< By which a receiver or a ray's start may lie elsewhere than its depth says.
    double offset[2];            ///< Least and largest, but for what a light's place and far corners add.
};

SquareAnswers::Prism SquareAnswers::prismOf(const ReceiverSquare& square) const
{
    constexpr double u = 0x1p-24;
    const gpu::ViewConstants& v = view_.constants;
    const InverseDepth inverse(v);
    const DepthPlane& plane = square.plane;
    const double change = changeIn(square), unsure = unsureDepth(plane, change);
    const double across = square.width - 1, down = square.height - 1;
    const double left = view_.area.offset.x + square.left + 0.5, top = view_.area.offset.y + square.top + 0.5;
    const glm::dvec3 eye(glm::vec3(v.eyeWs)), ray0(glm::vec3(v.rayCornerWs)), dx(glm::vec3(v.rayDxWs)),
        dy(glm::vec3(v.rayDyWs)), deeper(glm::vec3(v.rayDepthWs));
    Prism prism;
    double nearest = 1e300, farthest = 0.0, longest = 0.0;
    for (int i = 0; i < 4; ++i) {
        const double column = i & 1 ? across : 0.0, row = i & 2 ? down : 0.0;
        const glm::dvec3 ray = ray0 + (left + column) * dx + (top + row) * dy;
        const double depth = plane.depth + column * plane.dx + row * plane.dy;
        const double ends[2] = {depth + (plane.below - unsure), depth + (plane.above + unsure)};
        const double w[2] = {1.0 / inverse.of(ends[0]), 1.0 / inverse.of(ends[1])};
        prism.corner[i] = w[0] * (ray + ends[0] * deeper);
        prism.corner[i + 4] = w[1] * (ray + ends[1] * deeper);
        nearest = std::min({nearest, w[0], w[1]});
        farthest = std::max({farthest, w[0], w[1]});
        longest = std::max(longest, glm::dot(ray, ray));
    }
    // View rays are rounded three times, by parts of their terms, linear depth twice (unsureDepth() counts the rest),
    // their product once; the sum with the eye's place and the ray's start once each. All of it twice.
    const glm::dvec3 terms =
        glm::abs(ray0) + (left + across) * glm::abs(dx) + (top + down) * glm::abs(dy) + glm::abs(deeper);
    prism.rounding = u * (12.0 * farthest * terms + 4.0 * glm::abs(eye));
    // receiverOffset() (shaders/shared/receiver.h), of the largest of everything; at least what the pixel's width
    // tells.
    const glm::dvec3 reach = farthest * terms, places = glm::max(reach, reach + glm::abs(eye));
    const double ulp =
        std::max(2.0 * u * (std::abs(double(plane.depth)) + change), 0x1p-149) + static_cast<double>(v.eyeWs.w);
    const double perDistance = double(v.offsetFactor) * double(v.pixelSize) / 256.0;
    prism.offset[0] = (1.0 - 1e-6) * perDistance * nearest;
    prism.offset[1] =
        (1.0 + 1e-6) *
        (perDistance * farthest +
         double(v.offsetFactor) * (farthest * farthest * std::abs(inverse.mul) * ulp * std::sqrt(longest) +
                                   glm::length(deeper) * ulp + std::max({places.x, places.y, places.z}) / 2097152.0));
    return prism;
}

SquareAnswers::Answer SquareAnswers::of(const ReceiverSquare& square) const
{
    if (square.holds == Holds::beyond || square.holds == Holds::sky) return Answer::lit;
    if (square.holds == Holds::partial) return Answer::mixed;
    // Ways to the light: single ones for directional lights, a box of them for the others.
    glm::dvec3 towards = axis_, spread(0.0);
    // Single precision squares what it compares: 1e-5 is far more than it loses, and a hundredth of a pixel.
    constexpr double kRounding = 1e-5;
    if (light_.type != GN_LIGHT_TYPE_DIRECTIONAL) {
        const Prism prism = prismOf(square);
        glm::dvec3 lower = prism.corner[0], upper = lower;
        for (const glm::dvec3& corner : prism.corner) {
            lower = glm::min(lower, corner);
            upper = glm::max(upper, corner);
        }
        const glm::dvec3 centre = glm::dvec3(glm::vec3(view_.constants.eyeWs)) + 0.5 * (lower + upper);
        towards = position_ - centre;
        spread = 0.5 * (upper - lower) + prism.rounding + kRounding * (glm::abs(position_) + glm::abs(centre));
        const double radius = glm::length(spread), distance = glm::length(towards);
        if (distance - radius > range_ * (1.0 + kRounding)) return Answer::lit;
        if (!(distance + radius < range_ * (1.0 - kRounding))) return Answer::mixed;
        if (cone_) {
            // distance * sin(angle to the axis - half angle) changes by no more than a point moves.
            const double along = -glm::dot(towards, axis_);
            const double across = std::sqrt(std::max(distance * distance - along * along, 0.0));
            const double outside = cosine_ * across - sine_ * along, unsure = radius + 1e-3 * distance;
            if (outside > unsure) return Answer::lit;
            if (!(outside < -unsure)) return Answer::mixed;
        }
    }
    double least = 0.0, most = 0.0, size = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double n[2] = {square.normalLower[i], square.normalUpper[i]};
        const double to[2] = {towards[i] - spread[i], towards[i] + spread[i]};
        const double products[4] = {n[0] * to[0], n[0] * to[1], n[1] * to[0], n[1] * to[1]};
        least += *std::min_element(products, products + 4);
        most += *std::max_element(products, products + 4);
        size += std::max(std::abs(n[0]), std::abs(n[1])) * std::max(std::abs(to[0]), std::abs(to[1]));
    }
    if (least > kRounding * size) return Answer::rays;
    return most < -kRounding * size ? Answer::dark : Answer::mixed;
}

Hull SquareAnswers::hull(const ReceiverSquare& square) const
{
    const Prism prism = prismOf(square);
    const glm::dvec3 normal = 0.5 * (glm::dvec3(square.normalLower) + glm::dvec3(square.normalUpper));
    const glm::dvec3 spread = glm::dvec3(square.normalUpper) - normal;
    // Thin across the surface itself, whichever way normals were interpolated; on the side they say.
    glm::dvec3 across = glm::cross(prism.corner[3] - prism.corner[0], prism.corner[1] - prism.corner[2]);
    if (glm::dot(across, normal) < 0.0) across = -across;
    Hull hull;
    hull.turn(across / std::max(glm::length(across), 1e-300), glm::dvec3(glm::vec3(view_.constants.rayDxWs)));
    hull.largestOffset = prism.offset[1] + offset_;
    hull.centre = glm::vec3(view_.constants.eyeWs);
    // Rays start where normals point, not on both sides: else every surface would lie within its own hull.
    const double shortest = std::max(glm::length(glm::max(glm::abs(normal) - spread, 0.0)), 1e-300);
    const double longest = std::max(glm::length(glm::abs(normal) + spread), 1e-300);
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 axis = hull.axis[i], size = glm::abs(axis);
        const double middle = glm::dot(axis, normal), around = glm::dot(size, spread);
        const double low = middle - around, high = middle + around;
        const double leastCosine = std::max(low / (low < 0.0 ? shortest : longest), -1.0);
        const double mostCosine = std::min(high / (high < 0.0 ? longest : shortest), 1.0);
        double lower = glm::dot(axis, prism.corner[0]), upper = lower;
        for (const glm::dvec3& corner : prism.corner) {
            const double along = glm::dot(axis, corner);
            lower = std::min(lower, along);
            upper = std::max(upper, along);
        }
        lower += leastCosine * (leastCosine < 0.0 ? hull.largestOffset : prism.offset[0]);
        upper += mostCosine * (mostCosine < 0.0 ? prism.offset[0] : hull.largestOffset);
        hull.centre += axis * (0.5 * (lower + upper));
        hull.half[i] = 0.5 * (upper - lower) + glm::dot(size, prism.rounding) + 1e-6 * hull.largestOffset;
    }
    return hull;
}

} // namespace gnomon
